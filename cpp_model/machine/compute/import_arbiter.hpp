// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/compute/rp_import_arbiter.v: the units' import requests in turn, and the way back of their beats. present()
// and clock() as those of PortArbiter.
#pragma once

#include <cstdint>

#include "machine/common/packages.hpp"
#include "machine/common/request_queue.hpp"
#include "machine/compute/port_arbiter.hpp"

namespace raypool {

class ImportArbiter {
 public:
  /// `beats`: of a package.
  explicit ImportArbiter(int beats = kIntersectionBeats) : beats_(beats) {}

  void present(uint32_t valids) { port_.present(order_.count() < kPlaces ? valids : 0); }
  bool valid() const { return port_.valid(); }
  uint32_t choice() const { return port_.choice(); }

  bool expects() const { return order_.valid(); }      ///< beats are to come
  uint32_t receiver() const { return order_.data(); }  ///< of the next beat; means something while expects()

  /// `beat`: one arrives in this cycle.
  void clock(bool ready, bool beat) {
    const bool request = port_.valid() && ready;
    const bool package_end = beat && expects() && beat_ == beats_ - 1;
    if (beat && expects()) beat_ = package_end ? 0 : beat_ + 1;
    port_.clock(ready);
    order_.clock(package_end);
    if (request) order_.push(static_cast<uint8_t>(port_.choice()));
  }

 private:
  static constexpr uint32_t kPlaces = 3;

  PortArbiter port_;
  RequestQueue<uint8_t, kPlaces> order_;  // units that still await packages
  int beats_, beat_ = 0;
};

}  // namespace raypool
