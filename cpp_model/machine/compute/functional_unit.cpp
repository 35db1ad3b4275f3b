#include "machine/compute/functional_unit.hpp"

#include <algorithm>
#include <array>
#include <deque>
#include <utility>
#include <vector>

#include "bits.hpp"
#include "machine/compute/functional_core.hpp"
#include "machine/compute/multiprocessor.hpp"

namespace raypool {
namespace {

constexpr int kInstructionsPerClock = 4096;  // of one warp, so that a program that never ends still lets clock() return

class FunctionalUnit : public ComputeUnit {
 public:
  FunctionalUnit(const Configuration& configuration, Memory& memory, uint32_t unit, SpecialCensus* census = nullptr)
      : core_(configuration, memory, unit),
        lanes_(static_cast<uint32_t>(configuration.lanes)),
        reserved_(static_cast<size_t>(configuration.warps)),
        exporting_(static_cast<size_t>(configuration.warps)) {
    if (census != nullptr) core_.count_specials(*census);
  }

  void reset(uint32_t program_length, uint32_t memory_limit) override {
    core_.reset(program_length, memory_limit);
    launch_waits_ = false;
    import_ = Import{};
    std::fill(reserved_.begin(), reserved_.end(), 0);
    std::fill(exporting_.begin(), exporting_.end(), 0);
    exports_.clear();
    export_beat_ = 0;
    counters_.fill(0);
    outputs_ = UnitOutputs{};
    trace_ = UnitTrace{};
    present();
  }

  void set_argument(uint32_t index, uint32_t value) override { core_.set_argument(index, value); }
  const UnitOutputs& outputs() const override { return outputs_; }
  void trace_on() override { tracing_ = true; }
  const UnitTrace& trace() const override { return trace_; }
  uint64_t counter(int number) override { return counters_.at(static_cast<size_t>(number)); }
  bool timed() const override { return false; }

  void clock(const UnitInputs& inputs) override {
    if (tracing_) trace_ = UnitTrace{};
    if (outputs_.busy != 0) ++counters_[counter::kBusyCycles];
    transfer(inputs);
    outputs_.kernel_done = 0;
    if (outputs_.fault.code == FaultCode::None) run();
    present();
  }

 private:
  struct Import {
    ImportKind kind = ImportKind::None;
    uint32_t threads = 0;
    uint32_t requested = 0;
  };
  // What waits in the output slices: a ray, or a frame contribution.
  struct Export {
    uint32_t warp;
    bool to_frame;
    Ray ray;
    FrameContribution frame;
  };

  void transfer(const UnitInputs& inputs) {
    if (outputs_.launch_ready && inputs.launch_valid) {
      launch_waits_ = true;
      waiting_ = inputs.launch;
      if (waiting_.import != ImportKind::None) {
        import_ = {waiting_.import, waiting_.threads, 0};
        core_.expect_import(waiting_.threads);
      }
    }
    if (outputs_.import_request_valid && inputs.import_request_ready) {
      if (import_.requested % lanes_ == 0) ++reserved_[import_.requested / lanes_];
      ++import_.requested;
    }
    if (inputs.import_beat_valid) core_.import_beat(inputs.import_beat);
    if (outputs_.export_valid && inputs.export_ready) {
      if (++export_beat_ == kRayBeats) exported();
    }
    if (outputs_.frame_valid && inputs.frame_ready) exported();
  }

  void exported() {
    const uint32_t warp = exports_.front().warp;
    exports_.pop_front();
    export_beat_ = 0;
    if (--exporting_[warp] == 0) core_.set_output_busy(warp, false);
  }

  void run() {
    if (!core_.running()) {
      if (!launch_waits_) return;
      core_.launch(waiting_);
      launch_waits_ = false;
    }
    const int budget = tracing_ ? 1 : kInstructionsPerClock;
    for (uint32_t warp = 0; warp < reserved_.size(); ++warp) {
      for (int i = 0; i < budget; ++i) {
        const Step& step = core_.step(warp);
        if (step.status == Step::Status::Fault) {
          outputs_.fault = step.fault;
          return;
        }
        if (step.status != Step::Status::Executed) break;
        executed(step);
        if (step.subnormal) {
          outputs_.fault = {FaultCode::SubnormalNumber, step.warp, step.pc};
          return;
        }
      }
    }
    outputs_.kernel_done = core_.running() ? 0 : 1;
  }

  void executed(const Step& step) {
    ++counters_[counter::kInstructions];
    counters_[counter::kThreadInstructions] += popcount(step.mask);
    ++counters_[counter::kIssued + static_cast<size_t>(step.instruction->alu())];
    if (tracing_) record(step);
    if (step.instruction->opcode == Opcode::Rin) --reserved_[step.warp];
    const uint32_t count = step.ray_count + step.frame_count;
    if (count == 0) return;
    for (uint32_t i = 0; i < step.ray_count; ++i) exports_.push_back({step.warp, false, step.rays[i], {}});
    for (uint32_t i = 0; i < step.frame_count; ++i) exports_.push_back({step.warp, true, {}, step.frame[i]});
    outputs_.exports[0] = static_cast<uint16_t>(outputs_.exports[0] + count);
    exporting_[step.warp] = count;
    core_.set_output_busy(step.warp, true);
  }

  void record(const Step& step) {
    RetireEvent event;
    event.warp = step.warp;
    event.pc = step.pc;
    event.instruction = step.instruction->encoding;
    event.mask = step.mask;
    event.data.assign(lanes_, 0);
    if (step.data != nullptr) event.data.assign(step.data, step.data + lanes_);
    event.predicate = step.predicate;
    trace_.retired.push_back(std::move(event));
    const size_t first = trace_.stores.size();
    for (uint32_t i = 0; i < step.store_count; ++i) {
      const Step::LaneStore& store = step.stores[i];
      const bool opens = trace_.stores.size() == first || trace_.stores.back().address != (store.address & ~15u);
      if (opens) trace_.stores.push_back({step.warp, store.address & ~15u, {}, 0});
      StoreEvent& quadword = trace_.stores.back();
      quadword.data[store.address >> 2 & 3] = store.value;
      quadword.mask = static_cast<uint8_t>(quadword.mask | 1u << (store.address >> 2 & 3));
    }
    if (step.ray_words != nullptr) {
      trace_.ray_writes.push_back(
          {step.warp, step.instruction->x, step.mask, {step.ray_words, step.ray_words + lanes_}});
    }
  }

  void present() {
    const bool stopped = outputs_.fault.code != FaultCode::None;
    const uint32_t next = import_.requested;
    const bool wants_import = next < import_.threads;
    outputs_.launch_ready = !launch_waits_ && !wants_import && !stopped;
    outputs_.busy = core_.running() ? 1 : 0;
    outputs_.idle = !core_.running() && !launch_waits_ && exports_.empty();
    outputs_.unit_idle = outputs_.idle ? 1 : 0;
    outputs_.import_request_valid = wants_import && (next % lanes_ != 0 || reserved_[next / lanes_] == 0);
    outputs_.import_request_kind = import_.kind;
    outputs_.export_valid = !exports_.empty() && !exports_.front().to_frame;
    outputs_.frame_valid = !exports_.empty() && exports_.front().to_frame;
    if (outputs_.export_valid) {
      for (int i = 0; i < kBeatWords; ++i) {
        outputs_.export_data[i] = exports_.front().ray[export_beat_ * kBeatWords + i];
      }
      outputs_.export_last = export_beat_ == kRayBeats - 1;
    }
    if (outputs_.frame_valid) outputs_.frame = exports_.front().frame;
  }

  FunctionalCore core_;
  uint32_t lanes_;
  bool launch_waits_ = false;
  LaunchCommand waiting_;
  Import import_;
  std::vector<uint32_t> reserved_;   // [warp] sets of packages requested and not yet taken by a rin
  std::vector<uint32_t> exporting_;  // [warp] rays and contributions in its output slice
  std::deque<Export> exports_;
  int export_beat_ = 0;
  std::array<uint64_t, counter::kCount> counters_{};
  UnitOutputs outputs_;
  bool tracing_ = false;
  UnitTrace trace_;
};

}  // namespace

std::unique_ptr<ComputeUnit> make_functional_unit(const Configuration& configuration, Memory& memory) {
  return std::make_unique<FunctionalUnit>(configuration, memory, 0);
}

std::unique_ptr<ComputeUnit> make_functional_units(const Configuration& configuration, Memory& memory, uint32_t units) {
  std::vector<std::unique_ptr<ComputeUnit>> parts;
  for (uint32_t unit = 0; unit < units; ++unit)
    parts.push_back(std::make_unique<FunctionalUnit>(configuration, memory, unit));
  return make_multiprocessor(std::move(parts), static_cast<int>(configuration.intersection_beats()));
}

std::unique_ptr<ComputeUnit> make_counting_functional_unit(const Configuration& configuration, Memory& memory,
                                                           SpecialCensus& census) {
  return std::make_unique<FunctionalUnit>(configuration, memory, 0, &census);
}

}  // namespace raypool
