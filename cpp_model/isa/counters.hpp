// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The one table of performance counters. The number is what counter_select_i of the RTL asks
// for; rtl/include/rp_counters.vh is made from it.
#pragma once

#include <cstdint>
#include <string_view>

namespace raypool {

// clang-format off
//   name     constant of namespace counter, kName; in Verilog COUNTER_NAME, its words parted by underscores
//   number   SINGLE: 0, 1, ...; BY_TYPE: of ALU type 0, those of the others follow, eight numbers a row
//   meaning
#define RAYPOOL_COUNTERS(SINGLE, BY_TYPE) \
  SINGLE(BusyCycles,              0, "cycles in which a kernel ran") \
  SINGLE(Instructions,            1, "warp instructions retired") \
  SINGLE(ThreadInstructions,      2, "sum of their thread masks' sizes") \
  SINGLE(InstructionCacheHits,    3, "lookups that hit") \
  SINGLE(InstructionCacheMisses,  4, "lookups that did not hit") \
  SINGLE(DataCacheHits,           5, "quadword loads served by the cache at first try") \
  SINGLE(DataCacheMisses,         6, "quadword loads that were parked") \
  SINGLE(DataCacheStores,         7, "quadword stores") \
  SINGLE(WarpsNotLaunched,        8, "sum over busy cycles of the warps for which the launch has no thread") \
  SINGLE(WarpsEnded,              9, "of those that have exited, while others have not") \
  SINGLE(WarpsFetching,          10, "of those that have no instruction under way and wait for the next") \
  SINGLE(WarpsInMem,             11, "of these, with a task in Mem") \
  SINGLE(WarpsInRay,             12, "of these, with a task in Ray, importing and exporting ones not counted") \
  SINGLE(WarpsImporting,         13, "of these, with a rin that waits for a package that has not arrived") \
  SINGLE(WarpsExporting,         14, "of these, with a rout or rfb that waits for the one before to leave") \
  SINGLE(FltOverlapped,          15, "tasks of Flt behind which the next of their triple was read at once") \
  BY_TYPE(Unused,                16, "busy cycles x instances that were free for a task and got none") \
  BY_TYPE(Waiting,               24, "sum over busy cycles of the warps that wanted this type and were not granted") \
  BY_TYPE(Issued,                32, "tasks issued")
// clang-format on

namespace counter {
#define RAYPOOL_ROW(name, number, meaning) inline constexpr int k##name = number;
RAYPOOL_COUNTERS(RAYPOOL_ROW, RAYPOOL_ROW)
#undef RAYPOOL_ROW
inline constexpr int kCount = kIssued + 8;  ///< numbers are below it
}  // namespace counter

struct CounterInfo {
  std::string_view name;
  int number;
  std::string_view meaning;
  bool by_type;  ///< add the value of an AluType to the number
};

inline constexpr CounterInfo kCounters[] = {
#define RAYPOOL_SINGLE(name, number, meaning) {#name, number, meaning, false},
#define RAYPOOL_BY_TYPE(name, number, meaning) {#name, number, meaning, true},
    RAYPOOL_COUNTERS(RAYPOOL_SINGLE, RAYPOOL_BY_TYPE)
#undef RAYPOOL_SINGLE
#undef RAYPOOL_BY_TYPE
};

}  // namespace raypool
