#include "chip/traverser.hpp"

#include <fmt/format.h>

#include "chip/static_traverser.hpp"

namespace raypool::chip {

void Traverser::trace(PooledRay& ray) {
  ray.traced = true;
  ray.goes_on = around_.tracer.trace(ray.ray, ray.intersection);
  counts_.rays.count(ray.ray, ray.goes_on);
}

uint32_t Traverser::advance(uint32_t budget) {
  std::vector<PooledRay>& rays = around_.rays.rays();
  size_t kept = 0;
  uint32_t shadows = 0;  // that left
  for (size_t i = 0; i < rays.size(); ++i) {
    PooledRay& ray = rays[i];
    if (!ray.traced && budget > 0) {
      --budget;
      trace(ray);
    }
    const bool shadow = (ray.ray[word::kFlags] & kShadowFlag) != 0;
    const ImportKind kind = shadow ? ImportKind::Shadow : ImportKind::Normal;
    if (ray.traced && !ray.goes_on) {
      shadows += shadow;
      around_.ledger.ray_dropped(ray.ray[word::kPixel]);
    } else if (ray.traced && !around_.intersections.full(kind)) {
      ++counts_.delivered;
      shadows += shadow;
      around_.intersections.put(kind, ray.intersection);
    } else {
      if (kept != i) rays[kept] = ray;
      ++kept;
    }
  }
  const auto left = static_cast<uint32_t>(rays.size() - kept);
  rays.resize(kept);
  if (left > 0) {
    around_.rays.removed(shadows);
    around_.moved();
  }
  return left;
}

std::unique_ptr<Traverser> make_traverser(const std::string& kind, const TraverserSurroundings& surroundings) {
  if (kind == "static") return std::make_unique<StaticTraverser>("traverser", surroundings);
  throw InputError(fmt::format("there is no traverser '{}': use static", kind));
}

}  // namespace raypool::chip
