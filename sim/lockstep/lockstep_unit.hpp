// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Engine `lockstep`: the RTL and the golden model side by side on the same inputs, compared in every
// cycle; stops at the first difference.
//
// It is a ComputeUnit, so that the chip does not know it has one. docs/develop/lockstep.md lists what is compared.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "config/configuration.hpp"
#include "lockstep/mismatch.hpp"
#include "machine/common/memory.hpp"
#include "machine/compute/compute_unit.hpp"

namespace raypool {

struct LockstepOptions {
  uint64_t watchdog_cycles =
      20000;  ///< cycles without retirement or port transfer, while busy, that count as a hang; 0 = never
  /// The unit's surroundings answer within watchdog_cycles. Otherwise a unit that waits for an answer does not hang:
  /// they set the limit.
  bool answered_soon = true;
  std::string name = "unit";                          ///< names the device in reports
  std::map<uint32_t, std::string> kernel_names = {};  ///< entry PC -> name of the kernel, for reports
  /// Look inside the RTL in every cycle up to this one, so that a report can name the file to look at; it takes
  /// time. It is for finding a known difference again, inspect_differences(): a run that gets here without one ends
  /// with std::runtime_error. 0: no look.
  uint64_t inspect_until = 0;
};

/// What has been compared so far. A run that checked nothing shows here.
struct LockstepCounts {
  uint64_t cycles = 0;
  uint64_t kernels = 0;         ///< kernels that ended
  uint64_t instructions = 0;    ///< retired warp instructions, each in its cycle
  uint64_t thread_results = 0;  ///< register words and predicate bits of threads
  uint64_t stores = 0;          ///< words stored
  uint64_t memory_reads = 0;    ///< lines requested on the memory port
  uint64_t memory_writes = 0;   ///< quadwords written on the memory port
  uint64_t ray_words = 0;       ///< words written to ray memory by `rst`
  uint64_t imports = 0;         ///< packages requested
  uint64_t exports = 0;         ///< rays
  uint64_t frame_contributions = 0;
  uint64_t counters = 0;     ///< times that all performance counters were compared
  uint64_t faults = 0;       ///< faults of a program which both reported alike
  uint64_t differences = 0;  ///< 0, or 1: the first one ends the run

  LockstepCounts& operator+=(const LockstepCounts& other);
};

/// "lockstep: 1234 instructions (9872 thread results), ... compared, 0 differences"
std::string to_string(const LockstepCounts& counts);

/// LockstepOptions::inspect_until of a run that is to look inside for as long as it lasts.
inline constexpr uint64_t kInspectAlways = ~uint64_t{0};

/// The first difference, or a hang. what() is a report of several lines.
struct LockstepDifference : std::runtime_error {
  explicit LockstepDifference(const std::string& report, uint64_t inspect_until_cycle = 0)
      : runtime_error(report), inspect_until(inspect_until_cycle) {}

  /// LockstepOptions::inspect_until of a second run, equal but for it, that would report what was wrong inside. 0: none
  /// would, as this one has, or the RTL lacks the signals.
  uint64_t inspect_until;
};

/// Calls `run` with 0, and when it throws a difference that a look inside could narrow down, again with its
/// inspect_until. A run must start from the same state each time. Throws the difference with the better report.
void inspect_differences(const std::function<void(uint64_t inspect_until)>& run);

class LockstepUnit : public ComputeUnit {
 public:
  virtual const LockstepCounts& counts() const = 0;
  /// What was first not as it should be inside the RTL since reset(); empty as long as nothing is.
  virtual std::vector<lockstep::Finding> inside() const = 0;
  /// Why the inside is not looked at: it was not asked for, or the signal that the RTL lacks; empty if it is.
  virtual std::string uninspected() const = 0;
};

/// Wraps `rtl`, switches on its trace, and adds a golden model of the same configuration and number of units. The model
/// reads program and data from `memory`, the host's, when the first kernel after reset() or set_argument() starts; it
/// must outlive the lockstep. clock() throws LockstepDifference at the first difference, and again at every later call.
std::unique_ptr<LockstepUnit> make_lockstep_unit(const Configuration& configuration, std::unique_ptr<ComputeUnit> rtl,
                                                 const Memory& memory, const LockstepOptions& options = {});

}  // namespace raypool
