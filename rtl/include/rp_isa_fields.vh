// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
  // Generated from cpp_model/isa/isa.hpp by `raypool isa --write`; a test compares. Do not edit.
  // The fields of `instruction`, to be included behind its declaration. A module uses some of them only.
  /* verilator lint_off UNUSEDSIGNAL */
  wire [3:0] field_type = instruction[63:60];
  wire [4:0] field_operation = instruction[59:55];
  wire field_guard_negated = instruction[54];
  wire [3:0] field_guard = instruction[53:50];
  wire [3:0] field_rd = instruction[49:46];
  wire [3:0] field_ra = instruction[45:42];
  wire [3:0] field_rb = instruction[41:38];
  wire field_b_is_immediate = instruction[37];
  wire [4:0] field_x = instruction[36:32];
  wire [31:0] field_immediate = instruction[31:0];
  wire [15:0] field_target = instruction[15:0];
  wire [15:0] field_end = instruction[31:16];
  /* verilator lint_on UNUSEDSIGNAL */
