#include "chip/traverser.hpp"

#include <stdexcept>

#include "chip/static_traverser.hpp"

namespace raypool::chip {

Traverser::Traverser(const sc_core::sc_module_name& name, RayTracer& tracer) : sc_module(name), tracer_(tracer) {
  kernel_events.bind(*this);
  arrivals.bind(*this);
}

void Traverser::trace(PooledRay& ray) {
  ray.traced = true;
  ray.goes_on = tracer_.trace(ray.ray, ray.intersection);
  counts_.rays.count(ray.ray, ray.goes_on);
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
    const ImportKind kind = shadow ? ImportKind::Shadow : ImportKind::Normal;
    if (ray.traced && !ray.goes_on) {
      shadows += shadow;
      ledger->ray_dropped(ray.ray[word::kPixel]);
    } else if (ray.traced && !intersections->full(kind)) {
      ++counts_.delivered;
      shadows += shadow;
      intersections->put(kind, ray.intersection);
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
