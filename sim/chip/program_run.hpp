// Runs a compute program, which needs no pools, on a device of one or more compute units behind the chip's memory port.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>

#include "chip/chip.hpp"

namespace raypool {

namespace chip {
class LineStore;
}

struct ProgramOptions {
  Configuration configuration;
  ComputeUnit* device = nullptr;  ///< is reset; its counters can be read afterwards
  Memory* memory = nullptr;
  uint32_t program_length = 0;  ///< instructions, from address 0
  uint32_t entry = 0;
  uint32_t blocks = 1;   ///< launched with block words 0 .. blocks-1
  uint32_t threads = 1;  ///< a block, 1 .. contents
  std::array<uint32_t, kArguments> arguments{};
  uint64_t watchdog_cycles = 100'000;  ///< as of ChipOptions
  RunLimits limits;
  /// Called now and then with the cycles and warp instructions so far; may be empty.
  std::function<void(uint64_t cycles, uint64_t instructions)> progress;
};

struct ProgramResult {
  bool timed = true;
  uint64_t cycles = 0;  ///< until every block has ended and the device is idle
  std::array<uint64_t, counter::kCount> counters{};
  uint64_t memory_reads = 0, memory_writes = 0;
  double memory_port_utilisation = 0;
};

/// Throws InputError for options out of range and for programs that use the pools, ChipFault, ChipStalled.
ProgramResult run_program(const ProgramOptions& options);
/// The same with a memory of one's own (chip/board_memory.hpp) in place of the one with the fixed latency. Of
/// `options.memory` the program and the size are used.
ProgramResult run_program(const ProgramOptions& options, chip::LineStore& store);

/// "thread 3 of block 0 goes to address 0x402": the access behind a fault of run_program(options), which the units do
/// not report.
/// Runs the program again, on the architecture alone, from `memory` as it was before; empty if that ends otherwise.
std::string faulting_access(const ProgramOptions& options, Memory memory, const Fault& fault);

}  // namespace raypool
