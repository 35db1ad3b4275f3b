// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// What rtl/compute/rp_tid_alu.v gives: thread, warp, block and unit indices, dimensions, kernel arguments.
#pragma once

#include <array>
#include <cstdint>

#include "machine/compute/compute_unit.hpp"
#include "machine/compute/lanes.hpp"

namespace raypool {

class TidAlu {
 public:
  /// `unit`: the number of the compute unit among several.
  explicit TidAlu(uint32_t unit) : unit_(unit) {}

  /// Only while idle.
  void write_argument(uint32_t index, uint32_t data) { arguments_[index] = data; }
  uint32_t argument(uint32_t index) const { return arguments_[index % kArguments]; }

  /// `launched`: the launch that runs.
  template <int kLanes>
  void execute(Opcode opcode, const Lanes<kLanes>& lanes, uint32_t warp, uint32_t immediate,
               const LaunchCommand& launched) const {
    const auto fill = [&lanes](uint32_t value) { lanes.map([value](uint32_t, uint32_t) { return value; }); };
    switch (opcode) {
      case Opcode::Tid:
        return lanes.number(warp * kLanes);
      case Opcode::Lane:
        return lanes.number(0);
      case Opcode::Warp:
        return fill(warp);
      case Opcode::Block:
        return fill(launched.block);
      case Opcode::Threads:
        return fill(launched.threads);
      case Opcode::Blocks:
        return fill(launched.blocks);
      case Opcode::Unit:
        return fill(unit_);
      case Opcode::Arg:
        return fill(argument(immediate));
      default:
        not_modelled(opcode);
    }
  }

 private:
  uint32_t unit_;
  std::array<uint32_t, kArguments> arguments_{};
};

}  // namespace raypool
