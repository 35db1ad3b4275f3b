// Engine `rtl`: the Verilated rtl/multiprocessor.v, of one unit or several, behind the compute-unit interface.
// scripts/verilate.sh compiles it into a shared library. A clock is two evaluations of the model and the copying of the
// narrow outputs; wide ports are read only while they are valid, the trace only after trace_on().
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "Vmultiprocessor.h"
#include "rtl/unit_library.hpp"
#include "unit_parameters.h"
#include "verilated.h"
#include "verilated_sym_props.h"
#if VM_TRACE
#include "verilated_fst_c.h"
#endif

namespace raypool {
namespace {

constexpr uint32_t kUnitCount = RAYPOOL_UNIT_COUNT;

// A port is an integer or, beyond 64 bits, an array of 32-bit words. A field never crosses a word.
template <typename Port>
inline uint32_t bits(const Port& port, uint32_t low, uint32_t width) {
  const uint32_t mask = width >= 32 ? 0xffffffffu : (1u << width) - 1;
  if constexpr (std::is_integral_v<Port>) {
    return static_cast<uint32_t>(static_cast<uint64_t>(port) >> low) & mask;
  } else {
    return port.data()[low / 32] >> low % 32 & mask;
  }
}

template <typename Port>
inline void read_beat(const Port& port, Beat& beat) {
  for (uint32_t i = 0; i < kBeatWords; ++i) beat[i] = port.data()[i];
}

template <typename Port>
inline void write_beat(Port& port, const Beat& beat) {
  for (uint32_t i = 0; i < kBeatWords; ++i) port.data()[i] = beat[i];
}

class RtlUnit : public ComputeUnit {
 public:
  explicit RtlUnit(const Configuration& configuration)
      : warps_(configuration.warps),
        lanes_(configuration.lanes),
        warp_bits_(warps_ > 1 ? static_cast<uint32_t>(__builtin_ctz(warps_)) : 1) {
#if VM_TRACE
    context_.traceEverOn(true);
#endif
    top_ = std::make_unique<Vmultiprocessor>(&context_, "multiprocessor");
    top_->clk_i = 0;
    top_->rst_ni = 0;
    top_->eval();
  }

  ~RtlUnit() override {
#if VM_TRACE
    if (waveform_) waveform_->close();
#endif
    top_->final();
    // Its scopes leave the thread's context, which may by now be that of another unit.
    Verilated::threadContextp(&context_);
    top_.reset();
  }

  void reset(uint32_t program_length, uint32_t memory_limit) override {
    top_->program_length_i = static_cast<SData>(program_length);
    top_->memory_limit_i = memory_limit;
    top_->rst_ni = 0;
    clock(UnitInputs{});
    top_->rst_ni = 1;
    clock(UnitInputs{});
  }

  void set_argument(uint32_t index, uint32_t value) override {
    top_->argument_write_i = 1;
    top_->argument_index_i = static_cast<CData>(index);
    top_->argument_data_i = value;
    clock(UnitInputs{});
    top_->argument_write_i = 0;
  }

  const UnitOutputs& outputs() const override { return outputs_; }

  void clock(const UnitInputs& inputs) override {
    Vmultiprocessor& top = *top_;
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
    top.clk_i = 1;
    top.eval();
    dump();
    top.clk_i = 0;
    top.eval();
    dump();
    read_outputs();
    if (tracing_) read_trace();
  }

  void trace_on() override { tracing_ = true; }
  const UnitTrace& trace() const override { return trace_; }

  uint32_t units() const override { return kUnitCount; }

  uint64_t counter(int number) override {
    uint64_t sum = 0;
    top_->counter_select_i = static_cast<CData>(number);
    for (uint32_t u = 0; u < kUnitCount; ++u) {
      top_->counter_unit_i = static_cast<CData>(u);
      top_->eval();
      sum += top_->counter_o;
    }
    return sum;
  }

  Signal signal(const std::string& scope, const std::string& name) const override {
    // Verilator's look-up is not const, though it changes nothing.
    auto* found = const_cast<VerilatedScope*>(context_.scopeFind(("multiprocessor.multiprocessor." + scope).c_str()));
    const VerilatedVar* variable = found == nullptr ? nullptr : found->varFind(name.c_str());
    if (variable == nullptr) return {};
    return {variable->datap(), static_cast<uint32_t>(variable->packed().elements())};
  }

  bool timed() const override { return true; }

  void open_waveform(const std::string& path) override {
#if VM_TRACE
    waveform_ = std::make_unique<VerilatedFstC>();
    top_->trace(waveform_.get(), 99);
    waveform_->open(path.c_str());
    if (!waveform_->isOpen()) throw std::runtime_error(path + ": the waveform cannot be written there");
#else
    throw std::runtime_error(
        path + ": this unit was built without waveforms; build it with scripts/verilate.sh OUTPUT_DIR --trace ...");
#endif
  }

 private:
  void dump() {
#if VM_TRACE
    if (waveform_) waveform_->dump(time_++);
#endif
  }

  void read_outputs() {
    const Vmultiprocessor& top = *top_;
    UnitOutputs& out = outputs_;
    out.launch_ready = top.launch_ready_o;
    out.launch_unit = top.launch_unit_o;
    out.kernel_done = top.kernel_done_o;
    out.busy = top.busy_o;
    out.unit_idle = top.idle_o;
    out.idle = out.unit_idle == (1u << kUnitCount) - 1;
    for (uint32_t u = 0; u < kUnitCount; ++u) out.exports[u] = static_cast<uint16_t>(bits(top.exports_o, 16 * u, 16));
    out.memory_request_valid = top.memory_request_valid_o;
    if (out.memory_request_valid) {
      MemoryRequest& request = out.memory_request;
      request.write = top.memory_request_write_o;
      request.address = top.memory_request_address_o;
      request.id = top.memory_request_id_o;
      request.mask = top.memory_request_mask_o;
      if (request.write) read_beat(top.memory_request_data_o, request.data);
    }
    out.import_request_valid = top.import_request_valid_o;
    out.import_request_kind = static_cast<ImportKind>(top.import_request_kind_o);
    out.import_request_unit = top.import_request_unit_o;
    out.export_valid = top.export_valid_o;
    if (out.export_valid) {
      read_beat(top.export_data_o, out.export_data);
      out.export_last = top.export_last_o;
      out.export_unit = top.export_unit_o;
    }
    out.frame_valid = top.frame_valid_o;
    if (out.frame_valid) {
      out.frame.pixel = top.frame_pixel_o;
      out.frame_unit = top.frame_unit_o;
      for (uint32_t i = 0; i < 3; ++i) out.frame.rgb[i] = bits(top.frame_color_o, 32 * i, 32);
    }
    out.fault = Fault{};
    if (top.fault_valid_o) {
      out.fault = {static_cast<FaultCode>(top.fault_code_o), top.fault_warp_o, top.fault_pc_o, top.fault_unit_o};
    }
  }

  void read_trace() {
    const Vmultiprocessor& top = *top_;
    // Vectors of lanes are kept for the next event, so that a cycle allocates nothing.
    for (RetireEvent& event : trace_.retired) spare_.push_back(std::move(event.data));
    for (RayWriteEvent& event : trace_.ray_writes) spare_.push_back(std::move(event.data));
    trace_.retired.clear();
    trace_.stores.clear();
    trace_.ray_writes.clear();
    for (uint32_t u = 0; u < kUnitCount; ++u) read_unit_trace(u);
  }

  void read_unit_trace(uint32_t u) {
    const Vmultiprocessor& top = *top_;
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
  VerilatedContext context_;
  std::unique_ptr<Vmultiprocessor> top_;
  UnitOutputs outputs_;
  bool tracing_ = false;
  UnitTrace trace_;
  std::vector<std::vector<uint32_t>> spare_;
#if VM_TRACE
  std::unique_ptr<VerilatedFstC> waveform_;
  uint64_t time_ = 0;
#endif
};

}  // namespace
}  // namespace raypool

#define RAYPOOL_EXPORT extern "C" __attribute__((visibility("default")))

RAYPOOL_EXPORT raypool::ComputeUnit* raypool_create_unit(const raypool::Configuration& configuration) {
  return new raypool::RtlUnit(configuration);
}
RAYPOOL_EXPORT const char* raypool_unit_parameters() { return RAYPOOL_UNIT_PARAMETERS; }
RAYPOOL_EXPORT const char* raypool_unit_interface() {
  static const std::string kText = raypool::unit_interface();
  return kText.c_str();
}
