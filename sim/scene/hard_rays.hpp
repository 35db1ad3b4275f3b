// Scenes and rays that are hard to get right.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "scene/prepared_ray.hpp"
#include "scene/scene.hpp"

namespace raypool {

/// Triangles with corners of their own and one material.
Scene scene_of(const std::vector<std::array<Vec3, 3>>& triangles);

/// Triangles of all sizes within a cube, at a place and of a scale; some lie in the plane of an axis, some twice.
Scene soup(uint32_t seed, int triangles, float scale, const Vec3& at);

/// Rays that are hard to get right: through vertices, along edges, in the planes of triangles and
/// boxes, axis-parallel, and plain ones.
std::vector<RayQuery> hard_rays(const Scene& scene, int count, uint32_t seed);

}  // namespace raypool
