// A level that changes over time: its mean and its peak.
#pragma once

#include <algorithm>
#include <cstdint>

namespace raypool::chip {

class LevelStatistics {
 public:
  /// The level is `level` from cycle `cycle` on.
  void set(uint64_t cycle, uint32_t level) {
    if (level != level_) change(cycle, level);
  }
  uint32_t peak() const { return peak_; }
  /// Over cycles 0 .. end.
  double mean(uint64_t end) const { return end == 0 ? 0 : static_cast<double>(area_ + (end - since_) * level_) / end; }

 private:
  [[gnu::noinline]] void change(uint64_t cycle, uint32_t level) {
    area_ += (cycle - since_) * level_;
    since_ = cycle;
    level_ = level;
    peak_ = std::max(peak_, level);
  }

  uint64_t area_ = 0, since_ = 0;
  uint32_t level_ = 0, peak_ = 0;
};

}  // namespace raypool::chip
