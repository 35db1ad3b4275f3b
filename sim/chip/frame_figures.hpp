// What has been counted while a frame was drawn, on whichever engine; and the result that is made of it.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "chip/chip.hpp"
#include "chip/kernel_times.hpp"
#include "chip/statistics.hpp"
#include "chip/traverser_counts.hpp"
#include "enum_array.hpp"
#include "machine/compute/compute_unit.hpp"
#include "machine/traverser/traverser_work.hpp"

namespace raypool::chip {

struct FrameFigures {
  bool timed = true;    ///< there was a notion of time
  uint64_t cycles = 0;  ///< from reset until everything is idle
  uint32_t units = 1;
  std::function<uint64_t(int)> counter;  ///< of the units, summed; see namespace counter
  const KernelTimes* kernels = nullptr;
  uint64_t busy_cycles = 0;  ///< in which a kernel ran, summed over the units

  const LevelStatistics* rays = nullptr;
  EnumArray<ImportKind, const LevelStatistics*, kImportKinds> intersections{};
  uint64_t dropped_depth = 0;  ///< rays that the ray pool's port dropped as too deep
  uint64_t contributions = 0;
  uint64_t ray_port_busy = 0, intersection_port_busy = 0, memory_port_busy = 0;  ///< cycles
  uint64_t memory_reads = 0, memory_writes = 0;                                  ///< lines, quadwords

  TraverserCounts traverser;
  std::optional<TraverserWork> work;
};

/// All of it but the time that it took.
ChipResult chip_result(const ChipOptions& options, const FrameFigures& figures);

}  // namespace raypool::chip
