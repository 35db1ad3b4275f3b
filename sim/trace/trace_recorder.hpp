// Stands around a device and writes down what it does in a window of cycles.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "machine/compute/compute_unit.hpp"
#include "trace/machine_trace.hpp"

namespace raypool::trace {

/// The device must report when its instructions got on (engine `model`). The trace goes to `result`, which must outlive
/// the recorder; it is whole when the recorder is gone, and empty if the pixel's ray never left.
class TraceRecorder : public ComputeUnit {
 public:
  TraceRecorder(std::unique_ptr<ComputeUnit> device, const Configuration& configuration, const Window& window,
                MachineTrace& result);
  ~TraceRecorder() override;

  uint32_t units() const override { return device_->units(); }
  void reset(uint32_t program_length, uint32_t memory_limit) override;
  void set_argument(uint32_t index, uint32_t value) override { device_->set_argument(index, value); }
  const UnitOutputs& outputs() const override { return device_->outputs(); }
  void clock(const UnitInputs& inputs) override;
  uint64_t run(const UnitInputs& inputs, uint64_t cycles) override;
  std::vector<Fault> faults() const override { return device_->faults(); }
  void trace_on() override { device_->trace_on(); }
  const UnitTrace& trace() const override { return device_->trace(); }
  Signal signal(const std::string& scope, const std::string& name) const override {
    return device_->signal(scope, name);
  }
  uint64_t counter(int number) override { return device_->counter(number); }
  bool timed() const override { return device_->timed(); }
  void open_waveform(const std::string& path) override { device_->open_waveform(path); }

 private:
  void record_instructions();
  void record_ports(const UnitInputs& inputs);
  void watch_export(const UnitOutputs& outputs, bool ready);
  /// Something passes, or waits, in this cycle; the same in the cycle before goes on.
  void pass(Port port, uint32_t unit, bool waits, const std::string& what);
  /// The next thing that passes the port is another one.
  void end(Port port) { open_[port] = kNone; }
  void forget();
  void drop_before(uint64_t cycle);
  void finish();

  static constexpr size_t kNone = SIZE_MAX;
  std::unique_ptr<ComputeUnit> device_;
  Window window_;
  MachineTrace& result_;
  bool recording_ = true;
  bool waiting_for_pixel_;
  uint64_t now_ = 0, forgotten_ = 0;
  std::vector<InstructionSpan> started_;                    // [unit and warp] triples of which an element has retired
  EnumArray<Port, size_t, kPorts> open_{};                  // [port] transfer that may go on
  std::array<uint32_t, kMostUnits> exported_{};             // [unit] beats of the ray that leaves
  std::deque<std::pair<uint32_t, const char*>> requested_;  // records to come: unit, and what they are
  uint32_t import_beat_ = 0, import_beats_;
};

}  // namespace raypool::trace
