// Engine `sampled`: the cycle-accurate model on a random sample of a frame's tiles, and what follows for the frame.
//
// A block of the sample is simulated as it is in the frame, among its neighbours: tiles before it, that fill the chip
// and its caches, and behind it, so that it does not drain, are simulated too and not counted. What the native renderer
// knows of all blocks predicts what they cost.
#pragma once

#include <cstdint>
#include <vector>

#include "chip/sampling.hpp"

namespace raypool::sampled {

/// The blocks of which a sample is drawn, in order: the parts in which native draws for it (NativeOptions::parts).
std::vector<std::vector<PixelTile>> blocks_of(const Configuration& configuration, uint32_t width, uint32_t height);

/// Of the frame's tiles, those that a pilot sample simulates, with those beside its blocks; 1 where the picture is too
/// small for one.
double least_share(const Configuration& configuration, uint32_t width, uint32_t height);

/// Wall time in seconds that the model takes for the whole frame, from three blocks of it; otherwise as draw_sampled().
double seconds_of_frame(const ChipOptions& chip, uint32_t units, const std::vector<NativeWork>& work);

/// `work`: what each of blocks_of() takes, of the frame and its memory image. A pilot sample finds how many tiles it
/// takes; if that is three quarters of the frame all of it is simulated. Options of `chip` as for run_board(); it
/// passes on its exceptions, as in_processes() does; it makes the model of the chip itself, of so many units. The
/// sample is simulated in processes of their own: `chip.frame` gets nothing of it, and `chip.progress` is called when
/// one has ended, with its stage's share, cycles and rays.
Figures draw_sampled(const ChipOptions& chip, uint32_t units, const std::vector<NativeWork>& work,
                     const Wanted& wanted);

/// The engine.
inline constexpr Sampler kSampler = {blocks_of, least_share, seconds_of_frame, draw_sampled};

}  // namespace raypool::sampled
