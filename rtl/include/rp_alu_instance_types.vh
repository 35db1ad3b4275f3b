// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
  // Generated from cpp_model/isa/isa.hpp by `raypool isa --write`; a test compares. Do not edit.
  localparam integer ALU_TYPES = 7;
  localparam integer INSTANCES = TID_COUNT + BRH_COUNT + 1 + INT_COUNT + FLT_COUNT + SLW_COUNT + 1;
  // The type of each instance, the first one's lowest: by type, in the order of the types' numbers.
  localparam [INSTANCES*4-1:0] INSTANCE_TYPES = {
    {1{ISA_TYPE_RAY}},
    {SLW_COUNT{ISA_TYPE_SLW}},
    {FLT_COUNT{ISA_TYPE_FLT}},
    {INT_COUNT{ISA_TYPE_INT}},
    {1{ISA_TYPE_MEM}},
    {BRH_COUNT{ISA_TYPE_BRH}},
    {TID_COUNT{ISA_TYPE_TID}}};
  // Instructions that the ALUs lack: bit ALU type * 32 + operation.
  localparam [31:0] BRH_LACKS = BRH_WITHOUT | 32'd0;
  localparam [31:0] INT_LACKS = INT_WITHOUT | 32'd0;
  localparam [31:0] FLT_LACKS = FLT_WITHOUT | 32'd0;
  localparam [31:0] SLW_LACKS = SLW_WITHOUT | 32'd0;
  localparam [16*32-1:0] WITHOUT = {
    {9{32'd0}}, 32'd0, SLW_LACKS, FLT_LACKS, INT_LACKS, 32'd0, BRH_LACKS, 32'd0};
