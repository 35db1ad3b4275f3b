// What engines `sampled` and `estimate` take and find. They study the machine, so they stand above it: the program
// hands them to the command `sim`.
#pragma once

#include <cstdint>
#include <vector>

#include "chip/chip.hpp"
#include "chip/estimates.hpp"
#include "config/configuration.hpp"
#include "scene/native_renderer.hpp"
#include "scene/scene.hpp"
#include "scene/traversal.hpp"

namespace raypool::sampled {

inline constexpr double kDefaultError = 0.02;

/// What may be afforded: an error, or a time.
struct Wanted {
  double error = kDefaultError;  ///< half of the interval of the cycles, as a share of them; 0 < error < 1
  double seconds = 0;            ///< of simulation; 0: as many as the error takes
  uint64_t seed = 1;
  uint32_t processes = 1;  ///< at a time, 1 or more; no figure depends on it, but where `seconds` are given
};

struct Figures : Estimates {
  bool whole = false;  ///< all was simulated: the figures are exact
  uint32_t tiles = 0;  ///< of the frame
  uint32_t counted_tiles = 0, simulated_tiles = 0;
};

/// An engine that draws a sample (studies/sampled/sampled_frame.hpp).
struct Sampler {
  std::vector<std::vector<PixelTile>> (*blocks_of)(const Configuration& configuration, uint32_t width, uint32_t height);
  /// Of the frame's tiles, those that the smallest sample simulates; 1: there is none that is quicker than the frame.
  double (*least_share)(const Configuration& configuration, uint32_t width, uint32_t height);
  /// About how long the model takes for the whole frame on one core: from a few of its blocks.
  double (*seconds)(const ChipOptions& chip, uint32_t units, const std::vector<NativeWork>& work);
  Figures (*draw)(const ChipOptions& chip, uint32_t units, const std::vector<NativeWork>& work, const Wanted& wanted);
};

}  // namespace raypool::sampled

namespace raypool {

/// Engines that estimate: they study the machine.
struct EstimatingEngines {
  sampled::Sampler sampled;
  /// As Estimates::error(), of every frame on such a machine.
  double (*estimate_error)(const Configuration& configuration);
  /// Engine `estimate` (studies/estimate/estimated_frame.hpp).
  Estimates (*estimate)(const Configuration& configuration, uint32_t units, const Scene& scene,
                        const MemoryImage& image, const Tracer& tracer, const NativeOptions& native,
                        const NativeStatistics& whole);
};

}  // namespace raypool
