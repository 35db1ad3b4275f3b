// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Straight lines through 1/m and 1/sqrt(m), from which the exact slow unit
// starts: y = start - slope * offset with 15 fraction bits.
// index_i: {root, odd, i[5:0]}; root 0: 1/m, m in [1 + i/64, 1 + (i+1)/64) (odd is 0);
// root 1: 1/sqrt(m), or 1/sqrt(2m) when odd.
// offset: the 11 bits of m below i, weighing 2^-7 .. 2^-17. slope (11 fraction bits): the chord's, rounded; start
// (18): makes the largest errors of both signs equal, with half a unit of y in it, so that cutting y off rounds it.
// Relative error of y: at most 2^-14.29.
// enable_i takes index_i; row_o = {start[17:0], slope[10:0]} is there from the next cycle on.
`default_nettype none
module rp_slow_line_table #(
  parameter integer WITHOUT = 0   // as rp_slow_operations.vh has it: only roots take lines of root 1
) (
  input  wire        clk_i,
  input  wire        enable_i,
  input  wire [7:0]  index_i,
  output wire [28:0] row_o
);
  reg [28:0] row_q;
  assign row_o = row_q;
  `include "rp_slow_operations.vh"
  wire [1:0] operation = possible_operation(index_i[7], 1'b0);
  wire [7:0] index = {operation[1], index_i[6] && (WITHOUT & 6) != 6, index_i[5:0]};
  always @(posedge clk_i) begin
    if (enable_i) begin
      case (index)
        8'h00: row_q <= 29'h1fffdfe0; 8'h01: row_q <= 29'h1f81d7a3; 8'h02: row_q <= 29'h1f07a769;
        8'h03: row_q <= 29'h1e911731; 8'h04: row_q <= 29'h1e1e0efc; 8'h05: row_q <= 29'h1dae4ec9;
        8'h06: row_q <= 29'h1d41c698; 8'h07: row_q <= 29'h1cd84669; 8'h08: row_q <= 29'h1c71be3c;
        8'h09: row_q <= 29'h1c0dfe11; 8'h0a: row_q <= 29'h1bacede7; 8'h0b: row_q <= 29'h1b4e7dc0;
        8'h0c: row_q <= 29'h1af27d99; 8'h0d: row_q <= 29'h1a98ed75; 8'h0e: row_q <= 29'h1a419d51;
        8'h0f: row_q <= 29'h19ec8d2f; 8'h10: row_q <= 29'h19999d0f; 8'h11: row_q <= 29'h1948b4ef;
        8'h12: row_q <= 29'h18f9ccd1; 8'h13: row_q <= 29'h18acbcb3; 8'h14: row_q <= 29'h18618c97;
        8'h15: row_q <= 29'h1818247c; 8'h16: row_q <= 29'h17d06461; 8'h17: row_q <= 29'h178a5448;
        8'h18: row_q <= 29'h1745dc2f; 8'h19: row_q <= 29'h1702e417; 8'h1a: row_q <= 29'h16c17400;
        8'h1b: row_q <= 29'h168173ea; 8'h1c: row_q <= 29'h1642d3d4; 8'h1d: row_q <= 29'h160593c0;
        8'h1e: row_q <= 29'h15c993ab; 8'h1f: row_q <= 29'h158ee398; 8'h20: row_q <= 29'h15556385;
        8'h21: row_q <= 29'h151d1372; 8'h22: row_q <= 29'h14e5f361; 8'h23: row_q <= 29'h14afe34f;
        8'h24: row_q <= 29'h147af33f; 8'h25: row_q <= 29'h14470b2e; 8'h26: row_q <= 29'h1414231e;
        8'h27: row_q <= 29'h13e23b0f; 8'h28: row_q <= 29'h13b14b00; 8'h29: row_q <= 29'h13814af2;
        8'h2a: row_q <= 29'h135232e4; 8'h2b: row_q <= 29'h1323fad6; 8'h2c: row_q <= 29'h12f69ac9;
        8'h2d: row_q <= 29'h12ca12bc; 8'h2e: row_q <= 29'h129e52af; 8'h2f: row_q <= 29'h12736aa3;
        8'h30: row_q <= 29'h12493a97; 8'h31: row_q <= 29'h121fca8b; 8'h32: row_q <= 29'h11f71a80;
        8'h33: row_q <= 29'h11cf1a75; 8'h34: row_q <= 29'h11a7d26a; 8'h35: row_q <= 29'h11813260;
        8'h36: row_q <= 29'h115b3255; 8'h37: row_q <= 29'h1135da4b; 8'h38: row_q <= 29'h11112a42;
        8'h39: row_q <= 29'h10ed0a38; 8'h3a: row_q <= 29'h10c98a2f; 8'h3b: row_q <= 29'h10a69a26;
        8'h3c: row_q <= 29'h10843a1d; 8'h3d: row_q <= 29'h10626a15; 8'h3e: row_q <= 29'h10411a0c;
        8'h3f: row_q <= 29'h10205a04; 8'h80: row_q <= 29'h1ffffbf4; 8'h81: row_q <= 29'h1fc0c3dd;
        8'h82: row_q <= 29'h1f82fbc7; 8'h83: row_q <= 29'h1f468bb1; 8'h84: row_q <= 29'h1f0b739d;
        8'h85: row_q <= 29'h1ed1ab89; 8'h86: row_q <= 29'h1e991b76; 8'h87: row_q <= 29'h1e61bb63;
        8'h88: row_q <= 29'h1e2b8b51; 8'h89: row_q <= 29'h1df67b40; 8'h8a: row_q <= 29'h1dc2732f;
        8'h8b: row_q <= 29'h1d8f831f; 8'h8c: row_q <= 29'h1d5d9310; 8'h8d: row_q <= 29'h1d2c9300;
        8'h8e: row_q <= 29'h1cfc92f2; 8'h8f: row_q <= 29'h1ccd72e4; 8'h90: row_q <= 29'h1c9f3ad6;
        8'h91: row_q <= 29'h1c71dac9; 8'h92: row_q <= 29'h1c4552bc; 8'h93: row_q <= 29'h1c1992af;
        8'h94: row_q <= 29'h1beea2a3; 8'h95: row_q <= 29'h1bc47297; 8'h96: row_q <= 29'h1b9b028c;
        8'h97: row_q <= 29'h1b724a81; 8'h98: row_q <= 29'h1b4a4276; 8'h99: row_q <= 29'h1b22e26b;
        8'h9a: row_q <= 29'h1afc3261; 8'h9b: row_q <= 29'h1ad62257; 8'h9c: row_q <= 29'h1ab0b24d;
        8'h9d: row_q <= 29'h1a8bda44; 8'h9e: row_q <= 29'h1a67a23b; 8'h9f: row_q <= 29'h1a43f232;
        8'ha0: row_q <= 29'h1a20d229; 8'ha1: row_q <= 29'h19fe4a21; 8'ha2: row_q <= 29'h19dc3a18;
        8'ha3: row_q <= 29'h19bab210; 8'ha4: row_q <= 29'h1999b208; 8'ha5: row_q <= 29'h19793201;
        8'ha6: row_q <= 29'h195921f9; 8'ha7: row_q <= 29'h193989f2; 8'ha8: row_q <= 29'h191a71eb;
        8'ha9: row_q <= 29'h18fbc1e4; 8'haa: row_q <= 29'h18dd81dd; 8'hab: row_q <= 29'h18bfb1d6;
        8'hac: row_q <= 29'h18a251d0; 8'had: row_q <= 29'h188551ca; 8'hae: row_q <= 29'h1868b1c3;
        8'haf: row_q <= 29'h184c81bd; 8'hb0: row_q <= 29'h1830a9b7; 8'hb1: row_q <= 29'h181539b2;
        8'hb2: row_q <= 29'h17fa19ac; 8'hb3: row_q <= 29'h17df59a6; 8'hb4: row_q <= 29'h17c4f9a1;
        8'hb5: row_q <= 29'h17aae99c; 8'hb6: row_q <= 29'h17912996; 8'hb7: row_q <= 29'h1777c991;
        8'hb8: row_q <= 29'h175eb18c; 8'hb9: row_q <= 29'h1745e987; 8'hba: row_q <= 29'h172d7983;
        8'hbb: row_q <= 29'h1715497e; 8'hbc: row_q <= 29'h16fd6979; 8'hbd: row_q <= 29'h16e5d175;
        8'hbe: row_q <= 29'h16ce8971; 8'hbf: row_q <= 29'h16b7796c; 8'hc0: row_q <= 29'h16a0b2cc;
        8'hc1: row_q <= 29'h1673f2bb; 8'hc2: row_q <= 29'h164842ac; 8'hc3: row_q <= 29'h161d8a9d;
        8'hc4: row_q <= 29'h15f3ba8e; 8'hc5: row_q <= 29'h15cae280; 8'hc6: row_q <= 29'h15a2e272;
        8'hc7: row_q <= 29'h157bba65; 8'hc8: row_q <= 29'h15556a59; 8'hc9: row_q <= 29'h152fe24c;
        8'hca: row_q <= 29'h150b2241; 8'hcb: row_q <= 29'h14e71235; 8'hcc: row_q <= 29'h14c3c22a;
        8'hcd: row_q <= 29'h14a1221f; 8'hce: row_q <= 29'h147f2a15; 8'hcf: row_q <= 29'h145dda0b;
        8'hd0: row_q <= 29'h143d2a01; 8'hd1: row_q <= 29'h141d19f8; 8'hd2: row_q <= 29'h13fd99ef;
        8'hd3: row_q <= 29'h13dea9e6; 8'hd4: row_q <= 29'h13c049dd; 8'hd5: row_q <= 29'h13a279d5;
        8'hd6: row_q <= 29'h138529cd; 8'hd7: row_q <= 29'h136861c5; 8'hd8: row_q <= 29'h134c09bd;
        8'hd9: row_q <= 29'h133039b6; 8'hda: row_q <= 29'h1314e1af; 8'hdb: row_q <= 29'h12f9f9a8;
        8'hdc: row_q <= 29'h12df79a1; 8'hdd: row_q <= 29'h12c5719a; 8'hde: row_q <= 29'h12abd194;
        8'hdf: row_q <= 29'h1292918d; 8'he0: row_q <= 29'h1279c187; 8'he1: row_q <= 29'h12615181;
        8'he2: row_q <= 29'h1249417b; 8'he3: row_q <= 29'h12319176; 8'he4: row_q <= 29'h121a3170;
        8'he5: row_q <= 29'h1203396b; 8'he6: row_q <= 29'h11ec8965; 8'he7: row_q <= 29'h11d63960;
        8'he8: row_q <= 29'h11c0395b; 8'he9: row_q <= 29'h11aa8156; 8'hea: row_q <= 29'h11952151;
        8'heb: row_q <= 29'h1180114d; 8'hec: row_q <= 29'h116b4148; 8'hed: row_q <= 29'h1156c944;
        8'hee: row_q <= 29'h1142893f; 8'hef: row_q <= 29'h112e993b; 8'hf0: row_q <= 29'h111af137;
        8'hf1: row_q <= 29'h11078133; 8'hf2: row_q <= 29'h10f4592f; 8'hf3: row_q <= 29'h10e1712b;
        8'hf4: row_q <= 29'h10cec127; 8'hf5: row_q <= 29'h10bc5123; 8'hf6: row_q <= 29'h10aa211f;
        8'hf7: row_q <= 29'h1098311c; 8'hf8: row_q <= 29'h10867118; 8'hf9: row_q <= 29'h1074f115;
        8'hfa: row_q <= 29'h1063a111; 8'hfb: row_q <= 29'h1052890e; 8'hfc: row_q <= 29'h1041a90b;
        8'hfd: row_q <= 29'h1030f908; 8'hfe: row_q <= 29'h10208105; 8'hff: row_q <= 29'h10103902;
        default: row_q <= 29'h00000000;    // odd without root: never asked for
      endcase
    end
  end
endmodule
`default_nettype wire
