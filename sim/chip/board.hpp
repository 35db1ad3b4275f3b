// A board with the chip as one piece (machine/chip_device.hpp): its memory, its frame buffer, a host that starts a
// frame, and, unless the chip has one inside, the traverser at its ports. A loop over cycles, without SystemC: the chip
// has all that takes its time.
#pragma once

#include "chip/chip.hpp"
#include "machine/chip_device.hpp"

namespace raypool {

/// Draws one frame, as run_chip() does, on a chip for `options.configuration`. `options.device`, `tiles` and
/// `own_policy` have no meaning here, nor has `tracer` with a traverser inside, or `tree` with another. Throws
/// InputError for options out of range or a configuration that the chip has not, ChipFault, TraverserFault,
/// ChipStalled, also where an answer of the memory does not come, and whatever the chip's clock() or the tracer throws.
ChipResult run_board(const ChipOptions& options, ChipDevice& chip);

}  // namespace raypool
