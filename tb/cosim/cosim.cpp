#include "cosim/cosim.hpp"

#include <fmt/format.h>

#include <deque>
#include <random>

namespace raypool {
namespace {

/// Memory and pools around one unit, each with moods: for a while a port is quick, then slow.
class RandomHost {
 public:
  RandomHost(ComputeUnit& unit, Memory& memory, const RandomProgram& program, uint64_t seed)
      : unit_(unit), memory_(memory), program_(program), random_(seed) {}

  uint64_t run(uint64_t cycle_limit) {
    unit_.reset(static_cast<uint32_t>(program_.program.code.size()), memory_.size());
    for (int i = 0; i < kArguments; ++i) unit_.set_argument(i, program_.arguments[static_cast<size_t>(i)]);
    for (uint64_t cycle = 0; cycle < cycle_limit; ++cycle) {
      const UnitOutputs& outputs = unit_.outputs();
      if (outputs.fault.code != FaultCode::None)
        throw InputError(fmt::format("fault {} of warp {} at PC {}; random programs must not fault",
                                     static_cast<int>(outputs.fault.code), outputs.fault.warp, outputs.fault.pc));
      if (launched_ == program_.kernels.size() && outputs.idle && !outputs.busy) return cycle;
      if (cycle % 64 == 0) stall_ = 1 + random_() % 8;
      clock(outputs);
    }
    throw InputError(fmt::format("not finished after {} cycles", cycle_limit));
  }

 private:
  bool sometimes() { return random_() % stall_ == 0; }

  void clock(const UnitOutputs& outputs) {
    UnitInputs inputs;
    if (launched_ < program_.kernels.size() && sometimes()) {
      const auto& kernel = program_.kernels[launched_];
      inputs.launch_valid = true;
      inputs.launch = {program_.program.entries.at("main"), kernel.threads, kernel.block,
                       static_cast<uint32_t>(program_.kernels.size()), kernel.import};
      if (outputs.launch_ready) ++launched_;
    }
    serve_memory(outputs, inputs);
    serve_import(outputs, inputs);
    inputs.export_ready = sometimes();
    inputs.frame_ready = sometimes();
    unit_.clock(inputs);
    ++now_;
  }

  void serve_memory(const UnitOutputs& outputs, UnitInputs& inputs) {
    inputs.memory_request_ready = sometimes();
    if (inputs.memory_request_ready && outputs.memory_request_valid) {
      const MemoryRequest& request = outputs.memory_request;
      if (request.write) {
        for (uint32_t i = 0; i < kBeatWords; ++i)
          if (request.mask >> i & 1) memory_.store(request.address + 4 * i, request.data[i]);
      } else {
        Line line{request.id, now_ + 1 + random_() % (20 * stall_), 0, {}};
        for (uint32_t i = 0; i < 16; ++i) line.words[i] = memory_.load(request.address + 4 * i);
        lines_.push_back(line);
      }
    }
    // Lines come back in any order, beats of a line in theirs and without another line between them.
    if (lines_.empty() || !sometimes()) return;
    if (lines_[sending_ % lines_.size()].beat == 0) sending_ = random_() % lines_.size();
    Line& line = lines_[sending_ % lines_.size()];
    if (line.ready > now_) return;
    inputs.memory_response_valid = true;
    inputs.memory_response.id = line.id;
    inputs.memory_response.beat = line.beat;
    for (size_t i = 0; i < kBeatWords; ++i) inputs.memory_response.data[i] = line.words[line.beat * size_t{4} + i];
    if (++line.beat == 4) {
      lines_.erase(lines_.begin() + static_cast<std::ptrdiff_t>(sending_ % lines_.size()));
      sending_ = 0;
    }
  }

  void serve_import(const UnitOutputs& outputs, UnitInputs& inputs) {
    inputs.import_request_ready = sometimes();
    if (inputs.import_request_ready && outputs.import_request_valid) {
      Intersection package;
      for (auto& word : package) word = static_cast<uint32_t>(random_());
      packages_.push_back(package);
    }
    if (packages_.empty() || !sometimes()) return;
    inputs.import_beat_valid = true;
    for (size_t i = 0; i < kBeatWords; ++i) {
      const size_t word = import_beat_ * size_t{4} + i;
      inputs.import_beat[i] = word < packages_.front().size() ? packages_.front()[word] : 0;
    }
    if (++import_beat_ == kIntersectionBeats) {
      packages_.pop_front();
      import_beat_ = 0;
    }
  }

  struct Line {
    uint8_t id;
    uint64_t ready;
    uint8_t beat;
    std::array<uint32_t, 16> words;
  };

  ComputeUnit& unit_;
  Memory& memory_;
  const RandomProgram& program_;
  std::mt19937_64 random_;
  uint64_t now_ = 0;
  uint64_t stall_ = 1;
  size_t launched_ = 0;
  std::vector<Line> lines_;
  size_t sending_ = 0;
  std::deque<Intersection> packages_;
  int import_beat_ = 0;
};

}  // namespace

uint64_t run_random_program(ComputeUnit& unit, Memory& memory, const RandomProgram& program, uint64_t seed,
                            uint64_t cycle_limit) {
  return RandomHost(unit, memory, program, seed).run(cycle_limit);
}

}  // namespace raypool
