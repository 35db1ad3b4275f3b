// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The Verilated chip and its model side by side on the same inputs, all ports of all blocks compared in every cycle. It
// is a chip itself, so that drawing on it needs no other code.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "lockstep/lockstep_unit.hpp"
#include "lockstep/mismatch.hpp"
#include "machine/chip/chip_device.hpp"

namespace raypool {

/// What has been compared so far. A run that checked nothing shows here.
struct ChipLockstepCounts {
  uint64_t cycles = 0;         ///< all ports of all blocks, in each
  uint64_t kernels = 0;        ///< that ended
  uint64_t rays = 0;           ///< that left the units
  uint64_t intersections = 0;  ///< that the units asked for, and got
  uint64_t contributions = 0;  ///< to the frame buffer
  uint64_t memory_reads = 0;   ///< lines, the traverser's too
  uint64_t memory_writes = 0;  ///< quadwords, likewise
  uint64_t counters = 0;       ///< times that all counters were compared
  uint64_t differences = 0;    ///< 0, or 1: the first one ends the run

  ChipLockstepCounts& operator+=(const ChipLockstepCounts& other);
};

/// "chip lockstep: 1234 cycles, ... compared, 0 differences"
std::string to_string(const ChipLockstepCounts& counts);

class LockstepChip : public ChipDevice {
 public:
  virtual const ChipLockstepCounts& lockstep_counts() const = 0;
  /// What a look inside has found first; nothing in RTL that is right.
  virtual std::vector<lockstep::Finding> inside() const = 0;
};

/// Wraps `rtl`, and a model of the same configuration and number of units. The model reads program and data from
/// `memory`, the host's, when the first kernel after start() begins; it must outlive the lockstep. clock() throws
/// LockstepDifference at the first difference, and again at every later call. Counters are compared, and may be found
/// to differ, when a frame has ended and nothing has moved for some cycles. `name` is for the report. `inspect_until`:
/// it looks inside the traverser up to this cycle, of all that it is clocked, as in LockstepOptions::inspect_until; 0:
/// not at all.
std::unique_ptr<LockstepChip> make_lockstep_chip(const Configuration& configuration, std::unique_ptr<ChipDevice> rtl,
                                                 const Memory& memory, const std::string& name = "chip",
                                                 uint64_t inspect_until = 0);

/// What stands behind the ports of a chip.
enum class ChipKind : uint8_t { Model, Rtl, Lockstep };

/// A chip with `units` units for program and data in `memory`, which must outlive it. `library`: of rtl and lockstep,
/// the file libraypool_chip.so. Throws InputError when this is missing or does not fit.
std::unique_ptr<ChipDevice> make_chip(ChipKind kind, const Configuration& configuration, const Memory& memory,
                                      int units, const std::string& library = "", const std::string& name = "chip",
                                      uint64_t inspect_until = 0);

}  // namespace raypool
