#include "chip/ray_pool.hpp"

#include <fmt/format.h>

#include <stdexcept>

namespace raypool::chip {

RayPool::RayPool(const sc_core::sc_module_name& name, const ChipConfiguration& chip, uint32_t depth)
    : sc_module(name), pool_(chip, depth) {
  device.bind(*this);
  traverser.bind(*this);
  controller.bind(*this);
}

void RayPool::want() {
  pool_.want(clock->cycle());
  beats_from_ = pool_.beats_from();
}

void RayPool::take(uint32_t unit, const Beat& beat, bool last) {
  ++beats_;
  if (last != (beats_ == kRayBeats)) {
    throw std::runtime_error(fmt::format("compute unit {} marks beat {} of a ray as {}; a ray has {} beats", unit,
                                         beats_, last ? "its last" : "not its last", kRayBeats));
  }
  pool_.take(clock->cycle(), beat);
  beats_from_ = pool_.beats_from();
  if (!last) return;
  beats_ = 0;
  const raypool::RayPool::Outcome& outcome = pool_.outcome();
  ledger->ray_exported(unit, pool_.ray(), outcome.kept);
  dropped_depth_ += outcome.deep;
  if (!outcome.kept) return;
  PooledRay& ray = rays_.emplace_back();
  ray.ray = pool_.ray();
  ray.place = outcome.place;
  fill_.set(clock->cycle(), size());
  for (int i = 0; i < arrivals.size(); ++i) arrivals[i]->ray_arrived();
}

PooledRays::iterator RayPool::remove(PooledRays::iterator ray) {
  pool_.free(clock->cycle(), ray->place, (ray->ray[word::kFlags] & kShadowFlag) != 0);
  beats_from_ = pool_.beats_from();
  fill_.set(clock->cycle(), size());
  return rays_.erase(ray);
}

}  // namespace raypool::chip
