// Watches what on a board waits for an answer of the memory, and since when: an answer that is lost would never come.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>

#include "config/configuration.hpp"
#include "machine/chip/chip_device.hpp"
#include "machine/chip/memory_port.hpp"
#include "machine/common/port_cycles.hpp"

namespace raypool::chip {

class AnswerWatch {
 public:
  explicit AnswerWatch(const ChipConfiguration& chip) : limit_(limit(chip)) {}

  /// Cycles that no answer takes. Requests are served in the order in which they come, so before one of them are those
  /// that have room at the port and those on their way; even if the memory did one after the other, each of two lines,
  /// it would have all of them by then.
  static uint64_t limit(const ChipConfiguration& chip) {
    const auto limits = raypool::MemoryPort::Limits::of(chip);
    const uint64_t before = uint64_t{chip.memory_queue} + limits.traverser_queue + limits.lines + 1;
    return 2 * before * (chip.memory_latency + uint64_t{raypool::MemoryLine::kBeats} * chip.memory_cycles_per_beat);
  }

  /// What waits for a line, and since when, in a few words; none: nothing does.
  std::optional<std::string> waits() const;

  /// Once in a cycle: true if a requester has waited for too long.
  bool clock(uint64_t cycle, const ChipOutputs& outputs, const ChipInputs& inputs) {
    const bool moves = outputs.memory_request_valid || inputs.memory_beat_valid || outputs.tree_response_valid ||
                       outputs.traverser.tree_request_valid || outputs.device.memory_request_valid ||
                       outputs.to_device.memory_response_valid;
    return (moves || cycle >= due_) && look(cycle, outputs, inputs);
  }
  /// Cycle from which on clock() is true if no answer comes; before, a cycle without any needs no call.
  uint64_t due() const { return due_; }
  /// Which requester that is, in a sentence.
  std::string late() const;

 private:
  // A port at which lines are asked for, and come back in order.
  struct Port {
    const char *requester, *name;
    std::deque<uint64_t> asked{};  // cycles, the oldest first
    uint32_t beats = 0;            // of the oldest line, that have come

    void clock(uint64_t cycle, bool asks, bool beat);
  };
  bool look(uint64_t cycle, const ChipOutputs& outputs, const ChipInputs& inputs);
  // The first one that has waited for too long, or null.
  const Port* late_port() const;

  uint64_t limit_, cycle_ = 0, due_ = kNever;
  std::array<Port, 3> ports_{
      {{"the chip", "memory_request"}, {"the traverser", "tree_request"}, {"a unit", "device_request"}}};
};

}  // namespace raypool::chip
