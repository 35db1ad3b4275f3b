// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// A signal of the Verilated RTL, read where it stands (ComputeUnit::signal). One that the engine has not reads as 0.
#pragma once

#include <cstdint>
#include <string>

#include "machine/compute/compute_unit.hpp"

namespace raypool::lockstep {

class Wire {
 public:
  Wire() = default;
  /// Of a ComputeUnit or a ChipDevice.
  template <typename Device>
  Wire(const Device& device, const std::string& scope, const std::string& name) {
    const Signal signal = device.signal(scope, name);
    if (signal.data == nullptr) return;
    data_ = signal.data;
    width_ = signal.bits;
  }

  bool present() const { return width_ != 0; }
  uint32_t width() const { return width_; }

  /// A signal of at most 32 bits.
  uint32_t value() const {
    // Verilator keeps it in the smallest integer that it fits.
    if (width_ <= 8) return *static_cast<const uint8_t*>(data_);
    if (width_ <= 16) return *static_cast<const uint16_t*>(data_);
    return *static_cast<const uint32_t*>(data_);
  }
  /// Bits low .. low + width - 1 of any signal; width is at most 32.
  uint32_t bits(uint32_t low, uint32_t width) const {
    if (low + width > width_) return 0;
    uint64_t value = 0;
    if (width_ <= 32) {
      value = this->value() >> low;
    } else if (width_ <= 64) {
      value = *static_cast<const uint64_t*>(data_) >> low;
    } else {
      const auto* words = static_cast<const uint32_t*>(data_) + low / 32;
      value = words[0];
      if (low % 32 + width > 32) value |= uint64_t{words[1]} << 32;
      value >>= low % 32;
    }
    return static_cast<uint32_t>(value & ((uint64_t{1} << width) - 1));
  }
  /// Bits from `low` on, 32 or as many as there are.
  uint32_t part(uint32_t low) const { return bits(low, width_ - low < 32 ? width_ - low : 32); }
  /// The same of up to 64 bits.
  uint64_t wide(uint32_t low, uint32_t width) const {
    return width <= 32 ? bits(low, width) : bits(low, 32) | uint64_t{bits(low + 32, width - 32)} << 32;
  }
  /// Number `index` of fields of 32 bits.
  uint32_t word(uint32_t index) const { return bits(32 * index, 32); }
  bool flag(uint32_t index) const { return bits(index, 1) != 0; }

 private:
  static constexpr uint64_t kNothing = 0;
  const void* data_ = &kNothing;
  uint32_t width_ = 0;
};

}  // namespace raypool::lockstep
