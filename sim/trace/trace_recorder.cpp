#include "trace/trace_recorder.hpp"

#include <algorithm>
#include <utility>

#include "bits.hpp"
#include "machine/compute/memory_arbiter.hpp"

namespace raypool::trace {

namespace {

constexpr uint64_t kBefore = 4;  // a quarter of the window lies before the pixel's ray
constexpr uint32_t kPixelBeat = word::kPixel / kBeatWords, kPixelWord = word::kPixel % kBeatWords;

const char* import_name(ImportKind kind) {
  switch (kind) {
    case ImportKind::Normal:
      return "intersection";
    case ImportKind::Shadow:
      return "shadow intersection";
    case ImportKind::Direct:
      return "direct intersection";
    case ImportKind::None:
      break;
  }
  return "";
}

const char* request_name(uint8_t id, bool write) {
  if (write) return "store";
  return MemoryArbiter::of_instruction(id & 31) ? "instructions" : "data";
}

}  // namespace

TraceRecorder::TraceRecorder(std::unique_ptr<ComputeUnit> device, const Configuration& configuration,
                             const Window& window, MachineTrace& result)
    : device_(std::move(device)),
      window_(window),
      result_(result),
      waiting_for_pixel_(window.pixel.has_value()),
      started_(size_t{device_->units()} * configuration.warps),
      import_beats_(configuration.intersection_beats()) {
  result_.configuration = configuration.name;
  result_.units = device_->units();
  result_.warps = configuration.warps;
  result_.lanes = configuration.lanes;
  open_.fill(kNone);
  device_->trace_on();
}

TraceRecorder::~TraceRecorder() {
  if (recording_) finish();
}

void TraceRecorder::reset(uint32_t program_length, uint32_t memory_limit) {
  device_->reset(program_length, memory_limit);
  now_ = 0;
}

void TraceRecorder::clock(const UnitInputs& inputs) {
  if (recording_ && (waiting_for_pixel_ || now_ >= window_.from)) {
    record_instructions();
    record_ports(inputs);
  }
  device_->clock(inputs);
  ++now_;
  if (!recording_) return;
  if (waiting_for_pixel_)
    forget();
  else if (now_ >= window_.from + window_.cycles)
    finish();
}

// While it records every cycle is looked at.
uint64_t TraceRecorder::run(const UnitInputs& inputs, uint64_t cycles) {
  if (!recording_) return device_->run(inputs, cycles);
  clock(inputs);
  return 1;
}

void TraceRecorder::record_instructions() {
  for (const RetireEvent& event : device_->trace().retired) {
    InstructionSpan& span = started_[event.unit * result_.warps + event.warp];
    if (span.retired == 0) {
      span = {event.unit,
              event.warp,
              event.pc,
              event.instruction,
              static_cast<uint32_t>(popcount(event.mask)),
              now_ - event.wanted,
              now_ - event.issued,
              now_ - event.granted,
              now_};
    }
    span.retired = now_;
    if (!event.last) continue;
    result_.instructions.push_back(span);
    span = {};
  }
}

void TraceRecorder::record_ports(const UnitInputs& inputs) {
  const UnitOutputs& outputs = device_->outputs();
  if (inputs.launch_valid && outputs.launch_ready) {
    pass(Port::Launch, outputs.launch_unit, false, result_.kernel_of(inputs.launch.pc));
    end(Port::Launch);
  }
  if (outputs.memory_request_valid) {
    const MemoryRequest& request = outputs.memory_request;
    pass(Port::Memory, unit_of_id(request.id), !inputs.memory_request_ready, request_name(request.id, request.write));
    if (inputs.memory_request_ready) end(Port::Memory);
  }
  if (inputs.memory_response_valid) {
    const MemoryResponse& response = inputs.memory_response;
    pass(Port::Response, unit_of_id(response.id), false, request_name(response.id, false));
    if (response.beat == 3) end(Port::Response);
  }
  if (outputs.import_request_valid) {
    const char* const what = import_name(outputs.import_request_kind);
    pass(Port::Request, outputs.import_request_unit, !inputs.import_request_ready, what);
    if (inputs.import_request_ready) {
      end(Port::Request);
      requested_.emplace_back(outputs.import_request_unit, what);
    }
  }
  if (inputs.import_beat_valid && !requested_.empty()) {
    pass(Port::Import, requested_.front().first, false, requested_.front().second);
    if (++import_beat_ == import_beats_) {
      import_beat_ = 0;
      requested_.pop_front();
      end(Port::Import);
    }
  }
  if (outputs.export_valid) watch_export(outputs, inputs.export_ready);
  if (outputs.frame_valid) {
    pass(Port::Frame, outputs.frame_unit, !inputs.frame_ready, "contribution");
    if (inputs.frame_ready) end(Port::Frame);
  }
}

void TraceRecorder::watch_export(const UnitOutputs& outputs, bool ready) {
  pass(Port::Export, outputs.export_unit, !ready, "ray");
  if (!ready) return;
  uint32_t& beat = exported_[outputs.export_unit];
  if (waiting_for_pixel_ && beat == kPixelBeat && outputs.export_data[kPixelWord] == *window_.pixel) {
    // As much as is kept before it is part of the window.
    waiting_for_pixel_ = false;
    window_.from = now_ - std::min(now_, window_.cycles / kBefore);
  }
  ++beat;
  if (!outputs.export_last) return;
  beat = 0;
  end(Port::Export);
}

void TraceRecorder::pass(Port port, uint32_t unit, bool waits, const std::string& what) {
  if (open_[port] != kNone) {
    Transfer& transfer = result_.transfers[open_[port]];
    if (transfer.to == now_ && transfer.unit == unit && transfer.waits == waits && transfer.what == what) {
      ++transfer.to;
      return;
    }
  }
  open_[port] = result_.transfers.size();
  result_.transfers.push_back({port, unit, waits, now_, now_ + 1, what});
}

// What lies too far before the present cycle, now and then.
void TraceRecorder::forget() {
  if (now_ < forgotten_ + 2 * window_.cycles) return;
  forgotten_ = now_ - window_.cycles;
  drop_before(forgotten_);
  open_.fill(kNone);
}

void TraceRecorder::drop_before(uint64_t cycle) {
  auto& instructions = result_.instructions;
  instructions.erase(std::remove_if(instructions.begin(), instructions.end(),
                                    [&](const InstructionSpan& span) { return span.issued < cycle; }),
                     instructions.end());
  auto& transfers = result_.transfers;
  transfers.erase(std::remove_if(transfers.begin(), transfers.end(),
                                 [&](const Transfer& transfer) { return transfer.from < cycle; }),
                  transfers.end());
}

// Whole spans only.
void TraceRecorder::finish() {
  recording_ = false;
  device_->trace_off();
  if (waiting_for_pixel_) {
    result_.instructions.clear();
    result_.transfers.clear();
    return;
  }
  result_.from = window_.from;
  result_.to = std::max(now_, window_.from);
  drop_before(window_.from);
  for (InstructionSpan& span : result_.instructions) span.wanted = std::max(span.wanted, window_.from);
}

}  // namespace raypool::trace
