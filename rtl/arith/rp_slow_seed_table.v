// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Seeds of the Newton slow unit: the byte s stands for (256 + s) / 512. index_i: {0, i[6:0]}: 1/m for the middle m of
// [1 + i/128, 1 + (i+1)/128); {1, odd, i[5:0]}: 1/sqrt(m), or 1/sqrt(2m) when odd, for the
// middle m of [1 + i/64, 1 + (i+1)/64).
// enable_i takes index_i; seed_o is there from the next cycle on. The same numbers are
// computed in cpp_model/arith/arith.cpp.
`default_nettype none
module rp_slow_seed_table (
  input  wire       clk_i,
  input  wire       enable_i,
  input  wire [7:0] index_i,
  output wire [7:0] seed_o
);
  reg [7:0] seed_q;
  assign seed_o = seed_q;
  always @(posedge clk_i) begin
    if (enable_i) begin
      case (index_i)
        8'h00: seed_q <= 8'hfe; 8'h01: seed_q <= 8'hfa; 8'h02: seed_q <= 8'hf6; 8'h03: seed_q <= 8'hf2;
        8'h04: seed_q <= 8'hef; 8'h05: seed_q <= 8'heb; 8'h06: seed_q <= 8'he7; 8'h07: seed_q <= 8'he4;
        8'h08: seed_q <= 8'he0; 8'h09: seed_q <= 8'hdd; 8'h0a: seed_q <= 8'hd9; 8'h0b: seed_q <= 8'hd6;
        8'h0c: seed_q <= 8'hd2; 8'h0d: seed_q <= 8'hcf; 8'h0e: seed_q <= 8'hcc; 8'h0f: seed_q <= 8'hc9;
        8'h10: seed_q <= 8'hc6; 8'h11: seed_q <= 8'hc2; 8'h12: seed_q <= 8'hbf; 8'h13: seed_q <= 8'hbc;
        8'h14: seed_q <= 8'hb9; 8'h15: seed_q <= 8'hb6; 8'h16: seed_q <= 8'hb3; 8'h17: seed_q <= 8'hb1;
        8'h18: seed_q <= 8'hae; 8'h19: seed_q <= 8'hab; 8'h1a: seed_q <= 8'ha8; 8'h1b: seed_q <= 8'ha5;
        8'h1c: seed_q <= 8'ha3; 8'h1d: seed_q <= 8'ha0; 8'h1e: seed_q <= 8'h9d; 8'h1f: seed_q <= 8'h9b;
        8'h20: seed_q <= 8'h98; 8'h21: seed_q <= 8'h96; 8'h22: seed_q <= 8'h93; 8'h23: seed_q <= 8'h91;
        8'h24: seed_q <= 8'h8e; 8'h25: seed_q <= 8'h8c; 8'h26: seed_q <= 8'h8a; 8'h27: seed_q <= 8'h87;
        8'h28: seed_q <= 8'h85; 8'h29: seed_q <= 8'h83; 8'h2a: seed_q <= 8'h80; 8'h2b: seed_q <= 8'h7e;
        8'h2c: seed_q <= 8'h7c; 8'h2d: seed_q <= 8'h7a; 8'h2e: seed_q <= 8'h78; 8'h2f: seed_q <= 8'h75;
        8'h30: seed_q <= 8'h73; 8'h31: seed_q <= 8'h71; 8'h32: seed_q <= 8'h6f; 8'h33: seed_q <= 8'h6d;
        8'h34: seed_q <= 8'h6b; 8'h35: seed_q <= 8'h69; 8'h36: seed_q <= 8'h67; 8'h37: seed_q <= 8'h65;
        8'h38: seed_q <= 8'h63; 8'h39: seed_q <= 8'h61; 8'h3a: seed_q <= 8'h5f; 8'h3b: seed_q <= 8'h5e;
        8'h3c: seed_q <= 8'h5c; 8'h3d: seed_q <= 8'h5a; 8'h3e: seed_q <= 8'h58; 8'h3f: seed_q <= 8'h56;
        8'h40: seed_q <= 8'h54; 8'h41: seed_q <= 8'h53; 8'h42: seed_q <= 8'h51; 8'h43: seed_q <= 8'h4f;
        8'h44: seed_q <= 8'h4e; 8'h45: seed_q <= 8'h4c; 8'h46: seed_q <= 8'h4a; 8'h47: seed_q <= 8'h49;
        8'h48: seed_q <= 8'h47; 8'h49: seed_q <= 8'h45; 8'h4a: seed_q <= 8'h44; 8'h4b: seed_q <= 8'h42;
        8'h4c: seed_q <= 8'h40; 8'h4d: seed_q <= 8'h3f; 8'h4e: seed_q <= 8'h3d; 8'h4f: seed_q <= 8'h3c;
        8'h50: seed_q <= 8'h3a; 8'h51: seed_q <= 8'h39; 8'h52: seed_q <= 8'h37; 8'h53: seed_q <= 8'h36;
        8'h54: seed_q <= 8'h34; 8'h55: seed_q <= 8'h33; 8'h56: seed_q <= 8'h32; 8'h57: seed_q <= 8'h30;
        8'h58: seed_q <= 8'h2f; 8'h59: seed_q <= 8'h2d; 8'h5a: seed_q <= 8'h2c; 8'h5b: seed_q <= 8'h2b;
        8'h5c: seed_q <= 8'h29; 8'h5d: seed_q <= 8'h28; 8'h5e: seed_q <= 8'h27; 8'h5f: seed_q <= 8'h25;
        8'h60: seed_q <= 8'h24; 8'h61: seed_q <= 8'h23; 8'h62: seed_q <= 8'h21; 8'h63: seed_q <= 8'h20;
        8'h64: seed_q <= 8'h1f; 8'h65: seed_q <= 8'h1e; 8'h66: seed_q <= 8'h1c; 8'h67: seed_q <= 8'h1b;
        8'h68: seed_q <= 8'h1a; 8'h69: seed_q <= 8'h19; 8'h6a: seed_q <= 8'h17; 8'h6b: seed_q <= 8'h16;
        8'h6c: seed_q <= 8'h15; 8'h6d: seed_q <= 8'h14; 8'h6e: seed_q <= 8'h13; 8'h6f: seed_q <= 8'h12;
        8'h70: seed_q <= 8'h10; 8'h71: seed_q <= 8'h0f; 8'h72: seed_q <= 8'h0e; 8'h73: seed_q <= 8'h0d;
        8'h74: seed_q <= 8'h0c; 8'h75: seed_q <= 8'h0b; 8'h76: seed_q <= 8'h0a; 8'h77: seed_q <= 8'h09;
        8'h78: seed_q <= 8'h08; 8'h79: seed_q <= 8'h07; 8'h7a: seed_q <= 8'h06; 8'h7b: seed_q <= 8'h05;
        8'h7c: seed_q <= 8'h04; 8'h7d: seed_q <= 8'h03; 8'h7e: seed_q <= 8'h02; 8'h7f: seed_q <= 8'h01;
        8'h80: seed_q <= 8'hfe; 8'h81: seed_q <= 8'hfa; 8'h82: seed_q <= 8'hf6; 8'h83: seed_q <= 8'hf3;
        8'h84: seed_q <= 8'hef; 8'h85: seed_q <= 8'heb; 8'h86: seed_q <= 8'he8; 8'h87: seed_q <= 8'he4;
        8'h88: seed_q <= 8'he1; 8'h89: seed_q <= 8'hde; 8'h8a: seed_q <= 8'hdb; 8'h8b: seed_q <= 8'hd7;
        8'h8c: seed_q <= 8'hd4; 8'h8d: seed_q <= 8'hd1; 8'h8e: seed_q <= 8'hce; 8'h8f: seed_q <= 8'hcb;
        8'h90: seed_q <= 8'hc9; 8'h91: seed_q <= 8'hc6; 8'h92: seed_q <= 8'hc3; 8'h93: seed_q <= 8'hc0;
        8'h94: seed_q <= 8'hbe; 8'h95: seed_q <= 8'hbb; 8'h96: seed_q <= 8'hb8; 8'h97: seed_q <= 8'hb6;
        8'h98: seed_q <= 8'hb3; 8'h99: seed_q <= 8'hb1; 8'h9a: seed_q <= 8'haf; 8'h9b: seed_q <= 8'hac;
        8'h9c: seed_q <= 8'haa; 8'h9d: seed_q <= 8'ha8; 8'h9e: seed_q <= 8'ha5; 8'h9f: seed_q <= 8'ha3;
        8'ha0: seed_q <= 8'ha1; 8'ha1: seed_q <= 8'h9f; 8'ha2: seed_q <= 8'h9d; 8'ha3: seed_q <= 8'h9b;
        8'ha4: seed_q <= 8'h99; 8'ha5: seed_q <= 8'h97; 8'ha6: seed_q <= 8'h95; 8'ha7: seed_q <= 8'h93;
        8'ha8: seed_q <= 8'h91; 8'ha9: seed_q <= 8'h8f; 8'haa: seed_q <= 8'h8d; 8'hab: seed_q <= 8'h8b;
        8'hac: seed_q <= 8'h89; 8'had: seed_q <= 8'h87; 8'hae: seed_q <= 8'h86; 8'haf: seed_q <= 8'h84;
        8'hb0: seed_q <= 8'h82; 8'hb1: seed_q <= 8'h80; 8'hb2: seed_q <= 8'h7f; 8'hb3: seed_q <= 8'h7d;
        8'hb4: seed_q <= 8'h7b; 8'hb5: seed_q <= 8'h7a; 8'hb6: seed_q <= 8'h78; 8'hb7: seed_q <= 8'h77;
        8'hb8: seed_q <= 8'h75; 8'hb9: seed_q <= 8'h74; 8'hba: seed_q <= 8'h72; 8'hbb: seed_q <= 8'h71;
        8'hbc: seed_q <= 8'h6f; 8'hbd: seed_q <= 8'h6e; 8'hbe: seed_q <= 8'h6c; 8'hbf: seed_q <= 8'h6b;
        8'hc0: seed_q <= 8'h69; 8'hc1: seed_q <= 8'h66; 8'hc2: seed_q <= 8'h63; 8'hc3: seed_q <= 8'h61;
        8'hc4: seed_q <= 8'h5e; 8'hc5: seed_q <= 8'h5b; 8'hc6: seed_q <= 8'h59; 8'hc7: seed_q <= 8'h57;
        8'hc8: seed_q <= 8'h54; 8'hc9: seed_q <= 8'h52; 8'hca: seed_q <= 8'h50; 8'hcb: seed_q <= 8'h4d;
        8'hcc: seed_q <= 8'h4b; 8'hcd: seed_q <= 8'h49; 8'hce: seed_q <= 8'h47; 8'hcf: seed_q <= 8'h45;
        8'hd0: seed_q <= 8'h43; 8'hd1: seed_q <= 8'h41; 8'hd2: seed_q <= 8'h3f; 8'hd3: seed_q <= 8'h3d;
        8'hd4: seed_q <= 8'h3b; 8'hd5: seed_q <= 8'h39; 8'hd6: seed_q <= 8'h37; 8'hd7: seed_q <= 8'h36;
        8'hd8: seed_q <= 8'h34; 8'hd9: seed_q <= 8'h32; 8'hda: seed_q <= 8'h30; 8'hdb: seed_q <= 8'h2f;
        8'hdc: seed_q <= 8'h2d; 8'hdd: seed_q <= 8'h2c; 8'hde: seed_q <= 8'h2a; 8'hdf: seed_q <= 8'h28;
        8'he0: seed_q <= 8'h27; 8'he1: seed_q <= 8'h25; 8'he2: seed_q <= 8'h24; 8'he3: seed_q <= 8'h22;
        8'he4: seed_q <= 8'h21; 8'he5: seed_q <= 8'h1f; 8'he6: seed_q <= 8'h1e; 8'he7: seed_q <= 8'h1d;
        8'he8: seed_q <= 8'h1b; 8'he9: seed_q <= 8'h1a; 8'hea: seed_q <= 8'h19; 8'heb: seed_q <= 8'h17;
        8'hec: seed_q <= 8'h16; 8'hed: seed_q <= 8'h15; 8'hee: seed_q <= 8'h14; 8'hef: seed_q <= 8'h12;
        8'hf0: seed_q <= 8'h11; 8'hf1: seed_q <= 8'h10; 8'hf2: seed_q <= 8'h0f; 8'hf3: seed_q <= 8'h0d;
        8'hf4: seed_q <= 8'h0c; 8'hf5: seed_q <= 8'h0b; 8'hf6: seed_q <= 8'h0a; 8'hf7: seed_q <= 8'h09;
        8'hf8: seed_q <= 8'h08; 8'hf9: seed_q <= 8'h07; 8'hfa: seed_q <= 8'h06; 8'hfb: seed_q <= 8'h05;
        8'hfc: seed_q <= 8'h04; 8'hfd: seed_q <= 8'h03; 8'hfe: seed_q <= 8'h02;
        default: seed_q <= 8'h01;
      endcase
    end
  end
endmodule
`default_nettype wire
