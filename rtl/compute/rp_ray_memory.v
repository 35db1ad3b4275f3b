// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// One set of local ray memory: BANKS 32-bit single-port banks, WORDS words for each of CONTENTS threads. Word k of
// thread t lies in bank (t+k)%BANKS, row k*ceil(CONTENTS/BANKS) + t/BANKS, so that an access moves one word of BANKS
// threads a cycle, or words of one thread: four are read, as many as eight written.
// Element e of an access is word word_i + e of thread thread_i with package_i (e below 4, or 8 of a write with so many
// BANKS), else word word_i of thread thread_i + e (e below BANKS); then thread_i must be a multiple of BANKS. A cycle
// with write_i other than 0 writes these elements, else read_i reads all of them; they appear in data_o in the next
// cycle and stay until the next read. Words written or looked at must be 0 .. WORDS-1.
`default_nettype none
module rp_ray_memory #(
  parameter integer CONTENTS = 64,
  parameter integer WORDS = 21,
  parameter integer BANKS = 4          // 4, 8, 16 or 32; more than 4 only with as many CONTENTS at least
) (
  input  wire                clk_i,
  input  wire                read_i,
  input  wire [BANKS-1:0]    write_i,
  input  wire                package_i,
  input  wire [9:0]          thread_i,
  input  wire [4:0]          word_i,
  input  wire [BANKS*32-1:0] data_i,
  output wire [BANKS*32-1:0] data_o
);
  localparam integer BANK_BITS = $clog2(BANKS);
  localparam integer PACKAGE_BITS = (BANKS > 4) ? 3 : 2;   // of an element's number in a package
  localparam integer COLUMNS = (CONTENTS > BANKS) ? CONTENTS / BANKS : 1;
  localparam integer COLUMN_BITS = $clog2(COLUMNS);
  localparam integer DEPTH = WORDS * COLUMNS;
  localparam integer ADDRESS_BITS = $clog2(DEPTH);

  // Element e is in bank (e + shift) % BANKS.
  wire [BANK_BITS-1:0] shift = thread_i[BANK_BITS-1:0] + word_i[BANK_BITS-1:0];
  wire reading = read_i && write_i == {BANKS{1'b0}};
  reg [BANK_BITS-1:0] shift_q;
  wire [BANKS*32-1:0] bank_read;
  wire [9:0] column = thread_i >> BANK_BITS;

  always @(posedge clk_i) if (reading) shift_q <= shift;

  genvar b;
  generate
    for (b = 0; b < BANKS; b = b + 1) begin : gen_bank
      localparam [BANK_BITS-1:0] BANK = b;
      wire [BANK_BITS-1:0] element = BANK - shift;
      wire [4:0] word = package_i ? word_i + {{5-PACKAGE_BITS{1'b0}}, element[PACKAGE_BITS-1:0]} : word_i;
      wire [12:0] row = ({8'd0, word} << COLUMN_BITS) | {3'd0, column};
      wire write = write_i[element];
      wire read;
      if (BANKS > 4) assign read = reading && (!package_i || element[BANK_BITS-1:2] == 0);
      else assign read = reading;
      wire unused = &{1'b0, row};   // a small set leaves the upper bits
      rp_ram_1rw #(.WIDTH(32), .DEPTH(DEPTH)) u_bank (
        .clk_i(clk_i),
        .enable_i(write || read),
        .write_i(write),
        .address_i(row[ADDRESS_BITS-1:0]),
        .data_i(data_i[{element, 5'd0} +: 32]),
        .data_o(bank_read[b*32 +: 32])
      );
      wire [BANK_BITS-1:0] from = BANK + shift_q;   // of element b
      assign data_o[b*32 +: 32] = bank_read[{from, 5'd0} +: 32];
    end
  endgenerate
endmodule
`default_nettype wire
