// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Included in a module: bit i is set if all bits of x below i are ones, so that x + 1 is x ^ ones_below(x), and x + c
// for a bit c that comes late is x ^ (ones_below(x) & {64{c}}). In log2(64) steps; what is not used of it costs
// nothing. Where it is called under no condition it needs no variables of the instance in Verilator, so that instances
// share their code (sim/rtl/shared_modules.vlt).
function [63:0] ones_below(input [62:0] x);
  reg [63:0] ones;
  integer step;
  begin
    ones = {x, 1'b1};
    for (step = 1; step < 64; step = step * 2) ones = ones & ((ones << step) | ~({64{1'b1}} << step));
    ones_below = ones;
  end
endfunction
