#include "chip/unit_host.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "chip/chip.hpp"

namespace raypool::chip {

UnitHost::UnitHost(const sc_core::sc_module_name& name, int number, ComputeUnit& unit, const UnitSurroundings& surroundings)
    : sc_module(name), number_(number), unit_(unit), around_(surroundings) {
  SC_METHOD(cycle);
  sensitive << around_.clock.tick();
  dont_initialize();
}

void UnitHost::launch(const LaunchCommand& command) {
  pending_ = command;
  ++given_;
  if (awake_) return;
  awake_ = true;
  around_.clock.wake();
}

void UnitHost::cycle() {
  if (!awake_) return;
  around_.clock.guard([&] {
    // Outputs stay as they are until clock(), so the reference may be kept.
    const UnitOutputs& outputs = unit_.outputs();
    if (outputs.fault.code != FaultCode::None) throw ChipFault(number_, outputs.fault, fault_sentence(number_, outputs.fault));
    busy_cycles_ += outputs.busy;

    UnitInputs inputs;
    if (pending_) {
      inputs.launch_valid = true;
      inputs.launch = *pending_;
      if (outputs.launch_ready) {
        pending_.reset();
        ++transfers_;
        around_.launcher.accepted(number_);
      }
    }
    serve_memory(outputs, inputs);
    bool held_up = false;
    if (around_.frame) {
      serve_pools(outputs, inputs);
      held_up = outputs.export_valid && !inputs.export_ready && around_.frame->rays.held_up(number_);
    } else if (outputs.export_valid || outputs.frame_valid || outputs.import_request_valid) {
      throw InputError(fmt::format(
          "the program uses {}, but a compute program has no ray pools and no frame buffer: remove rin, rout and rfb from it",
          outputs.import_request_valid ? "an import"
          : outputs.export_valid       ? "rout"
                                       : "rfb"));
    }
    report(outputs, held_up);
    unit_.clock(inputs);

    const UnitOutputs& next = unit_.outputs();
    if (next.idle && given_ == 0 && !next.kernel_done && next.fault.code == FaultCode::None && around_.memory.quiet(number_)) {
      awake_ = false;
      around_.clock.sleep();
      if (around_.frame) around_.frame->ledger.unit_idle(number_);
      around_.launcher.changed();
    }
  });
}

void UnitHost::serve_memory(const UnitOutputs& outputs, UnitInputs& inputs) {
  inputs.memory_request_ready = around_.memory.ready(number_);
  if (outputs.memory_request_valid && inputs.memory_request_ready) {
    around_.memory.request(number_, outputs.memory_request);
    ++transfers_;
  }
  inputs.memory_response_valid = around_.memory.response(number_, inputs.memory_response);
}

void UnitHost::serve_pools(const UnitOutputs& outputs, UnitInputs& inputs) {
  UnitSurroundings::Frame& frame = *around_.frame;
  const uint64_t releases = frame.ledger.releases();
  if (outputs.import_request_valid) {
    inputs.import_request_ready = frame.intersections.ready(number_);
    if (!inputs.import_request_ready) frame.intersections.want(number_, outputs.import_request_kind);
  }
  inputs.import_beat_valid = frame.intersections.beat(number_, inputs.import_beat);
  transfers_ += inputs.import_beat_valid;

  if (outputs.export_valid) {
    inputs.export_ready = frame.rays.ready(number_);
    if (!inputs.export_ready) {
      frame.rays.want(number_);
    } else {
      ++transfers_;
      if (frame.rays.take(number_, outputs.export_data, outputs.export_last)) frame.traverser.ray_arrived();
    }
  }

  inputs.frame_ready = true;
  if (outputs.frame_valid) {
    frame.port.take(number_, outputs.frame);
    ++transfers_;
  }
  if (frame.ledger.releases() != releases) around_.launcher.changed();
}

void UnitHost::report(const UnitOutputs& outputs, bool held_up) {
  if (outputs.kernel_done) {
    if (given_ == 0) throw std::runtime_error(fmt::format("compute unit {} ended a kernel that it was not given", number_));
    --given_;
    around_.launcher.kernel_ended(number_);
    if (around_.frame) {
      around_.frame->ledger.kernel_ended(number_);
      around_.frame->traverser.kernel_ended();
    }
  }
  if (outputs.kernel_done || (outputs.launch_ready && !ready_before_) || (outputs.idle && !idle_before_))
    around_.launcher.changed();
  ready_before_ = outputs.launch_ready;
  idle_before_ = outputs.idle;

  const bool stalls = given_ == 0 || held_up;
  if (stalls == stalls_) return;
  stalls_ = stalls;
  if (around_.frame) around_.frame->traverser.unit_stalls(number_, stalls);
}

std::string UnitHost::describe() {
  const UnitOutputs& o = unit_.outputs();
  std::string ports;
  const auto add = [&](bool shown, const char* text) {
    if (shown) ports += (ports.empty() ? "" : ", ") + std::string(text);
  };
  add(pending_.has_value(), "launch offered");
  add(o.launch_ready, "ready for a launch");
  add(o.memory_request_valid, "memory request waits");
  add(!around_.memory.quiet(number_), "memory response to come");
  add(o.import_request_valid, "import request waits");
  add(o.export_valid, "ray waits for the ray pool");
  add(o.frame_valid, "contribution waits");
  return fmt::format("unit {}: {}, {} kernels to end, {} instructions retired; {}", number_,
                     o.idle   ? "idle"
                     : o.busy ? "running"
                              : "draining",
                     given_, instructions(), ports.empty() ? "ports quiet" : ports);
}

}  // namespace raypool::chip
