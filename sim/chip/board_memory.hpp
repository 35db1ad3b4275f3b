// The memories on a board, the units' and the traverser's, behind the bus of the chip's memory port: they answer in
// order, each line with its last beat when the memory has it.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <stdexcept>

#include "chip/memory_rows.hpp"
#include "config/configuration.hpp"
#include "machine/chip/chip_device.hpp"
#include "machine/chip/memory_port.hpp"
#include "machine/common/memory.hpp"

namespace raypool::chip {

/// What the memories hold, and how long they take.
class LineStore {
 public:
  using Line = std::array<Beat, raypool::MemoryLine::kBeats>;

  virtual ~LineStore() = default;
  /// Reads a line that is asked for in this cycle. Returns the cycles from its service at the chip's memory port to its
  /// last beat there: fewer than BoardMemory::least_latency() are that many.
  virtual uint64_t read(bool traverser, uint32_t address, Line& line) = 0;
  virtual void write(bool traverser, const MemoryRequest& request) = 0;
};

/// A read takes so many cycles, and what its row costs.
class FixedLatencyStore : public LineStore {
 public:
  /// `tree`: the traverser's; null: it has none. Both must outlive it.
  FixedLatencyStore(Memory& memory, Memory* tree, const ChipConfiguration& chip)
      : memory_(memory), tree_(tree), latency_(chip.memory_latency), rows_{MemoryRows(chip), MemoryRows(chip)} {}
  /// Without rows.
  FixedLatencyStore(Memory& memory, Memory* tree, uint64_t latency)
      : FixedLatencyStore(memory, tree, ChipConfiguration()) {
    latency_ = latency;
  }

  uint64_t read(bool traverser, uint32_t address, Line& line) override {
    const uint64_t latency = latency_ + rows_[traverser].access(address);
    for (Beat& beat : line)
      for (uint32_t& word : beat) word = of(traverser).load(address), address += 4;
    return latency;
  }
  void write(bool traverser, const MemoryRequest& request) override {
    rows_[traverser].access(request.address);
    for (uint32_t word = 0; word < kBeatWords; ++word)
      if ((request.mask >> word & 1) != 0) of(traverser).store(request.address + 4 * word, request.data[word]);
  }

 private:
  Memory& of(bool traverser) const {
    if (traverser && tree_ == nullptr) throw std::logic_error("the traverser has no memory");
    return traverser ? *tree_ : memory_;
  }

  Memory& memory_;
  Memory* tree_;
  uint64_t latency_;
  std::array<MemoryRows, 2> rows_;  // [traverser]
};

class BoardMemory {
 public:
  /// `store` must outlive it.
  BoardMemory(LineStore& store, const ChipConfiguration& chip)
      : store_(store), cycles_per_beat_(chip.memory_cycles_per_beat), least_latency_(least_latency(chip)) {}
  /// Of a line, from its service at the port to its last beat: the port has three cycles of them, and the beats.
  static uint64_t least_latency(const ChipConfiguration& chip) {
    return 3 + uint64_t{raypool::MemoryLine::kBeats - 1} * chip.memory_cycles_per_beat;
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
  /// Cycle of the next beat; kNever: none is on its way.
  uint64_t due() const { return lines_.empty() ? kNever : lines_.front().due; }

 private:
  struct Line {
    uint64_t due;  // its next beat
    LineStore::Line beats;
  };

  // The bus moves a beat at a time, whenever the memory has had the next line.
  void give(uint64_t cycle) {
    const uint64_t next = cycle + cycles_per_beat_;
    if (++next_beat_ < raypool::MemoryLine::kBeats) {
      lines_.front().due = next;
      return;
    }
    next_beat_ = 0;
    lines_.pop_front();
    if (!lines_.empty()) lines_.front().due = std::max(lines_.front().due, next);
  }
  void take(uint64_t cycle, const raypool::MemoryPort::Access& access) {
    const MemoryRequest& request = access.request;
    if (request.write) {
      store_.write(access.traverser, request);
      return;
    }
    Line line{};
    const uint64_t latency = std::max(store_.read(access.traverser, request.address, line.beats), least_latency_);
    line.due = cycle + latency - least_latency_ + 1;
    lines_.push_back(line);
  }

  LineStore& store_;
  uint64_t cycles_per_beat_, least_latency_;
  std::deque<Line> lines_;
  uint32_t next_beat_ = 0;  // of the oldest line
};

/// Throws InputError for a memory that is faster than the chip's port can be.
inline void check_memory_latency(const ChipConfiguration& chip) {
  const uint64_t least = BoardMemory::least_latency(chip);
  if (chip.memory_latency >= least) return;
  throw InputError(
      fmt::format("chip.memory.latency is {}; the chip in hardware takes {} at least, with {} cycles a beat",
                  chip.memory_latency, least, chip.memory_cycles_per_beat));
}

}  // namespace raypool::chip
