#include "lockstep/lockstep_unit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <deque>
#include <utility>
#include <vector>

#include "lockstep/checkers.hpp"
#include "lockstep/text.hpp"
#include "machine/functional_core.hpp"

namespace raypool {
namespace {

using namespace lockstep;

constexpr size_t kHistory = 8;
// The idle output may lag behind the last event by its registers.
constexpr int kIdleCycles = 4;
// An instruction that faults may retire, and the fault output follow it.
constexpr uint64_t kFaultCycles = 8;

class LockstepUnitImpl : public LockstepUnit {
 public:
  LockstepUnitImpl(const Configuration& configuration, std::unique_ptr<ComputeUnit> rtl, const Memory& initial,
                   const LockstepOptions& options)
      : options_(options),
        warps_(configuration.warps),
        lanes_(configuration.cores),
        rtl_(std::move(rtl)),
        memory_(initial),
        core_(configuration, memory_),
        histories_(static_cast<size_t>(configuration.warps)),
        retirement_(lanes_, counts_),
        stores_(warps_, counts_),
        memory_port_(counts_),
        ray_writes_(warps_, lanes_, counts_),
        exports_(counts_),
        frame_(counts_) {
    rtl_->trace_on();
  }

  void reset(uint32_t program_length, uint32_t memory_limit) override {
    rtl_->reset(program_length, memory_limit);
    core_.reset(program_length, memory_limit);
    launches_.clear();
    beats_ = 0;
    kernels_started_ = kernels_ended_ = kernels_done_ = 0;
    fault_seen_ = fault_expected_ = false;
    idle_cycles_ = 0;
    reads_ = 0;
    last_progress_ = counts_.cycles;
    for (History& history : histories_) history.count = 0;
    stores_.reset();
    memory_port_.reset();
    ray_writes_.reset();
    imports_.reset();
    exports_.reset();
    frame_.reset();
    stability_.reset();
  }

  void set_argument(int index, uint32_t value) override {
    rtl_->set_argument(index, value);
    core_.set_argument(index, value);
    stability_.reset();
  }

  const UnitOutputs& outputs() const override { return rtl_->outputs(); }
  void trace_on() override {}  // it always is
  const UnitTrace& trace() const override { return rtl_->trace(); }
  uint64_t counter(int number) override { return rtl_->counter(number); }
  bool timed() const override { return rtl_->timed(); }
  void open_waveform(const std::string& path) override { rtl_->open_waveform(path); }
  const LockstepCounts& counts() const override { return counts_; }
  void set_memory(const Memory& memory) override { memory_ = memory; }

  void clock(const UnitInputs& inputs) override {
    if (!report_.empty()) throw LockstepDifference(report_);
    try {
      if (!fault_seen_) transfers(inputs);
      rtl_->clock(inputs);
      ++counts_.cycles;
      if (!fault_seen_) check_cycle();
    } catch (const Mismatch& mismatch) {
      counts_.differences = 1;
      report_ = report(mismatch);
      throw LockstepDifference(report_);
    }
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

  // What passes the ports at the end of the current cycle.
  void transfers(const UnitInputs& inputs) {
    const UnitOutputs& out = rtl_->outputs();
    stability_.remember(out, inputs);
    bool progress = false;
    if (out.launch_ready && inputs.launch_valid) {
      launches_.push_back(inputs.launch);
      if (inputs.launch.import != ImportKind::None) {
        core_.expect_import(inputs.launch.threads);
        imports_.expect(inputs.launch.import, inputs.launch.threads);
      }
      progress = true;
    }
    if (out.memory_request_valid && inputs.memory_request_ready) {
      if (!out.memory_request.write) {
        ++reads_;
      } else if (options_.check_memory_port) {
        memory_port_.written(out.memory_request);
      }
      progress = true;
    }
    if (inputs.memory_response_valid) {
      if (inputs.memory_response.beat == 3) --reads_;
      progress = true;
    }
    if (out.import_request_valid && inputs.import_request_ready) {
      imports_.requested(out.import_request_kind);
      progress = true;
    }
    if (inputs.import_beat_valid) {
      take_beat(inputs.import_beat);
      progress = true;
    }
    if (out.export_valid && inputs.export_ready) {
      exports_.beat(out.export_data, out.export_last);
      progress = true;
    }
    if (out.frame_valid && inputs.frame_ready) {
      frame_.seen(out.frame);
      progress = true;
    }
    if (progress) last_progress_ = counts_.cycles;
  }

  void take_beat(const Beat& beat) {
    for (size_t i = 0; i < kBeatWords; ++i) {
      const size_t number = beats_ * kBeatWords + i;
      if (number < kIntersectionWords) package_[number] = beat[i];
    }
    if (++beats_ < kIntersectionBeats) return;
    beats_ = 0;
    core_.import_package(package_);
    ++counts_.imports;
  }

  // What outputs and trace show after the clock.
  void check_cycle() {
    const UnitOutputs& out = rtl_->outputs();
    const UnitTrace& trace = rtl_->trace();
    stability_.check(out);
    for (const StoreEvent& event : trace.stores) {
      stores_.traced(event);
      if (options_.check_memory_port) memory_port_.traced(event);
    }
    for (const RayWriteEvent& event : trace.ray_writes) ray_writes_.traced(event);
    for (const RetireEvent& event : trace.retired) retire(event);
    if (!trace.retired.empty()) last_progress_ = counts_.cycles;
    if (out.kernel_done) {
      ++kernels_done_;
      if (kernels_done_ > kernels_ended_) {
        throw Mismatch{"the RTL reports a kernel as done, and in the model it has warps that have not executed exit",
                       warp_lines(), "rtl/launcher.v, rtl/compute_unit.v", Context::Unit};
      }
      ++counts_.kernels;
    }
    if (out.fault.code != FaultCode::None && !fault_seen_) check_fault(out.fault);
    if (fault_seen_) return;
    if (fault_expected_ && counts_.cycles >= fault_deadline_) {
      const bool operands = context_.instruction != nullptr && context_.instruction->legal();
      throw Mismatch{"the RTL executed an instruction at which the model faults",
                     "  model: " + fault_text(core_.step(context_.warp).fault) + "\n", module_of(context_.instruction),
                     operands ? Context::Operands : Context::Warp};
    }
    idle_cycles_ = out.idle ? idle_cycles_ + 1 : 0;
    if (idle_cycles_ == kIdleCycles) check_idle();
    if (options_.watchdog_cycles != 0 && out.busy && counts_.cycles - last_progress_ > options_.watchdog_cycles) hang();
  }

  // The model starts a kernel when the RTL first shows that it runs.
  void start_kernel() {
    if (core_.running() || launches_.empty()) return;
    core_.launch(launches_.front());
    launches_.pop_front();
    ++kernels_started_;
  }

  void retire(const RetireEvent& event) {
    if (fault_expected_) return;  // the model has stopped
    start_kernel();
    context_.warp = event.warp;
    if (!core_.warp_running(event.warp)) {
      throw Mismatch{fmt::format("warp {} retired PC {}, and in the model it is not running", event.warp, event.pc),
                     fmt::format("  RTL: {}\n", instruction_text(event.instruction)), "rtl/launcher.v, rtl/compute_unit.v",
                     Context::Unit};
    }
    look_ahead(event.warp);
    retirement_.check_place(event, context_);
    const Step& step = core_.step(event.warp);
    if (step.status == Step::Status::Fault) {
      fault_expected_ = true;
      fault_deadline_ = counts_.cycles + kFaultCycles;
      return;
    }
    if (step.status == Step::Status::WaitsForImport) {
      throw Mismatch{"the RTL executed rin before the warp's packages had come",
                     fmt::format("  packages still to come: {}\n", core_.slices().packages_expected()), "rtl/ray_alu.v",
                     Context::Instruction};
    }
    retirement_.check_result(event, step, context_);
    stores_.check(step);
    ray_writes_.check(step, context_);
    uint32_t mask = step.mask;
    for (uint32_t i = 0; i < step.ray_count + step.frame_count; ++i, mask &= mask - 1) {
      const Origin origin{step.warp, step.pc, static_cast<uint32_t>(__builtin_ctz(mask))};
      if (i < step.ray_count) {
        exports_.expect(step.rays[i], origin);
      } else {
        frame_.expect(step.frame[i], origin);
      }
    }
    if (step.warp_ended && !core_.running()) ++kernels_ended_;
    History& history = histories_[event.warp];
    history.retired[history.count++ % kHistory] = {counts_.cycles, event.pc, event.instruction};
  }

  // The instruction that the model's warp executes next, with its operands.
  void look_ahead(uint32_t warp) {
    context_.pc = core_.next_pc(warp);
    context_.instruction = core_.instruction_at(context_.pc);
    context_.mask = 0;
    if (context_.instruction == nullptr) return;
    const DecodedInstruction& instruction = *context_.instruction;
    context_.mask = core_.thread_mask(warp, instruction);
    context_.px = core_.predicate(warp, instruction.x & 15);
    context_.pb = core_.predicate(warp, instruction.rb);
    const size_t lanes = static_cast<size_t>(lanes_);
    std::memcpy(context_.a.data(), core_.register_row(warp, instruction.ra), lanes * sizeof(uint32_t));
    if (instruction.b_is_immediate) {
      std::fill_n(context_.b.begin(), lanes, instruction.immediate);
    } else {
      std::memcpy(context_.b.data(), core_.register_row(warp, instruction.rb), lanes * sizeof(uint32_t));
    }
  }

  // Is the fault that of a fetch beside the warp's current instruction? It stops the RTL before that instruction has retired.
  bool fetched_ahead(const Fault& rtl) const {
    if (rtl.code != FaultCode::PcOutsideProgram || !core_.warp_running(rtl.warp)) return false;
    const uint32_t pc = core_.next_pc(rtl.warp);
    const DecodedInstruction* current = core_.instruction_at(pc);
    return current != nullptr && current->legal() && !current->info->control && rtl.pc == pc + 1 &&
           core_.instruction_at(rtl.pc) == nullptr;
  }

  void check_fault(const Fault& rtl) {
    start_kernel();
    Fault model;
    if (rtl.warp < static_cast<uint32_t>(warps_)) {
      if (fetched_ahead(rtl)) {
        model = rtl;
      } else {
        model = core_.step(rtl.warp).fault;
      }
    }
    if (model.code != rtl.code || model.warp != rtl.warp || model.pc != rtl.pc) {
      throw Mismatch{"the RTL stopped with a fault that the model does not have",
                     "  RTL:   " + fault_text(rtl) + "\n  model: " + fault_text(model) + "\n" + warp_lines(),
                     module_of(core_.instruction_at(rtl.pc)), Context::Unit};
    }
    fault_seen_ = true;
    ++counts_.faults;
  }

  void check_idle() const {
    if (core_.running() || !launches_.empty() || kernels_done_ != kernels_ended_) {
      throw Mismatch{"the RTL is idle and the model is not",
                     fmt::format("  kernels ended: RTL {}, model {}; launches waiting in the model: {}\n", kernels_done_,
                                 kernels_ended_, launches_.size()) +
                         warp_lines(),
                     "rtl/launcher.v, rtl/compute_unit.v", Context::Unit};
    }
    if (options_.check_memory_port) memory_port_.check_idle();
    imports_.check_idle();
    exports_.check_idle();
    frame_.check_idle();
  }

  // Every warp's next instruction, and what it can be waiting for.
  std::string warp_lines() const {
    std::string text;
    for (uint32_t warp = 0; warp < static_cast<uint32_t>(warps_); ++warp) {
      text += fmt::format("  warp {:>2}: ", warp);
      if (!core_.warp_running(warp)) {
        text += launches_.empty() ? "not running\n" : "not running; a launch waits\n";
        continue;
      }
      const uint32_t pc = core_.next_pc(warp);
      const DecodedInstruction* instruction = core_.instruction_at(pc);
      text +=
          fmt::format("PC {:>5}: {}", pc, instruction ? instruction_text(instruction->encoding) : "outside the program: a fault");
      if (instruction != nullptr && !instruction->legal()) {
        text += "; illegal: a fault";
      } else if (instruction != nullptr && instruction->info->unit == Unit::Mem) {
        text += fmt::format("; waits for memory ({} line reads under way)", reads_);
      } else if (instruction != nullptr && instruction->info->mnemonic == "rin") {
        text += fmt::format("; waits for import ({}; {} packages announced and not come)",
                            core_.slices().input_complete(warp) ? "its packages have come" : "its packages have not come",
                            core_.slices().packages_expected());
      } else if (instruction != nullptr && (instruction->info->mnemonic == "rout" || instruction->info->mnemonic == "rfb")) {
        text += "; waits for its output slice to be exported";
      } else if (instruction != nullptr) {
        text += "; waits for fetch, dispatch or ALU " + std::string(kUnitNames[static_cast<size_t>(instruction->info->unit)]);
      }
      text += '\n';
    }
    return text;
  }

  [[noreturn]] void hang() {
    start_kernel();
    const UnitOutputs& out = rtl_->outputs();
    const auto port = [](bool valid) { return valid ? "valid, not taken" : "nothing to send"; };
    throw Mismatch{
        fmt::format("hang: no instruction retired and nothing passed a port for {} cycles", options_.watchdog_cycles),
        warp_lines() +
            fmt::format("  ports: memory request {}; import request {}; export {}; frame {}; line reads under way {}\n",
                        port(out.memory_request_valid), port(out.import_request_valid), port(out.export_valid),
                        port(out.frame_valid), reads_),
        "the blocks that the warps above wait for", Context::Unit};
  }

  std::string report(const Mismatch& mismatch) const {
    std::string kernel = "before the first kernel";
    if (kernels_started_ > 0) {
      const uint32_t entry = core_.launched().pc;
      const auto name = options_.kernel_names.find(entry);
      kernel = fmt::format("kernel launch {} ({}entry PC {}, {} threads, block {})", kernels_started_,
                           name == options_.kernel_names.end() ? "" : name->second + ", ", entry, core_.launched().threads,
                           core_.launched().block);
    }
    std::string text =
        fmt::format("lockstep difference in {}: {}\n  cycle {}, {}\n", options_.name, mismatch.title, counts_.cycles, kernel);
    if (mismatch.context >= Context::Instruction) {
      text += fmt::format("  warp {}, PC {}: {}\n  encoding {:016x}, thread mask {} (lane 0 rightmost)\n", context_.warp,
                          context_.pc, instruction_text(context_.instruction->encoding), context_.instruction->encoding,
                          mask_text(context_.mask, lanes_));
    }
    text += mismatch.details;
    if (mismatch.context == Context::Operands) text += lane_table(context_, lanes_, nullptr, nullptr);
    const History& history = histories_[context_.warp];
    if (mismatch.context != Context::Unit && history.count > 0) {
      text += fmt::format("  warp {} before it (cycle, PC, instruction; latest last):\n", context_.warp);
      for (uint64_t i = history.count - std::min<uint64_t>(history.count, kHistory); i < history.count; ++i) {
        const Retired& retired = history.retired[i % kHistory];
        text += fmt::format("  {:>10} {:>6}  {}\n", retired.cycle, retired.pc, instruction_text(retired.encoding));
      }
    }
    text += "  look at: " + mismatch.module + "\n  so far " + to_string(counts_);
    return text;
  }

  LockstepOptions options_;
  int warps_, lanes_;
  std::unique_ptr<ComputeUnit> rtl_;
  Memory memory_;
  FunctionalCore core_;
  LockstepCounts counts_;
  std::deque<LaunchCommand> launches_;  // accepted by the RTL, not started by the model
  Intersection package_{};
  size_t beats_ = 0;                                                     // of the package that is arriving
  uint64_t kernels_started_ = 0, kernels_ended_ = 0, kernels_done_ = 0;  // model, model, RTL
  bool fault_seen_ = false;                                              // both have stopped
  bool fault_expected_ = false;                                          // the model has stopped
  uint64_t fault_deadline_ = 0;
  int idle_cycles_ = 0;
  int64_t reads_ = 0;  // lines requested and not answered completely
  uint64_t last_progress_ = 0;
  InstructionContext context_;  // of the last instruction that retired
  std::vector<History> histories_;
  std::string report_;
  RetirementChecker retirement_;
  StoreChecker stores_;
  MemoryPortChecker memory_port_;
  RayWriteChecker ray_writes_;
  ImportChecker imports_;
  ExportChecker exports_;
  FrameChecker frame_;
  StabilityChecker stability_;
};

}  // namespace

LockstepCounts& LockstepCounts::operator+=(const LockstepCounts& other) {
  cycles += other.cycles;
  kernels += other.kernels;
  instructions += other.instructions;
  thread_results += other.thread_results;
  stores += other.stores;
  memory_writes += other.memory_writes;
  ray_words += other.ray_words;
  imports += other.imports;
  exports += other.exports;
  frame_contributions += other.frame_contributions;
  faults += other.faults;
  differences += other.differences;
  return *this;
}

std::string to_string(const LockstepCounts& counts) {
  return fmt::format(
      "lockstep: {} kernels, {} instructions ({} thread results), {} stored words ({} memory writes), {} ray words, {} imports, "
      "{} exports, "
      "{} frame contributions, {} faults compared in {} cycles; {} differences",
      counts.kernels, counts.instructions, counts.thread_results, counts.stores, counts.memory_writes, counts.ray_words,
      counts.imports, counts.exports, counts.frame_contributions, counts.faults, counts.cycles, counts.differences);
}

std::unique_ptr<LockstepUnit> make_lockstep_unit(const Configuration& configuration, std::unique_ptr<ComputeUnit> rtl,
                                                 const Memory& initial, const LockstepOptions& options) {
  return std::make_unique<LockstepUnitImpl>(configuration, std::move(rtl), initial, options);
}

}  // namespace raypool
