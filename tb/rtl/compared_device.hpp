// For tests: two devices behind one set of ports, given the same inputs; what they show must be equal in every cycle.
// And the promises that a device of several units makes at its ports.
#pragma once

#include <fmt/format.h>

#include <array>
#include <deque>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "machine/compute/compute_unit.hpp"

namespace raypool::test {

/// Names the first port that differs; empty when all agree. What goes with a valid counts only while it is set.
inline std::string difference(const UnitOutputs& a, const UnitOutputs& b) {
  std::string names;
  const auto differs = [&](bool different, const char* name) {
    if (different && names.empty()) names = name;
  };
  differs(a.launch_ready != b.launch_ready, "launch_ready");
  differs(a.launch_ready && a.launch_unit != b.launch_unit, "launch_unit");
  differs(a.kernel_done != b.kernel_done, "kernel_done");
  differs(a.busy != b.busy, "busy");
  differs(a.unit_idle != b.unit_idle || a.idle != b.idle, "idle");
  differs(a.memory_request_valid != b.memory_request_valid, "memory_request_valid");
  if (a.memory_request_valid) {
    const MemoryRequest &x = a.memory_request, &y = b.memory_request;
    differs(x.write != y.write || x.address != y.address, "memory_request_address");
    differs(x.id != y.id, "memory_request_id");
    differs(x.write && (x.mask != y.mask || x.data != y.data), "memory_request_data");
  }
  differs(a.import_request_valid != b.import_request_valid, "import_request_valid");
  differs(a.import_request_valid && a.import_request_kind != b.import_request_kind, "import_request_kind");
  differs(a.import_request_valid && a.import_request_unit != b.import_request_unit, "import_request_unit");
  differs(a.export_valid != b.export_valid, "export_valid");
  differs(a.export_valid && (a.export_data != b.export_data || a.export_last != b.export_last), "export_data");
  differs(a.export_valid && a.export_unit != b.export_unit, "export_unit");
  differs(a.exports != b.exports, "exports");
  differs(a.frame_valid != b.frame_valid, "frame_valid");
  differs(a.frame_valid && (a.frame.pixel != b.frame.pixel || a.frame.rgb != b.frame.rgb), "frame");
  differs(a.frame_valid && a.frame_unit != b.frame_unit, "frame_unit");
  differs(a.fault.code != b.fault.code || a.fault.unit != b.fault.unit, "fault");
  differs(a.fault.warp != b.fault.warp || a.fault.pc != b.fault.pc, "fault_pc");
  return names;
}

inline std::string difference(const UnitTrace& a, const UnitTrace& b) {
  if (a.retired.size() != b.retired.size()) return "retire_valid";
  for (size_t i = 0; i < a.retired.size(); ++i) {
    const RetireEvent &x = a.retired[i], &y = b.retired[i];
    if (x.unit != y.unit || x.warp != y.warp || x.pc != y.pc || x.instruction != y.instruction) return "retire_pc";
    if (x.mask != y.mask || x.predicate != y.predicate || x.data != y.data) return "retire_data";
  }
  if (a.stores.size() != b.stores.size()) return "store_trace_valid";
  for (size_t i = 0; i < a.stores.size(); ++i) {
    const StoreEvent &x = a.stores[i], &y = b.stores[i];
    if (x.unit != y.unit || x.warp != y.warp || x.address != y.address || x.mask != y.mask || x.data != y.data)
      return "store_trace";
  }
  if (a.ray_writes.size() != b.ray_writes.size()) return "ray_trace_valid";
  for (size_t i = 0; i < a.ray_writes.size(); ++i) {
    const RayWriteEvent &x = a.ray_writes[i], &y = b.ray_writes[i];
    if (x.unit != y.unit || x.warp != y.warp || x.word != y.word || x.mask != y.mask || x.data != y.data)
      return "ray_trace";
  }
  return "";
}

/// What passed the ports, by unit.
struct PortCounts {
  std::array<uint64_t, kMostUnits> launches{}, kernels{}, reads{}, writes{}, imports{}, rays{}, contributions{},
      retired{};
};

/// clock(), reset() and set_argument() throw std::runtime_error at the first difference or broken promise.
class ComparedDevice : public ComputeUnit {
 public:
  ComparedDevice(std::unique_ptr<ComputeUnit> first, std::unique_ptr<ComputeUnit> second)
      : first_(std::move(first)), second_(std::move(second)) {
    first_->trace_on();
    second_->trace_on();
  }

  uint32_t units() const override { return first_->units(); }
  void reset(uint32_t program_length, uint32_t memory_limit) override {
    first_->reset(program_length, memory_limit);
    second_->reset(program_length, memory_limit);
    before_ = {};
    beats_ = 0;
    compare();
  }
  void set_argument(uint32_t index, uint32_t value) override {
    first_->set_argument(index, value);
    second_->set_argument(index, value);
    compare();
  }
  const UnitOutputs& outputs() const override { return first_->outputs(); }
  const UnitTrace& trace() const override { return first_->trace(); }
  bool timed() const override { return true; }

  void clock(const UnitInputs& inputs) override {
    count(inputs);
    before_ = first_->outputs();
    given_ = inputs;
    first_->clock(inputs);
    second_->clock(inputs);
    ++cycles;
    compare();
    check_stability();
    for (const RetireEvent& event : first_->trace().retired) ++counts.retired[event.unit];
  }

  uint64_t counter(int number) override {
    const uint64_t value = first_->counter(number);
    if (value != second_->counter(number)) fail(fmt::format("counter {} differs", number));
    return value;
  }

  PortCounts counts;
  uint64_t cycles = 0;

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw std::runtime_error(fmt::format("cycle {}: {}", cycles, what));
  }

  void compare() const {
    std::string name = difference(first_->outputs(), second_->outputs());
    if (name.empty()) name = difference(first_->trace(), second_->trace());
    if (!name.empty()) fail(name + " differs");
  }

  // What is transferred in this cycle.
  void count(const UnitInputs& in) {
    const UnitOutputs& out = first_->outputs();
    if (out.launch_ready && in.launch_valid) ++counts.launches[out.launch_unit];
    for (uint32_t u = 0; u < units(); ++u) counts.kernels[u] += out.kernel_done >> u & 1;
    if (out.memory_request_valid && in.memory_request_ready) {
      ++(out.memory_request.write ? counts.writes : counts.reads)[unit_of_id(out.memory_request.id)];
    }
    if (out.import_request_valid && in.import_request_ready) ++counts.imports[out.import_request_unit];
    if (out.export_valid && in.export_ready) {
      if (beats_ > 0 && out.export_unit != exporting_) fail("a ray's beats are mixed with those of another unit");
      exporting_ = out.export_unit;
      ++beats_;
      if (out.export_last != (beats_ == kRayBeats)) fail("export_last is not that of the third beat");
      if (out.export_last) {
        beats_ = 0;
        ++counts.rays[out.export_unit];
      }
    }
    if (out.frame_valid && in.frame_ready) ++counts.contributions[out.frame_unit];
  }

  // What was offered and not taken must be offered again.
  void check_stability() const {
    UnitOutputs now = first_->outputs(), was = before_;
    const auto keep = [&](bool UnitOutputs::*valid, bool ready) {
      if (was.*valid && !ready) return;
      now.*valid = was.*valid = false;
    };
    keep(&UnitOutputs::memory_request_valid, given_.memory_request_ready);
    keep(&UnitOutputs::import_request_valid, given_.import_request_ready);
    keep(&UnitOutputs::export_valid, given_.export_ready);
    keep(&UnitOutputs::frame_valid, given_.frame_ready);
    now.launch_ready = was.launch_ready = false;
    now.kernel_done = was.kernel_done = now.busy = was.busy = now.unit_idle = was.unit_idle = 0;
    now.idle = was.idle = false;
    now.exports = was.exports = {};
    if (was.fault.code == FaultCode::None) now.fault = was.fault = {};
    const std::string name = difference(was, now);
    if (!name.empty()) fail(name + " changed while it waited");
  }

  std::unique_ptr<ComputeUnit> first_, second_;
  UnitOutputs before_;
  UnitInputs given_;
  int beats_ = 0;
  uint8_t exporting_ = 0;
};

}  // namespace raypool::test
