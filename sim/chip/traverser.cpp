#include "chip/traverser.hpp"

#include <algorithm>
#include <stdexcept>

#include "chip/static_traverser.hpp"

namespace raypool::chip {

Traverser::Traverser(const sc_core::sc_module_name& name, RayTracer& tracer, const ChipConfiguration& chip)
    : sc_module(name), tracer_(tracer), contributes_(chip.shading == Shading::Traverser) {
  kernel_events.bind(*this);
  arrivals.bind(*this);
  SC_METHOD(next_contribution);
  sensitive << frame_free_;
  dont_initialize();
}

void Traverser::trace(PooledRay& ray) {
  ray.traced = true;
  ray.goes_on = tracer_.trace(ray.ray, ray.intersection);
  counts_.rays.count(ray.ray, ray.goes_on);
}

// True if the result of the ray, which goes on, has left.
bool Traverser::deliver(const PooledRay& ray, bool shadow) {
  if (shadow && contributes_) return contribute(ray.ray);
  const ImportKind kind = shadow ? ImportKind::Shadow : ImportKind::Normal;
  if (intersections->full(kind)) return false;
  intersections->put(kind, ray.intersection);
  return true;
}

bool Traverser::contribute(const Ray& ray) {
  FrameContribution contribution;
  contribution.pixel = ray[word::kPixel];
  std::copy_n(&ray[word::kColor], contribution.rgb.size(), contribution.rgb.begin());
  if (!frame->offer(contribution)) {
    clock->notify(frame_free_, Phase::Traverser, 1);
    return false;
  }
  ledger->ray_dropped(contribution.pixel);
  return true;
}

void Traverser::next_contribution() {
  clock->guard([&] { advance(0); });
}

uint32_t Traverser::advance(uint32_t budget) {
  std::vector<PooledRay>& pool = rays->rays();
  size_t kept = 0;
  uint32_t shadows = 0;  // that left
  for (size_t i = 0; i < pool.size(); ++i) {
    PooledRay& ray = pool[i];
    if (!ray.traced && budget > 0) {
      --budget;
      trace(ray);
    }
    const bool shadow = (ray.ray[word::kFlags] & kShadowFlag) != 0;
    if (ray.traced && !ray.goes_on) {
      shadows += shadow;
      ledger->ray_dropped(ray.ray[word::kPixel]);
    } else if (ray.traced && deliver(ray, shadow)) {
      ++counts_.delivered;
      shadows += shadow;
    } else {
      if (kept != i) pool[kept] = ray;
      ++kept;
    }
  }
  const auto left = static_cast<uint32_t>(pool.size() - kept);
  pool.resize(kept);
  if (left > 0) {
    rays->removed(shadows);
    controller->changed();
  }
  return left;
}

std::unique_ptr<Traverser> make_traverser(const ChipConfiguration& chip, RayTracer& tracer, uint32_t units) {
  switch (chip.traverser) {
    case TraverserName::Static:
      return std::make_unique<StaticTraverser>("traverser", tracer, units, chip);
  }
  throw std::logic_error("a traverser without a class");
}

}  // namespace raypool::chip
