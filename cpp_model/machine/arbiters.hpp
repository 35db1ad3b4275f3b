// The arbiters of rtl/multiprocessor.v, cycle by cycle (docs/multiprocessor.md). In each cycle present() is told what the units
// show and says what the shared port shows; clock() then is told what was transferred.
#pragma once

#include <array>
#include <cstdint>

#include "machine/compute_unit.hpp"

namespace raypool {

/// rtl/round_robin.v: who is next among those who ask, one bit each.
class RoundRobin {
 public:
  /// The first above the one chosen last, or else the lowest. `requests` must not be 0.
  uint32_t choose(uint32_t requests) const {
    const uint32_t behind = requests & behind_;
    return static_cast<uint32_t>(__builtin_ctz(behind != 0 ? behind : requests));
  }
  /// The choice is made use of.
  void advance(uint32_t number) { behind_ = ~((uint32_t{2} << number) - 1); }

 private:
  uint32_t behind_ = ~uint32_t{0};
};

/// rtl/port_arbiter.v: a port that is shared package by package.
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

/// rtl/import_arbiter.v: requests in turn, and the way back of their beats.
class ImportArbiter {
 public:
  void present(uint32_t valids) { port_.present(expected_ < kPlaces ? valids : 0); }
  bool valid() const { return port_.valid(); }
  uint32_t choice() const { return port_.choice(); }

  bool expects() const { return expected_ > 0; }       ///< beats are to come
  uint32_t receiver() const { return receivers_[0]; }  ///< of the next beat; means something while expects()

  /// `beat`: one arrives in this cycle.
  void clock(bool ready, bool beat) {
    const bool request = port_.valid() && ready;
    port_.clock(ready);
    if (beat && expected_ > 0 && ++beats_ == kIntersectionBeats) {
      beats_ = 0;
      --expected_;
      receivers_ = {receivers_[1], receivers_[2], 0};
    }
    if (request) receivers_[expected_++] = static_cast<uint8_t>(port_.choice());
  }

 private:
  static constexpr uint32_t kPlaces = 3;

  PortArbiter port_;
  std::array<uint8_t, kPlaces> receivers_{};  // oldest first
  uint32_t expected_ = 0;
  int beats_ = 0;
};

/// rtl/block_scheduler.v: which unit takes a launch.
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
