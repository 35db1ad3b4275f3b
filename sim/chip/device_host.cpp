#include "chip/device_host.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "bits.hpp"
#include "chip/chip.hpp"

namespace raypool::chip {

DeviceHost::DeviceHost(const sc_core::sc_module_name& name, ComputeUnit& device)
    : sc_module(name),
      device_(device),
      units_(device.units()),
      idle_before_((1u << units_) - 1),
      settled_((1u << units_) - 1) {
  launches.bind(*this);
  SC_METHOD(run);
  sensitive << next_cycle_;
  dont_initialize();
}

void DeviceHost::launch(const LaunchCommand& command) {
  pending_ = command;
  pending_unit_ = next_unit();
  ++given_[pending_unit_];
  ++given_in_all_;
  settled_ &= ~(1u << pending_unit_);
  if (awake_) return;
  awake_ = true;
  clock->notify(next_cycle_, Phase::Units, 1);
}

void DeviceHost::run() {
  clock->guard([&] {
    clock->compute_quantum();
    for (;; clock->advance(1)) {
      // Outputs stay as they are until the device is clocked.
      const UnitOutputs& outputs = device_.outputs();
      decide_inputs(outputs);
      const uint32_t busy = outputs.busy;
      const uint64_t cycles = device_.run(inputs_, quiet_cycles(outputs));
      busy_cycles_ += (busy < 2 ? busy : popcount(busy)) * cycles;
      clock->advance(cycles - 1);
      if ((device_.outputs().unit_idle & ~settled_) != 0) settle();
      if (!awake_) return;
      if (clock->need_sync()) break;
    }
    clock->notify(next_cycle_, Phase::Units, 1);
  });
}

// Most cycles have nothing for most of these.
void DeviceHost::decide_inputs(const UnitOutputs& outputs) {
  if (outputs.fault.code != FaultCode::None) {
    const uint32_t unit = outputs.fault.unit;
    throw ChipFault(unit, outputs.fault, fault_sentence(unit, outputs.fault));
  }
  const uint64_t now = clock->cycle();
  inputs_.launch_valid = false;
  if (pending_) offer_launch(outputs);
  serve_memory(outputs, now);
  serve_imports(outputs, now);
  serve_exports(outputs, now);
  if (outputs.kernel_done != 0 || outputs.launch_ready != ready_before_ || outputs.launch_unit != next_before_ ||
      outputs.unit_idle != idle_before_) {
    report(outputs);
  }
  const bool stalls = given_in_all_ == 0 || (outputs.export_valid && !inputs_.export_ready && rays->held_up());
  if (stalls != stalls_) report_stalls(stalls);
}

// Cycles from now on in which the device can be left alone: until somebody has something for it, or takes what it
// offers.
uint64_t DeviceHost::quiet_cycles(const UnitOutputs& outputs) const {
  if (inputs_.launch_valid) return 1;
  uint64_t until = std::min(memory->response_due(), intersections->beat_due());
  if (outputs.memory_request_valid && !inputs_.memory_request_ready) until = std::min(until, memory->room_from());
  if (outputs.import_request_valid && !inputs_.import_request_ready)
    until = std::min(until, intersections->request_due());
  if (outputs.export_valid && !inputs_.export_ready) until = std::min(until, rays->beats_from());
  return std::min(clock->quantum(), until - clock->cycle());
}

void DeviceHost::offer_launch(const UnitOutputs& outputs) {
  inputs_.launch_valid = true;
  inputs_.launch = *pending_;
  if (!outputs.launch_ready) return;
  if (outputs.launch_unit != pending_unit_) {
    throw std::logic_error(
        fmt::format("compute unit {} takes a kernel that was given to unit {}", outputs.launch_unit, pending_unit_));
  }
  pending_.reset();
  ++transfers_;
  for (int i = 0; i < kernel_events.size(); ++i) kernel_events[i]->accepted(pending_unit_);
}

void DeviceHost::serve_memory(const UnitOutputs& outputs, uint64_t now) {
  inputs_.memory_request_ready = memory->room_from() <= now;
  if (outputs.memory_request_valid && inputs_.memory_request_ready) {
    memory->request(outputs.memory_request);
    ++transfers_;
  }
  inputs_.memory_response_valid = memory->response_due() <= now;
  if (!inputs_.memory_response_valid) return;
  memory->response(inputs_.memory_response);
  ++transfers_;
}

void DeviceHost::serve_imports(const UnitOutputs& outputs, uint64_t now) {
  inputs_.import_request_ready =
      outputs.import_request_valid && intersections->request(outputs.import_request_unit, outputs.import_request_kind);
  inputs_.import_beat_valid = intersections->beat_due() <= now;
  if (!inputs_.import_beat_valid) return;
  intersections->beat(inputs_.import_beat);
  ++transfers_;
}

void DeviceHost::serve_exports(const UnitOutputs& outputs, uint64_t now) {
  inputs_.export_ready = outputs.export_valid && rays->beats_from() <= now;
  if (inputs_.export_ready) {
    ++transfers_;
    rays->take(outputs.export_unit, outputs.export_data, outputs.export_last);
  } else if (outputs.export_valid) {
    rays->want();
  }
  inputs_.frame_ready = true;
  if (outputs.frame_valid) {
    frame->take(outputs.frame_unit, outputs.frame);
    ++transfers_;
  }
}

void DeviceHost::report(const UnitOutputs& outputs) {
  for (uint32_t done = outputs.kernel_done; done != 0; done &= done - 1) {
    const uint32_t unit = lowest(done);
    if (given_[unit] == 0) {
      throw std::runtime_error(fmt::format("compute unit {} ended a kernel that it was not given", unit));
    }
    --given_[unit];
    --given_in_all_;
    for (int i = 0; i < kernel_events.size(); ++i) kernel_events[i]->kernel_ended(unit);
  }
  const bool ready = outputs.launch_ready && (!ready_before_ || outputs.launch_unit != next_before_);
  if (outputs.kernel_done != 0 || ready || (outputs.unit_idle & ~idle_before_) != 0) controller->changed();
  ready_before_ = outputs.launch_ready;
  next_before_ = outputs.launch_unit;
  idle_before_ = outputs.unit_idle;
}

void DeviceHost::report_stalls(bool stalls) {
  stalls_ = stalls;
  for (int i = 0; i < kernel_events.size(); ++i) kernel_events[i]->shader_stalls(stalls);
}

// Units of which nothing more is to come, and the end of the device's clock when that holds for all.
void DeviceHost::settle() {
  const UnitOutputs& outputs = device_.outputs();
  uint32_t candidates = outputs.unit_idle & ~outputs.kernel_done & ~settled_;
  if (candidates == 0 || outputs.fault.code != FaultCode::None) return;
  for (; candidates != 0; candidates &= candidates - 1) {
    const uint32_t unit = lowest(candidates);
    if (given_[unit] > 0 || !memory->quiet(unit)) continue;
    settled_ |= 1u << unit;
    for (int i = 0; i < kernel_events.size(); ++i) kernel_events[i]->unit_idle(unit);
    controller->changed();
  }
  awake_ = settled_ + 1 != 1u << units_;
}

std::string DeviceHost::describe() {
  const UnitOutputs& o = device_.outputs();
  std::string text, ports;
  for (uint32_t unit = 0; unit < units_; ++unit) {
    text += fmt::format("unit {}: {}, {} kernels to end{}; ", unit,
                        (o.unit_idle >> unit & 1) != 0 ? "idle"
                        : (o.busy >> unit & 1) != 0    ? "running"
                                                       : "draining",
                        given_[unit], memory->quiet(unit) ? "" : ", memory response to come");
  }
  const auto add = [&](bool shown, const std::string& what) {
    if (shown) ports += (ports.empty() ? "" : ", ") + what;
  };
  add(pending_.has_value(), fmt::format("a launch waits for unit {}", pending_unit_));
  add(o.launch_ready && !pending_, fmt::format("unit {} waits for a launch", o.launch_unit));
  add(o.memory_request_valid && !inputs_.memory_request_ready,
      "a request waits for the memory port, whose queue is full");
  add(o.import_request_valid && !inputs_.import_request_ready,
      fmt::format("unit {} waits for the intersection pool to give it a package", o.import_request_unit));
  add(o.export_valid && !inputs_.export_ready,
      fmt::format("unit {} waits for the ray pool to take a ray", o.export_unit));
  return fmt::format("{}{} instructions retired; {}", text, instructions(),
                     ports.empty() ? "nothing waits at the units' ports" : ports);
}

}  // namespace raypool::chip
