// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Random shader sets in GLSL, for tests that compare the kernels which they become with another reading of them.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace raypool::shader {

/// Texts of the three shaders, and what their bindings hold. They include no file. Set 0 has the tree (binding 0), the
/// picture (1), a uniform block in std140 (2) and a storage buffer in std430 (3).
///
/// Nothing that they do is undefined: divisors are not 0, shifts below 32, indices within arrays, arguments of
/// functions where these are defined, conversions to integers in range. Every float that is kept lies in -64 .. 64,
/// colours in 0 .. 64. Loops end after at most four turns each.
///
/// Ray generation traces at most one normal ray, with the uniform block's camera; closest hit at most one normal ray
/// and one shadow ray. All of them store to the picture.
struct RandomShaders {
  std::string ray_generation, closest_hit, miss;
  std::vector<uint32_t> block;   ///< words of the uniform block; the camera first (kRandomCameraWords)
  std::vector<uint32_t> buffer;  ///< words of the storage buffer
};

/// The camera in the uniform block: eye, corner, step_x and step_y as bits of floats, three words each, with a fourth
/// that is not used. The direction through the centre of pixel (x, y) is corner + x step_x + y step_y. random_shaders()
/// leaves zeros, for the test that has a scene.
inline constexpr uint32_t kRandomCameraWords = 16;

/// The same for the same seed on every machine. The seed modulo 4 is the size: from some 10 statements a shader with 12
/// words in variables to some 40 with 40.
RandomShaders random_shaders(uint32_t seed);

}  // namespace raypool::shader
