// The significands that benches of ALUs run with: each has its Verilated top, made by arith_widths in arith.cmake.
#pragma once

#include <cstdint>
#include <string>

namespace raypool {

/// A Verilated top and the parameter SIGNIFICAND that it was made with.
template <typename VerilatedTop, uint32_t kBits>
struct Significand {
  using Top = VerilatedTop;
  static constexpr uint32_t kSignificand = kBits;
  /// Random operands for it, where the full one has `full`: the tops of all short ones together try about as many.
  static constexpr int share(int full) { return kBits == 24 ? full : full / 4; }
};

/// Names the instances of a typed test: FltAlu/13.
struct SignificandName {
  template <typename Type>
  static std::string GetName(int) {
    return std::to_string(Type::kSignificand);
  }
};

}  // namespace raypool
