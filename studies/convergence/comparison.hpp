// A shader set's picture beside that of the reference.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "convergence/block_means.hpp"
#include "convergence/shader_frames.hpp"
#include "scene/scene.hpp"

namespace raypool::convergence {

struct Task {
  std::string set = "path";
  PictureSize size;
  uint32_t block = 16;  ///< pixels of its side
  uint32_t reference_samples = 64;
};

using Seen = std::function<void(const BlockMeans&)>;
/// The means of the set's samples; each scaled as if it were the whole picture. `seen` is called with each.
PictureSpread draw_with_shaders(const Task& task, const Scene& scene, const Seen& seen = {});
/// Those of the reference's.
PictureSpread draw_reference(const Task& task, const Scene& scene, const Seen& seen = {});

/// Ours less the reference's, as shares of the reference.
struct Comparison {
  double whole = 0, whole_error = 0;  ///< of the whole picture, with its standard error
  double typical = 0, noise = 0;      ///< root mean square over blocks: found, and to be expected of the noise alone
  double largest = 0, largest_error = 0;  ///< of the block that is off most, with its standard error
  double scatter = 0;   ///< mean over blocks and channels of the difference squared, in its variances: 1 of noise alone
  uint64_t beyond = 0;  ///< blocks that are off by more than kAgreed
  uint64_t blocks = 0;
};
inline constexpr double kAgreed = 0.005;

Comparison compare(const PictureSpread& ours, const PictureSpread& reference);

}  // namespace raypool::convergence
