// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/compute/rp_ray_import.v, cycle by cycle, without data: requests a launch's packages, thread after thread, and
// writes their beats into the warps' input slices.
#pragma once

#include <algorithm>
#include <cstdint>

#include "bits.hpp"
#include "config/configuration.hpp"
#include "machine/compute/compute_unit.hpp"

namespace raypool {

class RayImport {
 public:
  struct Registers {
    bool active = false;  ///< packages are left to be requested or received
    bool request_valid = false;
    ImportKind request_kind = ImportKind::None;
    uint32_t threads = 0, requested = 0, received = 0, outstanding = 0;  ///< packages
    int beat = 0;
    uint32_t full = 0;   ///< warps with all packages in their input slice
    bool write = false;  ///< the beat that came in the cycle before is written, and the one that waited for it
    uint8_t write_set = 0;
    uint32_t write_thread = 0, write_word = 0;
    uint32_t write_words = 0;  ///< from write_word on, with a beat that waits for the next one
  };
  struct Inputs {
    ImportKind start_kind = ImportKind::None;
    uint32_t start_threads = 0;
    bool request_ready = false;
    bool beat_valid = false;
    uint8_t input_set = 0;  ///< with beat_valid: of receive_warp()
  };

  explicit RayImport(const Configuration& configuration)
      : lane_bits_(lowest(configuration.lanes)),
        last_lane_(configuration.lanes - 1),
        wide_(configuration.wide_ray_memory && configuration.lanes > 4),
        words_(static_cast<int>(configuration.intersection_words)),
        beats_(static_cast<int>(configuration.intersection_beats())) {}

  void reset() { q_ = Registers{}; }
  const Registers& registers() const { return q_; }

  uint32_t receive_warp() const { return q_.received >> lane_bits_; }
  /// False if clock() would change nothing without a start or a beat.
  bool moves() const { return q_.write | (q_.active & (q_.request_valid | can_request())); }

  void clock(const Inputs& in) {
    const bool received = in.beat_valid && beat(in.input_set);
    if (!in.beat_valid) q_.write = false;
    if (q_.active) {
      if (q_.request_valid && in.request_ready) {
        ++q_.requested;
        ++q_.outstanding;
      }
      if (received) --q_.outstanding;
      q_.request_valid = can_request();
      if (received) receive();
    }
    if (in.start_kind != ImportKind::None) {
      q_.active = true;
      q_.request_kind = in.start_kind;
      q_.threads = in.start_threads;
      q_.requested = q_.received = 0;
      q_.beat = 0;
    }
  }
  /// With clock(), after it: the warp's packages become current.
  void take(uint32_t warp) { q_.full &= ~(1u << warp); }

 private:
  bool can_request() const {
    return (q_.requested != q_.threads) & (q_.outstanding != 2) &
           ((uint64_t{q_.full} >> (q_.requested >> lane_bits_) & 1) == 0);
  }
  /// A beat comes, which is written in the next cycle, or together with the one after it; true for the last one of its
  /// package.
  bool beat(uint8_t set) {
    const int waited = wide_ ? q_.beat % 2 : 0;
    q_.write = !wide_ || waited != 0 || q_.beat == beats_ - 1;
    q_.write_set = set;
    q_.write_thread = q_.received;
    const int word = (q_.beat - waited) * kBeatWords;
    q_.write_word = static_cast<uint32_t>(word);
    q_.write_words = static_cast<uint32_t>(std::min((waited + 1) * kBeatWords, words_ - word));
    if (++q_.beat < beats_) return false;
    q_.beat = 0;
    return true;
  }
  void receive() {
    const bool launch_end = q_.received + 1 == q_.threads;
    const bool slice_end = (q_.received & last_lane_) == last_lane_ || launch_end;
    if (slice_end) q_.full |= 1u << receive_warp();
    if (launch_end) q_.active = false;
    ++q_.received;
  }

  uint32_t lane_bits_, last_lane_;
  bool wide_;          // two beats are written at a time
  int words_, beats_;  // of a package
  Registers q_;
};

}  // namespace raypool
