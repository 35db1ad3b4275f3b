// Banks of a memory, each with a row open: what a line of another row waits for.
#pragma once

#include <cstdint>
#include <vector>

#include "config/configuration.hpp"

namespace raypool::chip {

class MemoryRows {
 public:
  explicit MemoryRows(const ChipConfiguration& chip)
      : miss_(chip.memory_row_miss), row_bytes_(chip.memory_row_bytes), open_(chip.memory_banks, kNone) {}

  /// Opens the row of this address. Returns the cycles by which an access comes later for that. Rows that follow one
  /// another are in banks that do.
  uint64_t access(uint32_t address) {
    const uint32_t row = address / row_bytes_;
    uint32_t& open = open_[row % open_.size()];
    const bool hit = open == row;
    open = row;
    return hit ? 0 : miss_;
  }

 private:
  static constexpr uint32_t kNone = UINT32_MAX;

  uint64_t miss_;
  uint32_t row_bytes_;
  std::vector<uint32_t> open_;  // [bank] row
};

}  // namespace raypool::chip
