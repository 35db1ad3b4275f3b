#include "chip/program_run.hpp"

#include <fmt/format.h>

#include "chip/chip_clock.hpp"
#include "chip/device_host.hpp"
#include "chip/launcher.hpp"
#include "chip/memory_port.hpp"
#include "chip/monitor.hpp"
#include "chip/simulation.hpp"

namespace raypool {

namespace {

using namespace chip;

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
}

}  // namespace

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
  watch.retired = [&] { return host.instructions(); };
  watch.transfers = [&] { return host.transfers(); };
  watch.describe = [&] { return grid.describe(); };
  Monitor monitor("monitor", clock, watch);
  grid.changed();
  simulation.run();
  clock.rethrow();

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
