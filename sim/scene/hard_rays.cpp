#include "scene/hard_rays.hpp"

#include <cmath>
#include <random>

#include "bits.hpp"

namespace raypool {

Scene scene_of(const std::vector<std::array<Vec3, 3>>& triangles) {
  Scene scene;
  scene.materials.resize(1);
  for (const auto& triangle : triangles) {
    const auto first = size32(scene.vertices);
    scene.vertices.insert(scene.vertices.end(), triangle.begin(), triangle.end());
    scene.triangles.push_back({first, first + 1, first + 2});
    scene.triangle_materials.push_back(0);
  }
  return scene;
}

Scene soup(uint32_t seed, int triangles, float scale, const Vec3& at) {
  std::mt19937 random(seed);
  const auto uniform = [&](float low, float high) { return std::uniform_real_distribution<float>(low, high)(random); };
  std::vector<std::array<Vec3, 3>> corners;
  for (int i = 0; i < triangles; ++i) {
    const Vec3 first{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
    const float size = std::ldexp(1.0f, -static_cast<int>(random() % 8));
    std::array<Vec3, 3> triangle{first, first, first};
    for (int axis = 0; axis < 3; ++axis) {
      const bool flat = random() % 4 == 0;  // in the plane of an axis
      for (int corner = 1; corner < 3; ++corner) triangle[corner][axis] += flat ? 0 : size * uniform(-1, 1);
      for (Vec3& corner : triangle) corner[axis] = corner[axis] * scale + at[axis];
    }
    corners.push_back(triangle);
    if (random() % 8 == 0) corners.push_back(triangle);  // a tie
  }
  return scene_of(corners);
}

std::vector<RayQuery> hard_rays(const Scene& scene, int count, uint32_t seed) {
  std::mt19937 random(seed);
  const Bounds bounds = scene.bounds();
  auto uniform = [&](float low, float high) { return std::uniform_real_distribution<float>(low, high)(random); };
  auto point = [&] {
    return Vec3{uniform(bounds.lower.x, bounds.upper.x), uniform(bounds.lower.y, bounds.upper.y),
                uniform(bounds.lower.z, bounds.upper.z)};
  };
  auto corner = [&](int k) { return scene.corner(random() % scene.triangles.size(), k); };
  std::vector<RayQuery> rays;
  for (int i = 0; i < count; ++i) {
    RayQuery ray{point(), {}, INFINITY};
    switch (i % 6) {
      case 0:
        ray.direction = point() - ray.origin;
        break;
      case 1:
        ray.direction = corner(i % 3) - ray.origin;
        break;
      case 2: {  // along an edge, starting before it
        const size_t t = random() % scene.triangles.size();
        const Vec3 edge = scene.corner(t, 1) - scene.corner(t, 0);
        ray = {scene.corner(t, 0) - edge * 2.0f, edge, INFINITY};
        break;
      }
      case 3:
        ray.direction[static_cast<int>(random() % 3)] = random() % 2 == 0 ? 1.0f : -1.0f;
        break;
      case 4:  // axis-parallel, from a coordinate of a vertex
        ray.origin[static_cast<int>(random() % 3)] = corner(0)[static_cast<int>(random() % 3)];
        ray.origin[i / 6 % 3] = corner(1)[i / 6 % 3];
        ray.direction[static_cast<int>(random() % 3)] = -2.0f;
        break;
      default:  // in the plane of a triangle, nearly
      {
        const size_t t = random() % scene.triangles.size();
        const Vec3 a = scene.corner(t, 0), b = scene.corner(t, 1), c = scene.corner(t, 2);
        ray.direction = (b - a) * uniform(-1, 1) + (c - a) * uniform(-1, 1);
        ray.origin = a - ray.direction * uniform(0, 20);
      }
    }
    if (i % 5 == 0) ray.limit = uniform(0, 3);
    rays.push_back(ray);
  }
  return rays;
}

}  // namespace raypool
