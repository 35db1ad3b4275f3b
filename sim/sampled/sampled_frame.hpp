// Engine `sampled`: the cycle-exact model on a random sample of a frame's tiles, and what that says of the frame.
//
// A block of the sample is simulated as it is in the frame, among its neighbours: tiles before it, that fill the chip
// and its caches, and behind it, so that it does not drain, are simulated too and not counted. What the native renderer
// knows of all blocks predicts what they cost.
#pragma once

#include <cstdint>
#include <vector>

#include "chip/chip.hpp"
#include "sampled/estimate.hpp"
#include "scene/native_renderer.hpp"

namespace raypool::sampled {

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

/// The blocks of which a sample is drawn, in order: the parts in which native draws for it (NativeOptions::parts).
std::vector<std::vector<PixelTile>> blocks_of(const Configuration& configuration, uint32_t width, uint32_t height);

/// `work`: what each of blocks_of() takes, of the frame and its memory image. A pilot sample finds how many tiles it
/// takes; if that is three quarters of the frame all of it is simulated. Options of `chip` as for run_board(), whose
/// exceptions it passes on, as in_processes() does; it makes the model of the chip itself, of so many units. The sample
/// is simulated in processes of their own: `chip.frame` gets nothing of it, and `chip.progress` is called when one has
/// ended, with its stage's share, cycles and rays.
Figures draw_sampled(const ChipOptions& chip, uint32_t units, const std::vector<NativeWork>& work,
                     const Wanted& wanted);

}  // namespace raypool::sampled
