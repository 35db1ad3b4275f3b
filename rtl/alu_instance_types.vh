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

  generate
    if (TID_COUNT < 1 || TID_COUNT > 4 ||
        BRH_COUNT < 1 || BRH_COUNT > 4 ||
        INT_COUNT < 1 || INT_COUNT > 4 ||
        FLT_COUNT < 1 || FLT_COUNT > 4 ||
        SLW_COUNT < 1 || SLW_COUNT > 4) begin : gen_bad_count
      compute_unit_counts_of_ALUs_must_be_from_1_to_4 illegal ();
    end
  endgenerate
