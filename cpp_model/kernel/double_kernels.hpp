// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The ray kernels as C++ with numbers in double precision: the same source as everywhere, and no machine's arithmetic.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "kernel/kernels.hpp"
#include "machine/chip/ray_kernel.hpp"
#include "machine/common/memory.hpp"
#include "machine/common/packages.hpp"

namespace raypool {

/// A word of a package, or an argument: an integer, or a number, which no machine has with so many bits.
struct DoubleWord {
  uint32_t bits = 0;
  double number = 0;
};
using DoubleRay = std::array<DoubleWord, kRayWords>;
using DoubleIntersection = std::array<DoubleWord, kIntersectionWords>;

struct DoubleContribution {
  uint32_t pixel;
  std::array<double, 3> rgb;
};

/// As NativeThread. Numbers in memory are single precision, as scenes have them.
struct DoubleThread {
  uint32_t thread = 0, block = 0;
  const std::array<DoubleWord, kArguments>* arguments = nullptr;
  const Memory* memory = nullptr;
  DoubleIntersection input{};
  std::vector<DoubleRay> rays;
  std::vector<DoubleContribution> frame;
};
/// Without culling.
void run_in_double(RayKernel kernel, DoubleThread& thread);

}  // namespace raypool
