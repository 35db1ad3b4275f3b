// What engine `sampled` takes and finds. It studies the machine, so it stands above it: the program hands it to the
// command `sim`.
#pragma once

#include <cstdint>
#include <vector>

#include "chip/chip.hpp"
#include "config/configuration.hpp"
#include "enum_array.hpp"
#include "isa/isa.hpp"
#include "scene/native_renderer.hpp"

namespace raypool::sampled {

/// 95% of such intervals contain the true value.
struct Interval {
  double value = 0;
  double low = 0, high = 0;

  bool contains(double x) const { return low <= x && x <= high; }
};

inline constexpr double kDefaultError = 0.02;

/// What may be afforded: an error, or a time.
struct Wanted {
  double error = kDefaultError;  ///< half of the interval of the cycles, as a share of them; 0 < error < 1
  double seconds = 0;            ///< of simulation; 0: as many as the error takes
  uint64_t seed = 1;
  uint32_t processes = 1;  ///< at a time, 1 or more; no figure depends on it, but where `seconds` are given
};

struct Figures {
  bool whole = false;  ///< all was simulated: the figures are exact
  uint32_t tiles = 0;  ///< of the frame
  uint32_t counted_tiles = 0, simulated_tiles = 0;
  Interval cycles;
  Interval mrays_per_s;
  EnumArray<AluType, Interval, kAluTypes> alus;  ///< utilisation, of busy time, 0 .. 1
  Interval ray_port, intersection_port, memory_port;

  double error() const { return cycles.value == 0 ? 0 : (cycles.high - cycles.low) / 2 / cycles.value; }
};

/// An engine that draws a sample (studies/sampled/sampled_frame.hpp).
struct Sampler {
  std::vector<std::vector<PixelTile>> (*blocks_of)(const Configuration& configuration, uint32_t width, uint32_t height);
  Figures (*draw)(const ChipOptions& chip, uint32_t units, const std::vector<NativeWork>& work, const Wanted& wanted);
};

}  // namespace raypool::sampled
