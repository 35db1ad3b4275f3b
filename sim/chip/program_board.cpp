#include "chip/program_board.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "bits.hpp"
#include "config/limits.hpp"

namespace raypool::chip {

namespace {

[[noreturn]] void refuse(const char* what) {
  throw InputError(
      fmt::format("the program uses {}, but a compute program has no ray pools and no frame buffer: remove rin, rout "
                  "and rfb from it",
                  what));
}

}  // namespace

ProgramBoard::ProgramBoard(const ProgramOptions& options, LineStore& store)
    : options_(options),
      device_(*options.device),
      timed_(device_.timed()),
      port_(options.configuration.chip, raypool::MemoryPort::Limits::of(options.configuration.chip)),
      memory_(store, options.configuration.chip),
      look_at_(next_look()),
      progress_(options.watchdog_cycles, options.limits.silent()) {
  device_.reset(options.program_length, options.memory->size());
  for (uint32_t i = 0; i < kArguments; ++i) device_.set_argument(i, options.arguments[i]);
}

ProgramResult ProgramBoard::run() {
  while (!ended_) clock();
  if (!timed_) limit_without_time();
  ProgramResult result;
  result.timed = timed_;
  result.cycles = cycle_;
  for (int i = 0; i < counter::kCount; ++i) result.counters[i] = device_.counter(i);

  // A store has ended for the device as soon as the port has it.
  while (port_.waits() || port_.offers()) clock();
  result.memory_reads = port_.reads();
  result.memory_writes = port_.writes();
  if (result.cycles > 0)
    result.memory_port_utilisation = static_cast<double>(port_.busy_cycles()) / static_cast<double>(result.cycles);
  return result;
}

void ProgramBoard::clock() {
  const UnitOutputs& outputs = device_.outputs();
  if (outputs.fault.code != FaultCode::None) {
    const Fault& fault = outputs.fault;
    throw ChipFault(fault.unit, fault, fault_sentence(fault.unit, fault));
  }
  if (outputs.import_request_valid) refuse("an import");
  if (outputs.export_valid) refuse("rout");
  if (outputs.frame_valid) refuse("rfb");
  follow_kernels(outputs);
  if (!ended_ && ended(outputs)) {
    ended_ = true;
    return;
  }
  if (cycle_ >= look_at_) watch();
  offer_launch(outputs);
  clock_memory(outputs);
  cycle_ += device_.run(inputs_, quiet_cycles(outputs));
}

void ProgramBoard::follow_kernels(const UnitOutputs& outputs) {
  for (uint32_t done = outputs.kernel_done; done != 0; done &= done - 1) {
    const uint32_t unit = lowest(done);
    if (under_way_[unit] == 0)
      throw std::runtime_error(fmt::format("compute unit {} ended a kernel that it was not given", unit));
    --under_way_[unit];
    --under_way_in_all_;
  }
}

bool ProgramBoard::ended(const UnitOutputs& outputs) const {
  return launched_ == options_.blocks && under_way_in_all_ == 0 && outputs.idle;
}

void ProgramBoard::offer_launch(const UnitOutputs& outputs) {
  inputs_.launch_valid = outputs.launch_ready && launched_ < options_.blocks;
  if (!inputs_.launch_valid) return;
  inputs_.launch = {options_.entry, options_.threads, launched_++, options_.blocks, ImportKind::None};
  ++under_way_[outputs.launch_unit];
  ++under_way_in_all_;
  ++transfers_;
}

// As the chip does (machine/chip/chip_model.cpp): what the port shows in a cycle depends on the cycles before it.
void ProgramBoard::clock_memory(const UnitOutputs& outputs) {
  inputs_.memory_request_ready = port_.room_from() <= cycle_;
  inputs_.memory_response_valid = port_.response_due() <= cycle_;
  if (inputs_.memory_response_valid) inputs_.memory_response = port_.next_response();
  to_memory_.memory_beat_ready = port_.beat_ready();
  to_memory_.memory_request_valid = port_.offers();
  if (to_memory_.memory_request_valid) to_memory_.memory_request = port_.access();
  memory_.offer(cycle_, from_memory_);

  memory_.clock(cycle_, to_memory_, from_memory_);
  if (to_memory_.memory_request_valid && from_memory_.memory_request_ready) port_.taken(cycle_);
  if (outputs.memory_request_valid && inputs_.memory_request_ready) {
    port_.request(cycle_, outputs.memory_request);
    ++transfers_;
  }
  if (port_.start() <= cycle_) port_.serve(cycle_);
  if (inputs_.memory_response_valid) {
    port_.response();
    ++transfers_;
  }
  if (from_memory_.memory_beat_valid && to_memory_.memory_beat_ready) port_.beat(cycle_, from_memory_.memory_beat_data);
}

// Until the next cycle in which the port, the memory, or watch() has something to do.
uint64_t ProgramBoard::quiet_cycles(const UnitOutputs& outputs) const {
  if (inputs_.launch_valid || outputs.kernel_done != 0 || port_.offers()) return 1;
  uint64_t until = std::min({look_at_, port_.start(), port_.response_due()});
  if (port_.beat_ready()) until = std::min(until, memory_.due());
  if (outputs.memory_request_valid && !inputs_.memory_request_ready) until = std::min(until, port_.room_from());
  return std::max(until, cycle_ + 1) - cycle_;
}

void ProgramBoard::watch() {
  const auto every = [this](uint64_t period) { return cycle_ != 0 && period != 0 && cycle_ % period == 0; };
  look_at_ = next_look();
  if (options_.progress && every(timed_ ? kProgressCycles : 1)) options_.progress(cycle_, instructions());
  if (every(options_.watchdog_cycles)) {
    // What is due in this cycle has not been given yet.
    const uint64_t due = std::max(this->due(), cycle_ + 1);
    switch (progress_.look(cycle_, {instructions(), transfers_, due})) {
      case ProgressWatch::State::GoesOn:
        break;
      case ProgressWatch::State::LockedUp:
        throw ChipStalled(at_cycle(progress_.locked_up()) + "; " + state());
      case ProgressWatch::State::Silent:
        throw LimitPassed(at_cycle(progress_.silent()), state());
    }
  }
  if (ended_) return;
  if (!timed_) return limit_without_time();
  if (cycle_ == options_.limits.cycles && cycle_ != 0)
    throw LimitPassed(limit_sentence(options_.limits.cycles, true), state());
  if (cycle_ == counted_cycles(options_.configuration)) {
    throw InputError(
        fmt::format("{} cycles have passed, and after so many a performance counter of {}, of {} bits, may have "
                    "wrapped: run it with --set counter_bits=48",
                    cycle_, options_.configuration.name, options_.configuration.counter_bits));
  }
}

// The first cycle after this one in which watch() may find something.
uint64_t ProgramBoard::next_look() const {
  if (!timed_) return cycle_ + 1;
  const auto multiple = [this](uint64_t period) { return cycle_ + period - cycle_ % period; };
  uint64_t next = multiple(kProgressCycles);
  if (options_.watchdog_cycles != 0) next = std::min(next, multiple(options_.watchdog_cycles));
  for (const uint64_t limit : {options_.limits.cycles, counted_cycles(options_.configuration)})
    if (limit > cycle_) next = std::min(next, limit);
  return next;
}

// Without time a cycle is thousands of instructions, and a program may end and pass the limit in the same one.
void ProgramBoard::limit_without_time() const {
  const uint64_t limit = options_.limits.cycles;
  if (limit == 0 || instructions() <= limit) return;
  throw LimitPassed(limit_sentence(limit, false), ended_ ? "the program has ended since" : state());
}

std::string ProgramBoard::at_cycle(const std::string& what) const {
  return fmt::format("{}, at cycle {}", what, cycle_);
}

std::string ProgramBoard::state() const {
  const UnitOutputs& o = device_.outputs();
  std::string text = fmt::format("{} of {} blocks launched; ", launched_, options_.blocks);
  for (uint32_t unit = 0; unit < device_.units(); ++unit) {
    text += fmt::format("unit {}: {}, {} kernels to end{}; ", unit,
                        (o.unit_idle >> unit & 1) != 0 ? "idle"
                        : (o.busy >> unit & 1) != 0    ? "running"
                                                       : "draining",
                        under_way_[unit], port_.quiet(cycle_, unit) ? "" : ", waits for the memory port");
  }
  if (o.launch_ready && launched_ < options_.blocks) text += fmt::format("unit {} waits for a launch; ", o.launch_unit);
  if (o.memory_request_valid && port_.room_from() > cycle_)
    text += "a request waits for the memory port: its queue is full; ";
  const uint64_t due = this->due();
  if (due < kFarAway)
    text += fmt::format("the memory gives a line in cycle {}; ", due);
  else
    text += due == kNever ? "no line is on its way; " : "the device waits for a line that the memory never gives; ";
  return text + fmt::format("{} instructions retired", instructions());
}

}  // namespace raypool::chip
