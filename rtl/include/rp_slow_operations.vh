// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
  // What the lane may be asked for. WITHOUT: operations of slw that it lacks, bit 0 fdiv, 1 fsqrt, 2 frsqrt, 3 frcp.
  // {root, unary}, constant where nothing else can come: registers and logic behind it then go.
  function [1:0] possible_operation(input ask_root, input ask_unary);
    reg is_root, only_unary, never_unary;
    begin
      is_root = (WITHOUT & 6) == 6 ? 1'b0 : (WITHOUT & 9) == 9 ? 1'b1 : ask_root;
      only_unary = is_root ? (WITHOUT & 2) != 0 : (WITHOUT & 1) != 0;
      never_unary = is_root ? (WITHOUT & 4) != 0 : (WITHOUT & 8) != 0;
      possible_operation = {is_root, only_unary || (ask_unary && !never_unary)};
    end
  endfunction
