// Engine `native`: the kernels as C++, every pixel in turn, no machine and no time. Also what all engines need to
// start a frame: the memory image and the kernel arguments.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "enum_array.hpp"
#include "kernel/kernels.hpp"
#include "machine/common/memory.hpp"
#include "scene/image.hpp"
#include "scene/ray_counts.hpp"
#include "scene/scene.hpp"
#include "scene/traversal.hpp"

namespace raypool {

/// Program at address 0, material records from material_base on (a multiple of 64), size a multiple of 64.
struct MemoryImage {
  Memory memory;
  uint32_t material_base = 0;
};
/// Throws InputError when it would not fit in 32-bit addresses.
MemoryImage build_memory(const Program& program, const Scene& scene);
/// From address 0 on, where there is room for it.
void store_program(const Program& program, Memory& memory);

/// A secondary ray's origin leaves its surface by this share of the sum of its hit's largest coordinate and t: four
/// times the most by which a rounding of the kernels is off, and four times that of t, which has 24 bits in every
/// machine; more where directions, of this length at most, are longer than 2. docs/studies/offset.md shows why that is
/// enough.
double offset_share(double longest_direction, uint32_t significand = arith::kFullSignificand);

/// The arguments before kOffset, as they are before a machine rounds them: eye, directions of pixels, light.
using CameraNumbers = std::array<double, argument::kOffset>;
/// Throws InputError unless width and height lie in 1 .. 65535.
CameraNumbers camera_numbers(const Scene& scene, uint32_t width, uint32_t height);
/// The length of the longest direction of such a picture's eye rays; reflections keep it.
double longest_direction(const CameraNumbers& numbers, uint32_t width, uint32_t height);

/// The kernel arguments of a frame (namespace argument), for a machine with floats of such a significand. Throws
/// InputError unless width and height lie in 1 .. 65535.
std::array<uint32_t, kArguments> camera_arguments(const Scene& scene, uint32_t width, uint32_t height,
                                                  uint32_t contents, uint32_t significand = arith::kFullSignificand);

/// A package's depth has 8 bits, and a reflection of the last depth must still be seen as beyond it.
inline constexpr int kLargestDepth = 254;

/// Each has a frame buffer of its own.
inline constexpr uint32_t kMostRenderThreads = 256;

/// Pixels that one launch of the eye kernel casts: in rows as wide as a tile, from this first one on.
struct PixelTile {
  uint32_t x = 0, y = 0;
  uint32_t pixels = 0;  ///< those beyond the picture included
};
/// What a part of the picture takes.
struct NativeWork {
  EnumArray<RayKernel, uint64_t, kRayKernels> kernel_threads{};
  uint64_t rays = 0;                  ///< traced
  uint64_t nodes = 0, triangles = 0;  ///< visited by them, as Traversal::visits() records it
  uint64_t places = 0;                ///< different ones of the tree among these
  VisitList chip_places;              ///< of the chip's tree, with the hardware's hits: Traversal::places_of()
  std::vector<size_t> tile_ends;      ///< of each tile of the part: so many of chip_places until its end
};

struct NativeOptions {
  uint32_t width = 512, height = 512;
  uint32_t depth = 1;       ///< 1 .. kLargestDepth; 1: eye and shadow rays only; d: up to d - 1 reflections
  bool reflections = true;  ///< false: casts none, whatever the depth; the same picture where no material reflects
  uint32_t contents = 64;   ///< size of an eye tile in pixels, a power of two; changes no picture
  uint32_t threads = 1;     ///< 1 .. kMostRenderThreads; changes no picture and no count
  arith::Mode mode;
  bool culling = false;  ///< chip.culling; changes no picture
  NativeKernels kernel;  ///< run_native when empty
  /// Called with camera_arguments() before the frame begins, to change them; may be empty.
  std::function<void(std::array<uint32_t, kArguments>&)> change_arguments;
  std::function<bool(const Ray&, Intersection&)> trace;  ///< the tracer's when empty
  /// The picture in parts, of tiles that are drawn one after the other; empty: by tiles of `contents` pixels.
  std::vector<std::vector<PixelTile>> parts;
  std::vector<NativeWork>* work = nullptr;  ///< gets what each of the parts takes; not together with `trace`
};

struct NativeStatistics {
  RayCounts ray_counts;
  uint64_t dropped_rays = 0;                                     ///< normal rays beyond the depth limit, not traced
  uint64_t contributions = 0;                                    ///< added to the frame buffer
  EnumArray<RayKernel, uint64_t, kRayKernels> kernel_threads{};  ///< threads run of each kernel

  uint64_t rays() const { return ray_counts.traced(); }
  /// Those of other pixels of the frame.
  void add(const NativeStatistics& part);
  /// Rays that kernels have not cast, once all pixels are counted.
  void count_left_out(const NativeOptions& options);
};

/// `tracer` must have been made from `scene` with the material_base of build_memory(ray_kernel_program(), scene).
/// Throws InputError when an option is out of its range.
FrameBuffer render_native(const Scene& scene, const MemoryImage& image, const Tracer& tracer,
                          const NativeOptions& options, NativeStatistics* statistics = nullptr);

/// The sum of as many frames, 1 or more, each with its number as the kernels' argument kSample; each begins with the
/// image's memory. `options` without change_arguments; `statistics` are of all frames.
FrameBuffer render_samples(const Scene& scene, const MemoryImage& image, const Tracer& tracer, NativeOptions options,
                           int samples, NativeStatistics* statistics = nullptr);

}  // namespace raypool
