#include "numerics/significands.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <utility>

#include "config/parameter_table.hpp"
#include "scene/double_renderer.hpp"
#include "scene/image.hpp"
#include "scene/threads.hpp"
#include "scene/traversal.hpp"

namespace raypool::numerics {
namespace {

Picture picture_of(const FrameBuffer& frame) {
  return {static_cast<int>(frame.width()), static_cast<int>(frame.height()), to_rgb8(frame)};
}

/// A scene, ready to be drawn with any arithmetic.
class Frame {
 public:
  Frame(const Scene& scene, const Configuration& configuration, NativeOptions options)
      : scene_(scene),
        image_(build_memory(ray_kernel_program(), scene)),
        tracer_(scene, image_.material_base, configuration.chip),
        options_(std::move(options)) {
    options_.reflections = scene.reflects();
    options_.contents = configuration.contents();
    options_.threads = threads_or_all();
    options_.mode = arith::mode_of(configuration);
  }

  DecidedPicture in_double() const {
    PixelDecisions decisions(options_.width, options_.height);
    NativeStatistics statistics;
    Picture picture = picture_of(render_in_double(scene_, image_, tracer_, options_, statistics, &decisions));
    return {std::move(picture), std::move(decisions)};
  }
  DecidedPicture with(uint32_t significand) const {
    PixelDecisions decisions(options_.width, options_.height);
    NativeOptions options = options_;
    options.mode.significand = significand;
    options.trace = told([this](const Ray& ray, Intersection& hit) { return tracer_.trace(ray, hit); }, decisions);
    Picture picture = picture_of(render_native(scene_, image_, tracer_, options));
    return {std::move(picture), std::move(decisions)};
  }

 private:
  const Scene& scene_;
  const MemoryImage image_;
  const Tracer tracer_;
  NativeOptions options_;
};

}  // namespace

std::vector<SignificandRow> try_significands(const Scene& scene, const Configuration& configuration,
                                             NativeOptions frame, const std::function<void(size_t)>& progress) {
  const Frame drawn(scene, configuration, std::move(frame));
  const DecidedPicture truth = drawn.in_double();
  std::vector<SignificandRow> rows;
  for (uint32_t significand = arith::kFullSignificand; significand >= arith::kLeastSignificand; --significand) {
    const DecidedPicture machine = drawn.with(significand);
    rows.push_back(
        {significand, difference_of(truth.picture, machine.picture), count_causes(causes_of(truth, machine))});
    if (progress) progress(rows.size());
  }
  return rows;
}

std::optional<uint32_t> smallest_passing(const std::vector<SignificandRow>& rows) {
  std::optional<uint32_t> smallest;
  for (const SignificandRow& row : rows) {
    if (!row.difference.passes()) break;
    smallest = row.significand;
  }
  return smallest;
}

std::string significand_table(const std::vector<SignificandRow>& rows) {
  const auto decibels = [](double value) { return std::isfinite(value) ? fmt::format("{:.1f}", value) : "equal"; };
  std::string text =
      fmt::format("{:>4}  {:>8} {:>7}  {:>23}  {:>7} {:>6}\n", "bits", fmt::format("off by {}", kOffByMore), "pixels",
                  "of these otherwise:    ", "largest", "dB");
  text += fmt::format("{:>4}  {:>8} {:>7}  {:>7} {:>7} {:>7}  {:>7}\n", "", "or more", "differ", kPixelCauseNames[0],
                      kPixelCauseNames[1], kPixelCauseNames[2], "of 255");
  for (const auto& [significand, difference, causes] : rows) {
    text += fmt::format("{:>4}  {:>7.3f}% {:>7}  {:>7} {:>7} {:>7}  {:>7} {:>6}\n", significand,
                        100 * difference.share_off(), difference.differ, causes[0], causes[1], causes[2],
                        difference.largest, decibels(difference.psnr));
  }
  const std::optional<uint32_t> smallest = smallest_passing(rows);
  return text + fmt::format("smallest with at most {:g}% of the pixels off by {} or more: {}\n", 100 * kMostOff,
                            kOffByMore, smallest ? fmt::format("{} bits", *smallest) : "none");
}

}  // namespace raypool::numerics
