#include "chip/traverser_watch.hpp"

#include <algorithm>

#include "bits.hpp"
#include "machine/chip/intersection_pool.hpp"

namespace raypool::chip {

void TraverserWatch::clock(const ChipOutputs& outputs) {
  const TraverserPorts& traverser = outputs.traverser;
  counts_.most_rays = ++cycles_ / kRayBeats;
  if (outputs.ray_valid && traverser.ray_ready) read(outputs);
  if (traverser.put_valid && (outputs.put_ready >> to_underlying(traverser.put_kind) & 1) != 0) put(traverser);
  if (traverser.contribution_valid && outputs.contribution_ready) {
    Ray ray{};
    ray[word::kFlags] = kShadowFlag;
    std::copy_n(traverser.contribution.rgb.begin(), 3, &ray[word::kColor]);
    delivered(ray, ImportKind::Shadow);
  }
  if (traverser.free_valid) counts_.rays.count(rays_[traverser.free_place], false);
}

void TraverserWatch::read(const ChipOutputs& outputs) {
  std::copy(outputs.ray_data.begin(), outputs.ray_data.end(), &coming_[beats_in_++ * kBeatWords]);
  if (!outputs.ray_last) return;
  beats_in_ = 0;
  rays_[outputs.ray_place] = coming_;
}

void TraverserWatch::put(const TraverserPorts& traverser) {
  const uint32_t first = beats_out_ * kBeatWords;
  for (uint32_t i = 0; i < kBeatWords && first + i < leaving_.size(); ++i) leaving_[first + i] = traverser.put_data[i];
  if (++beats_out_ < raypool::IntersectionPool::beats(layout_.words)) return;
  beats_out_ = 0;
  Ray ray{};
  ray[word::kFlags] = traverser.put_kind == ImportKind::Shadow ? kShadowFlag : 1;  // where no kernel needs it
  for (size_t i = 0; i < ray.size(); ++i)
    if (layout_.place[i] != RecordLayout::kAbsent) ray[i] = leaving_[layout_.place[i]];
  delivered(ray, traverser.put_kind);
}

// It does not report which of the rays it was; but what all of them come to.
void TraverserWatch::delivered(const Ray& ray, ImportKind kind) {
  RayCounts going_on;
  going_on.count(ray, true);
  for (RayCounts::Kind RayCounts::*of : {&RayCounts::eye, &RayCounts::reflection, &RayCounts::shadow}) {
    (counts_.rays.*of).ended -= (going_on.*of).traced;
    (counts_.rays.*of).futile -= (going_on.*of).traced - (going_on.*of).futile;
  }
  counts_.deepest += kind == ImportKind::Direct && (ray[word::kFlags] & kDepthMask) == depth_;
  ++counts_.delivered;
}

}  // namespace raypool::chip
