#include "port_recording.hpp"

#include <utility>

namespace raypool::bench {
namespace {

class Recorder : public ComputeUnit {
 public:
  Recorder(std::unique_ptr<ComputeUnit> device, const Memory& memory, PortRecording& recording)
      : device_(std::move(device)), memory_(memory), recording_(recording) {}

  uint32_t units() const override { return device_->units(); }
  void reset(uint32_t program_length, uint32_t memory_limit) override {
    recording_ = PortRecording();
    recording_.memory = memory_;
    recording_.program_length = program_length;
    recording_.memory_limit = memory_limit;
    device_->reset(program_length, memory_limit);
  }
  void set_argument(uint32_t index, uint32_t value) override {
    recording_.arguments[index] = value;
    device_->set_argument(index, value);
  }
  const UnitOutputs& outputs() const override { return device_->outputs(); }
  void clock(const UnitInputs& inputs) override { run(inputs, 1); }
  uint64_t run(const UnitInputs& inputs, uint64_t cycles) override {
    const uint64_t done = device_->run(inputs, cycles);
    add(inputs, done);
    return done;
  }
  const UnitTrace& trace() const override { return device_->trace(); }
  uint64_t counter(int number) override { return device_->counter(number); }
  bool timed() const override { return device_->timed(); }

 private:
  void add(const UnitInputs& inputs, uint64_t cycles) {
    const auto readies =
        static_cast<uint8_t>(uint32_t{inputs.memory_request_ready} | uint32_t{inputs.import_request_ready} << 1 |
                             uint32_t{inputs.export_ready} << 2 | uint32_t{inputs.frame_ready} << 3);
    recording_.cycles += cycles;
    std::vector<PortRecording::Span>& spans = recording_.spans;
    const bool plain = !inputs.launch_valid && !inputs.memory_response_valid && !inputs.import_beat_valid;
    if (plain && !spans.empty() && spans.back().readies == readies) {
      spans.back().cycles += static_cast<uint32_t>(cycles);
      return;
    }
    spans.push_back({static_cast<uint32_t>(cycles), readies, inputs.launch_valid, inputs.memory_response_valid,
                     inputs.import_beat_valid});
    if (inputs.launch_valid) recording_.launches.push_back(inputs.launch);
    if (inputs.memory_response_valid) recording_.responses.push_back(inputs.memory_response);
    if (inputs.import_beat_valid) recording_.beats.push_back(inputs.import_beat);
  }

  std::unique_ptr<ComputeUnit> device_;
  const Memory& memory_;
  PortRecording& recording_;
};

}  // namespace

std::unique_ptr<ComputeUnit> record_ports(std::unique_ptr<ComputeUnit> device, const Memory& memory,
                                          PortRecording& recording) {
  return std::make_unique<Recorder>(std::move(device), memory, recording);
}

void replay(ComputeUnit& device, const PortRecording& recording) {
  device.reset(recording.program_length, recording.memory_limit);
  for (int i = 0; i < kArguments; ++i) device.set_argument(i, recording.arguments[i]);
  auto launch = recording.launches.begin();
  auto response = recording.responses.begin();
  auto beat = recording.beats.begin();
  UnitInputs inputs;
  for (const PortRecording::Span& span : recording.spans) {
    inputs.memory_request_ready = (span.readies & 1) != 0;
    inputs.import_request_ready = (span.readies & 2) != 0;
    inputs.export_ready = (span.readies & 4) != 0;
    inputs.frame_ready = (span.readies & 8) != 0;
    inputs.launch_valid = span.launch;
    inputs.memory_response_valid = span.response;
    inputs.import_beat_valid = span.beat;
    if (span.launch) inputs.launch = *launch++;
    if (span.response) inputs.memory_response = *response++;
    if (span.beat) inputs.import_beat = *beat++;
    for (uint64_t left = span.cycles; left > 0;) {
      left -= device.run(inputs, left);
      inputs.launch_valid = inputs.memory_response_valid = inputs.import_beat_valid = false;
    }
  }
}

}  // namespace raypool::bench
