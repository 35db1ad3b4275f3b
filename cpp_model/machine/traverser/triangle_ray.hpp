// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// A triangle, and what the set-up of a ray computes once for its tests; scene/prepared_ray.cpp shows how.
#pragma once

#include <cstdint>

namespace raypool {

inline constexpr float kUlp = 1.1920929e-7f;  // 2^-23
/// t of a slab carries three roundings.
inline constexpr float kNearScale = 1 - 4 * kUlp;
inline constexpr float kFarScale = 1 + 4 * kUlp;

/// Its direction is scaled by a power of two so that the largest component lies in 1 .. 2.
struct TriangleRay {
  float origin[3];
  float padded[2][3];  ///< subtracted from lower and upper bounds
  float inverse[3];
  int near_side[3];  ///< 0: the lower bound is met first
  int kx, ky, kz;    ///< axes: kz is that of the largest component, kx and ky the next ones
  float shear_x, shear_y;
  double direction[3];  ///< floats times that power
};

struct Triangle {
  float corners[3][3];  ///< corner; x, y, z
  uint32_t number;      ///< of two at the same t the lower one is hit

  float operator()(int corner, int axis) const { return corners[corner][axis]; }
};

}  // namespace raypool
