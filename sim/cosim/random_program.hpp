// Constrained-random programs for the lockstep: every instruction of the table, nested loops, calls,
// divergent predicates, loads and stores with and without locality, ray memory rotation, special float
// values, long code, early exits, faults.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "config/configuration.hpp"
#include "cosim/stalls.hpp"
#include "isa/program.hpp"
#include "machine/compute/compute_unit.hpp"

namespace raypool {

inline constexpr uint32_t kLineBytes = 64;  ///< of a cache

/// What a host does between kernels, while the unit is idle: memory and arguments become others. It writes one argument
/// at least, after which the unit must not use what its caches have of the memory.
struct Rewrite {
  std::map<uint32_t, uint64_t> code;       ///< [PC] instruction
  uint64_t data_seed = 0;                  ///< the data are those of this seed; 0: they stay
  std::map<uint32_t, uint32_t> arguments;  ///< [number] word
};

constexpr uint32_t fault_bit(FaultCode code) { return 1u << static_cast<uint32_t>(code); }

/// A program and what it needs around it: the job of one run.
struct RandomProgram {
  Program program;  ///< entries "main", and "second" when there are two kernels to launch
  Memory memory;    ///< program and data, as fill_memory() makes it
  std::array<uint32_t, kArguments> arguments{};
  struct Kernel {
    uint32_t threads;
    uint32_t block;
    ImportKind import;
    uint32_t pc = 0;                      ///< entry
    uint32_t blocks = 1;                  ///< the number of blocks that the kernel is given
    std::optional<Rewrite> rewrite = {};  ///< before its launch
  };
  std::vector<Kernel>
      kernels;  ///< launched one after the other; after a fault the unit is reset, and goes on with the next
  StallPlan stalls;
  int units = 1;  ///< compute units of the device; with several, each kernel has words of its own
  uint32_t intersection_words = kIntersectionWords;  ///< of the machine: what is imported has as many

  uint64_t seed = 0;
  std::string profile;          ///< name of the mix of instructions
  uint32_t data_begin = 0;      ///< byte address; random words from here to the end of memory
  uint32_t memory_bytes = 0;    ///< size of memory
  uint32_t program_length = 0;  ///< what the unit is given; beyond the code, if that lies there
  uint32_t memory_limit = 0;    ///< what the unit is given; beyond memory, if that lies there
  uint32_t restart = 0;         ///< cycle in which the unit is reset and everything begins again; 0: never
  uint32_t faults = 0;          ///< in one of which a kernel may end, instead of `exit`: fault_bit() of each
};

/// A program that shows one thing; the next seed shows another one. The same configuration and seed give the same
/// program. Warps store only to words of their own and read those or words that no warp writes, so that the result does
/// not depend on the order of warps; program_check.hpp defines exactly what a program promises. `length`: about how
/// many instructions the body of a kernel has. `units`: of the device. `mix`: of instructions, by name
/// (program_profile.hpp); empty: the seed chooses it.
RandomProgram make_random_program(const Configuration& configuration, uint64_t seed, int length = 120, int units = 1,
                                  const std::string& mix = "");

/// The limits that the unit is given: never less than there is, whatever minimising has left.
uint32_t told_length(const RandomProgram& program);
uint32_t told_limit(const RandomProgram& program);

/// Makes `program.memory` from its code, seed and data range. To be called after a change of one of them.
void fill_memory(RandomProgram& program);

/// Changes `memory` as the host does before a kernel.
void rewrite_memory(const RandomProgram& program, const Rewrite& rewrite, Memory& memory);

/// A word: small, random, or a float at one of the edges; `random` is 64 random bits.
uint32_t random_word(uint64_t random);

}  // namespace raypool
