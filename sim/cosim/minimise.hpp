// Makes a failing program short: launches, blocks of instructions and stalls are left out as long as it still fails.
#pragma once

#include <cstdint>
#include <functional>

#include "cosim/random_program.hpp"

namespace raypool {

/// Runs a program; true if it fails.
using Fails = std::function<bool(const RandomProgram&)>;

struct MinimiseOptions {
  uint64_t attempts = 4000;                                          ///< runs at most
  double seconds = 120;                                              ///< and time
  std::function<void(size_t instructions, uint64_t runs)> progress;  ///< called after each run, may be empty
};

/// `program` must fail. The result fails too, and check_program() has nothing against it (nor is it asked to stop
/// earlier than `program` does): every attempt is checked before it is run. Delta debugging: blocks of half the code,
/// then of a quarter, and so on; jumps follow their targets.
RandomProgram minimise_program(const Configuration& configuration, const RandomProgram& program, const Fails& fails,
                               const MinimiseOptions& options = {});

/// The program without instructions from .. from+count-1: targets, ends and entries follow; one that was
/// left out becomes the next that stays.
RandomProgram without_instructions(const RandomProgram& program, size_t from, size_t count);

}  // namespace raypool
