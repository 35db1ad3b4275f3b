// Engine `model` as its host sees it: the ports, many cycles at once, and the counters.
#include <algorithm>

#include "machine/compute/cycle_unit.hpp"

namespace raypool {

// Nothing happens before the next cycle of the timeline that has something.
bool CycleUnit::quiet() const {
  return buffer_.ready() == 0 && buffer_.fetch_request() == 0 && dispatcher_.idle() && memory_arbiter_.idle() &&
         !instruction_cache_.request_valid() && !instruction_cache_.active() &&
         !(instruction_cache_.missed() && miss_cycle_ >= now_) && !mem_.active() && !ray_.active() &&
         !launcher_.acts(buffer_.active()) && planned_faults_.empty();
}

uint64_t CycleUnit::run(const UnitInputs& inputs, uint64_t cycles) {
  const uint32_t before = signals_;
  const bool transfers = (before & inputs.ready_signals()) != 0;
  step(inputs);
  uint32_t now = signals();
  uint64_t done = 1;
  if (done < cycles && !transfers && now == before) {
    UnitInputs rest;
    rest.memory_request_ready = inputs.memory_request_ready;
    rest.import_request_ready = inputs.import_request_ready;
    rest.export_ready = inputs.export_ready;
    rest.frame_ready = inputs.frame_ready;
    do {
      if (quiet()) {
        // Nothing happens before the next planned event.
        uint64_t skip = 0;
        while (skip < Timeline::kCycles && done + skip < cycles && !timeline_.at(now_ + skip).any()) ++skip;
        if (skip == Timeline::kCycles) skip = cycles - done;
        now_ += skip;
        for (uint64_t i = 0; i < std::min<uint64_t>(skip, older_.size()); ++i)
          older_ = {launcher_.older(), older_[0], older_[1]};
        fetch_cycle_ = std::max(fetch_cycle_, now_);
        counters_.single[counter::kBusyCycles] += launcher_.running() ? skip : 0;
        done += skip;
        if (done == cycles) break;
      }
      step(rest);
      now = signals();
      ++done;
    } while (done < cycles && now == before);
  }
  present(now);
  if (tracing_) record();
  return done;
}

// As UnitOutputs::signals(), if no ray moved.
uint32_t CycleUnit::signals_but_rays() const {
  const bool works = launcher_.running() | launcher_.waiting() | !memory_arbiter_.idle();
  const bool idle = !works && mem_.idle();
  return launcher_.launch_ready(false) * signal::kLaunchReady | idle * (signal::kIdle | signal::kUnitIdle) |
         memory_arbiter_.request_valid() * signal::kMemoryRequest | halted() * signal::kFault |
         launcher_.kernel_done(buffer_.active()) * signal::kKernelDone | launcher_.running() * signal::kBusy;
}

// As UnitOutputs::signals(). Of all blocks only the ray ALU changes its part in a cycle that needs no attention.
uint32_t CycleUnit::signals() const {
  uint32_t hidden = ray_.import_active() * signal::kLaunchReady;
  if (ray_.moves_rays()) hidden |= signal::kIdle | signal::kUnitIdle;
  return (rest_signals_ & ~hidden) | ray_.signals();
}

void CycleUnit::present(uint32_t now) {
  UnitOutputs& out = outputs_;
  if (now != signals_) {
    const auto is_set = [now](uint32_t flag) { return (now & flag) != 0; };
    signals_ = now;
    out.launch_ready = is_set(signal::kLaunchReady);
    out.idle = is_set(signal::kIdle);
    out.memory_request_valid = is_set(signal::kMemoryRequest);
    out.import_request_valid = is_set(signal::kImportRequest);
    out.export_valid = is_set(signal::kExport);
    out.frame_valid = is_set(signal::kFrame);
    out.kernel_done = is_set(signal::kKernelDone);
    out.busy = is_set(signal::kBusy);
    out.unit_idle = is_set(signal::kUnitIdle);
    if (is_set(signal::kFault)) out.fault = fault_;
  }
  out.exports[0] = ray_.registers().exports;
  if (out.memory_request_valid) out.memory_request = memory_arbiter_.request();
  out.import_request_kind = ray_.import_kind();
  if (out.export_valid) {
    out.export_data = ray_.beat().data;
    out.export_last = ray_.beat().last;
  } else if (out.frame_valid) {
    const Beat& beat = ray_.beat().data;
    out.frame = {beat[0], {beat[1], beat[2], beat[3]}};
  }
}

// The RTL counts these; here they are what is left of the busy cycles of all warps.
uint64_t CycleUnit::fetching() const {
  using namespace counter;
  uint64_t others = 0;
  for (int state = kWarpsNotLaunched; state <= kWarpsExporting; ++state)
    others += state == kWarpsFetching ? 0 : counters_.single[state];
  for (size_t type = 0; type < kAluTypes; ++type) {
    // A cycle in which operands are read, one of the grant, and those on the way through a pipeline.
    const uint64_t a_task = 2 + (kAluTable[type].timed_by_events() ? 0 : dispatcher_.depth(type) + 1);
    others += counters_.waiting[type] + a_task * counters_.issued[type];
  }
  others -= (dispatcher_.depth(static_cast<size_t>(AluType::Flt)) + 1) * counters_.single[kFltOverlapped];
  return warps_ * counters_.single[kBusyCycles] - others;
}

// No simulation takes so long that wide ones wrap.
uint64_t CycleUnit::counter(int number) {
  return counter_bits_ == 48 ? counted(number) : counted(number) & ((uint64_t{1} << counter_bits_) - 1);
}

uint64_t CycleUnit::counted(int number) const {
  if (number == counter::kWarpsFetching) return fetching();
  const size_t type = static_cast<size_t>(number & 7);
  if (number < counter::kUnused || type >= kAluTypes) return counters_.value(number, 0, 0);
  return counters_.value(number, dispatcher_.instances(type),
                         launcher_.running() ? dispatcher_.unready(type, now_) : 0);
}

}  // namespace raypool
