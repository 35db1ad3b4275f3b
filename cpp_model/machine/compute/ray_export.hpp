// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/compute/rp_ray_export.v, cycle by cycle: takes warps' output slices in the order in which they are pushed, reads
// the masked lanes' packages, four words a cycle, and offers them on the ray-pool port or the frame-buffer port.
#pragma once

#include <array>
#include <cstdint>

#include "bits.hpp"
#include "machine/compute/compute_unit.hpp"
#include "machine/compute/ray_slices.hpp"

namespace raypool {

class RayExport {
 public:
  static constexpr uint32_t kPlaces = 32;  ///< warps at most, of which each is in the order once

  struct Beat {
    bool frame = false;  ///< to the frame buffer: pixel, red, green, blue
    bool last = false;   ///< of its package
    raypool::Beat data{};
  };
  struct Registers {
    uint32_t slot = 0, busy = 0;            ///< sets of warps: place of the next mask; slices that wait or are read
    std::array<uint8_t, kPlaces> order{};   ///< warps in the order of their pushes, a ring
    uint32_t first = 0, end = 0;            ///< of it
    bool next = false, next_frame = false;  ///< the slice after the one that is read
    uint32_t next_warp = 0, next_mask = 0;
    bool slice = false, frame = false;  ///< the slice that is read
    uint32_t warp = 0;
    uint8_t set = 0;
    uint32_t lane = 0, rest = 0;  ///< lane that is read; the lanes after it
    uint32_t beat = 0;
    bool landing = false;       ///< a beat is on its way from the memory
    uint32_t fill = 0;          ///< beats that wait for their port, three at most
    uint32_t offered = 0;       ///< place of the one that is offered; the others, and the one on its way, follow it
    std::array<Beat, 4> beats;  ///< a ring, where the RTL moves them up
  };

  /// `slices` must outlive it.
  explicit RayExport(const RaySlices& slices) : slices_(&slices) {}

  void reset() { q_ = Registers{}; }
  const Registers& registers() const { return q_; }

  bool exporting() const { return q_.busy != 0 || q_.landing || q_.fill != 0; }
  bool read() const { return q_.slice && q_.fill + q_.landing != 3; }
  uint8_t read_set() const { return q_.set; }
  bool export_valid() const { return q_.fill != 0 && !offered().frame; }
  bool frame_valid() const { return q_.fill != 0 && offered().frame; }
  const Beat& offered() const { return q_.beats[q_.offered]; }  ///< means something while one of them is valid
  uint32_t next_warp() const { return q_.next_warp; }
  /// False if clock() would change nothing.
  bool moves() const { return q_.slice | q_.next | q_.landing | (q_.first != q_.end) | (q_.fill != 0); }

  /// `granted`: what is read() has its set's port; `output_set`: of next_warp().
  void clock(bool granted, uint8_t output_set, bool export_ready, bool frame_ready) {
    send((q_.fill != 0) & (offered().frame ? frame_ready : export_ready));
    q_.landing = granted;
    if (granted) read_beat();
    // The slice after it, and the one after that.
    if (q_.next && !q_.slice) load(output_set);
    if (!q_.next && q_.first != q_.end) take_first();
  }
  // With clock(), after it.
  /// A rout or rfb has arrived: which lanes it will export where.
  void park(uint32_t warp, bool frame, uint32_t mask) { masks_[q_.slot >> warp & 1][warp] = {frame, mask}; }
  /// It is executed: its slice is the output from the next cycle on. The mask must not have been empty.
  void push(uint32_t warp) {
    q_.order[q_.end++ % kPlaces] = static_cast<uint8_t>(warp);
    q_.slot ^= 1u << warp;
    q_.busy |= 1u << warp;
  }

 private:
  struct Mask {
    bool frame = false;
    uint32_t lanes = 0;
  };

  // Beats leave, and one that was read in the cycle before joins those that wait.
  void send(bool sent) {
    q_.offered = (q_.offered + sent) % 4;
    q_.fill += uint32_t{q_.landing} - uint32_t{sent};
  }
  void next_lane() {
    q_.beat = 0;
    q_.lane = lowest(q_.rest);
    q_.rest &= q_.rest - 1;
  }
  // Behind those that wait: send() has counted the one that landed in this cycle.
  void read_beat() {
    Beat& beat = q_.beats[(q_.offered + q_.fill) % 4];
    beat.frame = q_.frame;
    beat.last = q_.frame || q_.beat == kRayBeats - 1;
    beat.data = slices_->output_beat(q_.warp, q_.frame ? word::kPixel : q_.beat * kBeatWords, q_.lane);
    if (!beat.last) {
      ++q_.beat;
    } else if (q_.rest != 0) {
      next_lane();
    } else {
      q_.slice = false;
      q_.busy &= ~(1u << q_.warp);
    }
  }
  void load(uint8_t set) {
    q_.next = false;
    q_.slice = true;
    q_.frame = q_.next_frame;
    q_.warp = q_.next_warp;
    q_.set = set;
    q_.rest = q_.next_mask;
    next_lane();
  }
  void take_first() {
    q_.next = true;
    q_.next_warp = q_.order[q_.first++ % kPlaces];
    const Mask& mask = masks_[~q_.slot >> q_.next_warp & 1][q_.next_warp];
    q_.next_frame = mask.frame;
    q_.next_mask = mask.lanes;
  }

  const RaySlices* slices_;
  std::array<std::array<Mask, kPlaces>, 2> masks_{};  // a warp's next rout may arrive while the one before is exported
  Registers q_;
};

}  // namespace raypool
