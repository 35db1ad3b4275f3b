// What a random program promises, checked by running it on the functional core.
#pragma once

#include <cstdint>
#include <string>

#include "cosim/random_program.hpp"

namespace raypool {

/// Empty if the program keeps the rules of docs/develop/lockstep.md, so that a difference in lockstep is the fault of
/// RTL or model; else what is wrong: it does not end within `step_limit` instructions, or not as in `program.faults`;
/// it reads a register or a word of ray memory that was not written; two warps touch a word of memory within one kernel
/// (with several units: of any kernels), one of them with a store; it stores into its code; it leaves packages behind
/// or waits for some that never come; it rewrites what is not there. Of a program with faults, only that each kernel
/// ends in one of them (or all its warps in `exit`) is checked, since how far its warps come is open. `executed`: warp
/// instructions executed.
std::string check_program(const Configuration& configuration, const RandomProgram& program,
                          uint64_t step_limit = 4'000'000, uint64_t* executed = nullptr);

}  // namespace raypool
