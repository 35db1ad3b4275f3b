// Runs random programs on a compute unit whose every port stalls at random: the memory answers late and in bursts, pools are full
// or empty, the frame buffer waits.
#pragma once

#include <cstdint>

#include "cosim/random_program.hpp"
#include "machine/compute_unit.hpp"

namespace raypool {

/// Runs all kernels of `program` on `unit`, which must use (or be a lockstep over) `memory`. Returns the cycles. Throws
/// InputError when a fault occurs or the job has not ended after `cycle_limit` cycles; what the unit throws passes through.
uint64_t run_random_program(ComputeUnit& unit, Memory& memory, const RandomProgram& program, uint64_t seed,
                            uint64_t cycle_limit = 5'000'000);

}  // namespace raypool
