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
