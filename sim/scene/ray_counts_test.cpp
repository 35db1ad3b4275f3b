#include "scene/ray_counts.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

namespace raypool {
namespace {

Ray ray_of(uint32_t flags, float red, float green, float blue) {
  Ray ray{};
  ray[word::kFlags] = flags;
  const float weight[] = {red, green, blue};
  std::memcpy(&ray[word::kColor], weight, sizeof weight);
  return ray;
}

constexpr uint32_t kEyeFlags = 1, kReflectionFlags = 3, kShadowFlags = kShadowFlag | 2;

TEST(RayCounts, KnowTheKindFromTheFlags) {
  RayCounts counts;
  counts.count(ray_of(kEyeFlags, 1, 1, 1), true);
  counts.count(ray_of(kReflectionFlags, 1, 1, 1), true);
  counts.count(ray_of(kReflectionFlags, 1, 1, 1), false);
  for (int i = 0; i < 3; ++i) counts.count(ray_of(kShadowFlags, 1, 1, 1), i == 0);
  EXPECT_EQ(counts.eye.traced, 1u);
  EXPECT_EQ(counts.reflection.traced, 2u);
  EXPECT_EQ(counts.shadow.traced, 3u);
  EXPECT_EQ(counts.traced(), 6u);
  EXPECT_EQ(counts.missed(), 1u);
  EXPECT_EQ(counts.blocked(), 2u);
}

TEST(RayCounts, AWeightCountsWhenOneChannelIsAboveZero) {
  RayCounts counts;
  counts.count(ray_of(kReflectionFlags, 0, 0, 1e-38f), true);
  EXPECT_EQ(counts.reflection.weightless, 0u);
  counts.count(ray_of(kReflectionFlags, 0, -0.0f, 0), true);
  counts.count(ray_of(kReflectionFlags, NAN, -1, 0), true);
  EXPECT_EQ(counts.reflection.weightless, 2u);
}

TEST(RayCounts, AShadowRayWeighsWhatTheFrameBufferAdds) {
  RayCounts counts;
  counts.count(ray_of(kShadowFlags, 0x1p-33f, 0, 0), true);  // half a unit of the frame buffer: rounded up
  EXPECT_EQ(counts.shadow.weightless, 0u);
  counts.count(ray_of(kShadowFlags, 0x1p-34f, 0, 0), true);
  EXPECT_EQ(counts.shadow.weightless, 1u);
  EXPECT_EQ(counts.shadow.futile, 1u);
}

TEST(RayCounts, WastedIsEndedOrWeightlessOnce) {
  RayCounts counts;
  counts.count(ray_of(kShadowFlags, 1, 0, 0), true);
  EXPECT_EQ(counts.shadow.futile, 0u);
  counts.count(ray_of(kShadowFlags, 1, 0, 0), false);
  counts.count(ray_of(kShadowFlags, 0, 0, 0), true);
  counts.count(ray_of(kShadowFlags, 0, 0, 0), false);
  EXPECT_EQ(counts.shadow.ended, 2u);
  EXPECT_EQ(counts.shadow.weightless, 2u);
  EXPECT_EQ(counts.shadow.futile, 3u);
  RayCounts sum = counts;
  sum.add(counts);
  EXPECT_EQ(sum.shadow.traced, 8u);
  EXPECT_EQ(sum.shadow.futile, 6u);
  EXPECT_EQ(sum.blocked(), 4u);
}

}  // namespace
}  // namespace raypool
