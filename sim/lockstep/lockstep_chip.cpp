#include "lockstep/lockstep_chip.hpp"

#include <fmt/format.h>

#include <utility>

#include "bits.hpp"
#include "isa/counters.hpp"
#include "lockstep/chip_comparison.hpp"
#include "lockstep/chip_inspection.hpp"
#include "lockstep/rtl_loader.hpp"
#include "lockstep/text.hpp"
#include "machine/chip/chip_model.hpp"
#include "machine/compute/model.hpp"

namespace raypool {
namespace {

using namespace lockstep;

/// Cycles from when nothing passes a port any more until all counters are right: more than what the ports need for a
/// line and for a ray, which the model counts when they begin, or end.
uint64_t settling_cycles(const ChipConfiguration& chip) {
  return 8 + MemoryLine::kBeats * chip.memory_cycles_per_beat + chip.ray_pool_overhead +
         kRayBeats * chip.ray_pool_cycles_per_beat;
}

class LockstepChipImpl : public LockstepChip {
 public:
  LockstepChipImpl(const Configuration& configuration, std::unique_ptr<ChipDevice> rtl, const Memory& memory,
                   std::string name, uint64_t inspect_until)
      : kinds_(configuration.chip.culling ? 3 : 2),
        settling_(settling_cycles(configuration.chip)),
        name_(std::move(name)),
        rtl_(std::move(rtl)),
        model_(make_chip_model(configuration, make_model(configuration, memory, rtl_->units()).device)),
        inspect_until_(inspect_until),
        inspection_(configuration, *rtl_) {}

  uint32_t units() const override { return rtl_->units(); }
  const ChipOutputs& outputs() const override { return rtl_->outputs(); }
  ChipCounts counts() override { return rtl_->counts(); }
  uint64_t counter(int number) override { return rtl_->counter(number); }
  std::optional<TraverserWork> traverser_work() const override { return model_->traverser_work(); }
  void open_waveform(const std::string& path) override { rtl_->open_waveform(path); }
  const ChipLockstepCounts& lockstep_counts() const override { return counts_; }

  void start(const FrameSetup& setup) override {
    rtl_->start(setup);
    model_->start(setup);
    begin(true);
  }
  void start_next(const FrameSetup& setup) override {
    if (!report_.empty()) throw LockstepDifference(report_);
    rtl_->start_next(setup);
    model_->start_next(setup);
    begin(false);
  }

  void clock(const ChipInputs& inputs) override {
    if (!report_.empty()) throw LockstepDifference(report_);
    count_transfers(inputs);
    if (inputs.tree_request_valid || rtl_->outputs().traverser.tree_request_valid) still_since_ = cycle_ + 1;
    model_->clock(inputs);
    // The RTL still shows what its blocks hand over in this cycle.
    if (inspects()) {
      rtl_->settle(inputs);
      inspection_.advance(cycle_);
    }
    rtl_->clock(inputs);
    ++cycle_;
    ++counts_.cycles;
    if (inspects()) inspection_.check(cycle_);
    compared([this] {
      compare_chip(rtl_->outputs(), model_->outputs(), kinds_);
      counts_.kernels += popcount(rtl_->outputs().device.kernel_done);
      compare_counters();
    });
  }

  std::vector<Finding> inside() const override { return inspection_.findings(); }

 private:
  void begin(bool reset) {
    cycle_ = 0;
    moved_ = true;
    still_since_ = 0;
    if (inspects()) inspection_.restart(look_inside_traverser(*model_), reset);
    compared([this] { compare_chip(rtl_->outputs(), model_->outputs(), kinds_); });
  }

  bool inspects() const { return counts_.cycles <= inspect_until_ && inspect_until_ != 0; }

  // At most three files, those of what was found inside first.
  std::string last_lines(const Mismatch& mismatch) const {
    std::string text, files;
    for (const Finding& finding : inspection_.findings()) {
      const uint64_t ago = cycle_ - finding.cycle;
      text += fmt::format("  inside, {}: {}\n", ago == 0 ? "in this cycle" : fmt::format("{} cycles before", ago),
                          finding.text);
      files += finding.files + ", ";
    }
    return text + "  look at: " + first_files(files + mismatch.module, 3) + "\n  so far " + to_string(counts_);
  }

  // What passes the ports at the end of this cycle; both sides show the same.
  void count_transfers(const ChipInputs& inputs) {
    const ChipOutputs& out = rtl_->outputs();
    const UnitInputs& in = out.to_device;
    counts_.rays += out.device.export_valid && in.export_ready && out.device.export_last;
    counts_.intersections += out.device.import_request_valid && in.import_request_ready;
    counts_.contributions += out.frame_valid && inputs.frame_ready;
    if (out.memory_request_valid && inputs.memory_request_ready)
      ++(out.memory_request.request.write ? counts_.memory_writes : counts_.memory_reads);
  }

  // Some cycles after the last event of a frame, once.
  void compare_counters() {
    const ChipOutputs& out = rtl_->outputs();
    const bool still = !out.busy && out.device.idle && out.quiet + 1 == uint32_t{1} << units() && !out.frame_valid &&
                       !out.memory_request_valid && out.rays == 0;
    if (!still || cycle_ < 2) {
      moved_ = true;
      still_since_ = cycle_;
    }
    if (!moved_ || cycle_ < still_since_ + settling_) return;
    moved_ = false;
    lockstep::compare_counts(rtl_->counts(), model_->counts());
    for (int number = 0; number < counter::kCount; ++number) {
      const uint64_t r = rtl_->counter(number), m = model_->counter(number);
      if (r == m) continue;
      throw Mismatch{fmt::format("performance counter {} is {} in the RTL, {} in the model", number, r, m), "",
                     "rtl/compute/rp_performance_counters.v, rtl/compute/rp_multiprocessor.v, rtl/chip/rp_chip.v",
                     Context::Unit};
    }
    ++counts_.counters;
  }

  template <typename Check>
  void compared(const Check& check) {
    try {
      check();
    } catch (const Mismatch& mismatch) {
      counts_.differences = 1;
      report_ = fmt::format("lockstep difference in {}: {}\n  cycle {} of the frame, {} in all\n{}{}", name_,
                            mismatch.title, cycle_, counts_.cycles, mismatch.details, last_lines(mismatch));
      throw LockstepDifference(report_, inspect_until_ == 0 && inspection_.active() ? counts_.cycles + 1 : 0);
    }
  }

  uint32_t kinds_;
  uint64_t settling_;
  std::string name_;
  std::unique_ptr<ChipDevice> rtl_, model_;
  ChipLockstepCounts counts_;
  uint64_t cycle_ = 0;        // of the frame
  bool moved_ = true;         // since counters were compared
  uint64_t still_since_ = 0;  // this cycle
  std::string report_;
  uint64_t inspect_until_;  // cycles in all; 0: it does not look inside
  ChipInspection inspection_;
};

}  // namespace

ChipLockstepCounts& ChipLockstepCounts::operator+=(const ChipLockstepCounts& other) {
  for (uint64_t ChipLockstepCounts::*count :
       {&ChipLockstepCounts::cycles, &ChipLockstepCounts::kernels, &ChipLockstepCounts::rays,
        &ChipLockstepCounts::intersections, &ChipLockstepCounts::contributions, &ChipLockstepCounts::memory_reads,
        &ChipLockstepCounts::memory_writes, &ChipLockstepCounts::counters, &ChipLockstepCounts::differences}) {
    this->*count += other.*count;
  }
  return *this;
}

std::string to_string(const ChipLockstepCounts& counts) {
  return fmt::format(
      "chip lockstep: {} cycles, {} kernels, {} rays, {} intersections, {} contributions, {} memory reads, {} memory "
      "writes, {} times all counters compared; {} differences",
      counts.cycles, counts.kernels, counts.rays, counts.intersections, counts.contributions, counts.memory_reads,
      counts.memory_writes, counts.counters, counts.differences);
}

std::unique_ptr<LockstepChip> make_lockstep_chip(const Configuration& configuration, std::unique_ptr<ChipDevice> rtl,
                                                 const Memory& memory, const std::string& name,
                                                 uint64_t inspect_until) {
  return std::make_unique<LockstepChipImpl>(configuration, std::move(rtl), memory, name, inspect_until);
}

std::unique_ptr<ChipDevice> make_chip(ChipKind kind, const Configuration& configuration, const Memory& memory,
                                      int units, const std::string& library, const std::string& name,
                                      uint64_t inspect_until) {
  if (kind == ChipKind::Model)
    return make_chip_model(configuration, make_model(configuration, memory, static_cast<uint32_t>(units)).device);
  std::unique_ptr<ChipDevice> rtl = load_rtl_chip(library, configuration, units);
  if (kind == ChipKind::Rtl) return rtl;
  return make_lockstep_chip(configuration, std::move(rtl), memory, name, inspect_until);
}

}  // namespace raypool
