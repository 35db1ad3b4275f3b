#include "chip/device_host.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "bits.hpp"
#include "chip/chip.hpp"

namespace raypool::chip {

DeviceHost::DeviceHost(const sc_core::sc_module_name& name, ComputeUnit& device, const DeviceSurroundings& surroundings)
    : sc_module(name),
      device_(device),
      units_(device.units()),
      around_(surroundings),
      idle_before_((1u << units_) - 1),
      settled_((1u << units_) - 1) {
  SC_METHOD(cycles);
  sensitive << around_.clock.tick();
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
  around_.clock.wake();
}

void DeviceHost::cycles() {
  if (!awake_) return;
  around_.clock.guard([&] {
    do {
      cycle();
    } while (awake_ && around_.clock.run_on());
  });
}

void DeviceHost::cycle() {
  // Outputs stay as they are until clock(), so the reference may be kept.
  const UnitOutputs& outputs = device_.outputs();
  if (outputs.fault.code != FaultCode::None) {
    const int unit = static_cast<int>(outputs.fault.unit);
    throw ChipFault(unit, outputs.fault, fault_sentence(unit, outputs.fault));
  }
  inputs_.launch_valid = inputs_.import_request_ready = inputs_.import_beat_valid = inputs_.export_ready = false;
  if (pending_) offer_launch(outputs);
  serve_memory(outputs);
  bool held_up = false;
  released_ = false;
  if (around_.frame) {
    serve_pools(outputs);
    held_up = outputs.export_valid && !inputs_.export_ready && around_.frame->rays.held_up();
  } else if (outputs.export_valid || outputs.frame_valid || outputs.import_request_valid) {
    throw InputError(fmt::format(
        "the program uses {}, but a compute program has no ray pools and no frame buffer: remove rin, rout and rfb from it",
        outputs.import_request_valid ? "an import"
        : outputs.export_valid       ? "rout"
                                     : "rfb"));
  }
  report(outputs, held_up);
  const auto busy = popcount(outputs.busy);
  const uint64_t cycles = device_.run(inputs_, quiet_cycles(outputs));
  busy_cycles_ += busy * cycles;
  around_.clock.pass(cycles);
  settle(device_.outputs());
  // A pixel that is finished may allow eye rays, or have been the last one.
  if (released_ && (can_launch() || idle())) around_.launcher.changed();
}

// Cycles from now on in which the device can be left alone.
uint64_t DeviceHost::quiet_cycles(const UnitOutputs& outputs) const {
  if (outputs.memory_request_valid || outputs.import_request_valid || outputs.export_valid || outputs.frame_valid ||
      inputs_.launch_valid || inputs_.memory_response_valid || inputs_.import_beat_valid) {
    return 1;
  }
  const uint64_t now = around_.clock.cycle();
  uint64_t cycles = std::min(around_.clock.quiet_cycles(), around_.memory.response_due() - now);
  if (around_.frame) cycles = std::min(cycles, around_.frame->intersections.beat_due() - now);
  return cycles;
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
  around_.launcher.accepted(static_cast<int>(pending_unit_));
}

void DeviceHost::serve_memory(const UnitOutputs& outputs) {
  inputs_.memory_request_ready = around_.memory.ready();
  if (outputs.memory_request_valid && inputs_.memory_request_ready) {
    around_.memory.request(outputs.memory_request);
    ++transfers_;
  }
  inputs_.memory_response_valid = around_.memory.response(inputs_.memory_response);
}

void DeviceHost::serve_pools(const UnitOutputs& outputs) {
  DeviceSurroundings::Frame& frame = *around_.frame;
  const uint64_t releases = frame.ledger.releases();
  if (outputs.import_request_valid) {
    inputs_.import_request_ready = frame.intersections.ready();
    if (!inputs_.import_request_ready) frame.intersections.want(outputs.import_request_unit, outputs.import_request_kind);
  }
  inputs_.import_beat_valid = frame.intersections.beat(inputs_.import_beat);
  transfers_ += inputs_.import_beat_valid;

  if (outputs.export_valid) {
    inputs_.export_ready = frame.rays.ready();
    if (!inputs_.export_ready) {
      frame.rays.want();
    } else {
      ++transfers_;
      if (frame.rays.take(outputs.export_unit, outputs.export_data, outputs.export_last)) frame.traverser.ray_arrived();
    }
  }

  inputs_.frame_ready = true;
  if (outputs.frame_valid) {
    frame.port.take(outputs.frame_unit, outputs.frame);
    ++transfers_;
  }
  released_ = frame.ledger.releases() != releases;
}

void DeviceHost::report(const UnitOutputs& outputs, bool held_up) {
  for (uint32_t done = outputs.kernel_done; done != 0; done &= done - 1) {
    const int unit = __builtin_ctz(done);
    if (given_[static_cast<size_t>(unit)] == 0) {
      throw std::runtime_error(fmt::format("compute unit {} ended a kernel that it was not given", unit));
    }
    --given_[static_cast<size_t>(unit)];
    --given_in_all_;
    around_.launcher.kernel_ended(unit);
    if (around_.frame) {
      around_.frame->ledger.kernel_ended(unit);
      around_.frame->traverser.kernel_ended();
    }
  }
  const bool ready = outputs.launch_ready && (!ready_before_ || outputs.launch_unit != next_before_);
  if (outputs.kernel_done != 0 || ready || (outputs.unit_idle & ~idle_before_) != 0) around_.launcher.changed();
  ready_before_ = outputs.launch_ready;
  next_before_ = outputs.launch_unit;
  idle_before_ = outputs.unit_idle;

  const bool stalls = given_in_all_ == 0 || held_up;
  if (stalls == stalls_) return;
  stalls_ = stalls;
  if (around_.frame) around_.frame->traverser.shader_stalls(stalls);
}

// Units of which nothing more is to come, and the end of the device's clock when that holds for all.
void DeviceHost::settle(const UnitOutputs& outputs) {
  uint32_t candidates = outputs.unit_idle & ~outputs.kernel_done & ~settled_;
  if (candidates == 0 || outputs.fault.code != FaultCode::None) return;
  for (; candidates != 0; candidates &= candidates - 1) {
    const uint32_t unit = lowest(candidates);
    if (given_[unit] > 0 || !around_.memory.quiet(unit)) continue;
    settled_ |= 1u << unit;
    if (around_.frame) around_.frame->ledger.unit_idle(static_cast<int>(unit));
    around_.launcher.changed();
  }
  if (settled_ + 1 != 1u << units_) return;
  awake_ = false;
  around_.clock.sleep();
}

std::string DeviceHost::describe() {
  const UnitOutputs& o = device_.outputs();
  std::string text, ports;
  for (uint32_t unit = 0; unit < units_; ++unit) {
    text += fmt::format("unit {}: {}, {} kernels to end{}; ", unit,
                        (o.unit_idle >> unit & 1) != 0 ? "idle"
                        : (o.busy >> unit & 1) != 0    ? "running"
                                                       : "draining",
                        given_[unit], around_.memory.quiet(unit) ? "" : ", memory response to come");
  }
  const auto add = [&](bool shown, const char* what) {
    if (shown) ports += (ports.empty() ? "" : ", ") + std::string(what);
  };
  add(pending_.has_value(), "launch offered");
  add(o.launch_ready, "ready for a launch");
  add(o.memory_request_valid, "memory request waits");
  add(o.import_request_valid, "import request waits");
  add(o.export_valid, "ray waits for the ray pool");
  add(o.frame_valid, "contribution waits");
  return fmt::format("{}{} instructions retired; {}", text, instructions(), ports.empty() ? "ports quiet" : ports);
}

}  // namespace raypool::chip
