// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
  // Generated from cpp_model/config/parameters.hpp by `raypool isa --write`; a test compares. Do not edit.
  generate
    if (WARPS < 1 || WARPS > 32 ||
        (WARPS & (WARPS - 1)) != 0) begin : gen_bad_WARPS
      WARPS_must_be_a_power_of_two_from_1_to_32 illegal ();
    end
    if (LANES < 1 || LANES > 32 ||
        (LANES & (LANES - 1)) != 0) begin : gen_bad_LANES
      LANES_must_be_a_power_of_two_from_1_to_32 illegal ();
    end
    if (STACK_DEPTH < 2 || STACK_DEPTH > 32) begin : gen_bad_STACK_DEPTH
      STACK_DEPTH_must_be_an_integer_from_2_to_32 illegal ();
    end
    if (TRIPLES < 0 || TRIPLES > 1) begin : gen_bad_TRIPLES
      TRIPLES_must_be_an_integer_from_0_to_1 illegal ();
    end
    if (KERNEL_OVERLAP < 0 || KERNEL_OVERLAP > 1) begin : gen_bad_KERNEL_OVERLAP
      KERNEL_OVERLAP_must_be_an_integer_from_0_to_1 illegal ();
    end
    if (WIDE_RAY_MEMORY < 0 || WIDE_RAY_MEMORY > 1) begin : gen_bad_WIDE_RAY_MEMORY
      WIDE_RAY_MEMORY_must_be_an_integer_from_0_to_1 illegal ();
    end
    if (SLOW_LANES < 1 || SLOW_LANES > 32 ||
        (SLOW_LANES & (SLOW_LANES - 1)) != 0) begin : gen_bad_SLOW_LANES
      SLOW_LANES_must_be_a_power_of_two_from_1_to_32 illegal ();
    end
    if (SHARING < 0 || SHARING > 1) begin : gen_bad_SHARING
      SHARING_must_be_an_integer_from_0_to_1 illegal ();
    end
    if (INTERSECTION_WORDS < 12 || INTERSECTION_WORDS > 21) begin : gen_bad_INTERSECTION_WORDS
      INTERSECTION_WORDS_must_be_an_integer_from_12_to_21 illegal ();
    end
    if (REGISTERS < 8 || REGISTERS > 16) begin : gen_bad_REGISTERS
      REGISTERS_must_be_an_integer_from_8_to_16 illegal ();
    end
    if (PREDICATES < 2 || PREDICATES > 16) begin : gen_bad_PREDICATES
      PREDICATES_must_be_an_integer_from_2_to_16 illegal ();
    end
    if (ARGUMENTS < 4 || ARGUMENTS > 32) begin : gen_bad_ARGUMENTS
      ARGUMENTS_must_be_an_integer_from_4_to_32 illegal ();
    end
    if (PC_BITS < 8 || PC_BITS > 16) begin : gen_bad_PC_BITS
      PC_BITS_must_be_an_integer_from_8_to_16 illegal ();
    end
    if (COUNTER_BITS < 16 || COUNTER_BITS > 48) begin : gen_bad_COUNTER_BITS
      COUNTER_BITS_must_be_an_integer_from_16_to_48 illegal ();
    end
    if (SUBNORMALS < 0 || SUBNORMALS > 2) begin : gen_bad_SUBNORMALS
      SUBNORMALS_must_be_an_integer_from_0_to_2 illegal ();
    end
    if (SIGNIFICAND < 11 || SIGNIFICAND > 24) begin : gen_bad_SIGNIFICAND
      SIGNIFICAND_must_be_an_integer_from_11_to_24 illegal ();
    end
    if (SLOW_UNIT < 0 || SLOW_UNIT > 3) begin : gen_bad_SLOW_UNIT
      SLOW_UNIT_must_be_an_integer_from_0_to_3 illegal ();
    end
    if (FMA < 0 || FMA > 1) begin : gen_bad_FMA
      FMA_must_be_an_integer_from_0_to_1 illegal ();
    end
    if (TID_COUNT < 1 || TID_COUNT > 4) begin : gen_bad_TID_COUNT
      TID_COUNT_must_be_an_integer_from_1_to_4 illegal ();
    end
    if (BRH_COUNT < 1 || BRH_COUNT > 4) begin : gen_bad_BRH_COUNT
      BRH_COUNT_must_be_an_integer_from_1_to_4 illegal ();
    end
    if (INT_COUNT < 1 || INT_COUNT > 4) begin : gen_bad_INT_COUNT
      INT_COUNT_must_be_an_integer_from_1_to_4 illegal ();
    end
    if (FLT_COUNT < 1 || FLT_COUNT > 4) begin : gen_bad_FLT_COUNT
      FLT_COUNT_must_be_an_integer_from_1_to_4 illegal ();
    end
    if (SLW_COUNT < 1 || SLW_COUNT > 4) begin : gen_bad_SLW_COUNT
      SLW_COUNT_must_be_an_integer_from_1_to_4 illegal ();
    end
    if (TID_LATENCY < 1 || TID_LATENCY > 16) begin : gen_bad_TID_LATENCY
      TID_LATENCY_must_be_an_integer_from_1_to_16 illegal ();
    end
    if (BRH_LATENCY < 1 || BRH_LATENCY > 16) begin : gen_bad_BRH_LATENCY
      BRH_LATENCY_must_be_an_integer_from_1_to_16 illegal ();
    end
    if (INT_LATENCY < 1 || INT_LATENCY > 16) begin : gen_bad_INT_LATENCY
      INT_LATENCY_must_be_an_integer_from_1_to_16 illegal ();
    end
    if (FLT_LATENCY < 1 || FLT_LATENCY > 16) begin : gen_bad_FLT_LATENCY
      FLT_LATENCY_must_be_an_integer_from_1_to_16 illegal ();
    end
    if (SLW_LATENCY < 1 || SLW_LATENCY > 16) begin : gen_bad_SLW_LATENCY
      SLW_LATENCY_must_be_an_integer_from_1_to_16 illegal ();
    end
    if (TID_DEPTH < 1 || TID_DEPTH > 32) begin : gen_bad_TID_DEPTH
      TID_DEPTH_must_be_an_integer_from_1_to_32 illegal ();
    end
    if (BRH_DEPTH < 2 || BRH_DEPTH > 32) begin : gen_bad_BRH_DEPTH
      BRH_DEPTH_must_be_an_integer_from_2_to_32 illegal ();
    end
    if (INT_DEPTH < 2 || INT_DEPTH > 32) begin : gen_bad_INT_DEPTH
      INT_DEPTH_must_be_an_integer_from_2_to_32 illegal ();
    end
    if (FLT_DEPTH < 3 || FLT_DEPTH > 32) begin : gen_bad_FLT_DEPTH
      FLT_DEPTH_must_be_an_integer_from_3_to_32 illegal ();
    end
    if (SLW_DEPTH < 6 || SLW_DEPTH > 32) begin : gen_bad_SLW_DEPTH
      SLW_DEPTH_must_be_an_integer_from_6_to_32 illegal ();
    end
    if ((BRH_WITHOUT & ~64942) != 0) begin : gen_bad_BRH_WITHOUT
      BRH_WITHOUT_must_be_bits_of_instructions_that_a_unit_may_lack illegal ();
    end
    if ((INT_WITHOUT & ~32296) != 0) begin : gen_bad_INT_WITHOUT
      INT_WITHOUT_must_be_bits_of_instructions_that_a_unit_may_lack illegal ();
    end
    if ((FLT_WITHOUT & ~120) != 0) begin : gen_bad_FLT_WITHOUT
      FLT_WITHOUT_must_be_bits_of_instructions_that_a_unit_may_lack illegal ();
    end
    if ((SLW_WITHOUT & ~15) != 0) begin : gen_bad_SLW_WITHOUT
      SLW_WITHOUT_must_be_bits_of_instructions_that_a_unit_may_lack illegal ();
    end
  endgenerate
