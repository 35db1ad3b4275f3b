// Start of a frame, and the native engine.
#include "scene/native_renderer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <optional>
#include <thread>
#include <utility>

#include "bits.hpp"

namespace raypool {
namespace {

constexpr uint32_t kPiece = 1024;  // pixels

void require_range(const char* what, int value, int low, int high) {
  if (value < low || value > high)
    throw InputError(fmt::format("{} is {}; it must lie in {} .. {}", what, value, low, high));
}

/// One worker: its own picture and counts.
class Worker {
 public:
  Worker(const std::array<uint32_t, kArguments>& arguments, Memory& memory, const Tracer& tracer,
         const NativeOptions& options)
      : frame(options.width, options.height),
        tracer_(tracer),
        options_(options),
        kernels_(options.kernel ? options.kernel : NativeKernels(run_native)) {
    NativeThread thread;
    thread.arguments = &arguments;
    thread.memory = &memory;
    thread.mode = options.mode;
    thread.culling = options.culling;
    for (Packet& packet : packets_) packet.threads.assign(kernels_.most(), thread);
    if (options.work != nullptr) visits_.emplace(tracer.traversal().visits());
  }

  /// Only where options ask for it.
  NativeWork work_of(const std::vector<PixelTile>& tiles) {
    const auto threads = statistics.kernel_threads;
    const uint64_t rays = statistics.rays();
    visits_->begin();
    NativeWork work;
    size_t told = 0;
    for (const PixelTile& tile : tiles) {
      render({tile});
      tracer_.traversal().places_of(*visits_, std::exchange(told, visits_->places.size()), work.chip_places);
      work.tile_ends.push_back(work.chip_places.size());
    }
    for (size_t i = 0; i < kRayKernels; ++i) work.kernel_threads[i] = statistics.kernel_threads[i] - threads[i];
    work.rays = statistics.rays() - rays;
    work.nodes = visits_->nodes;
    work.triangles = visits_->triangles;
    work.places = visits_->places.size();
    return work;
  }

  void render(const std::vector<PixelTile>& tiles) {
    Packet& eye = packets_[RayKernel::CastEye];
    for (const PixelTile& tile : tiles) {
      for (uint32_t i = 0; i < tile.pixels; ++i) {
        NativeThread& thread = eye.threads[eye.count++];
        thread.thread = i;
        thread.threads = tile.pixels;
        thread.block = tile.x | tile.y << 16;
        if (eye.count < kernels_.most() && i + 1 < tile.pixels) continue;
        run(RayKernel::CastEye);
        follow_all();
      }
    }
    // What has not filled a packet.
    for (bool waits = true; waits;) {
      waits = false;
      for (size_t kernel = 0; kernel < kRayKernels; ++kernel) {
        if (packets_[kernel].count == 0) continue;
        run(static_cast<RayKernel>(kernel));
        follow_all();
        waits = true;
      }
    }
  }

  FrameBuffer frame;
  NativeStatistics statistics;

 private:
  /// Threads that run next.
  struct Packet {
    std::vector<NativeThread> threads;
    size_t count = 0;
  };

  void run(RayKernel kernel) {
    Packet& packet = packets_[kernel];
    const size_t count = std::exchange(packet.count, 0);
    for (size_t i = 0; i < count; ++i) packet.threads[i].rays.clear(), packet.threads[i].frame.clear();
    kernels_(kernel, packet.threads.data(), count);
    statistics.kernel_threads[kernel] += count;
    for (size_t i = 0; i < count; ++i) {
      const NativeThread& thread = packet.threads[i];
      pending_.insert(pending_.end(), thread.rays.begin(), thread.rays.end());
      for (const FrameContribution& contribution : thread.frame) statistics.contributions += frame.add(contribution);
    }
  }

  void follow_all() {
    while (!pending_.empty()) {
      const Ray ray = pending_.back();
      pending_.pop_back();
      follow(ray);
    }
  }

  void follow(const Ray& ray) {
    const bool shadow = is_shadow(ray);
    const uint32_t depth = ray[word::kFlags] & kDepthMask;
    if (!shadow && depth > options_.depth) {
      ++statistics.dropped_rays;
      return;
    }
    if (options_.culling && is_black(ray)) return;
    const bool goes_on = options_.trace ? options_.trace(ray, hit_)
                         : visits_      ? tracer_.trace(ray, hit_, *visits_)
                                        : tracer_.trace(ray, hit_);
    statistics.ray_counts.count(ray, goes_on);
    if (!goes_on) return;
    const RayKernel kernel = shadow ? RayKernel::Shade : secondary(depth);
    Packet& packet = packets_[kernel];
    packet.threads[packet.count++].input = hit_;
    if (packet.count == kernels_.most()) run(kernel);
  }

  // Of the hit of a ray of this depth.
  RayKernel secondary(uint32_t depth) {
    const RayKernel kernel = secondary_kernel(options_.depth, options_.reflections);
    if (kernel == RayKernel::CastSecondaryDirect || !options_.culling) return kernel;
    const bool deepest = depth == options_.depth;
    statistics.dropped_rays += deepest;
    return deepest || !tracer_.reflects(hit_[word::kMaterial]) ? RayKernel::CastSecondaryDirect : kernel;
  }

  const Tracer& tracer_;
  const NativeOptions& options_;
  const NativeKernels kernels_;
  EnumArray<RayKernel, Packet, kRayKernels> packets_;
  Intersection hit_{};
  std::vector<Ray> pending_;
  std::optional<TreeVisits> visits_;
};

/// What is handed out to workers, one at a time: tiles, or parts of several. Which worker gets which does not matter:
/// pictures and counts are sums.
class Pieces {
 public:
  explicit Pieces(const NativeOptions& options)
      : options_(options),
        tile_width_(1u << tile_width_log2(options.contents)),
        tile_height_(options.contents / tile_width_),
        columns_((options.width + tile_width_ - 1) / tile_width_),
        tiles_(uint64_t{columns_} * ((options.height + tile_height_ - 1) / tile_height_)) {
    // So many tiles that few packets run unfilled.
    if (options.kernel && options.kernel.most() > 1) at_once_ = std::max(1u, kPiece / options.contents);
  }

  uint64_t count() const { return in_parts() ? options_.parts.size() : (tiles_ + at_once_ - 1) / at_once_; }
  std::vector<PixelTile> tiles(uint64_t piece) const {
    if (in_parts()) return options_.parts[piece];
    std::vector<PixelTile> several;
    for (uint64_t tile = piece * at_once_; tile < std::min(tiles_, (piece + 1) * at_once_); ++tile) {
      const auto row = static_cast<uint32_t>(tile / columns_), column = static_cast<uint32_t>(tile % columns_);
      several.push_back({column * tile_width_, row * tile_height_, options_.contents});
    }
    return several;
  }

 private:
  bool in_parts() const { return !options_.parts.empty(); }

  const NativeOptions& options_;
  uint32_t tile_width_, tile_height_, columns_;
  uint64_t tiles_, at_once_ = 1;
};

}  // namespace

void NativeStatistics::add(const NativeStatistics& part) {
  ray_counts.add(part.ray_counts);
  dropped_rays += part.dropped_rays;
  contributions += part.contributions;
  for (size_t i = 0; i < kRayKernels; ++i) kernel_threads[i] += part.kernel_threads[i];
}

void NativeStatistics::count_left_out(const NativeOptions& options) {
  ray_counts.count_left_out(kernel_threads[RayKernel::CastSecondary] + kernel_threads[RayKernel::CastSecondaryDirect],
                            secondary_kernel(options.depth, options.reflections) == RayKernel::CastSecondary,
                            dropped_rays);
}

void store_program(const Program& program, Memory& memory) {
  for (uint32_t i = 0; i < program.code.size(); ++i) {
    memory.store(8 * i, static_cast<uint32_t>(program.code[i]));
    memory.store(8 * i + 4, static_cast<uint32_t>(program.code[i] >> 32));
  }
}

MemoryImage build_memory(const Program& program, const Scene& scene) {
  auto round_up = [](uint64_t bytes) { return (bytes + 63) / 64 * 64; };
  const uint64_t base = round_up(8 * program.code.size());
  const uint64_t size = round_up(base + kMaterialBytes * scene.materials.size());
  if (size > UINT32_MAX)
    throw InputError(fmt::format("{}: {} materials do not fit in the memory", scene.name, scene.materials.size()));
  MemoryImage image{Memory(static_cast<uint32_t>(size)), static_cast<uint32_t>(base)};
  store_program(program, image.memory);
  for (uint32_t i = 0; i < scene.materials.size(); ++i) {
    const uint32_t record = image.material_base + i * kMaterialBytes;
    for (uint32_t axis = 0; axis < 3; ++axis) {
      const uint32_t offset = 4 * axis;
      image.memory.store(record + kMaterialDiffuse + offset, as_bits(scene.materials[i].kd[axis]));
      image.memory.store(record + kMaterialReflectance + offset, as_bits(scene.materials[i].ks[axis]));
    }
  }
  return image;
}

CameraNumbers camera_numbers(const Scene& scene, uint32_t width, uint32_t height) {
  require_range("image width", width, 1, 65535);
  require_range("image height", height, 1, 65535);
  CameraNumbers numbers{};
  auto put = [&](int first, const Vec3d& v) {
    for (int axis = 0; axis < 3; ++axis) numbers[first + axis] = v[axis];
  };
  const Vec3d forward = normalized(scene.camera.direction.as<double>());
  const Vec3d right = normalized(cross(forward, scene.camera.up.as<double>()));
  const Vec3d up = cross(right, forward);
  const double pi = 3.14159265358979323846;
  const double half_height = std::tan(scene.camera.fov * 0.5 * pi / 180);
  const double pixel = 2 * half_height / height;  // pixels are square
  const Vec3d step_x = right * pixel, step_y = up * -pixel;
  put(argument::kEye, scene.camera.eye.as<double>());
  put(argument::kCorner, forward + step_x * (0.5 * (1.0 - width)) + step_y * (0.5 * (1.0 - height)));
  put(argument::kStepX, step_x);
  put(argument::kStepY, step_y);
  put(argument::kLight, scene.light.position.as<double>());
  put(argument::kLightColor, scene.light.color.as<double>());
  return numbers;
}

double offset_share(double longest_direction, uint32_t significand) {
  const auto rounding = [](uint32_t bits) { return std::ldexp(1.0, -static_cast<int>(bits)); };
  return 4 * (rounding(significand) + rounding(arith::kFullSignificand)) * std::max(1.0, longest_direction / 2);
}

double longest_direction(const CameraNumbers& numbers, uint32_t width, uint32_t height) {
  const auto get = [&](int first) { return Vec3d{numbers[first], numbers[first + 1], numbers[first + 2]}; };
  double longest = 0;  // at a corner of the picture: what is longest of a parallelogram
  for (const double x : {0.0, width - 1.0}) {
    for (const double y : {0.0, height - 1.0}) {
      const Vec3d direction = get(argument::kCorner) + get(argument::kStepX) * x + get(argument::kStepY) * y;
      longest = std::max(longest, length(direction));
    }
  }
  return longest;
}

std::array<uint32_t, kArguments> camera_arguments(const Scene& scene, uint32_t width, uint32_t height,
                                                  uint32_t contents, uint32_t significand) {
  std::array<uint32_t, kArguments> arguments{};
  const CameraNumbers numbers = camera_numbers(scene, width, height);
  for (size_t i = 0; i < numbers.size(); ++i) arguments[i] = as_bits(static_cast<float>(numbers[i]));
  const double longest = longest_direction(numbers, width, height);
  arguments[argument::kOffset] = as_bits(static_cast<float>(offset_share(longest, significand)));
  const uint32_t log2 = tile_width_log2(contents);
  arguments[argument::kTileWidthLog2] = log2;
  arguments[argument::kTileMask] = (1u << log2) - 1;
  arguments[argument::kWidth] = width;
  arguments[argument::kHeight] = height;
  return arguments;
}

FrameBuffer render_native(const Scene& scene, const MemoryImage& image, const Tracer& tracer,
                          const NativeOptions& options, NativeStatistics* statistics) {
  require_range("depth", options.depth, 1, kLargestDepth);
  require_range("threads", options.threads, 1, kMostRenderThreads);
  require_range("contents", options.contents, 1, 1024);
  if ((options.contents & (options.contents - 1)) != 0) {
    throw InputError(fmt::format("contents is {}; it must be a power of two", options.contents));
  }
  auto arguments = camera_arguments(scene, options.width, options.height, options.contents, options.mode.significand);
  if (options.change_arguments) options.change_arguments(arguments);
  Memory memory = image.memory;
  const Pieces pieces(options);
  if (options.work != nullptr) options.work->assign(pieces.count(), {});
  const size_t workers_count = options.threads;
  std::vector<Worker> workers(workers_count, Worker(arguments, memory, tracer, options));
  std::vector<std::exception_ptr> errors(workers_count);
  std::atomic<uint64_t> next{0};
  auto work = [&](size_t index) {
    try {
      for (uint64_t piece = next++; piece < pieces.count(); piece = next++) {
        if (options.work != nullptr) {
          (*options.work)[piece] = workers[index].work_of(pieces.tiles(piece));
        } else {
          workers[index].render(pieces.tiles(piece));
        }
      }
    } catch (...) {
      errors[index] = std::current_exception();
    }
  };
  std::vector<std::thread> threads;
  for (size_t i = 1; i < workers_count; ++i) threads.emplace_back(work, i);
  work(0);
  for (std::thread& thread : threads) thread.join();
  for (const std::exception_ptr& error : errors) {
    if (error) std::rethrow_exception(error);
  }

  FrameBuffer frame = std::move(workers[0].frame);
  NativeStatistics sum = workers[0].statistics;
  for (size_t i = 1; i < workers_count; ++i) {
    frame.add(workers[i].frame);
    sum.add(workers[i].statistics);
  }
  sum.count_left_out(options);
  if (statistics != nullptr) *statistics = sum;
  return frame;
}

FrameBuffer render_samples(const Scene& scene, const MemoryImage& image, const Tracer& tracer, NativeOptions options,
                           int samples, NativeStatistics* statistics) {
  std::optional<FrameBuffer> picture;
  for (int sample = 0; sample < samples; ++sample) {
    options.change_arguments = [sample](std::array<uint32_t, kArguments>& arguments) {
      arguments[argument::kSample] = static_cast<uint32_t>(sample);
    };
    NativeStatistics of_frame;
    FrameBuffer frame = render_native(scene, image, tracer, options, &of_frame);
    if (statistics != nullptr) statistics->add(of_frame);
    if (picture)
      picture->add(frame);
    else
      picture = std::move(frame);
  }
  return std::move(picture.value());
}

}  // namespace raypool
