#include "cosim/vector_recorder.hpp"

#include "cosim/bus.hpp"
#include "isa/encoding.hpp"

namespace raypool {
namespace {

class Recorder : public ComputeUnit {
 public:
  Recorder(const Configuration& configuration, std::unique_ptr<ComputeUnit> unit, std::ostream& out)
      : unit_(std::move(unit)), out_(&out), warps_(configuration.warps), lanes_(configuration.lanes), warp_bits_(1) {
    while ((1 << warp_bits_) < warps_) ++warp_bits_;
  }

  void reset(uint32_t program_length, uint32_t memory_limit) override {
    program_length_ = program_length;
    memory_limit_ = memory_limit;
    // Nothing is compared before the reset has done its work; then comes the cycle that every unit's reset() ends with.
    for (int i = 0; i < 4; ++i) record(UnitInputs{}, Cycle::Reset, -1, 0);
    record(UnitInputs{}, Cycle::Unchecked, -1, 0);
    unit_->reset(program_length, memory_limit);
  }
  void set_argument(uint32_t index, uint32_t value) override {
    record(UnitInputs{}, Cycle::Checked, index, value);
    unit_->set_argument(index, value);
  }
  const UnitOutputs& outputs() const override { return unit_->outputs(); }
  void clock(const UnitInputs& inputs) override {
    record(inputs, Cycle::Checked, -1, 0);
    unit_->clock(inputs);
  }
  void trace_on() override { unit_->trace_on(); }
  const UnitTrace& trace() const override { return unit_->trace(); }
  uint64_t counter(int number) override { return unit_->counter(number); }
  bool timed() const override { return unit_->timed(); }

 private:
  enum class Cycle : uint8_t { Reset, Unchecked, Checked };

  void record(const UnitInputs& in, Cycle cycle, int argument, uint32_t value) {
    bus_.clear();
    bus_.put(cycle == Cycle::Reset ? 0 : 1, 1);
    bus_.put(program_length_, 16);
    bus_.put(memory_limit_, 32);
    bus_.put(argument >= 0 ? 1 : 0, 1);
    bus_.put(static_cast<uint64_t>(argument), 5);
    bus_.put(value, 32);
    bus_.put(in.launch_valid ? 1 : 0, 1);
    bus_.put(in.launch.pc, 16);
    bus_.put(in.launch.threads, 11);
    bus_.put(in.launch.block, 32);
    bus_.put(in.launch.blocks, 32);
    bus_.put(to_underlying(in.launch.import), 2);
    bus_.put(in.memory_request_ready ? 1 : 0, 1);
    bus_.put(in.memory_response_valid ? 1 : 0, 1);
    bus_.put(in.memory_response.id, 5);
    bus_.put(in.memory_response.beat, 2);
    bus_.put_words(in.memory_response.data);
    bus_.put(in.import_request_ready ? 1 : 0, 1);
    bus_.put(in.import_beat_valid ? 1 : 0, 1);
    bus_.put_words(in.import_beat);
    bus_.put(in.export_ready ? 1 : 0, 1);
    bus_.put(in.frame_ready ? 1 : 0, 1);
    outputs(cycle == Cycle::Checked);
    *out_ << bus_.hex() << ' ' << expected_.hex() << '\n';
  }

  /// `on`: they count.
  void outputs(bool on) {
    expected_.clear();
    const UnitOutputs& out = unit_->outputs();
    expected_.put(out.launch_ready ? 1 : 0, 1, on);
    expected_.put(out.kernel_done ? 1 : 0, 1, on);
    expected_.put(out.busy ? 1 : 0, 1, on);
    expected_.put(out.idle ? 1 : 0, 1, on);
    const bool request = on && out.memory_request_valid, write = request && out.memory_request.write;
    expected_.put(out.memory_request_valid ? 1 : 0, 1, on);
    expected_.put(out.memory_request.write ? 1 : 0, 1, request);
    expected_.put(out.memory_request.address, 32, request);
    expected_.put_words(out.memory_request.data, write ? out.memory_request.mask : 0);
    expected_.put(out.memory_request.mask, 4, write);
    expected_.put(out.memory_request.id, 5, request && !write);
    expected_.put(out.import_request_valid ? 1 : 0, 1, on);
    expected_.put(to_underlying(out.import_request_kind), 2, on && out.import_request_valid);
    expected_.put(out.export_valid ? 1 : 0, 1, on);
    expected_.put_words(out.export_data, on && out.export_valid ? 15 : 0);
    expected_.put(out.export_last ? 1 : 0, 1, on && out.export_valid);
    expected_.put(out.exports[0], 16, on);
    expected_.put(out.frame_valid ? 1 : 0, 1, on);
    expected_.put(out.frame.pixel, 32, on && out.frame_valid);
    expected_.put_words(out.frame.rgb, on && out.frame_valid ? 7 : 0);
    const bool fault = out.fault.code != FaultCode::None;
    expected_.put(fault ? 1 : 0, 1, on);
    expected_.put(to_underlying(out.fault.code), 4, on && fault);
    expected_.put(out.fault.warp, warp_bits_, on && fault);
    expected_.put(out.fault.pc, 16, on && fault);
    for (int warp = warps_ - 1; warp >= 0; --warp) retirement(static_cast<uint32_t>(warp), on);
    const UnitTrace& trace = unit_->trace();
    const StoreEvent* store = trace.stores.empty() ? nullptr : &trace.stores.front();
    const StoreEvent nothing;
    expected_.put(store != nullptr ? 1 : 0, 1, on);
    const StoreEvent& s = store != nullptr ? *store : nothing;
    expected_.put(s.warp, warp_bits_, on && store != nullptr);
    expected_.put(s.address, 32, on && store != nullptr);
    expected_.put_words(s.data, on && store != nullptr ? s.mask : 0);
    expected_.put(s.mask, 4, on && store != nullptr);
    const RayWriteEvent* ray = trace.ray_writes.empty() ? nullptr : &trace.ray_writes.front();
    expected_.put(ray != nullptr ? 1 : 0, 1, on);
    expected_.put(ray != nullptr ? ray->warp : 0, warp_bits_, on && ray != nullptr);
    expected_.put(ray != nullptr ? ray->word : 0, 5, on && ray != nullptr);
    expected_.put(ray != nullptr ? ray->mask : 0, lanes_, on && ray != nullptr);
    for (int lane = lanes_ - 1; lane >= 0; --lane) {
      const size_t l = lane;
      expected_.put(ray != nullptr ? ray->data[l] : 0, 32, on && ray != nullptr && (ray->mask >> lane & 1) != 0);
    }
  }

  void retirement(uint32_t warp, bool on) {
    const RetireEvent* event = nullptr;
    for (const RetireEvent& each : unit_->trace().retired)
      if (each.warp == warp) event = &each;
    const bool valid = on && event != nullptr;
    const Instruction instruction = event != nullptr ? unpack(event->instruction) : Instruction{};
    const bool data = valid && instruction.info != nullptr && writes_register(*instruction.info);
    const bool predicate = valid && instruction.info != nullptr && writes_predicate(*instruction.info);
    expected_.put(event != nullptr ? 1 : 0, 1, on);
    expected_.put(event != nullptr ? event->pc : 0, 16, valid);
    expected_.put(event != nullptr ? event->instruction : 0, 64, valid);
    expected_.put(event != nullptr ? event->mask : 0, lanes_, valid);
    for (int lane = lanes_ - 1; lane >= 0; --lane) {
      const size_t l = lane;
      expected_.put(event != nullptr ? event->data[l] : 0, 32, data && (event->mask >> lane & 1) != 0);
    }
    expected_.put(event != nullptr ? event->predicate : 0, lanes_, predicate);
  }

  std::unique_ptr<ComputeUnit> unit_;
  std::ostream* out_;
  int warps_, lanes_, warp_bits_;
  uint32_t program_length_ = 0, memory_limit_ = 0;
  Bus bus_;
  ExpectedBus expected_;
};

}  // namespace

std::unique_ptr<ComputeUnit> make_vector_recorder(const Configuration& configuration, std::unique_ptr<ComputeUnit> unit,
                                                  std::ostream& out) {
  return std::make_unique<Recorder>(configuration, std::move(unit), out);
}

}  // namespace raypool
