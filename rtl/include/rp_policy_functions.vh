// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// What the controller's policies share: the kinds of kernels, and functions of numbers.
localparam [1:0] HALT = 2'd0, EYE = 2'd1, SECONDARY = 2'd2, SHADE = 2'd3;

function integer smaller(input integer a, input integer b);
  smaller = (a < b) ? a : b;
endfunction

function integer larger(input integer a, input integer b);
  larger = (a > b) ? a : b;
endfunction

function [COUNT_BITS-1:0] least(input [COUNT_BITS-1:0] a, input [COUNT_BITS-1:0] b);
  least = (a < b) ? a : b;
endfunction
