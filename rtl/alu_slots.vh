  // Generated from cpp_model/isa/isa.hpp by `raypool isa --write`; a test compares. Do not edit.
  localparam integer UNITS = 7;
  // ALU instances, by type in the order of the unit numbers
  localparam integer TID_SLOT = 0;
  localparam integer BRH_SLOT = TID_SLOT + TID_COUNT;
  localparam integer MEM_SLOT = BRH_SLOT + BRH_COUNT;
  localparam integer INT_SLOT = MEM_SLOT + 1;
  localparam integer FLT_SLOT = INT_SLOT + INT_COUNT;
  localparam integer SLW_SLOT = FLT_SLOT + FLT_COUNT;
  localparam integer RAY_SLOT = SLW_SLOT + SLW_COUNT;
  localparam integer SLOTS = RAY_SLOT + 1;
  localparam [SLOTS*4-1:0] SLOT_UNITS = {
    {1{ISA_UNIT_RAY}},
    {SLW_COUNT{ISA_UNIT_SLW}},
    {FLT_COUNT{ISA_UNIT_FLT}},
    {INT_COUNT{ISA_UNIT_INT}},
    {1{ISA_UNIT_MEM}},
    {BRH_COUNT{ISA_UNIT_BRH}},
    {TID_COUNT{ISA_UNIT_TID}}};

  generate
    if (TID_COUNT < 1 || TID_COUNT > 4 ||
        BRH_COUNT < 1 || BRH_COUNT > 4 ||
        INT_COUNT < 1 || INT_COUNT > 4 ||
        FLT_COUNT < 1 || FLT_COUNT > 4 ||
        SLW_COUNT < 1 || SLW_COUNT > 4) begin : gen_bad_count
      compute_unit_counts_of_ALUs_must_be_from_1_to_4 illegal ();
    end
  endgenerate
