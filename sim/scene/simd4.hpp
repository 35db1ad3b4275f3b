// Four floats at a time. Vector extensions of GCC and Clang give the operators; what they lack is below, for SSE and
// for any other machine. Every operation rounds as its scalar form does.
#pragma once

#include <cstring>
#if defined(__SSE__)
#include <xmmintrin.h>
#endif

namespace raypool {

using Float4 = float __attribute__((vector_size(16)));
using Int4 = int __attribute__((vector_size(16)));

inline Float4 load4(const float* p) {
  Float4 v;
  std::memcpy(&v, p, sizeof v);
  return v;
}
inline Float4 splat4(float x) { return Float4{x, x, x, x}; }

/// No argument may be a NaN.
inline Float4 min4(Float4 a, Float4 b) {
#if defined(__SSE__)
  return _mm_min_ps(a, b);
#else
  return a < b ? a : b;
#endif
}
inline Float4 max4(Float4 a, Float4 b) {
#if defined(__SSE__)
  return _mm_max_ps(a, b);
#else
  return a > b ? a : b;
#endif
}

/// Bit i is set when lane i of a comparison's result is true.
inline unsigned mask4(Int4 truth) {
#if defined(__SSE__)
  return static_cast<unsigned>(_mm_movemask_ps(reinterpret_cast<__m128>(truth)));
#else
  return static_cast<unsigned>((truth[0] & 1) | (truth[1] & 2) | (truth[2] & 4) | (truth[3] & 8));
#endif
}

}  // namespace raypool
