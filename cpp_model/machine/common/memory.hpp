// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The machine's memory: bytes, little endian, addressed from 0. Program first, then data.
#pragma once

#include <cstdint>
#include <cstring>
#include <unordered_map>
#include <vector>

#include "bits.hpp"

namespace raypool {

class Memory {
 public:
  explicit Memory(uint32_t bytes = 0) : bytes_(bytes, 0) {}

  uint32_t size() const { return size32(bytes_); }
  /// Grows to hold `bytes`; new bytes are zero.
  void grow(uint32_t bytes) {
    if (bytes > size()) bytes_.resize(bytes, 0);
  }

  /// From now on there is memory beyond the end too, as far as addresses reach; its words are different ones at first.
  void begin_far(uint64_t seed) {
    has_far_ = true;
    far_seed_ = seed;
  }

  /// The 32-bit word at `address`, which must be a multiple of 4; 0 beyond the end.
  uint32_t load(uint32_t address) const {
    uint32_t value = 0;
    if (uint64_t{address} + 4 <= bytes_.size())
      std::memcpy(&value, &bytes_[address], 4);
    else if (has_far_)
      value = load_far(address);
    return value;
  }
  /// Ignored beyond the end.
  void store(uint32_t address, uint32_t value) {
    if (uint64_t{address} + 4 <= bytes_.size())
      std::memcpy(&bytes_[address], &value, 4);
    else if (has_far_)
      far_[address] = value;
  }

 private:
  uint32_t load_far(uint32_t address) const {
    const auto stored = far_.find(address);
    if (stored != far_.end()) return stored->second;
    uint64_t mixed = (far_seed_ ^ address) * 0x9e3779b97f4a7c15u;
    mixed = (mixed ^ mixed >> 32) * 0xd1b54a32d192ed03u;
    return static_cast<uint32_t>(mixed >> 32);
  }

  std::vector<uint8_t> bytes_;
  bool has_far_ = false;
  uint64_t far_seed_ = 0;
  std::unordered_map<uint32_t, uint32_t> far_;  ///< [address] what was stored there
};

}  // namespace raypool
