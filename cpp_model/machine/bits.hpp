// Sets of warps, lanes, types as the bits of a word.
#pragma once

#include <cstdint>

namespace raypool {

/// Number of the lowest member of a set that is not empty.
inline uint32_t lowest(uint32_t set) { return static_cast<uint32_t>(__builtin_ctz(set)); }
inline uint64_t popcount(uint32_t set) { return static_cast<uint64_t>(__builtin_popcount(set)); }

}  // namespace raypool
