// Runs random programs on a compute unit with random stalls at every port: the memory answers late and in bursts, pools
// are full or empty, the frame buffer waits.
#pragma once

#include <cstdint>
#include <vector>

#include "cosim/random_program.hpp"
#include "isa/input_error.hpp"
#include "machine/compute/compute_unit.hpp"

namespace raypool {

/// Sees every cycle of a run: what the unit shows, and what the host answers in the same cycle.
class RunObserver {
 public:
  virtual ~RunObserver() = default;
  virtual void cycle(const UnitOutputs& outputs, const UnitInputs& inputs, const UnitTrace& trace) = 0;
  /// The unit has been reset in the middle of the run, which begins again.
  virtual void restart() {}
  /// The first fault: all of its cycle, as ComputeUnit::faults() has them, before that cycle.
  virtual void faulted(const std::vector<Fault>& faults) { static_cast<void>(faults); }
};

/// A program that ends otherwise than it must: another fault, or no end. Of the program and the unit, not of what
/// stands around them, so that minimising the program makes sense.
struct ProgramFailure : InputError {
  using InputError::InputError;
};

/// Runs all kernels of `program` on `unit`, which must use (or be a lockstep over) `memory`, until the unit is idle, or
/// has stopped in the last kernel with one of the faults that the program may end in. `seed` is that of the stalls and
/// of the imported packages. Returns the cycles. Throws ProgramFailure when another fault occurs or the job has not
/// ended after `cycle_limit` cycles; what the unit throws passes through.
uint64_t run_random_program(ComputeUnit& unit, Memory& memory, const RandomProgram& program, uint64_t seed,
                            uint64_t cycle_limit = 5'000'000, RunObserver* observer = nullptr);

}  // namespace raypool
