// Measures what the offset of secondary rays does, prints the table of docs/scenes.md, and holds kOffsetShare to it.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "scene/native_renderer.hpp"
#include "scene/reference_kernels.hpp"

namespace raypool {
namespace {

struct SurfacePoint {
  Vec3 point, normal;  // the normal towards the eye
  uint32_t triangle;
};

/// What the eye rays of a 256 x 256 picture hit, as the kernels compute it, where the light is in front of the surface.
std::vector<SurfacePoint> lit_side_points(const Scene& scene, const Traversal& traversal) {
  const auto arguments = camera_arguments(scene, 256, 256, 1);
  std::vector<SurfacePoint> points;
  for (uint32_t y = 0; y < 256; ++y) {
    for (uint32_t x = 0; x < 256; ++x) {
      NativeThread thread;
      thread.arguments = &arguments;
      thread.block = x | y << 16;
      reference::run(RayKernel::CastEye, thread);
      const RayQuery ray = to_query(thread.rays.at(0));
      Hit hit;
      if (!traversal.nearest(ray, hit)) continue;
      const Vec3 point = ray.origin + ray.direction * hit.t;
      const Vec3 normal = dot(hit.normal, ray.direction) > 0 ? hit.normal * -1.0f : hit.normal;
      if (dot(normal, scene.light.position - point) > 0) points.push_back({point, normal, hit.triangle});
    }
  }
  return points;
}

TEST(Offset, LiesBetweenAcneAndDisplacedShadows) {
  SceneOptions options;
  options.detail = 0.25;
  const Scene scene = load_scene("room", options);
  const Traversal traversal(scene);
  const auto points = lit_side_points(scene, traversal);
  const double shares[] = {1e-8, 1e-7, 1e-6, 3e-6, 1e-5, 3e-5, 1e-4, 1e-3};
  std::vector<std::vector<bool>> blocked;
  std::vector<size_t> own;  // blocked by the triangle that the ray starts from
  for (double share : shares) {
    const auto offset = static_cast<float>(share * static_cast<double>(scene.bounds().diagonal()));
    std::vector<bool> results;
    size_t count = 0;
    for (const SurfacePoint& p : points) {
      const Vec3 origin = p.point + p.normal * offset;
      Hit hit;
      const bool found = traversal.nearest({origin, scene.light.position - origin, 1}, hit);
      results.push_back(found);
      count += found && hit.triangle == p.triangle;
    }
    blocked.push_back(results);
    own.push_back(count);
  }
  auto changed = [&](size_t a, size_t b) {
    size_t count = 0;
    for (size_t i = 0; i < points.size(); ++i) count += blocked[a][i] != blocked[b][i];
    return count;
  };
  std::printf("%zu shadow rays\n   offset  own shadow  differ from 3e-06\n", points.size());
  for (size_t i = 0; i < own.size(); ++i) std::printf("%9.0e %11zu %18zu\n", shares[i], own[i], changed(i, 3));
  ASSERT_EQ(shares[4], kOffsetShare);
  EXPECT_GT(own[0], points.size() / 20) << "without an offset surfaces shadow themselves";
  EXPECT_EQ(own[2], 0u) << "a tenth of the offset is still enough";
  EXPECT_EQ(own[4], 0u);
  EXPECT_LT(changed(4, 3), points.size() / 1000) << "and shadows stay where they are";
  EXPECT_GT(changed(7, 3), 5 * changed(4, 3));
}

}  // namespace
}  // namespace raypool
