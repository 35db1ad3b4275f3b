// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/compute/rp_task_register.v: the task of one ALU instance, for one cycle. Of an instance timed by events; the task
// of a pipelined one is over before it begins, as the cycle in which it will be done is known. What the RTL
// holds of the operands is the core's.
#pragma once

#include <cstdint>

namespace raypool {

class TaskRegister {
 public:
  /// In the next cycle there is a task of this warp.
  void grant(uint32_t warp) { warp_ = static_cast<int>(warp); }
  /// The cycle of the task is over, or the unit is reset.
  void clear() { warp_ = -1; }
  /// task_warp, or -1 where task_valid is low.
  int warp() const { return warp_; }

 private:
  int warp_ = -1;
};

}  // namespace raypool
