// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/chip/rp_ray_pool.v: the ray pool's port, its places and levels; and RayReader, its port to the traverser.
//
// The port is passed each event, with its cycle, and gives the cycle in which the next beat is taken: so it need not be
// called in the others. Within a cycle the units come first, then the traverser.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "config/configuration.hpp"
#include "machine/common/free_list.hpp"
#include "machine/common/packages.hpp"
#include "machine/common/port_cycles.hpp"
#include "machine/common/ram_queue.hpp"

namespace raypool {

class RayPool {
 public:
  /// Normal rays deeper than `depth` are dropped when they arrive; with chip.culling, so are rays without weight.
  RayPool(const ChipConfiguration& chip, uint32_t depth)
      : capacity_(chip.ray_pool_size),
        overhead_(chip.ray_pool_overhead),
        cycles_per_beat_(chip.ray_pool_cycles_per_beat),
        pipelined_(chip.ray_pool_pipelined),
        culling_(chip.culling),
        depth_(depth),
        places_(capacity_) {}

  /// For the rays of another frame.
  void set_depth(uint32_t depth) { depth_ = depth; }

  /// What a ray that has arrived becomes.
  struct Outcome {
    bool shadow = false, deep = false, kept = false;
    uint32_t place = 0;  ///< of one that is kept
  };

  /// Cycle from which on the next beat of a ray is taken; kNever: not while none is offered, or the pool is full.
  uint64_t beats_from() const { return beats_from_; }

  /// In this cycle a beat is offered that is not taken. May be called again. Room, once there, cannot be taken by
  /// another ray: so the ray that wants it is begun at once.
  void want(uint64_t cycle) {
    if (beats_from_ != kNever) return;
    wanting_ = full();
    if (wanting_) return;
    begun_ = std::max(cycle, free_from_);
    beats_from_ = begun_ + overhead_;
  }

  /// Takes a beat. True if the ray is complete: ray() and outcome() are about it then.
  bool take(uint64_t cycle, const Beat& beat) {
    if (beats_ == 0) first_beat_ = cycle;
    if (beats_ == 0 && ahead_) begun_ = first_beat_;
    std::copy(beat.begin(), beat.end(), &ray_[beats_ * kBeatWords]);
    free_from_ = beats_from_ = cycle + cycles_per_beat_;
    if (++beats_ < kRayBeats) return false;
    beats_ = 0;
    arrive(cycle);
    return true;
  }
  const Ray& ray() const { return ray_; }
  const Outcome& outcome() const { return outcome_; }

  /// A ray leaves its place.
  void free(uint64_t cycle, uint32_t place, bool shadow) {
    places_.free(place);
    --size_;
    shadow_rays_ -= shadow;
    if (wanting_) want(cycle);
  }

  /// True if a ray that is offered waits because there has been no room since before this cycle.
  bool held_up(uint64_t cycle) const { return beats_from_ == kNever && full() && cycle > kept_at_; }

  uint32_t size() const { return size_; }
  uint32_t shadow_rays() const { return shadow_rays_; }  ///< among them
  bool full() const { return size_ >= capacity_; }
  uint32_t capacity() const { return capacity_; }
  uint64_t taken() const { return taken_; }              ///< rays, dropped ones too
  uint64_t busy_cycles() const { return busy_cycles_; }  ///< of the port

 private:
  void arrive(uint64_t cycle) {
    if (pipelined_) free_from_ = std::max(free_from_, first_beat_ + overhead_);
    busy_cycles_ += free_from_ - begun_;
    ++taken_;
    outcome_.shadow = (ray_[word::kFlags] & kShadowFlag) != 0;
    outcome_.deep = !outcome_.shadow && (ray_[word::kFlags] & kDepthMask) > depth_;
    outcome_.kept = !outcome_.deep && !(culling_ && is_black(ray_));
    if (outcome_.kept) {
      outcome_.place = places_.number();
      places_.take();
      ++size_;
      shadow_rays_ += outcome_.shadow;
      kept_at_ = cycle;
    }
    ahead_ = pipelined_ && !full();
    beats_from_ = ahead_ ? free_from_ : kNever;
  }

  uint32_t capacity_;
  uint64_t overhead_, cycles_per_beat_;
  bool pipelined_, culling_;
  uint32_t depth_;
  uint64_t beats_from_ = kNever;
  uint64_t begun_ = 0;       // cycle in which the ray that arrives was
  uint64_t first_beat_ = 0;  // its
  uint64_t free_from_ = 0;   // the next one may be begun
  bool ahead_ = false;       // its overhead has run before it was
  bool wanting_ = false;     // a ray is offered, and there is no room
  uint64_t kept_at_ = 0;
  Ray ray_{};
  uint32_t beats_ = 0;
  Outcome outcome_;
  FreeList places_;
  uint32_t size_ = 0, shadow_rays_ = 0;
  uint64_t taken_ = 0, busy_cycles_ = 0;
};

/// The ray pool's port to the traverser: beats of the oldest ray that has not entered it, one a cycle, the first
/// three cycles after the ray has arrived.
class RayReader {
 public:
  explicit RayReader(uint32_t capacity) : rays_(capacity), order_(capacity) {}

  bool valid() const { return valid_; }
  Beat data() const {
    Beat beat;
    std::copy_n(&rays_[place_][beat_ * kBeatWords], kBeatWords, beat.begin());
    return beat;
  }
  bool last() const { return beat_ == kRayBeats - 1; }
  uint32_t place() const { return place_; }

  /// It holds no ray and offers none.
  bool still() const { return !arrived_ && !valid_ && !order_.valid(); }
  /// The end of a cycle: `ready`, what is offered is taken.
  void clock(bool ready) {
    if (!valid_ || ready) move();
    if (arrived_) order_.push(arriving_);
    arrived_ = false;
  }
  /// A ray has arrived in this cycle; after clock().
  void push(uint32_t place, const Ray& ray) {
    rays_[place] = ray;
    arriving_ = place;
    arrived_ = true;
  }

 private:
  void move() {
    valid_ = order_.valid();
    if (!valid_) return;
    place_ = order_.data();
    beat_ = next_;
    next_ = next_ + 1 == kRayBeats ? 0 : next_ + 1;
    if (next_ == 0) order_.pop();
  }

  std::vector<Ray> rays_;  // [place]
  RamQueue<uint32_t> order_;
  bool arrived_ = false;  // a ray, in the cycle before
  uint32_t arriving_ = 0;
  bool valid_ = false;
  uint32_t place_ = 0, beat_ = 0, next_ = 0;
};

}  // namespace raypool
