// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
      // Generated from cpp_model/isa/isa.hpp by `raypool isa --write`; a test compares. Do not edit.
      if (TYPE == ISA_TYPE_BRH) begin : gen_brh
        rp_brh_alu #(
          .WARPS(WARPS), .LANES(LANES), .WARP_BITS(WARP_BITS), .LATENCY(BRH_LATENCY),
          .DEPTH(BRH_DEPTH), .WITHOUT(BRH_WITHOUT), .SUBNORMALS(SUBNORMALS), .SIGNIFICAND(SIGNIFICAND)
        ) brh_alu (
          .done_subnormal_o(done_subnormal[k]),
`include "rp_alu_port_map.vh"
        );
      end
      if (TYPE == ISA_TYPE_INT) begin : gen_int
        rp_int_alu #(
          .WARPS(WARPS), .LANES(LANES), .WARP_BITS(WARP_BITS), .LATENCY(INT_LATENCY),
          .DEPTH(INT_DEPTH), .WITHOUT(INT_WITHOUT)
        ) int_alu (
`include "rp_alu_port_map.vh"
        );
      end
      if (TYPE == ISA_TYPE_FLT) begin : gen_flt
        rp_flt_alu #(
          .WARPS(WARPS), .LANES(LANES), .WARP_BITS(WARP_BITS), .LATENCY(FLT_LATENCY),
          .DEPTH(FLT_DEPTH), .WITHOUT(FLT_WITHOUT), .SUBNORMALS(SUBNORMALS), .SIGNIFICAND(SIGNIFICAND), .FMA(FMA)
        ) flt_alu (
          .done_subnormal_o(done_subnormal[k]),
`include "rp_alu_port_map.vh"
        );
      end
      if (TYPE == ISA_TYPE_SLW) begin : gen_slw
        rp_slw_alu #(
          .WARPS(WARPS), .LANES(LANES), .WARP_BITS(WARP_BITS), .LATENCY(SLW_LATENCY),
          .DEPTH(SLW_DEPTH), .WITHOUT(SLW_WITHOUT), .SUBNORMALS(SUBNORMALS), .SIGNIFICAND(SIGNIFICAND),
          .SLOW_UNIT(SLOW_UNIT), .SLOW_LANES(SLOW_LANES)
        ) slw_alu (
          .done_subnormal_o(done_subnormal[k]),
`include "rp_alu_port_map.vh"
        );
      end
      if (TYPE != ISA_TYPE_BRH && TYPE != ISA_TYPE_FLT && TYPE != ISA_TYPE_SLW) begin : gen_unguarded
        assign done_subnormal[k] = 1'b0;
      end
