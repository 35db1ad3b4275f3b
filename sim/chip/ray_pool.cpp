#include "chip/ray_pool.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace raypool::chip {

RayPool::RayPool(const sc_core::sc_module_name& name, const ChipConfiguration& chip, uint32_t depth)
    : sc_module(name),
      capacity_(chip.ray_pool_size),
      overhead_(chip.ray_pool_overhead),
      cycles_per_beat_(chip.ray_pool_cycles_per_beat),
      pipelined_(chip.ray_pool_pipelined),
      culling_(chip.culling),
      depth_(depth) {
  device.bind(*this);
  traverser.bind(*this);
  controller.bind(*this);
}

// Room, once there, is taken by nobody else: so the ray that wants it is begun at once.
void RayPool::want() {
  if (beats_from_ != kNever) return;
  wanting_ = full();
  if (wanting_) return;
  begun_ = std::max(clock->cycle(), free_from_);
  beats_from_ = begun_ + overhead_;
}

void RayPool::take(uint32_t unit, const Beat& beat, bool last) {
  if (beats_ == 0) first_beat_ = clock->cycle();
  if (beats_ == 0 && ahead_) begun_ = first_beat_;
  std::copy(beat.begin(), beat.end(), &arriving_[beats_ * kBeatWords]);
  ++beats_;
  if (last != (beats_ == kRayBeats)) {
    throw std::runtime_error(fmt::format("compute unit {} marks beat {} of a ray as {}; a ray has {} beats", unit,
                                         beats_, last ? "its last" : "not its last", kRayBeats));
  }
  free_from_ = clock->cycle() + cycles_per_beat_;
  if (!last) {
    beats_from_ = free_from_;
    return;
  }
  beats_ = 0;
  if (pipelined_) free_from_ = std::max(free_from_, first_beat_ + overhead_);
  busy_cycles_ += free_from_ - begun_;
  beats_from_ = kNever;
  ++taken_;
  const bool shadow = (arriving_[word::kFlags] & kShadowFlag) != 0;
  const bool deep = !shadow && (arriving_[word::kFlags] & kDepthMask) > depth_;
  const bool kept = !deep && !(culling_ && is_black(arriving_));
  ledger->ray_exported(unit, arriving_, kept);
  if (kept) keep(shadow);
  dropped_depth_ += deep;
  ahead_ = pipelined_ && !full();
  if (ahead_) beats_from_ = free_from_;
}

void RayPool::keep(bool shadow) {
  shadow_rays_ += shadow;
  kept_at_ = clock->cycle();
  rays_.emplace_back().ray = arriving_;
  fill_.set(clock->cycle(), size());
  for (int i = 0; i < arrivals.size(); ++i) arrivals[i]->ray_arrived();
}

void RayPool::removed(uint32_t shadow_rays) {
  shadow_rays_ -= shadow_rays;
  fill_.set(clock->cycle(), size());
  if (wanting_) want();
}

}  // namespace raypool::chip
