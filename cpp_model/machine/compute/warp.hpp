// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/compute/rp_warp.v as the architecture sees it: what a warp has besides its registers, which lie with those of all
// warps.
#pragma once

#include <cstdint>

#include "config/configuration.hpp"
#include "machine/compute/compute_unit.hpp"
#include "machine/compute/decoder.hpp"
#include "machine/compute/pc_stack.hpp"
#include "machine/compute/predicate_file.hpp"

namespace raypool {

struct Warp {
  explicit Warp(const Configuration& configuration) : pc_stack(configuration.stack_depth, configuration.pc_bits) {}
  void reset() {
    running = output_busy = false;
    launched = 0;
    element = nullptr;
    pc_stack.start(0);
    predicates = {};
  }

  bool running = false;      ///< started and not yet exited
  bool output_busy = false;  ///< the next rout or rfb waits
  LaunchCommand launch;      ///< that it was started for last
  uint32_t launched = 0;     ///< lanes that have a thread
  /// The element of a triple that is next; null: the first of the instruction at the PC.
  const DecodedInstruction* element = nullptr;
  PcStack pc_stack;
  PredicateFile predicates;
};

}  // namespace raypool
