#include "chip/program_run.hpp"

#include <fmt/format.h>

#include <optional>
#include <stdexcept>

#include "bits.hpp"
#include "chip/board_memory.hpp"
#include "chip/program_board.hpp"
#include "config/limits.hpp"
#include "machine/compute/decoder.hpp"
#include "machine/compute/functional_core.hpp"

namespace raypool {

namespace {

void check(const ProgramOptions& options) {
  if (options.device == nullptr || options.memory == nullptr)
    throw std::logic_error("run_program needs a device and a memory");
  const auto contents = options.configuration.contents();
  if (options.threads < 1 || options.threads > contents) {
    throw InputError(fmt::format("{} threads a block: configuration {} holds 1 to {}", options.threads,
                                 options.configuration.name, contents));
  }
  check_program_length(options.configuration, options.program_length);
  if (options.blocks < 1) throw InputError("0 blocks: launch at least one");
  for (uint32_t pc = 0; pc < options.program_length; ++pc) {
    const uint64_t word = options.memory->load(8 * pc) | uint64_t{options.memory->load(8 * pc + 4)} << 32;
    const DecodedInstruction instruction = decode(word, options.configuration);
    if (!instruction.legal() || instruction.opcode != Opcode::Rin) continue;
    throw InputError(fmt::format(
        "PC {}: rin waits for a ray, and a compute program has no ray pools that one could come from: remove it", pc));
  }
}

/// A load or store that faults.
struct FaultingAccess {
  Fault fault;
  uint32_t thread, block, address;
};

/// Blocks one after the other, each warp as far as it goes in turn: where this run faults, if it does within
/// `instructions`.
std::optional<FaultingAccess> run_to_fault(const ProgramOptions& options, Memory& memory, uint64_t instructions) {
  FunctionalCore core(options.configuration, memory);
  core.reset(options.program_length, memory.size());
  for (uint32_t i = 0; i < kArguments; ++i) core.set_argument(i, options.arguments[i]);
  for (uint32_t block = 0; block < options.blocks; ++block) {
    core.launch({options.entry, options.threads, block, options.blocks, ImportKind::None});
    while (core.running()) {
      for (uint32_t warp = 0; warp < core.warps(); ++warp) {
        const Step& step = core.step(warp);
        if (step.status == Step::Status::Executed && instructions-- == 0) return std::nullopt;
        if (step.status != Step::Status::Fault) continue;
        for (uint32_t mask = step.mask; mask != 0; mask &= mask - 1) {
          const auto lane = lowest(mask);
          const uint32_t address = step.addresses[lane];
          const bool faulty = step.fault.code == FaultCode::Misaligned ? address % 4 != 0 : address >= memory.size();
          if (faulty) return FaultingAccess{step.fault, warp * core.lanes() + lane, block, address};
        }
        return std::nullopt;
      }
    }
  }
  return std::nullopt;
}

}  // namespace

std::string faulting_access(const ProgramOptions& options, Memory memory, const Fault& fault) {
  if (fault.code != FaultCode::Misaligned && fault.code != FaultCode::AddressOutsideMemory) return "";
  constexpr uint64_t kMostInstructions = 20'000'000;
  const std::optional<FaultingAccess> found = run_to_fault(options, memory, kMostInstructions);
  if (!found || found->fault.code != fault.code || found->fault.pc != fault.pc) return "";
  return fmt::format("thread {} of block {} goes to address 0x{:x}", found->thread, found->block, found->address);
}

ProgramResult run_program(const ProgramOptions& options, chip::LineStore& store) {
  check(options);
  return chip::ProgramBoard(options, store).run();
}

ProgramResult run_program(const ProgramOptions& options) {
  check(options);
  const ChipConfiguration& chip = options.configuration.chip;
  chip::check_memory_latency(chip);
  chip::FixedLatencyStore store(*options.memory, nullptr, chip);
  return chip::ProgramBoard(options, store).run();
}

}  // namespace raypool
