#include "cosim/cosim.hpp"

#include <fmt/format.h>

#include <array>
#include <deque>
#include <vector>

#include "bits.hpp"

namespace raypool {
namespace {

// After a fault the unit is watched longer than anything takes that was under way: nothing else may come of it. In the
// end every port is open, so that what could leave does.
constexpr uint64_t kFaultCycles = 600, kStalledFaultCycles = 100;
constexpr uint64_t kCyclesBeforeNext = 40;  ///< if there is another kernel

/// Memory and pools around one unit.
class RandomHost {
 public:
  RandomHost(ComputeUnit& unit, Memory& memory, const RandomProgram& program, uint64_t seed, RunObserver* observer)
      : unit_(unit),
        memory_(memory),
        program_(program),
        seed_(seed),
        stalls_(program.stalls, seed),
        observer_(observer) {}

  uint64_t run(uint64_t cycle_limit) {
    begin(0);
    for (; now_ < cycle_limit; ++now_) {
      if (program_.restart != 0 && now_ == program_.restart) {
        restore();
        begin(0);
        if (observer_ != nullptr) observer_->restart();
      }
      const UnitOutputs& outputs = unit_.outputs();
      if (outputs.fault.code != FaultCode::None) {
        if ((program_.faults & fault_bit(outputs.fault.code)) == 0) {
          throw ProgramFailure(fmt::format("fault {} of warp {} at PC {} in a program that must not end so",
                                           to_underlying(outputs.fault.code), outputs.fault.warp, outputs.fault.pc));
        }
        if (fault_cycles_ == 0 && observer_ != nullptr) observer_->faulted(unit_.faults());
        // What a device of one unit has taken beyond the kernel with the fault has not begun.
        const size_t next = unit_.units() == 1 ? ended_ + 1 : launched_;
        if (++fault_cycles_ == (next < program_.kernels.size() ? kCyclesBeforeNext : kFaultCycles)) {
          if (next >= program_.kernels.size()) return now_;
          begin(next);
          if (observer_ != nullptr) observer_->restart();
        }
      }
      ended_ += popcount(outputs.kernel_done);
      if (outputs.idle && !outputs.busy) {
        if (ended_ > first_) check_exports(outputs);
        if (launched_ == program_.kernels.size()) return now_;
        rewrite();
      }
      clock(outputs);
    }
    throw ProgramFailure(fmt::format("not finished after {} cycles", cycle_limit));
  }

 private:
  struct Line {
    uint8_t id;
    uint64_t ready;  ///< first cycle in which it may be answered
    std::array<uint32_t, 16> words;
  };

  // As nothing had been rewritten. What has been stored stays.
  void restore() {
    Rewrite original;
    for (const RandomProgram::Kernel& kernel : program_.kernels) {
      if (!kernel.rewrite) continue;
      for (const auto& [pc, instruction] : kernel.rewrite->code) original.code[pc] = program_.program.code[pc];
    }
    rewrite_memory(program_, original, memory_);
    arguments_ = program_.arguments;
  }

  void begin(size_t kernel) {
    unit_.reset(told_length(program_), told_limit(program_));
    for (int i = 0; i < kArguments; ++i) unit_.set_argument(i, arguments_[i]);
    first_ = launched_ = ended_ = rewritten_ = kernel;
    fault_cycles_ = 0;
    offered_ = false;
    lines_.clear();
    beat_ = import_beat_ = 0;
    packages_asked_ = packages_given_ = 0;
    left_ = {};
  }

  // Nothing is left: the units must have counted what has left, whatever engine they are.
  void check_exports(const UnitOutputs& outputs) const {
    for (uint32_t unit = 0; unit < unit_.units(); ++unit) {
      if (outputs.exports[unit] == left_[unit]) continue;
      throw ProgramFailure(fmt::format("unit {} has counted {} exports when it is idle, and {} have left", unit,
                                       outputs.exports[unit], left_[unit]));
    }
  }

  // The unit is idle: the next kernel finds what it is to find.
  void rewrite() {
    const std::optional<Rewrite>& rewrite = program_.kernels[launched_].rewrite;
    if (!rewrite || rewritten_ == launched_ + 1) return;
    rewritten_ = launched_ + 1;
    rewrite_memory(program_, *rewrite, memory_);
    for (const auto& [number, value] : rewrite->arguments) {
      arguments_[number] = value;
      unit_.set_argument(static_cast<int>(number), value);
    }
  }

  bool open(Port port) const { return fault_cycles_ > kStalledFaultCycles || stalls_.open(port, now_); }

  void clock(const UnitOutputs& outputs) {
    UnitInputs inputs;
    serve_launch(outputs, inputs);
    // A beat that is given was asked for in an earlier cycle: the unit's outputs are registers.
    give_beat(inputs);
    give_package(inputs);
    serve_memory(outputs, inputs);
    inputs.import_request_ready = open(Port::ImportRequest);
    if (inputs.import_request_ready && outputs.import_request_valid) ++packages_asked_;
    inputs.export_ready = open(Port::Export);
    inputs.frame_ready = open(Port::Frame);
    if (outputs.export_valid && inputs.export_ready && outputs.export_last) ++left_[outputs.export_unit];
    if (outputs.frame_valid && inputs.frame_ready) ++left_[outputs.frame_unit];
    if (observer_ != nullptr) observer_->cycle(outputs, inputs, unit_.trace());
    unit_.clock(inputs);
  }

  void serve_launch(const UnitOutputs& outputs, UnitInputs& inputs) {
    // An offer stays until it is taken.
    if (launched_ == program_.kernels.size() || !(offered_ || open(Port::Launch))) return;
    const RandomProgram::Kernel& kernel = program_.kernels[launched_];
    if (kernel.rewrite && rewritten_ != launched_ + 1) return;
    inputs.launch_valid = true;
    inputs.launch.pc = kernel.pc;
    inputs.launch.threads = kernel.threads;
    inputs.launch.block = kernel.block;
    inputs.launch.blocks = kernel.blocks;
    inputs.launch.import = kernel.import;
    offered_ = !outputs.launch_ready;
    if (outputs.launch_ready) ++launched_;
  }

  void serve_memory(const UnitOutputs& outputs, UnitInputs& inputs) {
    inputs.memory_request_ready = open(Port::MemoryRequest);
    if (!inputs.memory_request_ready || !outputs.memory_request_valid) return;
    const MemoryRequest& request = outputs.memory_request;
    if (request.write) {
      for (uint32_t i = 0; i < kBeatWords; ++i)
        if (request.mask >> i & 1) memory_.store(request.address + 4 * i, request.data[i]);
      return;
    }
    Line line{request.id, now_ + stalls_.latency(now_), {}};
    for (uint32_t i = 0; i < line.words.size(); ++i) line.words[i] = memory_.load(request.address + 4 * i);
    lines_.push_back(line);
  }

  // Lines come back in any order, beats of a line in theirs and without another line between them.
  void give_beat(UnitInputs& inputs) {
    if (lines_.empty() || !open(Port::MemoryResponse)) return;
    if (beat_ == 0) {
      const size_t first = mix(seed_, 500, now_) % lines_.size();
      size_t n = 0;
      while (n < lines_.size() && lines_[(first + n) % lines_.size()].ready > now_) ++n;
      if (n == lines_.size()) return;
      sending_ = (first + n) % lines_.size();
    }
    const Line& line = lines_[sending_];
    inputs.memory_response_valid = true;
    inputs.memory_response.id = line.id;
    inputs.memory_response.beat = static_cast<uint8_t>(beat_);
    for (size_t i = 0; i < kBeatWords; ++i) inputs.memory_response.data[i] = line.words[beat_ * size_t{kBeatWords} + i];
    if (++beat_ < 4) return;
    beat_ = 0;
    lines_.erase(lines_.begin() + sending_);
  }

  void give_package(UnitInputs& inputs) {
    if (packages_given_ == packages_asked_ || !open(Port::ImportBeat)) return;
    inputs.import_beat_valid = true;
    for (size_t i = 0; i < kBeatWords; ++i) {
      const size_t word = import_beat_ * size_t{kBeatWords} + i;
      inputs.import_beat[i] =
          word < program_.intersection_words ? random_word(mix(seed_, 600 + word, packages_given_)) : 0;
    }
    if (++import_beat_ * kBeatWords < program_.intersection_words) return;
    import_beat_ = 0;
    ++packages_given_;
  }

  ComputeUnit& unit_;
  Memory& memory_;
  const RandomProgram& program_;
  uint64_t seed_;
  Stalls stalls_;
  RunObserver* observer_;
  uint64_t now_ = 0;
  uint64_t fault_cycles_ = 0;  ///< since the fault
  std::array<uint32_t, kArguments> arguments_ = program_.arguments;
  size_t launched_ = 0, ended_ = 0;
  size_t first_ = 0;      ///< kernel before which it has been reset
  size_t rewritten_ = 0;  ///< kernels before which it has been rewritten
  bool offered_ = false;  ///< and not taken
  std::vector<Line> lines_;
  size_t sending_ = 0;
  int beat_ = 0;  ///< of lines_[sending_]
  uint64_t packages_asked_ = 0, packages_given_ = 0;
  uint32_t import_beat_ = 0;
  std::array<uint16_t, kMostUnits> left_{};  ///< [unit] rays and contributions since the reset, modulo 2^16
};

}  // namespace

uint64_t run_random_program(ComputeUnit& unit, Memory& memory, const RandomProgram& program, uint64_t seed,
                            uint64_t cycle_limit, RunObserver* observer) {
  return RandomHost(unit, memory, program, seed, observer).run(cycle_limit);
}

}  // namespace raypool
