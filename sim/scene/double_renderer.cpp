#include "scene/double_renderer.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <thread>
#include <utility>
#include <vector>

#include "bits.hpp"
#include "kernel/double_kernels.hpp"
#include "scene/double_traversal.hpp"

namespace raypool {
namespace {

using Arguments = std::array<DoubleWord, kArguments>;

Arguments arguments_in_double(const Scene& scene, uint32_t width, uint32_t height) {
  Arguments arguments{};
  const CameraNumbers numbers = camera_numbers(scene, width, height);
  for (size_t i = 0; i < numbers.size(); ++i) arguments[i].number = numbers[i];
  arguments[argument::kOffset].number =
      kDoubleOffsetShare * std::max(1.0, longest_direction(numbers, width, height) / 2);
  // An eye tile is a pixel.
  arguments[argument::kWidth].bits = width;
  arguments[argument::kHeight].bits = height;
  return arguments;
}

/// One worker: its own picture and counts.
class DoubleWorker {
 public:
  DoubleWorker(const Scene& scene, const Arguments& arguments, const MemoryImage& image, const Tracer& tracer,
               const NativeOptions& options, PixelDecisions* decisions)
      : frame(options.width, options.height),
        scene_(scene),
        base_(image.material_base),
        traversal_(tracer.traversal().bvh()),
        options_(options),
        decisions_(decisions) {
    thread_.arguments = &arguments;
    thread_.memory = &image.memory;
  }

  void render_row(uint32_t y) {
    for (uint32_t x = 0; x < options_.width; ++x) {
      thread_.block = x | y << 16;
      run(RayKernel::CastEye);
      while (!pending_.empty()) {
        const DoubleRay ray = pending_.back();
        pending_.pop_back();
        follow(ray);
      }
    }
  }

  FrameBuffer frame;
  NativeStatistics statistics;

 private:
  void run(RayKernel kernel) {
    thread_.rays.clear();
    thread_.frame.clear();
    run_in_double(kernel, thread_);
    ++statistics.kernel_threads[kernel];
    pending_.insert(pending_.end(), thread_.rays.begin(), thread_.rays.end());
    for (const DoubleContribution& made : thread_.frame) {
      FrameContribution contribution{made.pixel, {}};
      for (size_t i = 0; i < made.rgb.size(); ++i) contribution.rgb[i] = as_bits(static_cast<float>(made.rgb[i]));
      statistics.contributions += frame.add(contribution);
    }
  }

  void follow(const DoubleRay& ray) {
    const uint32_t flags = ray[word::kFlags].bits, depth = flags & kDepthMask;
    const bool shadow = (flags & kShadowFlag) != 0;
    if (!shadow && depth > options_.depth) {
      ++statistics.dropped_rays;
      return;
    }
    const bool goes_on = shadow ? is_free(ray) : meets(ray);
    Ray counted{};
    counted[word::kFlags] = flags;
    for (int i = 0; i < 3; ++i) counted[word::kColor + i] = as_bits(static_cast<float>(ray[word::kColor + i].number));
    statistics.ray_counts.count(counted, goes_on);
    if (goes_on)
      run(shadow ? RayKernel::Shade : secondary_kernel(static_cast<int>(options_.depth), options_.reflections));
  }

  static Vec3d vector_of(const DoubleRay& ray, int first) {
    return {ray[first].number, ray[first + 1].number, ray[first + 2].number};
  }
  bool is_free(const DoubleRay& ray) {
    const bool free = traversal_.occluder(vector_of(ray, word::kOrigin), vector_of(ray, word::kDirection),
                                          ray[word::kLimit].number) == kNoTriangle;
    pass_on(ray);
    if (decisions_ != nullptr) decisions_->shadow(ray[word::kPixel].bits, free);
    return free;
  }
  bool meets(const DoubleRay& ray) {
    const uint32_t pixel = ray[word::kPixel].bits;
    const DoubleHit hit =
        traversal_.nearest(vector_of(ray, word::kOrigin), vector_of(ray, word::kDirection), ray[word::kLimit].number);
    if (hit.triangle == kNoTriangle) {
      if (decisions_ != nullptr) decisions_->miss(pixel);
      return false;
    }
    if (decisions_ != nullptr) decisions_->hit(pixel, hit.triangle);
    pass_on(ray);
    DoubleIntersection& input = thread_.input;
    input[word::kDistance].number = hit.t;
    const auto corner = [&](int k) { return scene_.corner(hit.triangle, k).as<double>(); };
    const Vec3d normal = normalized(cross(corner(1) - corner(0), corner(2) - corner(0)));
    for (int axis = 0; axis < 3; ++axis) input[word::kNormal + axis].number = normal[axis];
    input[word::kMaterial].bits =
        base_ + scene_.triangle_materials[hit.triangle] * static_cast<uint32_t>(kMaterialBytes);
    return true;
  }
  void pass_on(const DoubleRay& ray) {
    thread_.input.fill({});
    std::copy(ray.begin(), ray.end(), thread_.input.begin());
  }

  const Scene& scene_;
  const uint32_t base_;
  const DoubleTraversal traversal_;
  const NativeOptions& options_;
  PixelDecisions* decisions_;
  DoubleThread thread_;
  std::vector<DoubleRay> pending_;
};

}  // namespace

FrameBuffer render_in_double(const Scene& scene, const MemoryImage& image, const Tracer& tracer,
                             const NativeOptions& options, NativeStatistics& statistics, PixelDecisions* decisions) {
  const Arguments arguments = arguments_in_double(scene, options.width, options.height);
  std::vector<DoubleWorker> workers(options.threads, DoubleWorker(scene, arguments, image, tracer, options, decisions));
  std::atomic<uint32_t> next{0};
  const auto work = [&](DoubleWorker& worker) {
    for (uint32_t row = next++; row < options.height; row = next++) worker.render_row(row);
  };
  std::vector<std::thread> threads;
  for (size_t i = 1; i < workers.size(); ++i) threads.emplace_back(work, std::ref(workers[i]));
  work(workers[0]);
  for (std::thread& thread : threads) thread.join();
  FrameBuffer frame = std::move(workers[0].frame);
  statistics = workers[0].statistics;
  for (size_t i = 1; i < workers.size(); ++i) {
    frame.add(workers[i].frame);
    statistics.add(workers[i].statistics);
  }
  statistics.count_left_out(options);
  return frame;
}

}  // namespace raypool
