// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Engine `rtl`: the Verilated rtl/compute/rp_multiprocessor.v, of one unit or several, behind the compute-unit
// interface. scripts/verilate.sh compiles it into a shared library. A clock is two evaluations of the model and the
// copying of the narrow outputs; wide ports are read only while they are valid, the trace only after trace_on().
#include <string>
#include <utility>
#include <vector>

#include "Vmultiprocessor.h"
#include "built_parameters.h"
#include "rtl/unit_library.hpp"
#include "rtl/verilated_design.hpp"

namespace raypool {
namespace {

constexpr uint32_t kUnitCount = RAYPOOL_UNIT_COUNT;

class RtlUnit : public ComputeUnit {
 public:
  explicit RtlUnit(const Configuration& configuration)
      : warps_(configuration.warps),
        lanes_(configuration.lanes),
        warp_bits_(warps_ > 1 ? static_cast<uint32_t>(__builtin_ctz(warps_)) : 1) {}

  void reset(uint32_t program_length, uint32_t memory_limit) override {
    top().program_length_i = static_cast<SData>(program_length);
    top().memory_limit_i = memory_limit;
    top().rst_ni = 0;
    clock(UnitInputs{});
    top().rst_ni = 1;
    clock(UnitInputs{});
  }

  void set_argument(uint32_t index, uint32_t value) override {
    top().argument_write_i = 1;
    top().argument_index_i = static_cast<CData>(index);
    top().argument_data_i = value;
    clock(UnitInputs{});
    top().argument_write_i = 0;
  }

  const UnitOutputs& outputs() const override { return outputs_; }

  void clock(const UnitInputs& inputs) override {
    Vmultiprocessor& top = this->top();
    top.launch_valid_i = inputs.launch_valid;
    if (inputs.launch_valid) {
      top.launch_pc_i = static_cast<SData>(inputs.launch.pc);
      top.launch_threads_i = static_cast<SData>(inputs.launch.threads);
      top.launch_block_i = inputs.launch.block;
      top.launch_blocks_i = inputs.launch.blocks;
      top.launch_import_i = static_cast<CData>(inputs.launch.import);
    }
    top.memory_request_ready_i = inputs.memory_request_ready;
    top.memory_response_valid_i = inputs.memory_response_valid;
    if (inputs.memory_response_valid) {
      top.memory_response_id_i = inputs.memory_response.id;
      top.memory_response_beat_i = inputs.memory_response.beat;
      write_beat(top.memory_response_data_i, inputs.memory_response.data);
    }
    top.import_request_ready_i = inputs.import_request_ready;
    top.import_beat_valid_i = inputs.import_beat_valid;
    if (inputs.import_beat_valid) write_beat(top.import_beat_data_i, inputs.import_beat);
    top.export_ready_i = inputs.export_ready;
    top.frame_ready_i = inputs.frame_ready;
    design_.clock();
    read_unit_outputs(top, kUnitCount, outputs_);
    if (tracing_) read_trace();
  }

  void trace_on() override { tracing_ = true; }
  const UnitTrace& trace() const override { return trace_; }

  uint32_t units() const override { return kUnitCount; }

  uint64_t counter(int number) override { return read_counter(top(), kUnitCount, number); }

  Signal signal(const std::string& scope, const std::string& name) const override {
    return design_.signal(scope, name);
  }

  bool timed() const override { return true; }

  void open_waveform(const std::string& path) override { design_.open_waveform(path); }

 private:
  Vmultiprocessor& top() { return design_.top(); }

  void read_trace() {
    const Vmultiprocessor& top = design_.top();
    // Vectors of lanes are kept for the next event, so that a cycle allocates nothing.
    for (RetireEvent& event : trace_.retired) spare_.push_back(std::move(event.data));
    for (RayWriteEvent& event : trace_.ray_writes) spare_.push_back(std::move(event.data));
    trace_.retired.clear();
    trace_.stores.clear();
    trace_.ray_writes.clear();
    for (uint32_t u = 0; u < kUnitCount; ++u) read_unit_trace(u);
  }

  void read_unit_trace(uint32_t u) {
    const Vmultiprocessor& top = design_.top();
    for (uint32_t valid = bits(top.retire_valid_o, u * warps_, warps_); valid != 0; valid &= valid - 1) {
      const uint32_t warp = __builtin_ctz(valid);
      const uint32_t row = u * warps_ + warp;  // of the concatenated ports
      RetireEvent& event = trace_.retired.emplace_back();
      event.unit = u;
      event.warp = warp;
      event.pc = bits(top.retire_pc_o, row * 16, 16);
      const uint64_t high = bits(top.retire_instruction_o, row * 64 + 32, 32);
      event.instruction = high << 32 | bits(top.retire_instruction_o, row * 64, 32);
      event.mask = bits(top.retire_mask_o, row * lanes_, lanes_);
      event.predicate = bits(top.retire_predicate_o, row * lanes_, lanes_);
      read_lanes(top.retire_data_o, row * lanes_ * 32, event.data);
    }
    if ((top.store_trace_valid_o >> u & 1) != 0) {
      StoreEvent& event = trace_.stores.emplace_back();
      event.unit = u;
      event.warp = bits(top.store_trace_warp_o, u * warp_bits_, warp_bits_);
      event.address = bits(top.store_trace_address_o, u * 32, 32);
      for (uint32_t i = 0; i < kBeatWords; ++i) event.data[i] = bits(top.store_trace_data_o, u * 128 + i * 32, 32);
      event.mask = static_cast<uint8_t>(bits(top.store_trace_mask_o, u * 4, 4));
    }
    if ((top.ray_trace_valid_o >> u & 1) != 0) {
      RayWriteEvent& event = trace_.ray_writes.emplace_back();
      event.unit = u;
      event.warp = bits(top.ray_trace_warp_o, u * warp_bits_, warp_bits_);
      event.word = bits(top.ray_trace_word_o, u * 5, 5);
      event.mask = bits(top.ray_trace_mask_o, u * lanes_, lanes_);
      read_lanes(top.ray_trace_data_o, u * lanes_ * 32, event.data);
    }
  }

  template <typename Port>
  void read_lanes(const Port& port, uint32_t low, std::vector<uint32_t>& data) {
    if (!spare_.empty()) {
      data = std::move(spare_.back());
      spare_.pop_back();
    }
    data.resize(lanes_);
    for (uint32_t lane = 0; lane < lanes_; ++lane) data[lane] = bits(port, low + 32 * lane, 32);
  }

  uint32_t warps_, lanes_;
  uint32_t warp_bits_;  // of a warp number
  VerilatedDesign<Vmultiprocessor> design_{"rp_multiprocessor"};
  UnitOutputs outputs_;
  bool tracing_ = false;
  UnitTrace trace_;
  std::vector<std::vector<uint32_t>> spare_;
};

}  // namespace
}  // namespace raypool

RAYPOOL_EXPORT raypool::ComputeUnit* raypool_create_unit(const raypool::Configuration& configuration) {
  return new raypool::RtlUnit(configuration);
}
RAYPOOL_EXPORT const char* raypool_unit_parameters() { return RAYPOOL_BUILT_PARAMETERS; }
RAYPOOL_EXPORT const char* raypool_unit_interface() {
  static const std::string kText = raypool::unit_interface();
  return kText.c_str();
}
