// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// A number moved up until its first bit is at the top, and by how many places: combinational. A zero stays one. With
// LEFT the last steps, less than 2^LEFT places together, are left to be taken.
`default_nettype none
module rp_normaliser #(
  parameter integer WIDTH = 24,
  parameter integer LEFT = 0,
  parameter integer PLACES_BITS = $clog2(WIDTH)
) (
  input  wire [WIDTH-1:0]       value_i,
  output reg  [WIDTH-1:0]       moved_o,
  output reg  [PLACES_BITS-1:0] places_o
);
  integer step;
  always @* begin
    moved_o = value_i;
    places_o = {PLACES_BITS{1'b0}};
    for (step = PLACES_BITS - 1; step >= LEFT; step = step - 1)
      if (moved_o >> (WIDTH - (1 << step)) == {WIDTH{1'b0}}) begin
        moved_o = moved_o << (1 << step);
        places_o[step] = 1'b1;
      end
  end
endmodule
`default_nettype wire
