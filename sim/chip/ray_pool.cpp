#include "chip/ray_pool.hpp"

#include <fmt/format.h>

#include <stdexcept>

namespace raypool::chip {

RayPool::RayPool(const sc_core::sc_module_name& name, ChipClock& clock, PixelLedger& ledger, int capacity, int depth)
    : sc_module(name),
      clock_(clock),
      ledger_(ledger),
      capacity_(static_cast<size_t>(capacity)),
      depth_(static_cast<uint32_t>(depth)),
      work_(clock, [this] { serve(); }) {
  rays_.reserve(capacity_);
}

void RayPool::want() {
  if (granted_) return;
  wanting_ = true;
  if (!full()) work_.ask();
}

bool RayPool::take(uint32_t unit, const Beat& beat, bool last) {
  for (size_t i = 0; i < kBeatWords; ++i) arriving_[beats_ * kBeatWords + i] = beat[i];
  ++beats_;
  if (last != (beats_ == kRayBeats)) {
    throw std::runtime_error(fmt::format("compute unit {} marks beat {} of a ray as {}; a ray has {} beats", unit, beats_,
                                         last ? "its last" : "not its last", kRayBeats));
  }
  if (!last) return false;

  beats_ = 0;
  granted_ = false;
  busy_cycles_ += clock_.cycle() + 1 - granted_at_;
  ++taken_;
  free_at_ = clock_.cycle() + 1;
  const bool shadow = (arriving_[word::kFlags] & kShadowFlag) != 0;
  const bool kept = shadow || (arriving_[word::kFlags] & kDepthMask) <= depth_;
  ledger_.ray_exported(static_cast<int>(unit), arriving_, kept);
  if (!kept) {
    ++dropped_depth_;
    return false;
  }
  shadow_rays_ += shadow;
  kept_at_ = clock_.cycle();
  rays_.push_back({arriving_, false, false, {}});
  fill_.set(clock_.cycle(), size());
  return true;
}

void RayPool::removed(uint32_t shadow_rays) {
  shadow_rays_ -= shadow_rays;
  fill_.set(clock_.cycle(), size());
  if (!granted_ && wanting_) work_.ask();
}

void RayPool::serve() {
  if (granted_ || full()) return;
  if (clock_.cycle() < free_at_) return work_.ask(1);
  if (!wanting_) return;
  wanting_ = false;
  granted_ = true;
  granted_at_ = clock_.cycle();
  first_beat_ = granted_at_ + kPoolOverhead;
}

}  // namespace raypool::chip
