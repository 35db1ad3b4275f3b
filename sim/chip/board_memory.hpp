// The memories on a board, the units' and the traverser's, behind the bus of the chip's memory port: they answer in
// order, each line with its last beat after the latency.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <stdexcept>

#include "config/configuration.hpp"
#include "machine/chip_device.hpp"
#include "machine/memory.hpp"
#include "machine/memory_port.hpp"

namespace raypool::chip {

class BoardMemory {
 public:
  /// chip.memory.latency must leave it a cycle (MemoryPort): least_latency() is enough. `tree`: the traverser's; null:
  /// it has none. Both must outlive it.
  BoardMemory(Memory& memory, Memory* tree, const ChipConfiguration& chip)
      : memory_(memory),
        tree_(tree),
        cycles_per_beat_(chip.memory_cycles_per_beat),
        first_beat_(chip.memory_latency - least_latency(chip) + 1) {}
  /// Of a line, from its service at the port to its last beat: the port has three cycles of them, and the beats.
  static uint64_t least_latency(const ChipConfiguration& chip) {
    return 3 + uint64_t{raypool::MemoryPort::kLineBeats - 1} * chip.memory_cycles_per_beat;
  }

  /// Shows what it has at the memory's ports.
  void offer(uint64_t cycle, ChipInputs& inputs) const {
    inputs.memory_request_ready = true;
    inputs.memory_beat_valid = !lines_.empty() && lines_.front().due <= cycle;
    if (inputs.memory_beat_valid) inputs.memory_beat_data = lines_.front().beats[next_beat_];
  }
  void clock(uint64_t cycle, const ChipOutputs& outputs, const ChipInputs& inputs) {
    if (inputs.memory_beat_valid && outputs.memory_beat_ready) give(cycle);
    if (outputs.memory_request_valid) take(cycle, outputs.memory_request);
  }
  bool busy() const { return !lines_.empty(); }

 private:
  struct Line {
    uint64_t due;  // its next beat
    std::array<Beat, raypool::MemoryPort::kLineBeats> beats;
  };

  void give(uint64_t cycle) {
    lines_.front().due = cycle + cycles_per_beat_;
    if (++next_beat_ < raypool::MemoryPort::kLineBeats) return;
    next_beat_ = 0;
    lines_.pop_front();
  }
  void take(uint64_t cycle, const raypool::MemoryPort::Access& access) {
    if (access.traverser && tree_ == nullptr) throw std::logic_error("the traverser has no memory");
    Memory& memory = access.traverser ? *tree_ : memory_;
    const MemoryRequest& request = access.request;
    if (request.write) {
      for (uint32_t word = 0; word < kBeatWords; ++word)
        if ((request.mask >> word & 1) != 0) memory.store(request.address + 4 * word, request.data[word]);
      return;
    }
    Line line{cycle + first_beat_, {}};
    uint32_t address = request.address;
    for (Beat& beat : line.beats)
      for (uint32_t& word : beat) word = memory.load(address), address += 4;
    lines_.push_back(line);
  }

  Memory& memory_;
  Memory* tree_;
  uint64_t cycles_per_beat_, first_beat_;
  std::deque<Line> lines_;
  uint32_t next_beat_ = 0;  // of the oldest line
};

}  // namespace raypool::chip
