// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Sets of warps, lanes, types as the bits of a word; floats as bits; sizes as words.
#pragma once

#include <cstdint>
#include <cstring>

namespace raypool {

inline constexpr uint32_t kMostWarps = 32;

/// Number of the lowest member of a set that is not empty.
inline uint32_t lowest(uint32_t set) { return static_cast<uint32_t>(__builtin_ctz(set)); }
/// The lowest member as a set; of an empty set the empty set.
inline uint32_t lowest_bit(uint32_t set) { return set & (0u - set); }
/// Number of the leading one, from 0 on, of a word that is not 0.
inline int leading_one(uint64_t word) { return 63 - __builtin_clzll(word); }
inline uint64_t popcount(uint32_t set) { return static_cast<uint64_t>(__builtin_popcount(set)); }

/// Elements of a container: of code, memory, lanes there are never more than a word counts.
template <typename Container>
uint32_t size32(const Container& container) {
  return static_cast<uint32_t>(container.size());
}

inline uint32_t as_bits(float value) {
  uint32_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}
inline float as_float(uint32_t bits) {
  float value = 0;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

}  // namespace raypool
