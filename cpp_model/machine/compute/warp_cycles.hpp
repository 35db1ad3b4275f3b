// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Where the cycles of a device's warps went while kernels ran, from its performance counters: each cycle of each warp
// is in one of these. They are defined while no kernel runs.
#pragma once

#include <cstdint>
#include <functional>
#include <numeric>

#include "config/configuration.hpp"
#include "enum_array.hpp"
#include "isa/isa.hpp"
#include "machine/compute/compute_unit.hpp"

namespace raypool {

/// Warps x cycles, summed over the units.
struct WarpCycles {
  uint64_t busy = 0;                                    ///< all: the warp's unit had a kernel
  uint64_t not_launched = 0;                            ///< the launch had no thread for the warp
  uint64_t ended = 0;                                   ///< it had exited, others had not
  uint64_t fetch = 0;                                   ///< no instruction was under way
  uint64_t registers = 0;                               ///< it read its operands
  uint64_t issued = 0;                                  ///< an ALU took its instruction in this cycle
  uint64_t imports = 0;                                 ///< its rin waited for a package that had not arrived
  uint64_t exports = 0;                                 ///< its rout or rfb waited for the one before to leave
  EnumArray<AluType, uint64_t, kAluTypes> waiting{};    ///< it wanted this ALU type, and got none
  EnumArray<AluType, uint64_t, kAluTypes> executing{};  ///< its instruction was in this ALU type

  uint64_t waiting_sum() const { return std::accumulate(waiting.begin(), waiting.end(), uint64_t{0}); }
  uint64_t executing_sum() const { return std::accumulate(executing.begin(), executing.end(), uint64_t{0}); }
  /// Of all but `busy`: the same, if every cycle is accounted for.
  uint64_t sum() const {
    return not_launched + ended + fetch + registers + issued + imports + exports + waiting_sum() + executing_sum();
  }
};

/// `count`: a counter by its number (namespace counter), summed over the device's units.
WarpCycles warp_cycles(const Configuration& configuration, const std::function<uint64_t(int)>& count);
WarpCycles warp_cycles(const Configuration& configuration, ComputeUnit& device);

}  // namespace raypool
