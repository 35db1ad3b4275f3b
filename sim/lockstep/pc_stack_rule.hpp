// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// What the PC stack of a warp (rtl/compute/rp_pc_stack.v) must show, computed from the inputs that it has in the RTL:
// so a stack that breaks the rule is wrong itself, whatever is wrong around it.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "lockstep/unit_wires.hpp"
#include "machine/compute/pc_stack.hpp"

namespace raypool::lockstep {

class PcStackRule {
 public:
  /// `depth` entries, 2 to PcStack::kMostEntries, with PCs of `pc_bits` bits, 1 to 16; `scope` is the stack's instance.
  PcStackRule(const ComputeUnit& rtl, const std::string& scope, uint32_t depth, uint32_t pc_bits)
      : wires_(rtl, scope), last_(depth - 1), greatest_((1u << pc_bits) - 1) {}

  const std::string& missing() const { return wires_.missing; }  ///< the signal that the RTL lacks
  void reset() {
    top_ = 0;
    started_ = false;
  }
  /// The end of a cycle, when all wires have settled; `start`: the warp is started at `start_pc`.
  void take(bool start, uint32_t start_pc) {
    if (start) {
      top_ = 0;
      started_ = true;
      pc_[0] = fitting(start_pc);
    } else if (wires_.step_i.value() != 0) {
      if (finished())
        --top_;
      else
        pc_[top_] = (pc_[top_] + 1) & greatest_;
    } else if (wires_.jump_i.value() != 0) {
      pc_[top_] = fitting(wires_.target_i.value());
    } else if (wires_.push_i.value() != 0 && top_ != last_) {
      if (wires_.push_return_i.value() != 0) pc_[top_] = wires_.return_i.value();
      ++top_;
      pc_[top_] = fitting(wires_.target_i.value());
      rpc_[top_] = fitting(wires_.end_i.value());
    } else if (wires_.pop_i.value() != 0 && top_ != 0) {
      --top_;
    }
  }
  /// What the stack shows otherwise than by the rule in this cycle; null: nothing.
  const char* broken() const {
    if (wires_.top_q.value() != top_) return "another entry is on top";
    if (started_ && wires_.pc_o.value() != pc_[top_]) return "another PC is on top";
    if (started_ && (wires_.pc_valid_o.value() != 0) != (wires_.step_i.value() != 0 && !finished()))
      return "a step pops when it should yield a PC, or the reverse";
    if ((wires_.overflow_o.value() != 0) != (wires_.push_i.value() != 0 && top_ == last_)) return "overflow";
    if ((wires_.underflow_o.value() != 0) != (wires_.pop_i.value() != 0 && top_ == 0)) return "underflow";
    return nullptr;
  }
  uint32_t depth() const { return top_ + 1; }  ///< entries
  /// The stack gives its PC to the instruction buffer in this cycle.
  bool yields() const { return wires_.pc_valid_o.value() != 0; }
  uint32_t pc() const { return pc_[top_]; }

 private:
  bool finished() const { return top_ != 0 && pc_[top_] >= rpc_[top_]; }
  uint32_t fitting(uint32_t pc) const { return pc < greatest_ ? pc : greatest_; }

  PcStackWires wires_;
  uint32_t last_, greatest_;
  uint32_t top_ = 0;
  bool started_ = false;  ///< nothing is known of the PC before that
  std::array<uint32_t, PcStack::kMostEntries> pc_{}, rpc_{};
};

}  // namespace raypool::lockstep
