// For tests: a memory port that nobody else uses.
#pragma once

#include <algorithm>
#include <cstdint>

#include "traverser/tree_memory.hpp"

namespace raypool::test {

class LonelyPort : public traverser::MemoryTurns {
 public:
  explicit LonelyPort(uint32_t cycles_per_beat) : cycles_per_beat_(cycles_per_beat) {}
  uint64_t turn(uint64_t cycle, uint32_t beats) override {
    const uint64_t start = std::max(free_from_, cycle);
    free_from_ = start + beats * cycles_per_beat_;
    beats_ += beats;
    return start;
  }
  uint64_t line(uint64_t start, uint64_t end) override {
    last_ = std::max(end, std::max(last_, start) + 4 * cycles_per_beat_);
    return last_;
  }
  uint64_t beats() const { return beats_; }

 private:
  uint64_t cycles_per_beat_, free_from_ = 0, last_ = 0, beats_ = 0;
};

}  // namespace raypool::test
