#include "chip/program_run.hpp"

#include <fmt/format.h>

#include <optional>

#include "bits.hpp"
#include "chip/fixed_latency_memory.hpp"
#include "chip/program_module.hpp"
#include "chip/simulation.hpp"
#include "machine/functional_core.hpp"

namespace raypool {

namespace {

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

ProgramResult run_program(const ProgramOptions& options) {
  chip::Simulation simulation;
  chip::ProgramChip chip("chip", options);
  chip::FixedLatencyMemory memory("memory", *options.memory, options.configuration.chip.memory_latency);
  chip.memory.bind(memory.socket);
  return chip.run();
}

}  // namespace raypool
