// Engine `sampled`: the cycle-exact model on a random sample of a frame's tiles, and what that says of the frame.
//
// A block of the sample is simulated as it is in the frame, among its neighbours: tiles before it, that fill the chip
// and its caches, and behind it, so that it does not drain, are simulated too and not counted.
#pragma once

#include <cstdint>
#include <vector>

#include "chip/chip.hpp"
#include "sampled/estimate.hpp"

namespace raypool::sampled {

inline constexpr double kDefaultError = 0.02;

/// What may be afforded: an error, or a time.
struct Wanted {
  double error = kDefaultError;  ///< half of the interval of the cycles, as a share of them; 0 < error < 1
  double seconds = 0;            ///< of simulation; 0: as many as the error takes
  uint64_t seed = 1;
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

/// `rays`: that the frame traces of each pixel, row by row. A pilot sample finds how many tiles it takes; if that is
/// half of the frame all of it is simulated. Options of `chip` as for run_chip(), whose exceptions it passes on;
/// `chip.frame` gets what is simulated, some of it several times.
Figures draw_sampled(const ChipOptions& chip, const std::vector<uint32_t>& rays, const Wanted& wanted);

}  // namespace raypool::sampled
