// What the Brh, Flt and Slw ALUs do with a lane's operands, by the operation numbers of the instruction table.
#pragma once

#include <cstdint>

#include "arith/arith.hpp"

namespace raypool {

using ModelFunction = uint32_t (*)(int operation, uint32_t a, uint32_t b, uint32_t c, arith::Mode mode);

/// Compares, and predicate logic on the bits 0 and 1 of c; control (24 ..) as a task with lanes decides.
inline uint32_t brh_model(int operation, uint32_t a, uint32_t b, uint32_t c, arith::Mode mode) {
  const auto x = static_cast<int32_t>(a), y = static_cast<int32_t>(b);
  const uint32_t first = c & 1, second = c >> 1 & 1;
  switch (operation) {
    case 0:
      return a == b;
    case 1:
      return a != b;
    case 2:
      return x < y;
    case 3:
      return x <= y;
    case 4:
      return x > y;
    case 5:
      return x >= y;
    case 6:
      return a < b;
    case 7:
      return a <= b;
    case 8:
      return a > b;
    case 9:
      return a >= b;
    case 10:
      return arith::equal(a, b, mode);
    case 11:
      return arith::not_equal(a, b, mode);
    case 12:
      return arith::less(a, b, mode);
    case 13:
      return arith::less_equal(a, b, mode);
    case 14:
      return arith::greater(a, b, mode);
    case 15:
      return arith::greater_equal(a, b, mode);
    case 16:
      return first & second;
    case 17:
      return first | second;
    case 18:
      return first ^ second;
    case 19:
      return first & ~second;
    case 25:  // jnone
      return 0;
    default:
      return 1;
  }
}

inline uint32_t flt_model(int operation, uint32_t a, uint32_t b, uint32_t c, arith::Mode mode) {
  switch (operation) {
    case 0:
      return arith::add(a, b, mode);
    case 1:
      return arith::sub(a, b, mode);
    case 2:
      return arith::mul(a, b, mode);
    case 3:
      return arith::min(a, b, mode);
    case 4:
      return arith::max(a, b, mode);
    case 5:
      return arith::to_int(a, mode);
    case 6:
      return arith::from_int(a, mode);
    default:
      return arith::fma(a, b, c, mode);
  }
}

inline uint32_t slw_model(int operation, uint32_t a, uint32_t b, uint32_t, arith::Mode mode) {
  switch (operation) {
    case 0:
      return arith::div(a, b, mode);
    case 1:
      return arith::sqrt(a, mode);
    case 2:
      return arith::rsqrt(a, mode);
    default:
      return arith::rcp(a, mode);
  }
}

}  // namespace raypool
