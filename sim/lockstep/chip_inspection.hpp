// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Looks inside a chip, block by block, so that a report can name the file to look at: blocks that have a rule of their
// own (block_rules.hpp), and the traverser. Up to the first difference all its blocks have had the same inputs in RTL
// and model; so the block with the first output or state that differs is the one that went wrong.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "lockstep/block_rules.hpp"
#include "lockstep/chip_wires.hpp"
#include "lockstep/findings.hpp"
#include "machine/chip/chip_device.hpp"
#include "machine/traverser/line_want.hpp"

namespace raypool {
class Traverser;
}

namespace raypool::lockstep {

class ChipInspection {
 public:
  /// `rtl` must outlive it. Inactive if the RTL lacks what it looks at.
  ChipInspection(const Configuration& configuration, const ChipDevice& rtl);

  bool active() const { return active_; }
  /// The model has started another frame; its traverser, if it has one. `reset`: the chip was reset before.
  void restart(const Traverser* model, bool reset);
  /// The end of a cycle: the model has been clocked, the RTL has settled, and shows what is handed over in the cycle.
  void advance(uint64_t cycle);
  /// Both have been clocked: the state that the next cycle begins with.
  void check(uint64_t cycle);
  /// All of the first cycle that has any; the likeliest first.
  const std::vector<Finding>& findings() const { return findings_.all(); }

 private:
  /// A finding unless both are equal; true if they are.
  bool expect(uint64_t rtl, uint64_t expected, const char* files, const char* what);
  /// The same of so many words, that begin at bit `low` of the wire.
  bool expect_words(const Wire& wire, uint32_t low, const uint32_t* words, uint32_t count, const char* files,
                    const char* what);
  void find_lanes(const ChipConfiguration& chip);
  bool traverser_seen() const { return traverser_active_ && model_ != nullptr; }
  void advance_traverser();
  void advance_lane(uint32_t number);
  void advance_lines(uint32_t number);
  void advance_stacks(uint32_t number);
  void check_lane(uint32_t number);
  void check_lane_boxes(uint32_t number);
  void check_lane_ports(uint32_t number);
  void check_test(uint32_t number);
  void check_wants(const LineWants& wants, const Wire& valid, const Wire& line, const Wire& slot, uint32_t number,
                   const char* files, const char* what);
  void check_set();
  void check_caches();
  void check_exit();

  const ChipDevice* rtl_;
  TraverserWires w_;
  std::vector<LaneWires> lanes_;
  BlockRules rules_;
  bool active_ = false, traverser_active_ = false;
  const Traverser* model_ = nullptr;
  uint32_t lane_ = 0;  ///< that is looked at, for the texts
  Findings findings_;
};

}  // namespace raypool::lockstep
