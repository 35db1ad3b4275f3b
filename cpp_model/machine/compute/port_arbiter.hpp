// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/compute/rp_port_arbiter.v: a port that is shared package by package. In each cycle present() is given what the
// requesters show and returns what the port shows; clock() then is given what was transferred.
#pragma once

#include <cstdint>

#include "machine/common/round_robin.hpp"

namespace raypool {

class PortArbiter {
 public:
  /// `valids`: of the requesters, one bit each.
  void present(uint32_t valids) {
    if (!locked_ && valids != 0) choice_ = turn_.choose(valids);
    valid_ = (valids >> choice_ & 1) != 0;
  }
  bool valid() const { return valid_; }
  uint32_t choice() const { return choice_; }  ///< means something while valid()

  /// `last`: what is offered is its package's last transfer.
  void clock(bool ready, bool last = true) {
    if (!valid_) return;
    if (!locked_) turn_.advance(choice_);
    locked_ = !(ready && last);
  }

 private:
  RoundRobin turn_;
  bool locked_ = false, valid_ = false;
  uint32_t choice_ = 0;
};

}  // namespace raypool
