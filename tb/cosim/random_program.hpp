// Constrained-random programs for the lockstep: every instruction of the table, nested loops, calls, divergent predicates, loads
// and stores with and without locality, ray memory rotation, special float values.
#pragma once

#include <cstdint>
#include <vector>

#include "config/configuration.hpp"
#include "isa/program.hpp"
#include "machine/compute_unit.hpp"

namespace raypool {

/// A program and what it needs around it. The same seed gives the same program.
struct RandomProgram {
  Program program;  ///< entry "main"; every kernel of the job runs it
  Memory memory;    ///< program and data
  std::array<uint32_t, kArguments> arguments{};
  struct Kernel {
    uint32_t threads;
    uint32_t block;
    ImportKind import;
  };
  std::vector<Kernel> kernels;  ///< launched one after the other; they share one import kind
};

/// Warps store only to regions of their own and read those or a region that nobody writes, so that the result does not depend on
/// the order of warps. `length`: about how many instructions the body has.
RandomProgram make_random_program(const Configuration& configuration, uint64_t seed, int length = 120);

}  // namespace raypool
