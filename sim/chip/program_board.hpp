// A board for a compute program: the device behind the chip's memory port, a memory, and a host that launches the
// blocks of a grid in order. A loop over cycles.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>

#include "chip/board_memory.hpp"
#include "chip/program_run.hpp"
#include "chip/progress_watch.hpp"
#include "machine/chip/chip_device.hpp"
#include "machine/chip/memory_port.hpp"
#include "machine/compute/compute_unit.hpp"

namespace raypool::chip {

/// Runs one program.
class ProgramBoard {
 public:
  /// Resets the device. `store`: the memory; it, what `options` points to, and `options` must outlive the board.
  ProgramBoard(const ProgramOptions& options, LineStore& store);

  /// Until every block has ended and the memory has all that was stored. Throws as run_program does.
  ProgramResult run();

 private:
  /// One cycle, or several of which only the first has anything for the device.
  void clock();
  void follow_kernels(const UnitOutputs& outputs);
  void offer_launch(const UnitOutputs& outputs);
  void clock_memory(const UnitOutputs& outputs);
  bool ended(const UnitOutputs& outputs) const;
  /// Cycles from this one on in which the device can be left alone.
  uint64_t quiet_cycles(const UnitOutputs& outputs) const;

  /// Cycle in which the next beat comes; kNever: none is on its way.
  uint64_t due() const { return std::min(memory_.due(), port_.response_due()); }
  void watch();
  uint64_t next_look() const;
  void limit_without_time() const;
  uint64_t instructions() const { return device_.counter(counter::kInstructions); }
  std::string at_cycle(const std::string& what) const;
  /// What waits for what.
  std::string state() const;

  const ProgramOptions& options_;
  ComputeUnit& device_;
  const bool timed_;
  raypool::MemoryPort port_;
  BoardMemory memory_;
  UnitInputs inputs_;
  // Between the port and the memory, of which nothing else of a chip is used.
  ChipOutputs to_memory_;
  ChipInputs from_memory_;

  uint64_t cycle_ = 0;
  bool ended_ = false;
  uint32_t launched_ = 0;                         // blocks
  std::array<uint32_t, kMostUnits> under_way_{};  // [unit] kernels that have not ended
  uint32_t under_way_in_all_ = 0;
  uint64_t transfers_ = 0;  // launches, requests and beats
  uint64_t look_at_;        // cycle in which watch() has something to look at
  ProgressWatch progress_;
};

}  // namespace raypool::chip
