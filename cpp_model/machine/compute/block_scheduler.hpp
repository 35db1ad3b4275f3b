// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/compute/rp_block_scheduler.v: which unit takes a launch. present() and clock() as those of PortArbiter.
#pragma once

#include <cstdint>

#include "machine/common/round_robin.hpp"

namespace raypool {

class BlockScheduler {
 public:
  /// `ready`: units that can take a launch; `busy`: units that run a kernel.
  void present(uint32_t ready, uint32_t busy) {
    ready_ = ready != 0;
    if (ready_) unit_ = turn_.choose((ready & ~busy) != 0 ? ready & ~busy : ready);
  }
  bool ready() const { return ready_; }
  uint32_t unit() const { return unit_; }  ///< means something while ready()

  void clock(bool launch_valid) {
    if (launch_valid && ready_) turn_.advance(unit_);
  }

 private:
  RoundRobin turn_;
  bool ready_ = false;
  uint32_t unit_ = 0;
};

}  // namespace raypool
