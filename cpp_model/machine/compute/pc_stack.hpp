// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/compute/rp_pc_stack.v: the PC/RPC stack of one warp. An entry is finished when its PC has reached its RPC; the
// first one never is. A PC that does not fit becomes the greatest, which is outside of every program.
#pragma once

#include <array>
#include <cstdint>

namespace raypool {

class PcStack {
 public:
  static constexpr uint32_t kMostEntries = 32;

  PcStack(uint32_t depth, uint32_t pc_bits) : last_(depth - 1), greatest_((1u << pc_bits) - 1) {}

  void start(uint32_t pc) {
    top_ = 0;
    pc_[0] = fitting(pc);
  }

  // The instruction that a warp executes next. The RTL pops and counts on while it
  // fetches, here it is done at the execution.
  void pop_finished() {
    while (finished(top_, pc_[top_])) --top_;
  }
  uint32_t pc() const { return pc_[top_]; }  ///< after pop_finished()
  void advance() { ++pc_[top_]; }            ///< it has been executed
  void jump(uint32_t target) { pc_[top_] = fitting(target); }
  /// False: overflow, and nothing happened. What is below goes on at `return_pc`.
  bool push(uint32_t target, uint32_t end, uint32_t return_pc) {
    if (top_ == last_) return false;
    pc_[top_++] = return_pc;
    pc_[top_] = fitting(target);
    rpc_[top_] = fitting(end);
    return true;
  }
  /// False: underflow, and nothing happened.
  bool pop() {
    if (top_ == 0) return false;
    --top_;
    return true;
  }

  /// PC of the next instruction, whether finished entries have been popped or not.
  uint32_t next_pc() const { return fetch(false).pc; }
  /// What the instruction routine's next steps find.
  struct Fetch {
    uint32_t pops = 0;  ///< finished entries above the entry that is taken
    uint32_t pc = 0;
  };
  /// `past_current`: as if the next instruction, which must not be a control instruction, had been executed.
  Fetch fetch(bool past_current) const {
    uint32_t top = top_;
    // What is popped before the next instruction is no step of the instruction routine any more.
    if (past_current) {
      while (finished(top, pc_[top])) --top;
    }
    Fetch fetch;
    fetch.pc = pc_[top] + (past_current ? 1 : 0);
    while (finished(top, fetch.pc)) {
      fetch.pc = pc_[--top];
      ++fetch.pops;
    }
    return fetch;
  }

 private:
  bool finished(uint32_t entry, uint32_t pc) const { return entry > 0 && pc >= rpc_[entry]; }

  uint32_t fitting(uint32_t pc) const { return pc < greatest_ ? pc : greatest_; }

  uint32_t last_, greatest_;
  uint32_t top_ = 0;
  std::array<uint32_t, kMostEntries> pc_{}, rpc_{};
};

}  // namespace raypool
