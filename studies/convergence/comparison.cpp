#include "convergence/comparison.hpp"

#include <atomic>
#include <cmath>
#include <thread>
#include <vector>

#include "convergence/path_reference.hpp"
#include "scene/threads.hpp"

namespace raypool::convergence {
namespace {

/// One path a pixel. Each row has random numbers of its own, which go on from sample to sample.
std::vector<Vec3d> reference_sample(const PathReference& reference, const PictureSize& size,
                                    std::vector<Random>& randoms) {
  std::vector<Vec3d> picture(size_t{size.width} * size.height);
  std::atomic<uint32_t> next{0};
  const auto work = [&] {
    for (uint32_t y = next++; y < size.height; y = next++) {
      for (uint32_t x = 0; x < size.width; ++x)
        picture[size_t{y} * size.width + x] = reference.sample(x, y, randoms[y]);
    }
  };
  std::vector<std::thread> threads;
  for (uint32_t i = 0; i < threads_or_all(); ++i) threads.emplace_back(work);
  for (std::thread& thread : threads) thread.join();
  return picture;
}

double square(double x) { return x * x; }

}  // namespace

PictureSpread draw_with_shaders(const Task& task, const Scene& scene, const Seen& seen) {
  const PictureSize& size = task.size;
  const ShaderFrames frames(task.set, scene, size);
  PictureSpread spread;
  for (uint32_t sample = 0; sample < size.samples; ++sample) {
    const FrameBuffer frame = frames.draw(sample);
    const BlockMeans means = block_means(
        size.width, size.height, task.block,
        [&](uint32_t x, uint32_t y, uint32_t channel) { return frame.linear(x, y, channel) * size.samples; });
    spread.add(means);
    if (seen) seen(means);
  }
  return spread;
}

PictureSpread draw_reference(const Task& task, const Scene& scene, const Seen& seen) {
  const PictureSize& size = task.size;
  const PathReference reference(scene, size.width, size.height, size.depth);
  std::vector<Random> randoms;
  for (uint32_t y = 0; y < size.height; ++y) randoms.emplace_back(y);
  PictureSpread spread;
  for (uint32_t sample = 0; sample < task.reference_samples; ++sample) {
    const std::vector<Vec3d> picture = reference_sample(reference, size, randoms);
    const BlockMeans means =
        block_means(size.width, size.height, task.block, [&](uint32_t x, uint32_t y, uint32_t channel) {
          return picture[size_t{y} * size.width + x][static_cast<int>(channel)];
        });
    spread.add(means);
    if (seen) seen(means);
  }
  return spread;
}

Comparison compare(const PictureSpread& ours, const PictureSpread& reference) {
  const auto off = [](const Spread& a, const Spread& b) { return a.mean() / b.mean() - 1; };
  const auto error = [](const Spread& a, const Spread& b) {
    return std::sqrt(a.variance_of_mean() + b.variance_of_mean()) / b.mean();
  };
  Comparison result;
  result.whole = off(ours.whole(), reference.whole());
  result.whole_error = error(ours.whole(), reference.whole());
  Spread found, expected, scatter;
  for (size_t i = 0; i < ours.blocks().size(); ++i) {
    const Spread &a = ours.blocks()[i], &b = reference.blocks()[i];
    if (b.mean() == 0) continue;
    found.add(square(off(a, b)));
    expected.add(square(error(a, b)));
    if (std::fabs(off(a, b)) > kAgreed) ++result.beyond;
    if (std::fabs(off(a, b)) > std::fabs(result.largest))
      result.largest = off(a, b), result.largest_error = error(a, b);
  }
  for (size_t i = 0; i < ours.channels().size(); ++i) {
    const Spread &a = ours.channels()[i], &b = reference.channels()[i];
    if (a.variance() + b.variance() > 0) scatter.add(square(off(a, b) / error(a, b)));
  }
  result.blocks = found.count();
  result.typical = std::sqrt(found.mean());
  result.noise = std::sqrt(expected.mean());
  result.scatter = scatter.mean();
  return result;
}

}  // namespace raypool::convergence
