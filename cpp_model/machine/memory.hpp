// The machine's memory: bytes, little endian, addressed from 0. Program first, then data.
#pragma once

#include <cstdint>
#include <cstring>
#include <vector>

namespace raypool {

class Memory {
 public:
  explicit Memory(uint32_t bytes = 0) : bytes_(bytes, 0) {}

  uint32_t size() const { return static_cast<uint32_t>(bytes_.size()); }
  /// Grows to hold `bytes`; new bytes are zero.
  void grow(uint32_t bytes) {
    if (bytes > size()) bytes_.resize(bytes, 0);
  }

  /// The 32-bit word at `address`, which must be a multiple of 4; 0 beyond the end.
  uint32_t load(uint32_t address) const {
    uint32_t value = 0;
    if (uint64_t{address} + 4 <= bytes_.size()) std::memcpy(&value, &bytes_[address], 4);
    return value;
  }
  /// Ignored beyond the end.
  void store(uint32_t address, uint32_t value) {
    if (uint64_t{address} + 4 <= bytes_.size()) std::memcpy(&bytes_[address], &value, 4);
  }

 private:
  std::vector<uint8_t> bytes_;
};

}  // namespace raypool
