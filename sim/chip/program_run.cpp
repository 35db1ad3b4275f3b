#include "chip/program_run.hpp"

#include <fmt/format.h>

#include <optional>

#include "bits.hpp"
#include "chip/chip_clock.hpp"
#include "chip/device_host.hpp"
#include "chip/launcher.hpp"
#include "chip/memory_port.hpp"
#include "chip/monitor.hpp"
#include "chip/simulation.hpp"
#include "machine/decoder.hpp"
#include "machine/functional_core.hpp"

namespace raypool {

namespace {

using namespace chip;

/// A load or store that faults.
struct FaultingAccess {
  Fault fault;
  uint32_t thread, block, address;
};

/// Launches the blocks of a grid, in order.
class Grid : public sc_core::sc_module, public Launcher {
 public:
  SC_HAS_PROCESS(Grid);
  Grid(const sc_core::sc_module_name& name, ChipClock& clock, const ProgramOptions& options)
      : sc_module(name), clock_(clock), options_(options) {
    SC_METHOD(decide);
    sensitive << decide_;
    dont_initialize();
  }
  void connect(DeviceHost& host) { host_ = &host; }

  void accepted(int) override {}
  void kernel_ended(int) override {}
  void changed() override { clock_.notify(decide_, Phase::Controller); }
  std::string describe() const {
    return fmt::format("{} of {} blocks launched; {}", launched_, options_.blocks, host_->describe());
  }

 private:
  void decide() {
    clock_.guard([&] {
      if (launched_ < options_.blocks && host_->can_launch()) {
        host_->launch({options_.entry, options_.threads, launched_++, options_.blocks, ImportKind::None});
      } else if (launched_ == options_.blocks && host_->idle()) {
        clock_.stop();
      }
    });
  }

  ChipClock& clock_;
  const ProgramOptions& options_;
  DeviceHost* host_ = nullptr;
  sc_core::sc_event decide_;
  uint32_t launched_ = 0;
};

void check(const ProgramOptions& options) {
  if (options.device == nullptr || options.memory == nullptr) throw std::logic_error("run_program needs a device and a memory");
  const auto contents = static_cast<uint32_t>(options.configuration.contents());
  if (options.threads < 1 || options.threads > contents) {
    throw InputError(
        fmt::format("{} threads a block: configuration {} holds 1 to {}", options.threads, options.configuration.name, contents));
  }
  if (options.blocks < 1) throw InputError("0 blocks: launch at least one");
  for (uint32_t pc = 0; pc < options.program_length; ++pc) {
    const uint64_t word = options.memory->load(8 * pc) | static_cast<uint64_t>(options.memory->load(8 * pc + 4)) << 32;
    const DecodedInstruction instruction = decode(word, options.configuration);
    if (!instruction.legal() || instruction.opcode != Opcode::Rin) continue;
    throw InputError(fmt::format(
        "PC {}: rin waits for a ray, and a compute program has no ray pools that one could come from: remove it", pc));
  }
}

/// Blocks one after the other, each warp as far as it goes in turn: where this run faults, if it does within `instructions`.
std::optional<FaultingAccess> run_to_fault(const ProgramOptions& options, Memory& memory, uint64_t instructions) {
  FunctionalCore core(options.configuration, memory);
  core.reset(options.program_length, memory.size());
  for (int i = 0; i < kArguments; ++i) core.set_argument(i, options.arguments[static_cast<size_t>(i)]);
  for (uint32_t block = 0; block < options.blocks; ++block) {
    core.launch({options.entry, options.threads, block, options.blocks, ImportKind::None});
    while (core.running()) {
      for (uint32_t warp = 0; warp < static_cast<uint32_t>(core.warps()); ++warp) {
        const Step& step = core.step(warp);
        if (step.status == Step::Status::Executed && instructions-- == 0) return std::nullopt;
        if (step.status != Step::Status::Fault) continue;
        for (uint32_t mask = step.mask; mask != 0; mask &= mask - 1) {
          const auto lane = lowest(mask);
          const uint32_t address = step.addresses[lane];
          const bool faulty = step.fault.code == FaultCode::Misaligned ? address % 4 != 0 : address >= memory.size();
          if (faulty) return FaultingAccess{step.fault, warp * static_cast<uint32_t>(core.lanes()) + lane, block, address};
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
  check(options);
  ComputeUnit& device = *options.device;
  device.reset(options.program_length, options.memory->size());
  for (int i = 0; i < kArguments; ++i) device.set_argument(i, options.arguments[static_cast<size_t>(i)]);

  Simulation simulation;
  ChipClock clock("clock");
  MemoryPort memory("memory_port", clock, *options.memory);
  Grid grid("grid", clock, options);
  DeviceHost host("device", device, {clock, memory, grid, std::nullopt});
  grid.connect(host);
  MonitorOptions watch;
  watch.watchdog_cycles = options.watchdog_cycles;
  watch.cycle_limit = options.cycle_limit;
  watch.timed = device.timed();
  if (options.progress) watch.progress = [&] { options.progress(clock.cycle(), host.instructions()); };
  watch.retired = [&] { return host.instructions(); };
  watch.transfers = [&] { return host.transfers(); };
  watch.describe = [&] { return grid.describe(); };
  Monitor monitor("monitor", clock, watch);
  grid.changed();
  simulation.run();
  clock.rethrow();
  // Without time a program may end and pass the limit in the same cycle.
  if (!device.timed() && options.cycle_limit > 0 && host.instructions() > options.cycle_limit)
    throw ChipStalled(Monitor::limit_sentence(options.cycle_limit, false) + "; the program has ended since");

  ProgramResult result;
  result.timed = device.timed();
  result.cycles = clock.cycle();
  for (int i = 0; i < counter::kCount; ++i) result.counters[static_cast<size_t>(i)] = device.counter(i);
  result.memory_reads = memory.reads();
  result.memory_writes = memory.writes();
  if (result.cycles > 0)
    result.memory_port_utilisation = static_cast<double>(memory.busy_cycles()) / static_cast<double>(result.cycles);
  return result;
}

}  // namespace raypool
