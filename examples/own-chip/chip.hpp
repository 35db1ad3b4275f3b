// A chip around a compute unit: memory that answers in order after `latency` cycles, and a grid of blocks to launch. It
// has no ray pools, so its programs use memory only.
#pragma once

#include <deque>
#include <raypool/machine/compute/compute_unit.hpp>
#include <stdexcept>

class Chip {
 public:
  Chip(raypool::ComputeUnit& unit, raypool::Memory& memory, uint64_t latency)
      : unit_(unit), memory_(memory), latency_(latency) {}

  /// Runs `blocks` blocks of `threads` threads from instruction `entry` on, and returns the cycles.
  uint64_t run(uint32_t entry, uint32_t threads, uint32_t blocks) {
    for (uint32_t launched = 0;; ++cycle_) {
      const raypool::UnitOutputs& out = unit_.outputs();
      if (out.fault.code != raypool::FaultCode::None) throw std::runtime_error("the program faults");
      if (launched == blocks && out.idle && lines_.empty()) return cycle_;

      raypool::UnitInputs in;
      in.launch_valid = launched < blocks;
      in.launch = {entry, threads, launched, blocks};
      if (in.launch_valid && out.launch_ready) ++launched;  // both set: the launch is taken in this cycle
      in.memory_request_ready = true;
      if (out.memory_request_valid) take(out.memory_request);
      if (!lines_.empty() && lines_.front().due <= cycle_) answer(in);
      unit_.clock(in);
    }
  }

 private:
  struct Line {
    uint64_t due;
    uint8_t id, beat;
    raypool::Beat data[4];
  };

  void take(const raypool::MemoryRequest& request) {
    if (request.write) {
      for (uint32_t i = 0; i < 4; ++i)
        if (request.mask >> i & 1) memory_.store(request.address + 4 * i, request.data[i]);
      return;
    }
    Line line{cycle_ + latency_, request.id, 0, {}};
    for (uint32_t i = 0; i < 16; ++i) line.data[i / 4][i % 4] = memory_.load(request.address + 4 * i);
    lines_.push_back(line);
  }

  /// A line comes back in four beats of 16 bytes, one a cycle.
  void answer(raypool::UnitInputs& in) {
    Line& line = lines_.front();
    in.memory_response_valid = true;
    in.memory_response = {line.id, line.beat, line.data[line.beat]};
    if (++line.beat == 4) lines_.pop_front();
  }

  raypool::ComputeUnit& unit_;
  raypool::Memory& memory_;
  uint64_t latency_, cycle_ = 0;
  std::deque<Line> lines_;
};
