// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/chip/rp_frame_port.v: the frame buffer's port, which takes one contribution a cycle.
//
// The port is passed each event, with its cycle: so it need not be called in the others. Within a cycle the units come
// first, then the traverser, then the frame buffer.
#pragma once

#include <cstdint>

#include "machine/common/port_cycles.hpp"
#include "machine/common/request_queue.hpp"
#include "machine/compute/compute_unit.hpp"

namespace raypool {

class FramePort {
 public:
  bool room() const { return waiting_.count() < kPlaces; }
  /// A contribution that is offered now is taken: there is room, and none has been given in this cycle.
  bool ready(uint64_t cycle) const { return cycle != taken_at_ && room(); }
  /// Takes one; only if ready().
  void take(uint64_t cycle, const FrameContribution& contribution) {
    taken_at_ = cycle;
    waiting_.push(contribution);
    ++taken_;
  }

  /// One is offered to the frame buffer, from the cycle after the one in which it came.
  bool valid() const { return waiting_.valid(); }
  const FrameContribution& data() const { return waiting_.data(); }  ///< means something while valid()
  /// The frame buffer takes it.
  void leave() { waiting_.clock(true); }

  uint64_t taken() const { return taken_; }

 private:
  static constexpr uint32_t kPlaces = 2;  // one is filled while the other one leaves

  RequestQueue<FrameContribution, kPlaces> waiting_;
  uint64_t taken_at_ = kNever;
  uint64_t taken_ = 0;
};

}  // namespace raypool
