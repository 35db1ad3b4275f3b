// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
  // Generated from cpp_model/isa/counters.hpp by `raypool isa --write`; a test compares. Do not edit.
  // Numbers of the performance counters; those of a row by type are of ALU type 0, and the other types' follow.
  // A module uses some of them only.
  /* verilator lint_off UNUSEDPARAM */
  localparam integer COUNTER_BUSY_CYCLES = 0;
  localparam integer COUNTER_INSTRUCTIONS = 1;
  localparam integer COUNTER_THREAD_INSTRUCTIONS = 2;
  localparam integer COUNTER_INSTRUCTION_CACHE_HITS = 3;
  localparam integer COUNTER_INSTRUCTION_CACHE_MISSES = 4;
  localparam integer COUNTER_DATA_CACHE_HITS = 5;
  localparam integer COUNTER_DATA_CACHE_MISSES = 6;
  localparam integer COUNTER_DATA_CACHE_STORES = 7;
  localparam integer COUNTER_WARPS_NOT_LAUNCHED = 8;
  localparam integer COUNTER_WARPS_ENDED = 9;
  localparam integer COUNTER_WARPS_FETCHING = 10;
  localparam integer COUNTER_WARPS_IN_MEM = 11;
  localparam integer COUNTER_WARPS_IN_RAY = 12;
  localparam integer COUNTER_WARPS_IMPORTING = 13;
  localparam integer COUNTER_WARPS_EXPORTING = 14;
  localparam integer COUNTER_FLT_OVERLAPPED = 15;
  localparam integer COUNTER_UNUSED = 16;
  localparam integer COUNTER_WAITING = 24;
  localparam integer COUNTER_ISSUED = 32;
  /* verilator lint_on UNUSEDPARAM */
