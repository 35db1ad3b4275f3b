#include "machine/compute/multiprocessor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace raypool {

Multiprocessor::Multiprocessor(std::vector<std::unique_ptr<ComputeUnit>> units, int intersection_beats)
    : units_(std::move(units)),
      inputs_(units_.size()),
      intersection_beats_(intersection_beats),
      import_arbiter_(intersection_beats) {}

void Multiprocessor::reset(uint32_t program_length, uint32_t memory_limit) {
  for (const auto& unit : units_) unit->reset(program_length, memory_limit);
  block_scheduler_ = {};
  memory_arbiter_ = {};
  export_arbiter_ = frame_arbiter_ = fault_arbiter_ = {};
  import_arbiter_ = ImportArbiter(intersection_beats_);
  outputs_ = {};
  faults_.clear();
  trace_ = {};
  present();
}

void Multiprocessor::set_argument(uint32_t index, uint32_t value) {
  for (const auto& unit : units_) unit->set_argument(index, value);
  present();
}

void Multiprocessor::clock(const UnitInputs& inputs) {
  give(inputs);
  for (size_t u = 0; u < units_.size(); ++u) units_[u]->clock(inputs_[u]);
  present();
  if (tracing_) gather_trace();
}

// While no unit changes what it shows the arbiters need no look at it.
uint64_t Multiprocessor::run(const UnitInputs& inputs, uint64_t cycles) {
  if (tracing_ || (outputs_.signals() & inputs.ready_signals()) != 0 || inputs.launch_valid) cycles = 1;
  UnitInputs rest;
  rest.memory_request_ready = inputs.memory_request_ready;
  rest.import_request_ready = inputs.import_request_ready;
  rest.export_ready = inputs.export_ready;
  rest.frame_ready = inputs.frame_ready;
  uint64_t done = 0;
  bool same = true;
  do {
    give(done == 0 ? inputs : rest);
    for (size_t u = 0; u < units_.size(); ++u) {
      const uint32_t before = units_[u]->outputs().signals();
      units_[u]->clock(inputs_[u]);
      same = same && units_[u]->outputs().signals() == before;
    }
    ++done;
  } while (done < cycles && same);
  present();
  if (tracing_) gather_trace();
  return done;
}

// What the device is given goes to the units, and the arbiters learn what is transferred.
void Multiprocessor::give(const UnitInputs& inputs) {
  for (UnitInputs& unit : inputs_) {
    unit.launch_valid = unit.memory_request_ready = unit.memory_response_valid = false;
    unit.import_request_ready = unit.import_beat_valid = unit.export_ready = unit.frame_ready = false;
  }
  if (inputs.launch_valid && block_scheduler_.ready()) {
    UnitInputs& unit = inputs_[block_scheduler_.unit()];
    unit.launch_valid = true;
    unit.launch = inputs.launch;
    block_scheduler_.clock(true);
  }
  if (memory_arbiter_.valid()) {
    inputs_[memory_arbiter_.choice()].memory_request_ready = inputs.memory_request_ready;
    memory_arbiter_.clock(inputs.memory_request_ready);
  }
  const uint32_t response_unit = UnitMemoryArbiter::response_unit(inputs.memory_response.id);
  if (inputs.memory_response_valid && response_unit < inputs_.size()) {
    UnitInputs& unit = inputs_[response_unit];
    unit.memory_response_valid = true;
    unit.memory_response = inputs.memory_response;
    unit.memory_response.id = UnitMemoryArbiter::response_id(inputs.memory_response.id);
  }
  if (inputs.import_beat_valid && import_arbiter_.expects()) {
    UnitInputs& unit = inputs_[import_arbiter_.receiver()];
    unit.import_beat_valid = true;
    unit.import_beat = inputs.import_beat;
  }
  if (import_arbiter_.valid()) inputs_[import_arbiter_.choice()].import_request_ready = inputs.import_request_ready;
  if (import_arbiter_.valid() || inputs.import_beat_valid) {
    import_arbiter_.clock(inputs.import_request_ready, inputs.import_beat_valid);
  }
  if (export_arbiter_.valid()) {
    inputs_[export_arbiter_.choice()].export_ready = inputs.export_ready;
    export_arbiter_.clock(inputs.export_ready, outputs_.export_last);
  }
  if (frame_arbiter_.valid()) {
    inputs_[frame_arbiter_.choice()].frame_ready = inputs.frame_ready;
    frame_arbiter_.clock(inputs.frame_ready);
  }
  fault_arbiter_.clock(false);
}

// What the units show, on the device's ports.
void Multiprocessor::present() {
  uint32_t launch_ready = 0, busy = 0, done = 0, idle = 0, memory = 0, import = 0, exports = 0, frame = 0, fault = 0;
  for (size_t u = 0; u < units_.size(); ++u) {
    const UnitOutputs& unit = units_[u]->outputs();
    launch_ready |= uint32_t{unit.launch_ready} << u;
    busy |= unit.busy << u;
    done |= unit.kernel_done << u;
    idle |= unit.unit_idle << u;
    memory |= uint32_t{unit.memory_request_valid} << u;
    import |= uint32_t{unit.import_request_valid} << u;
    exports |= uint32_t{unit.export_valid} << u;
    frame |= uint32_t{unit.frame_valid} << u;
    fault |= uint32_t{unit.fault.code != FaultCode::None} << u;
    outputs_.exports[u] = unit.exports[0];
  }
  outputs_.busy = busy;
  outputs_.kernel_done = done;
  outputs_.unit_idle = idle;
  outputs_.idle = idle + 1 == uint32_t{1} << units_.size();
  block_scheduler_.present(launch_ready, busy);
  outputs_.launch_ready = block_scheduler_.ready();
  outputs_.launch_unit = static_cast<uint8_t>(block_scheduler_.unit());

  memory_arbiter_.present(memory);
  outputs_.memory_request_valid = memory_arbiter_.valid();
  if (memory_arbiter_.valid()) {
    const uint32_t unit = memory_arbiter_.choice();
    outputs_.memory_request = units_[unit]->outputs().memory_request;
    outputs_.memory_request.id = UnitMemoryArbiter::id_of_unit(outputs_.memory_request.id, unit);
  }
  import_arbiter_.present(import);
  outputs_.import_request_valid = import_arbiter_.valid();
  if (import_arbiter_.valid()) {
    outputs_.import_request_unit = static_cast<uint8_t>(import_arbiter_.choice());
    outputs_.import_request_kind = units_[import_arbiter_.choice()]->outputs().import_request_kind;
  }
  export_arbiter_.present(exports);
  outputs_.export_valid = export_arbiter_.valid();
  if (export_arbiter_.valid()) {
    const UnitOutputs& unit = units_[export_arbiter_.choice()]->outputs();
    outputs_.export_unit = static_cast<uint8_t>(export_arbiter_.choice());
    outputs_.export_data = unit.export_data;
    outputs_.export_last = unit.export_last;
  }
  frame_arbiter_.present(frame);
  outputs_.frame_valid = frame_arbiter_.valid();
  if (frame_arbiter_.valid()) {
    outputs_.frame_unit = static_cast<uint8_t>(frame_arbiter_.choice());
    outputs_.frame = units_[frame_arbiter_.choice()]->outputs().frame;
  }
  fault_arbiter_.present(fault);
  if (fault_arbiter_.valid()) {
    if (outputs_.fault.code == FaultCode::None) gather_faults();
    outputs_.fault = units_[fault_arbiter_.choice()]->outputs().fault;
    outputs_.fault.unit = fault_arbiter_.choice();
  }
}

void Multiprocessor::gather_faults() {
  faults_.clear();
  for (uint32_t u = 0; u < units(); ++u) {
    for (Fault fault : units_[u]->faults()) {
      fault.unit = u;
      faults_.push_back(fault);
    }
  }
}

void Multiprocessor::trace_on() {
  tracing_ = true;
  for (const auto& unit : units_) unit->trace_on();
}

void Multiprocessor::trace_off() {
  tracing_ = false;
  for (const auto& unit : units_) unit->trace_off();
}

void Multiprocessor::gather_trace() {
  const auto lanes_of = [&](const std::vector<uint32_t>& data) {
    std::vector<uint32_t> lanes;
    if (!spare_.empty()) {
      lanes = std::move(spare_.back());
      spare_.pop_back();
    }
    lanes.assign(data.begin(), data.end());
    return lanes;
  };
  for (RetireEvent& event : trace_.retired) spare_.push_back(std::move(event.data));
  for (RayWriteEvent& event : trace_.ray_writes) spare_.push_back(std::move(event.data));
  trace_.retired.clear();
  trace_.stores.clear();
  trace_.ray_writes.clear();
  for (uint32_t u = 0; u < units(); ++u) {
    const UnitTrace& trace = units_[u]->trace();
    for (const RetireEvent& event : trace.retired) {
      trace_.retired.push_back({event.warp, event.pc, event.instruction, event.mask, lanes_of(event.data),
                                event.predicate, u, event.wanted, event.issued, event.granted, event.last});
    }
    for (const StoreEvent& event : trace.stores) {
      trace_.stores.push_back(event);
      trace_.stores.back().unit = u;
    }
    for (const RayWriteEvent& event : trace.ray_writes) {
      trace_.ray_writes.push_back({event.warp, event.word, event.mask, lanes_of(event.data), u});
    }
  }
}

uint64_t Multiprocessor::counter(int number) {
  uint64_t sum = 0;
  for (const auto& unit : units_) sum += unit->counter(number);
  return sum;
}

bool Multiprocessor::timed() const {
  return std::all_of(units_.begin(), units_.end(), [](const auto& unit) { return unit->timed(); });
}

std::unique_ptr<ComputeUnit> make_multiprocessor(std::vector<std::unique_ptr<ComputeUnit>> units,
                                                 int intersection_beats) {
  if (units.size() == 1) return std::move(units.front());
  if (units.size() != 2 && units.size() != kMostUnits) {
    throw InputError(fmt::format("{} compute units: there must be 1, 2 or 4", units.size()));
  }
  return std::make_unique<Multiprocessor>(std::move(units), intersection_beats);
}

}  // namespace raypool
