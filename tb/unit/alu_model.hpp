// What the Flt and Slw ALUs do with a lane's operands, by the operation numbers of the instruction table.
#pragma once

#include <cstdint>

#include "arith/arith.hpp"

namespace raypool {

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
