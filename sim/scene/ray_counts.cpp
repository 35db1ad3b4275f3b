#include "scene/ray_counts.hpp"

#include "bits.hpp"
#include "scene/image.hpp"

namespace raypool {
namespace {

/// A shadow ray carries what it adds if it is free: nothing, where the frame buffer would round it to
/// nothing. A normal ray's throughput may still be multiplied with bright colours; only zero, negative
/// or NaN is without effect for certain.
bool weightless(const Ray& ray, bool shadow) {
  for (int channel = 0; channel < 3; ++channel) {
    const float weight = as_float(ray[word::kColor + channel]);
    if (shadow ? to_fixed(weight) > 0 : weight > 0) return false;
  }
  return true;
}

void add(RayCounts::Kind& sum, const RayCounts::Kind& part) {
  sum.traced += part.traced;
  sum.ended += part.ended;
  sum.weightless += part.weightless;
  sum.futile += part.futile;
  sum.left_out += part.left_out;
}

}  // namespace

void RayCounts::count(const Ray& ray, bool goes_on) {
  const bool without = weightless(ray, is_shadow(ray));
  Kind& kind = is_shadow(ray) ? shadow : (ray[word::kFlags] & kDepthMask) == 1 ? eye : reflection;
  ++kind.traced;
  kind.ended += !goes_on;
  kind.weightless += without;
  kind.futile += !goes_on || without;
}

void RayCounts::add(const RayCounts& other) {
  raypool::add(eye, other.eye);
  raypool::add(reflection, other.reflection);
  raypool::add(shadow, other.shadow);
}

void RayCounts::count_left_out(uint64_t hits, bool reflections, uint64_t too_deep) {
  shadow.left_out = hits - shadow.traced;
  reflection.left_out = reflections ? hits - too_deep - reflection.traced : 0;
}

RayCounts RayCounts::without_weights() const {
  RayCounts counts = *this;
  for (Kind* kind : {&counts.eye, &counts.reflection, &counts.shadow}) {
    kind->weightless = kind->left_out = 0;
    kind->futile = kind->ended;
  }
  return counts;
}

}  // namespace raypool
