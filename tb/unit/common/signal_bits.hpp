// Parts of a Verilated signal: up to 64 bits are a number, more are an array of words.
#pragma once

#include <cstdint>
#include <type_traits>

namespace raypool::bench {

/// `width` bits, 32 at most.
template <typename Signal>
void set_bits(Signal& signal, uint32_t first, uint32_t width, uint32_t value) {
  for (uint32_t bit = 0; bit < width; ++bit) {
    const uint32_t at = first + bit;
    if constexpr (std::is_integral_v<Signal>) {
      signal = static_cast<Signal>((signal & ~(uint64_t{1} << at)) | uint64_t{value >> bit & 1} << at);
    } else {
      signal[at / 32] = (signal[at / 32] & ~(1u << at % 32)) | (value >> bit & 1) << at % 32;
    }
  }
}

template <typename Signal>
uint32_t get_bits(const Signal& signal, uint32_t first, uint32_t width) {
  uint32_t value = 0;
  for (uint32_t bit = 0; bit < width; ++bit) {
    const uint32_t at = first + bit;
    if constexpr (std::is_integral_v<Signal>) {
      value |= static_cast<uint32_t>(uint64_t{signal} >> at & 1) << bit;
    } else {
      value |= (signal[at / 32] >> at % 32 & 1) << bit;
    }
  }
  return value;
}

}  // namespace raypool::bench
