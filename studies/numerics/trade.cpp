#include "numerics/trade.hpp"

#include <algorithm>
#include <cmath>

#include "scene/hits_check.hpp"
#include "scene/picture_file.hpp"
#include "scene/threads.hpp"

namespace raypool::numerics {
namespace {

bool is_nan(uint32_t bits) { return (bits & 0x7fffffffu) > 0x7f800000u; }

/// Above zero, and no NaN.
bool positive(uint32_t bits) { return bits != 0 && bits <= 0x7f800000u; }

size_t pixel_index(uint32_t pixel, int width) {
  return static_cast<size_t>(pixel >> 16) * static_cast<size_t>(width) + (pixel & 0xffffu);
}

/// Mean of squares as decibels below 1.
double decibels(double squares, uint64_t values) {
  return squares == 0 || values == 0 ? INFINITY : 10 * std::log10(static_cast<double>(values) / squares);
}

/// Judges the shadow of a primary hit that both have: true when the machine's answer is wrong, false for a tie.
bool shadow_is_wrong(const TradeScene& scene, const PathStep& ours, const PathStep& truth, int x, int y,
                     const Ray& machine_ray) {
  const ReferenceCamera camera(scene.arguments);
  const Vec3d direction = camera.direction(x, y);
  const DoubleHit hit = scene.reference_tracer.nearest(camera.eye, direction, INFINITY);
  const ReferenceShadowRay shadow = shadow_ray(scene.reference_tracer, camera.eye, direction, hit, camera.light);
  HitAnswer machine, reference;
  machine.hit = !ours.lit;
  Hit blocker;
  if (machine.hit && scene.tracer.traversal().nearest(to_query(machine_ray), blocker)) {
    machine.triangle = blocker.triangle;
    // The judge would call a block at t = 0 a tie.
    if (same_surface(scene.reference_tracer, hit.triangle, blocker.triangle)) return true;
  }
  reference.hit = !truth.lit;
  if (reference.hit) reference.triangle = scene.reference_tracer.occluder(shadow.origin, shadow.direction, 1);
  std::string reason;
  return judge_hits(scene.scene, {shadow.origin, shadow.direction, 1}, machine, reference, reason) != HitVerdict::Tie;
}

}  // namespace

TradeScene::TradeScene(std::string scene_title, Scene what, int w, int h, int d)
    : title(std::move(scene_title)),
      scene(std::move(what)),
      width(w),
      height(h),
      depth(d),
      image(build_memory(ray_kernel_program(), scene)),
      tracer(scene, image.material_base),
      reference_tracer(scene),
      arguments(camera_arguments(scene, w, h, 64)),
      reference(0, 0, 0) {}

void TradeScene::draw_reference(const std::function<void(double)>& progress) {
  reference = render_reference(reference_tracer, arguments, width, height, depth, progress);
}

RecordedFrame::RecordedFrame(int width, int height, int depth)
    : frame(width, height),
      paths(width, height, depth),
      shadow_rays(paths.color.size()),
      nan_pixels(paths.color.size()) {}

RecordedFrame record_frame(const TradeScene& scene, const arith::Mode& mode,
                           const std::function<void(RayKernel, NativeThread&)>& kernel) {
  RecordedFrame recorded(scene.width, scene.height, scene.depth);
  NativeOptions options;
  options.width = scene.width;
  options.height = scene.height;
  options.depth = scene.depth;
  options.mode = mode;
  // What is recorded of a pixel, the one thread writes that draws it.
  if (!kernel) options.threads = threads_or_all();
  options.kernel = [&](RayKernel which, NativeThread& thread) {
    kernel ? kernel(which, thread) : run_native(which, thread);
    if (which == RayKernel::CastEye) return;
    const Intersection& input = thread.input;
    const size_t pixel = pixel_index(input[word::kPixel], scene.width);
    PathStep& step = recorded.paths.step(pixel, static_cast<int>(input[word::kFlags] & kDepthMask) - 1);
    if (which == RayKernel::Shade) {
      step.lit = true;
      for (int i = 0; i < 3; ++i) {
        if (is_nan(input[word::kColor + i])) recorded.nan_pixels[pixel] = 1;
      }
      return;
    }
    step.triangle = input[word::kTriangle];
    step.followed = true;
    for (const Ray& ray : thread.rays) {
      if ((ray[word::kFlags] & kShadowFlag) == 0) continue;
      for (int i = 0; i < 3; ++i) step.facing |= positive(ray[word::kColor + i]);
      if ((ray[word::kFlags] & kDepthMask) == 1) recorded.shadow_rays[pixel] = ray;
    }
  };
  recorded.frame = render_native(scene.scene, scene.image, scene.tracer, options);
  return recorded;
}

Quality judge_frame(const TradeScene& scene, const RecordedFrame& drawn) {
  const PathImage& truth = scene.reference;
  const ReferenceCamera camera(scene.arguments);
  Quality quality;
  quality.pixels = truth.color.size();
  double squares = 0, squares_same = 0;
  for (size_t pixel = 0; pixel < truth.color.size(); ++pixel) {
    const int x = static_cast<int>(pixel % static_cast<size_t>(scene.width)),
              y = static_cast<int>(pixel / static_cast<size_t>(scene.width));
    quality.nan_pixels += drawn.nan_pixels[pixel];

    // The primary hit, and its shadow.
    const PathStep &ours = drawn.paths.step(pixel, 0), &reference = truth.step(pixel, 0);
    if (ours.triangle != reference.triangle) {
      const HitAnswer our_answer{ours.triangle != kNoTriangle, ours.triangle, 0};
      const HitAnswer reference_answer{reference.triangle != kNoTriangle, reference.triangle, 0};
      std::string reason;
      const HitVerdict verdict =
          judge_hits(scene.scene, {camera.eye, camera.direction(x, y), INFINITY}, our_answer, reference_answer, reason);
      ++(verdict == HitVerdict::Tie ? quality.ties : our_answer.hit ? quality.wrong_triangles : quality.holes);
    } else if (reference.facing && ours.lit != reference.lit) {
      ++(shadow_is_wrong(scene, ours, reference, x, y, drawn.shadow_rays[pixel]) ? quality.wrong_shadows
                                                                                 : quality.ties);
    }

    bool same = true;
    for (int i = 0; i < scene.depth && truth.step(pixel, i).followed; ++i) {
      const PathStep &a = drawn.paths.step(pixel, i), &b = truth.step(pixel, i);
      same &= a.triangle == b.triangle && (!b.facing || a.lit == b.lit);
    }
    quality.same_paths += same;

    // Colours.
    int largest = 0;
    for (int channel = 0; channel < 3; ++channel) {
      const double linear = drawn.frame.linear(x, y, channel), wanted = truth.color[pixel][channel];
      const double square = (linear - wanted) * (linear - wanted);
      squares += square;
      if (same) squares_same += square;
      largest = std::max(largest, std::abs(int{to_srgb8(linear)} - int{to_srgb8(wanted)}));
    }
    quality.off_by_one += largest == 1;
    quality.off_by_more += largest >= kOffByMore;
  }
  quality.psnr = decibels(squares, 3 * quality.pixels);
  quality.psnr_same_paths = decibels(squares_same, 3 * quality.same_paths);
  return quality;
}

}  // namespace raypool::numerics
