// Subnormal numbers in what a frame is drawn from, which a machine with arithmetic.subnormals none refuses.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "machine/compute/compute_unit.hpp"
#include "scene/scene.hpp"

namespace raypool {

/// The first one among vertices and normals of triangles, materials, light, camera, and what `arguments`
/// (camera_arguments()) has of them: "vertex 4, a corner of triangle 2 (material 'floor'), has the coordinate y 1e-39".
/// Empty: there is none.
std::string subnormal_word(const Scene& scene, const std::array<uint32_t, kArguments>& arguments);

}  // namespace raypool
