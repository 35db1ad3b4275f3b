#include "chip/program_module.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "config/limits.hpp"
#include "machine/decoder.hpp"

namespace raypool::chip {

namespace {

const ProgramOptions& checked(const ProgramOptions& options) {
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
  return options;
}

[[noreturn]] void refuse(const char* what) {
  throw InputError(
      fmt::format("the program uses {}, but a compute program has no ray pools and no frame buffer: remove rin, rout "
                  "and rfb from it",
                  what));
}

}  // namespace

Grid::Grid(const sc_core::sc_module_name& name, const ProgramOptions& options) : sc_module(name), options_(options) {
  decisions.bind(*this);
  SC_METHOD(decide);
  sensitive << decide_;
  dont_initialize();
}

void Grid::decide() {
  clock->guard([&] {
    if (launched_ < options_.blocks && device->can_launch()) {
      device->launch({options_.entry, options_.threads, launched_++, options_.blocks, ImportKind::None});
    } else if (launched_ == options_.blocks && device->idle()) {
      clock->stop();
    }
  });
}

std::string Grid::describe() const { return fmt::format("{} of {} blocks launched", launched_, options_.blocks); }

NoFrame::NoFrame(const sc_core::sc_module_name& name) : sc_module(name) {
  rays.bind(*this);
  intersections.bind(*this);
  frame.bind(*this);
}

void NoFrame::want() { refuse("rout"); }
void NoFrame::take(uint32_t, const Beat&, bool) { refuse("rout"); }
bool NoFrame::request(uint32_t, ImportKind) { refuse("an import"); }
void NoFrame::beat(Beat&) { refuse("an import"); }
void NoFrame::take(uint32_t, const FrameContribution&) { refuse("rfb"); }

ProgramChip::ProgramChip(const sc_core::sc_module_name& name, const ProgramOptions& options)
    : sc_module(name),
      options_(checked(options)),
      memory_port_("memory_port", options.configuration.chip),
      grid_("grid", options_),
      device_("device_host", *options.device),
      monitor_("monitor", {options.watchdog_cycles, options.limits, options.device->timed(),
                           options.progress != nullptr, options.device->timed() ? &options.configuration : nullptr}) {
  memory_port_.clock(clock_.now);
  memory_port_.socket.bind(memory);

  grid_.clock(clock_.now);
  grid_.device(device_.launches);

  device_.clock(clock_.now);
  device_.memory(memory_port_.device);
  device_.rays(no_frame_.rays);
  device_.intersections(no_frame_.intersections);
  device_.frame(no_frame_.frame);
  device_.controller(grid_.decisions);

  monitor_.clock(clock_.now);
  monitor_.watched(*this);
}

ProgramResult ProgramChip::run() {
  ComputeUnit& device = *options_.device;
  device.reset(options_.program_length, options_.memory->size());
  for (uint32_t i = 0; i < kArguments; ++i) device.set_argument(i, options_.arguments[i]);

  sc_core::sc_start();
  clock_.rethrow();
  // Without time a program may end and pass the limit in the same cycle.
  if (!device.timed() && options_.limits.cycles > 0 && device_.instructions() > options_.limits.cycles)
    throw LimitPassed(Monitor::limit_sentence(options_.limits.cycles, false), "the program has ended since");

  ProgramResult result;
  result.timed = device.timed();
  result.cycles = clock_.cycle();
  for (int i = 0; i < counter::kCount; ++i) result.counters[i] = device.counter(i);
  result.memory_reads = memory_port_.reads();
  result.memory_writes = memory_port_.writes();
  if (result.cycles > 0)
    result.memory_port_utilisation = static_cast<double>(memory_port_.busy_cycles()) / result.cycles;
  return result;
}

}  // namespace raypool::chip
