// For tests: scenes with triangles that are hard to separate: on a grid, or nearly all in one place.
#pragma once

#include <algorithm>
#include <cmath>

#include "random.hpp"
#include "scene/scene.hpp"

namespace raypool::test {

/// Moves corners, eye and light to a grid of a few steps, so that many coordinates, faces and planes are the same; half
/// of the grids lie far away along an axis. `wild`: the steps of some are so small that distances are subnormal.
inline void put_on_grid(Scene& scene, uint32_t seed, bool wild) {
  Random random(seed + 3);
  const Bounds bounds = scene.bounds();
  const Vec3 centre = (bounds.lower + bounds.upper) * 0.5f;
  const float extent = bounds.diagonal();
  if (extent == 0) return;
  const int steps = 2 + static_cast<int>(random() % 8);
  // Of tiny ones most have subnormal distances beside others.
  const int tiny = random() % 4 == 0 ? -149 + static_cast<int>(random() % 23) : -124 - static_cast<int>(random() % 6);
  const int exponent = wild && random() % 3 == 0 ? tiny : std::ilogb(extent / 4);
  const float step = std::ldexp(1.0f, exponent);
  Vec3 at{};
  if (random() % 2 == 0)
    at[static_cast<int>(random() % 3)] = std::ldexp(random() % 2 == 0 ? step : -step, static_cast<int>(random() % 22));
  const auto on_grid = [&](const Vec3& point) {
    Vec3 moved;
    for (int axis = 0; axis < 3; ++axis) {
      const float place = std::round((point[axis] - centre[axis]) / extent * 2 * static_cast<float>(steps));
      moved[axis] = at[axis] + step * std::clamp(place, -100.0f, 100.0f);
    }
    return moved;
  };
  const bool ragged = random() % 2 == 0;  // so that small triangles keep an area
  for (Vec3& vertex : scene.vertices) {
    vertex = on_grid(vertex);
    for (int axis = 0; axis < 3 && ragged; ++axis) vertex[axis] += step * (static_cast<float>(random() % 3) - 1);
  }
  const Vec3 target = on_grid(scene.camera.eye + scene.camera.direction), eye = on_grid(scene.camera.eye);
  scene.camera.eye = eye;
  const Vec3 direction = (target - eye) * (1 / std::max(step, 0x1p-100f));
  if (!(direction == Vec3{})) scene.camera.direction = direction;
  scene.light.position = on_grid(scene.light.position);
}

/// Moves all of the first triangles close to the first one, or (`same`: always) makes every triangle that one: a ray
/// that comes to one of them comes to all. The camera looks at them.
inline void gather(Scene& scene, uint32_t seed, uint32_t triangles, bool same) {
  Random random(seed + 4);
  const int places = same || random() % 2 == 0 ? 0 : 1 + static_cast<int>(random() % 20);
  if (same) {  // one that has an area
    const float size = 0.5f * scene.bounds().diagonal();
    const auto [first, second, third] = scene.triangles[0];
    scene.vertices[second] = scene.vertices[first] + Vec3{size, 0, 0};
    scene.vertices[third] = scene.vertices[first] + Vec3{0, size, size};
  }
  if (places == 0)
    for (auto& triangle : scene.triangles) triangle = scene.triangles[0];
  for (size_t vertex = 3; vertex < std::min<size_t>(3 * triangles, scene.vertices.size()) && places != 0; ++vertex) {
    const Vec3& first = scene.vertices[vertex % 3];
    scene.vertices[vertex] = first + (scene.vertices[vertex] - first) * std::ldexp(1.0f, -places);
  }
  const Vec3 direction = (scene.corner(0, 0) + scene.corner(0, 1) + scene.corner(0, 2)) * (1 / 3.0f) - scene.camera.eye;
  if (!(direction == Vec3{})) scene.camera.direction = direction;
}

}  // namespace raypool::test
