#include "lockstep/lockstep_unit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "bits.hpp"
#include "lockstep/comparison.hpp"
#include "lockstep/inspection.hpp"
#include "lockstep/text.hpp"
#include "machine/compute/model.hpp"

namespace raypool {
namespace {

using namespace lockstep;

constexpr size_t kHistory = 8;

class LockstepUnitImpl : public LockstepUnit {
 public:
  LockstepUnitImpl(const Configuration& configuration, std::unique_ptr<ComputeUnit> rtl, const Memory& memory,
                   const LockstepOptions& options)
      : configuration_(configuration),
        options_(options),
        warps_(configuration.warps),
        lanes_(configuration.lanes),
        rtl_(std::move(rtl)),
        model_(make_model(configuration, memory, rtl_->units())),
        histories_(warps_ * model_.units.size()),
        comparison_(
            configuration,
            [this](uint32_t unit, uint32_t warp) -> const CycleUnit::Issue& { return model_.units[unit]->issue(warp); },
            counts_) {
    rtl_->trace_on();
    model_.device->trace_on();
    if (options.inspect_until != 0) inspection_.emplace(configuration, *rtl_, model_.units);
  }

  void reset(uint32_t program_length, uint32_t memory_limit) override {
    rtl_->reset(program_length, memory_limit);
    model_.device->reset(program_length, memory_limit);
    if (inspection_) inspection_->reset(program_length);
    kernels_started_ = 0;
    fault_seen_ = false;
    was_idle_ = true;
    reads_ = 0;
    import_beats_ = 0;
    last_progress_ = counts_.cycles;
    for (History& history : histories_) history.count = 0;
  }

  void set_argument(uint32_t index, uint32_t value) override {
    rtl_->set_argument(index, value);
    model_.device->set_argument(index, value);
    if (inspection_) inspection_->argument_written();
  }

  uint32_t units() const override { return rtl_->units(); }
  const UnitOutputs& outputs() const override { return rtl_->outputs(); }
  void trace_on() override {}  // it always is
  const UnitTrace& trace() const override { return rtl_->trace(); }
  uint64_t counter(int number) override { return rtl_->counter(number); }
  std::vector<Fault> faults() const override { return model_.device->faults(); }
  bool timed() const override { return rtl_->timed(); }
  void open_waveform(const std::string& path) override { rtl_->open_waveform(path); }
  const LockstepCounts& counts() const override { return counts_; }
  std::string uninspected() const override { return inspection_ ? inspection_->missing() : "not asked for"; }
  std::vector<Finding> inside() const override {
    return inspection_ ? inspection_->findings() : std::vector<Finding>();
  }

  void clock(const UnitInputs& inputs) override {
    if (!report_.empty()) throw LockstepDifference(report_);
    try {
      count_transfers(inputs);
      if (inspection_) inspection_->advance(inputs);
      rtl_->clock(inputs);
      ++counts_.cycles;
      model_.device->clock(inputs);
      if (inspection_) inspection_->check();
      check_cycle();
    } catch (const Mismatch& mismatch) {
      counts_.differences = 1;
      report_ = report(mismatch);
      throw LockstepDifference(report_, can_inspect() ? counts_.cycles : 0);
    }
    if (inspection_ && counts_.cycles >= options_.inspect_until)
      throw std::runtime_error(fmt::format(
          "there is no difference up to cycle {}, where this run was to find one again", options_.inspect_until));
  }

 private:
  struct Retired {
    uint64_t cycle;
    uint32_t pc;
    uint64_t encoding;
  };
  struct History {
    std::array<Retired, kHistory> retired{};
    uint64_t count = 0;  // all that retired; the last ones are kept
  };

  // What passes the ports at the end of the current cycle; both sides show the same.
  void count_transfers(const UnitInputs& inputs) {
    const UnitOutputs& out = rtl_->outputs();
    bool progress = false;
    if (out.launch_ready && inputs.launch_valid) {
      ++kernels_started_;
      progress = true;
    }
    if (out.memory_request_valid && inputs.memory_request_ready) {
      ++(out.memory_request.write ? counts_.memory_writes : counts_.memory_reads);
      reads_ += !out.memory_request.write;
      progress = true;
    }
    if (inputs.memory_response_valid) {
      reads_ -= inputs.memory_response.beat == 3;
      progress = true;
    }
    if (out.import_request_valid && inputs.import_request_ready) {
      ++counts_.imports;
      import_beats_ += configuration_.intersection_beats();
      progress = true;
    }
    if (out.export_valid && inputs.export_ready) {
      counts_.exports += out.export_last;
      progress = true;
    }
    if (out.frame_valid && inputs.frame_ready) {
      ++counts_.frame_contributions;
      progress = true;
    }
    if (inputs.import_beat_valid && import_beats_ != 0) --import_beats_;
    if (progress || inputs.import_beat_valid) last_progress_ = counts_.cycles;
  }

  void check_cycle() {
    const UnitOutputs& out = rtl_->outputs();
    const UnitTrace& trace = rtl_->trace();
    comparison_.trace(trace, model_.device->trace());
    comparison_.outputs(out, model_.device->outputs());
    for (const RetireEvent& event : trace.retired) {
      History& history = histories_[event.unit * warps_ + event.warp];
      history.retired[history.count++ % kHistory] = {counts_.cycles, event.pc, event.instruction};
    }
    if (!trace.retired.empty()) last_progress_ = counts_.cycles;
    counts_.kernels += popcount(out.kernel_done);
    if (out.fault.code != FaultCode::None) {
      counts_.faults += fault_seen_ ? 0 : 1;
      fault_seen_ = true;
      return;  // it waits for a reset
    }
    if (out.idle && !was_idle_) {
      compare_counters(configuration_, *rtl_, *model_.device);
      ++counts_.counters;
    }
    was_idle_ = out.idle;
    if (options_.watchdog_cycles != 0 && out.busy != 0 && counts_.cycles - last_progress_ > options_.watchdog_cycles &&
        (options_.answered_soon || !waits_for_others()))
      hang();
  }

  // At a port, or for what it has asked for there. Several units hang only when all of them do.
  bool waits_for_others() const {
    const UnitOutputs& out = rtl_->outputs();
    return out.memory_request_valid || out.import_request_valid || out.export_valid || out.frame_valid || reads_ != 0 ||
           import_beats_ != 0;
  }

  // Every warp's instruction under way, and what it can be waiting for.
  std::string warp_lines(uint32_t unit) const {
    std::string text;
    const CycleUnit& model = *model_.units[unit];
    for (uint32_t warp = 0; warp < warps_; ++warp) {
      text += fmt::format("  {}warp {:>2}: ", model_.units.size() > 1 ? fmt::format("unit {}, ", unit) : "", warp);
      const CycleUnit::Issue& issue = model.issue(warp);
      if (!model.warp_active(warp)) {
        text += "not running\n";
        continue;
      }
      if (issue.instruction == nullptr) {
        text += "waits for its first instruction\n";
        continue;
      }
      text += fmt::format("PC {:>5}: {}", issue.pc, instruction_text(issue.instruction->encoding));
      const DecodedInstruction& instruction = *issue.instruction;
      if (!model.instruction_under_way(warp)) {
        text += "; has retired, the next one is being fetched";
      } else if (instruction.alu() == AluType::Mem) {
        text += fmt::format("; waits for memory ({} line reads under way)", reads_);
      } else if (instruction.opcode == Opcode::Rin) {
        text += fmt::format(
            "; waits for import ({}; {} packages announced and not come)",
            model.core().slices().input_complete(warp) ? "its packages have come" : "its packages have not come",
            model.core().slices().packages_expected());
      } else if (instruction.kind == Kind::Swap) {
        text += "; waits for its output slice to be exported";
      } else {
        text += "; waits for dispatch or ALU " + std::string(alu_info(instruction.alu()).name);
      }
      text += '\n';
    }
    return text;
  }

  [[noreturn]] void hang() const {
    const UnitOutputs& out = rtl_->outputs();
    const auto port = [](bool valid) { return valid ? "valid, not taken" : "nothing to send"; };
    std::string text;
    for (uint32_t unit = 0; unit < model_.units.size(); ++unit) text += warp_lines(unit);
    throw Mismatch{
        fmt::format("hang: no instruction retired and nothing passed a port for {} cycles", options_.watchdog_cycles),
        text +
            fmt::format("  ports: memory request {}; import request {}; export {}; frame {}; line reads under way {}\n",
                        port(out.memory_request_valid), port(out.import_request_valid), port(out.export_valid),
                        port(out.frame_valid), reads_),
        "RTL and model wait alike: the host that should answer, or what the warps above wait for"};
  }

  std::string report(const Mismatch& mismatch) const {
    std::string kernel = "before the first kernel";
    if (kernels_started_ > 0) {
      const LaunchCommand& launched = model_.units[mismatch.unit]->launcher().newest();
      const auto name = options_.kernel_names.find(launched.pc);
      kernel = fmt::format("kernel: {}entry PC {}, {} threads, block {}; {} launched so far",
                           name == options_.kernel_names.end() ? "" : name->second + ", ", launched.pc,
                           launched.threads, launched.block, kernels_started_);
    }
    std::string text = fmt::format("lockstep difference in {}: {}\n  cycle {}, {}\n", options_.name, mismatch.title,
                                   counts_.cycles, kernel);
    if (mismatch.context == Context::Unit) return text + mismatch.details + last_lines(mismatch);

    const CycleUnit::Issue& issue = model_.units[mismatch.unit]->issue(mismatch.warp);
    const std::string warp = (model_.units.size() > 1 ? fmt::format("unit {}, ", mismatch.unit) : "") +
                             fmt::format("warp {}", mismatch.warp);
    const bool operands = mismatch.context >= Context::Instruction && issue.instruction != nullptr;
    if (operands) {
      text += fmt::format("  {}, PC {}: {}\n  encoding {:016x}, thread mask {} (lane 0 rightmost)\n", warp, issue.pc,
                          instruction_text(issue.instruction->encoding), issue.instruction->encoding,
                          mask_text(issue.mask, lanes_));
    }
    text += mismatch.details;
    if (operands && mismatch.context == Context::Operands) text += lane_table(issue, lanes_, nullptr, nullptr);
    const History& history = histories_[mismatch.unit * warps_ + mismatch.warp];
    if (history.count > 0) {
      text += fmt::format("  {} before it (cycle, PC, instruction; latest last):\n", warp);
      for (uint64_t i = history.count - std::min<uint64_t>(history.count, kHistory); i < history.count; ++i) {
        const Retired& retired = history.retired[i % kHistory];
        text += fmt::format("  {:>10} {:>6}  {}\n", retired.cycle, retired.pc, instruction_text(retired.encoding));
      }
    }
    return text + last_lines(mismatch);
  }

  // Whether there is more to know than this run does.
  bool can_inspect() const { return !inspection_ && Inspection(configuration_, *rtl_, model_.units).active(); }

  // At most three files, those of what was found inside before those that the kind of difference suggests.
  std::string last_lines(const Mismatch& mismatch) const {
    std::string text, files;
    for (const Finding& finding : inside()) {
      const uint64_t ago = model_.units[0]->now() - finding.cycle;
      text += fmt::format("  inside, {}: {}\n", ago == 0 ? "in this cycle" : fmt::format("{} cycles before", ago),
                          finding.text);
      files += finding.files + ", ";
    }
    return text + "  look at: " + first_files(files + mismatch.module, 3) + "\n  so far " + to_string(counts_);
  }

  Configuration configuration_;
  LockstepOptions options_;
  uint32_t warps_;
  int lanes_;
  std::unique_ptr<ComputeUnit> rtl_;
  Model model_;
  LockstepCounts counts_;
  uint64_t kernels_started_ = 0;
  bool fault_seen_ = false;  // of a unit of both, which has stopped
  bool was_idle_ = true;
  int64_t reads_ = 0;          // lines requested and not answered completely
  uint64_t import_beats_ = 0;  // of packages that have been promised, to come
  uint64_t last_progress_ = 0;
  std::vector<History> histories_;  // [unit][warp]
  std::optional<Inspection> inspection_;

  std::string report_;
  Comparison comparison_;
};

// Its title and cycle.
std::string first_lines(const std::string& report) {
  return report.substr(0, report.find(',', report.find("\n  cycle ")));
}

}  // namespace

void inspect_differences(const std::function<void(uint64_t inspect_until)>& run) {
  try {
    run(0);
  } catch (const LockstepDifference& first) {
    if (first.inspect_until == 0) throw;
    std::string otherwise = "without a difference";
    try {
      run(first.inspect_until);
    } catch (const LockstepDifference& inspected) {
      if (first_lines(inspected.what()) == first_lines(first.what())) throw;
      otherwise = inspected.what();
    } catch (const std::exception& error) {
      otherwise = error.what();
    }
    throw LockstepDifference(fmt::format(
        "{}\n  run again for a look inside, it went otherwise, which equal runs do not: {}", first.what(), otherwise));
  }
}

LockstepCounts& LockstepCounts::operator+=(const LockstepCounts& other) {
  cycles += other.cycles;
  kernels += other.kernels;
  instructions += other.instructions;
  thread_results += other.thread_results;
  stores += other.stores;
  memory_reads += other.memory_reads;
  memory_writes += other.memory_writes;
  ray_words += other.ray_words;
  imports += other.imports;
  exports += other.exports;
  frame_contributions += other.frame_contributions;
  counters += other.counters;
  faults += other.faults;
  differences += other.differences;
  return *this;
}

std::string to_string(const LockstepCounts& counts) {
  return fmt::format(
      "lockstep: {} cycles, {} kernels, {} instructions ({} thread results), {} stored words, {} memory reads, {} "
      "memory writes, "
      "{} ray words, {} imports, {} exports, {} frame contributions, {} times all counters, {} faults compared; {} "
      "differences",
      counts.cycles, counts.kernels, counts.instructions, counts.thread_results, counts.stores, counts.memory_reads,
      counts.memory_writes, counts.ray_words, counts.imports, counts.exports, counts.frame_contributions,
      counts.counters, counts.faults, counts.differences);
}

std::unique_ptr<LockstepUnit> make_lockstep_unit(const Configuration& configuration, std::unique_ptr<ComputeUnit> rtl,
                                                 const Memory& memory, const LockstepOptions& options) {
  return std::make_unique<LockstepUnitImpl>(configuration, std::move(rtl), memory, options);
}

}  // namespace raypool
