// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The ray-tracing kernels and what runs them natively. Written once in the kernel language (kernel.hpp); the same
// source runs as C++ and compiles to machine code.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "arith/arith.hpp"
#include "config/configuration.hpp"
#include "isa/isa.hpp"
#include "isa/program.hpp"
#include "kernel/target.hpp"
#include "machine/chip/ray_kernel.hpp"
#include "machine/common/packages.hpp"
#include "machine/compute/compute_unit.hpp"

namespace raypool {

/// What normal intersections are given to: the kernel without reflections at depth 1, and
/// wherever there are none to be seen.
constexpr RayKernel secondary_kernel(int depth, bool reflections) {
  return depth > 1 && reflections ? RayKernel::CastSecondary : RayKernel::CastSecondaryDirect;
}

/// Those that the chip may launch in such a frame.
std::vector<RayKernel> kernels_of(const ChipConfiguration& chip, int depth, bool reflections);

/// Argument words of the ray kernels (floats unless said otherwise). The direction through the centre of pixel (x, y)
/// is corner + x * step_x + y * step_y.
namespace argument {
inline constexpr int kEye = 0;          ///< x, y, z
inline constexpr int kCorner = 3;       ///< x, y, z
inline constexpr int kStepX = 6;        ///< x, y, z
inline constexpr int kStepY = 9;        ///< x, y, z
inline constexpr int kLight = 12;       ///< position x, y, z
inline constexpr int kLightColor = 15;  ///< red, green, blue
inline constexpr int kOffset = 18;      ///< of hit and t: by how much a secondary ray's origin leaves its surface
inline constexpr int kTileWidthLog2 =
    19;  ///< integer: an eye tile is 2^this pixels wide; thread t is pixel (t & mask, t >> log2)
inline constexpr int kTileMask = 20;  ///< integer: tile width - 1
inline constexpr int kWidth = 21;     ///< integer: image width, pixels
inline constexpr int kHeight = 22;    ///< integer: image height, pixels
inline constexpr int kSample = 23;    ///< integer: number of the sample, from 0, of a picture of several frames
inline constexpr int kCount = 24;
}  // namespace argument
// CastEye is launched with block word = x of the tile's first pixel | y << 16. Pixels outside the image export nothing.

/// The built-in ray kernels in one program, for such machines (ray_program.hpp).
const Program& ray_kernel_program(const KernelTarget& target = {});
/// Of the intersections that they import. Throws InputError when the configuration's have too few words.
RecordLayout ray_record_layout(const Configuration& configuration);

/// What one thread of a kernel sees and leaves when it runs as C++.
struct NativeThread {
  uint32_t thread = 0, block = 0, threads = 1, blocks = 1;
  const std::array<uint32_t, kArguments>* arguments = nullptr;
  Memory* memory = nullptr;
  arith::Mode mode;
  bool culling = false;                  ///< chip.culling
  Intersection input{};                  ///< what `rin` makes current
  std::vector<Ray> rays;                 ///< what `rout` exported, in order
  std::vector<FrameContribution> frame;  ///< what `rfb` exported, in order
};
void run_native(RayKernel kernel, NativeThread& thread);

/// What runs threads of the ray kernels without a machine: one of them, or several at a time, which have the same
/// arguments, memory and mode.
class NativeKernels {
 public:
  using Run = std::function<void(RayKernel, NativeThread* threads, size_t count)>;

  NativeKernels() = default;
  NativeKernels(size_t most, Run run) : most_(most), run_(std::move(run)) {}
  /// From what runs one.
  template <typename One, std::enable_if_t<std::is_invocable_v<One&, RayKernel, NativeThread&> &&
                                               !std::is_same_v<std::decay_t<One>, NativeKernels>,
                                           int> = 0>
  NativeKernels(One one)
      : run_([one = std::move(one)](RayKernel which, NativeThread* threads, size_t count) {
          for (size_t i = 0; i < count; ++i) one(which, threads[i]);
        }) {}

  explicit operator bool() const { return run_ != nullptr; }
  /// How many threads at a time, at most.
  size_t most() const { return most_; }
  void operator()(RayKernel which, NativeThread* threads, size_t count) const { run_(which, threads, count); }
  void operator()(RayKernel which, NativeThread& thread) const { run_(which, &thread, 1); }

 private:
  size_t most_ = 1;
  Run run_;
};

}  // namespace raypool
