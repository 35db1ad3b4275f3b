// Engine `lockstep`: the RTL and the functional model, compared as they run; stops at the first difference.
//
// It is a ComputeUnit, so that the chip does not know it has one. docs/lockstep.md says what is compared and when.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>

#include "config/configuration.hpp"
#include "machine/compute_unit.hpp"
#include "machine/memory.hpp"

namespace raypool {

struct LockstepOptions {
  uint64_t watchdog_cycles = 20000;  ///< cycles without retirement or port transfer, while busy, that count as a hang; 0 = never
  bool check_memory_port =
      true;                   ///< writes on the memory port are compared with the stores; off for a unit that has no memory port
  std::string name = "unit";  ///< names the compute unit in reports
  std::map<uint32_t, std::string> kernel_names = {};  ///< entry PC -> name of the kernel, for reports
};

/// What has been compared so far. A run that checked nothing shows here.
struct LockstepCounts {
  uint64_t cycles = 0;
  uint64_t kernels = 0;         ///< kernels that ended
  uint64_t instructions = 0;    ///< retired warp instructions
  uint64_t thread_results = 0;  ///< register words and predicate bits of threads
  uint64_t stores = 0;          ///< words stored
  uint64_t memory_writes = 0;   ///< quadwords written on the memory port
  uint64_t ray_words = 0;       ///< words written to ray memory by `rst`
  uint64_t imports = 0;         ///< packages given to both
  uint64_t exports = 0;         ///< rays
  uint64_t frame_contributions = 0;
  uint64_t faults = 0;       ///< faults of a program which both reported alike
  uint64_t differences = 0;  ///< 0, or 1: the first one ends the run

  LockstepCounts& operator+=(const LockstepCounts& other);
};

/// "lockstep: 1234 instructions (9872 thread results), ... compared, 0 differences"
std::string to_string(const LockstepCounts& counts);

/// The first difference, or a hang. what() is a report of several lines.
struct LockstepDifference : std::runtime_error {
  using std::runtime_error::runtime_error;
};

class LockstepUnit : public ComputeUnit {
 public:
  virtual const LockstepCounts& counts() const = 0;
  uint64_t instructions_compared() const { return counts().instructions; }
  /// Replaces the model's memory. For a host that changes memory after the unit was made; only while idle.
  virtual void set_memory(const Memory& memory) = 0;
};

/// Wraps `rtl`, whose trace it switches on. The model works on its own copy of `initial`, which must hold program and data as the
/// RTL will see them. clock() throws LockstepDifference at the first difference, and again at every later call. A unit that
/// shares memory with others is compared correctly as long as none of them reads what another one has stored.
std::unique_ptr<LockstepUnit> make_lockstep_unit(const Configuration& configuration, std::unique_ptr<ComputeUnit> rtl,
                                                 const Memory& initial, const LockstepOptions& options = {});

}  // namespace raypool
