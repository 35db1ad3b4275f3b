#include "convergence/convergence_command.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>

#include "cli/image_size.hpp"
#include "cli/progress.hpp"
#include "convergence/comparison.hpp"

namespace raypool::convergence {
namespace {

constexpr uint32_t kFewestSamples = 16, kStep = 4;  // of the pictures whose variance is taken: 16, 64, 256, ...

std::string percent(double share) { return fmt::format("{:.2f}%", 100 * share); }

void print_row(const Scene& scene, const Comparison& result) {
  fmt::print("{:<12} {:>8} {:>6}  {:>7} {:>6} {:>8}  {:>8} {:>6}  {:>8}\n", scene.name, percent(result.whole),
             percent(result.whole_error), percent(result.typical), percent(result.noise),
             fmt::format("{:.2f}", result.scatter), percent(result.largest), percent(result.largest_error),
             fmt::format("{}/{}", result.beyond, result.blocks));
}

/// As it would be of one sample, if it falls with the number of samples.
void print_variances(const std::vector<VarianceOfPictures>& pictures, const PictureSpread& ours) {
  fmt::print("{:<12}", "  variance");
  for (const VarianceOfPictures& each : pictures)
    fmt::print("  {}: {:.4f}", each.samples(), each.relative(ours) * each.samples());
  fmt::print("\n");
  std::fflush(stdout);
}

}  // namespace

int convergence_command(const CommandOptions& options) {
  const ImageSize size = parse_image_size(options.size);
  Task task;
  task.set = options.shaders;
  task.size = {static_cast<uint32_t>(size.width), static_cast<uint32_t>(size.height), options.depth, options.samples};
  task.block = options.block;
  task.reference_samples = static_cast<uint32_t>(std::lround(options.samples * options.reference));
  fmt::print("{:<12} {:>8} {:>6}  {:>7} {:>6} {:>8}  {:>8} {:>6}  {:>8}\n", "scene", "whole", "+-", "blocks", "noise",
             "scatter", "worst", "+-", fmt::format("> {}%", 100 * kAgreed));
  Progress progress(false);
  for (const std::string& name : options.scenes) {
    SceneOptions with_surfaces;
    with_surfaces.surfaces = true;
    const Scene scene = load_scene(name, with_surfaces);
    std::vector<VarianceOfPictures> pictures;
    for (uint32_t n = kFewestSamples; 4 * n <= options.samples; n *= kStep) pictures.emplace_back(n);
    const auto show = [&](const char* what, uint32_t drawn, uint32_t all) {
      if (progress.due()) progress.show(fmt::format("  {}: {} of {} samples of {}", scene.name, drawn, all, what));
    };
    uint32_t drawn = 0;
    const PictureSpread ours = draw_with_shaders(task, scene, [&](const BlockMeans& sample) {
      for (VarianceOfPictures& each : pictures) each.add(sample);
      show("the shaders", ++drawn, options.samples);
    });
    drawn = 0;
    const PictureSpread reference =
        draw_reference(task, scene, [&](const BlockMeans&) { show("the reference", ++drawn, task.reference_samples); });
    print_row(scene, compare(ours, reference));
    print_variances(pictures, ours);
  }
  return 0;
}

}  // namespace raypool::convergence
