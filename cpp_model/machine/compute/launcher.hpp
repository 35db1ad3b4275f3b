// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/compute/rp_launcher.v: takes launches, of which one may wait while a kernel runs, starts the warps, and detects
// the end of the kernel. With kernel_overlap two kernels may run, the older one ending first.
#pragma once

#include <array>
#include <cstdint>

#include "bits.hpp"
#include "config/configuration.hpp"
#include "machine/compute/compute_unit.hpp"

namespace raypool {

class Launcher {
 public:
  struct Registers {
    bool pending = false;  ///< a launch waits
    bool running = false;
    LaunchCommand launch;  ///< that waits, with the kind of its import
    uint32_t newest = 0;   ///< place of the launch that began last
    bool older = false;    ///< another one runs too
    std::array<LaunchCommand, 2> places;
    uint32_t started = 0;  ///< warps, in the newest
    uint32_t of_newest = 0;
  };

  explicit Launcher(const Configuration& configuration)
      : overlap_(configuration.kernel_overlap),
        lanes_(configuration.lanes),
        all_(configuration.warps == kMostWarps ? ~0u : (1u << configuration.warps) - 1) {}

  void reset() { q_ = Registers{}; }
  const Registers& registers() const { return q_; }

  // Outputs of the present cycle; `active`: warps that run.
  bool launch_ready(bool import_active) const { return !(q_.pending | import_active); }
  bool waiting() const { return q_.pending; }
  bool running() const { return q_.running; }
  /// The launch that waits runs from the next cycle on.
  bool begins() const { return q_.pending && !(overlap_ ? q_.older : q_.running); }
  /// Warps that are started, and for which launch.
  uint32_t starts(uint32_t active) const {
    if (!overlap_) return begins() ? warps_of(q_.launch) : 0;
    return q_.running ? has() & ~q_.started & ~active : 0;
  }
  const LaunchCommand& start_launch() const { return overlap_ ? newest() : q_.launch; }
  bool kernel_done(uint32_t active) const {
    if (q_.older) return (active & ~q_.of_newest) == 0;
    return q_.running && active == 0 && (!overlap_ || all_started());
  }
  /// Something changes at the end of the cycle.
  bool acts(uint32_t active) const { return begins() || kernel_done(active) || (overlap_ && starts(active) != 0); }
  /// Warps that have threads of a launch that runs.
  uint32_t launched(uint32_t active) const { return overlap_ ? has() | active : has(); }
  uint32_t all() const { return all_; }
  /// Warps in the older one of two kernels.
  uint32_t older() const { return q_.older ? ~q_.of_newest : 0; }
  /// The launch that began last.
  const LaunchCommand& newest() const { return q_.places[q_.newest]; }

  // The end of a cycle.
  void accept(const LaunchCommand& launch) {
    q_.pending = true;
    q_.launch = launch;
  }
  void clock(uint32_t active) {
    const bool begin = begins(), done = kernel_done(active);
    const uint32_t starting = overlap_ ? starts(active) : 0;
    q_.started |= starting;
    q_.of_newest |= starting;
    if (begin) {
      q_.older = overlap_ && q_.running && !done;
      q_.newest ^= overlap_ ? 1 : 0;
      q_.places[q_.newest] = q_.launch;
      q_.started = q_.of_newest = 0;
      q_.pending = false;
      q_.running = true;
    } else if (done) {
      q_.running = q_.older;
      q_.older = false;
    }
  }

 private:
  uint32_t warps_of(const LaunchCommand& launch) const {
    const uint32_t warps = (launch.threads + lanes_ - 1) / lanes_;
    return warps >= kMostWarps ? ~0u : (1u << warps) - 1;
  }
  uint32_t has() const { return warps_of(newest()); }
  bool all_started() const { return (has() & ~q_.started) == 0; }

  bool overlap_;
  uint32_t lanes_, all_;
  Registers q_;
};

}  // namespace raypool
