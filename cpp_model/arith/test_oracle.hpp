// Independent oracles for tests of arithmetic: the host's SSE unit (and its fused multiply-add), with MXCSR set to
// the mode, integers for frsqrt, and MPFR where the host has no such operation, or to judge another oracle, or where
// the significand is shorter. None shares code with the model.
#pragma once

#include <immintrin.h>
#include <mpfr.h>

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "arith/arith.hpp"
#include "bits.hpp"

namespace raypool::arith {

enum class Operation : uint8_t {
  Add,
  Sub,
  Mul,
  Fma,
  Min,
  Max,
  ToInt,
  FromInt,
  Div,
  Sqrt,
  Rsqrt,
  Rcp,
  Equal,
  NotEqual,
  Less,
  LessEqual,
  Greater,
  GreaterEqual
};
inline constexpr int kOperations = 18;
inline constexpr const char* kOperationNames[kOperations] = {"fadd", "fsub", "fmul", "ffma",  "fmin",   "fmax",
                                                             "f2i",  "i2f",  "fdiv", "fsqrt", "frsqrt", "frcp",
                                                             "feq",  "fne",  "flt",  "fle",   "fgt",    "fge"};

/// What the model gives; a truth value as 0 or 1.
inline uint32_t model(Operation operation, uint32_t a, uint32_t b, uint32_t c, Mode mode) {
  switch (operation) {
    case Operation::Add:
      return add(a, b, mode);
    case Operation::Sub:
      return sub(a, b, mode);
    case Operation::Mul:
      return mul(a, b, mode);
    case Operation::Fma:
      return fma(a, b, c, mode);
    case Operation::Min:
      return min(a, b, mode);
    case Operation::Max:
      return max(a, b, mode);
    case Operation::ToInt:
      return to_int(a, mode);
    case Operation::FromInt:
      return from_int(a, mode);
    case Operation::Div:
      return div(a, b, mode);
    case Operation::Sqrt:
      return sqrt(a, mode);
    case Operation::Rsqrt:
      return rsqrt(a, mode);
    case Operation::Rcp:
      return rcp(a, mode);
    case Operation::Equal:
      return equal(a, b, mode);
    case Operation::NotEqual:
      return not_equal(a, b, mode);
    case Operation::Less:
      return less(a, b, mode);
    case Operation::LessEqual:
      return less_equal(a, b, mode);
    case Operation::Greater:
      return greater(a, b, mode);
    case Operation::GreaterEqual:
      return greater_equal(a, b, mode);
  }
  return 0;
}

/// Operands of a block of operations; unused ones may hold anything.
struct OperandBlock {
  std::vector<uint32_t> a, b, c;
  size_t size() const { return a.size(); }
  void clear() { a.clear(), b.clear(), c.clear(); }
  void push(uint32_t first, uint32_t second, uint32_t third) {
    a.push_back(first), b.push_back(second), c.push_back(third);
  }
};

/// False if the host has no fused multiply-add: MPFR then judges all of ffma.
inline bool host_has_fma() { return __builtin_cpu_supports("fma") != 0; }

namespace oracle {

/// MXCSR with flush-to-zero and denormals-are-zero on or off, as long as it lives.
class HostMode {
 public:
  explicit HostMode(bool flush) : before_(_mm_getcsr()) { _mm_setcsr(0x1f80u | (flush ? 0x8040u : 0u)); }
  ~HostMode() { _mm_setcsr(before_); }
  HostMode(const HostMode&) = delete;
  HostMode& operator=(const HostMode&) = delete;

 private:
  unsigned before_;
};

// Loads and stores of volatile keep the operation between the two changes of MXCSR.
inline __m128 load(uint32_t bits) {
  volatile uint32_t held = bits;
  return _mm_castsi128_ps(_mm_cvtsi32_si128(static_cast<int>(held)));
}
inline bool not_a_number(uint32_t a) { return (a & 0x7fffffffu) > 0x7f800000u; }
inline uint32_t canonical_bits(__m128 value) {
  volatile uint32_t bits = static_cast<uint32_t>(_mm_cvtsi128_si32(_mm_castps_si128(value)));
  const uint32_t held = bits;
  return not_a_number(held) ? 0x7fc00000u : held;
}
/// Of a compare: its result is all ones or all zeros.
inline uint32_t truth(__m128 mask) {
  volatile int bits = _mm_cvtsi128_si32(_mm_castps_si128(mask));
  return bits != 0 ? 1 : 0;
}

__attribute__((noinline, target("fma"))) inline void fuse(const OperandBlock& in, std::vector<uint32_t>& out) {
  for (size_t i = 0; i < in.size(); ++i)
    out[i] = canonical_bits(_mm_fmadd_ss(load(in.a[i]), load(in.b[i]), load(in.c[i])));
}

template <typename Function>
__attribute__((noinline)) void each(const OperandBlock& in, std::vector<uint32_t>& out, Function function) {
  for (size_t i = 0; i < in.size(); ++i) out[i] = function(in.a[i], in.b[i]);
}

/// frsqrt in integers. x = v * 2^(2k) with v in 1 .. 4, and r/2^24 in 1/2 .. 1 is the rounded 1/sqrt(v) exactly if
/// (2r-1)^2 * v is below 2^50 and (2r+1)^2 * v above; an odd number above 1 divides no power of two, so there are no
/// ties. A double only gives the first guess.
inline uint32_t inverse_root(uint32_t x, bool flush) {
  const uint32_t sign = x & 0x80000000u, field = x >> 23 & 0xff;
  uint64_t mantissa = x & 0x007fffffu;
  if (field == 0 && (mantissa == 0 || flush)) return sign | 0x7f800000u;
  if (sign != 0 || (field == 255 && mantissa != 0)) return 0x7fc00000u;
  if (field == 255) return 0;
  int exponent = static_cast<int>(field == 0 ? 1 : field) - 127;
  if (field != 0) mantissa |= 0x00800000u;
  for (; mantissa < 0x00800000u; mantissa <<= 1) --exponent;
  if (exponent % 2 != 0) mantissa <<= 1, --exponent;
  constexpr unsigned __int128 kOne = static_cast<unsigned __int128>(1) << (50 + 23);
  const auto scaled_square = [&](uint64_t n) { return static_cast<unsigned __int128>(n * n) * mantissa; };
  auto r = static_cast<uint64_t>(0x1p24 / __builtin_sqrt(static_cast<double>(mantissa) * 0x1p-23));
  while (scaled_square(2 * r - 1) > kOne) --r;
  while (scaled_square(2 * r + 1) < kOne) ++r;
  // 2^24 is 1, every other r is below it and has its leading one at 2^23.
  const int half = exponent / 2;
  return r == 1u << 24 ? static_cast<uint32_t>(127 - half) << 23
                       : static_cast<uint32_t>(126 - half) << 23 | (static_cast<uint32_t>(r) & 0x007fffffu);
}

/// Numbers of so many bits in MPFR with single precision's exponents. Operands must have no more.
class Wide {
 public:
  explicit Wide(uint32_t significand) : least_exponent_(-124 - static_cast<int>(significand)) {
    mpfr_inits2(static_cast<mpfr_prec_t>(significand), a_, b_, c_, result_, static_cast<mpfr_ptr>(nullptr));
  }
  ~Wide() { mpfr_clears(a_, b_, c_, result_, static_cast<mpfr_ptr>(nullptr)); }
  Wide(const Wide&) = delete;
  Wide& operator=(const Wide&) = delete;

  uint32_t operator()(Operation operation, uint32_t a, uint32_t b, uint32_t c, bool flush) {
    mpfr_set_emax(128);
    mpfr_set_emin(least_exponent_);
    set(a_, a, flush), set(b_, b, flush), set(c_, c, flush);
    int inexact = 0;
    // Tiny is judged at the significand's bits, before the exponent's end is looked at.
    if (flush && operation != Operation::Min && operation != Operation::Max) mpfr_set_emin(-1000);
    switch (operation) {
      case Operation::Add:
        inexact = mpfr_add(result_, a_, b_, MPFR_RNDN);
        break;
      case Operation::Sub:
        inexact = mpfr_sub(result_, a_, b_, MPFR_RNDN);
        break;
      case Operation::Mul:
        inexact = mpfr_mul(result_, a_, b_, MPFR_RNDN);
        break;
      case Operation::Div:
        inexact = mpfr_div(result_, a_, b_, MPFR_RNDN);
        break;
      case Operation::Rcp:
        inexact = mpfr_ui_div(result_, 1, a_, MPFR_RNDN);
        break;
      case Operation::Sqrt:
        inexact = mpfr_sqrt(result_, a_, MPFR_RNDN);
        break;
      case Operation::FromInt:
        inexact = mpfr_set_si(result_, static_cast<int32_t>(a), MPFR_RNDN);
        break;
      case Operation::Min:
        mpfr_min(result_, a_, b_, MPFR_RNDN);
        break;
      case Operation::Max:
        mpfr_max(result_, a_, b_, MPFR_RNDN);
        break;
      case Operation::Rsqrt:
        // MPFR gives +infinity for -0; IEEE 754-2008, 9.2.1, gives the infinity of the zero's sign.
        inexact = mpfr_rec_sqrt(result_, a_, MPFR_RNDN);
        if (mpfr_zero_p(a_)) mpfr_setsign(result_, result_, mpfr_signbit(a_), MPFR_RNDN);
        break;
      default:
        inexact = mpfr_fma(result_, a_, b_, c_, MPFR_RNDN);
        break;
    }
    mpfr_set_emin(least_exponent_);
    if (!flush) mpfr_subnormalize(result_, inexact, MPFR_RNDN);
    if (mpfr_nan_p(result_)) return 0x7fc00000u;
    const bool tiny = flush && mpfr_regular_p(result_) && mpfr_get_exp(result_) < -125;
    return as_bits(tiny ? (mpfr_signbit(result_) ? -0.0f : 0.0f) : mpfr_get_flt(result_, MPFR_RNDN));
  }

 private:
  static void set(mpfr_t& wide, uint32_t bits, bool flush) {
    if (flush && (bits & 0x7f800000u) == 0) bits &= 0x80000000u;
    mpfr_set_flt(wide, as_float(bits), MPFR_RNDN);
  }

  int least_exponent_;  // of the smallest subnormal number, in MPFR's way
  mpfr_t a_, b_, c_, result_;
};

inline void wide(Operation operation, const OperandBlock& in, bool flush, std::vector<uint32_t>& out,
                 uint32_t significand = 24) {
  Wide numbers(significand);
  for (size_t i = 0; i < in.size(); ++i) out[i] = numbers(operation, in.a[i], in.b[i], in.c[i], flush);
}

/// The correct results of a block. `with_mpfr`: ffma and frsqrt by MPFR, though there is another oracle.
inline void results(Operation operation, const OperandBlock& in, bool flush, bool with_mpfr,
                    std::vector<uint32_t>& out) {
  out.resize(in.size());
  const HostMode mode(flush);
  switch (operation) {
    case Operation::Add:
      return each(in, out, [](uint32_t a, uint32_t b) { return canonical_bits(_mm_add_ss(load(a), load(b))); });
    case Operation::Sub:
      return each(in, out, [](uint32_t a, uint32_t b) { return canonical_bits(_mm_sub_ss(load(a), load(b))); });
    case Operation::Mul:
      return each(in, out, [](uint32_t a, uint32_t b) { return canonical_bits(_mm_mul_ss(load(a), load(b))); });
    case Operation::Div:
      return each(in, out, [](uint32_t a, uint32_t b) { return canonical_bits(_mm_div_ss(load(a), load(b))); });
    case Operation::Rcp:
      return each(in, out, [](uint32_t a, uint32_t) { return canonical_bits(_mm_div_ss(load(0x3f800000u), load(a))); });
    case Operation::Sqrt:
      return each(in, out, [](uint32_t a, uint32_t) { return canonical_bits(_mm_sqrt_ss(load(a))); });
    case Operation::FromInt:
      return each(in, out, [](uint32_t a, uint32_t) {
        return canonical_bits(_mm_cvtsi32_ss(_mm_setzero_ps(), static_cast<int>(a)));
      });
    case Operation::ToInt:
      // The host's 64-bit conversion, saturated; it gives its most negative number for whatever it cannot hold.
      return each(in, out, [](uint32_t a, uint32_t) {
        if (not_a_number(a)) return uint32_t{0};
        const int64_t whole = _mm_cvttss_si64(load(a));
        if (whole == INT64_MIN) return a >> 31 ? 0x80000000u : 0x7fffffffu;
        return static_cast<uint32_t>(whole < INT32_MIN ? INT32_MIN : whole > INT32_MAX ? INT32_MAX : whole);
      });
    case Operation::Equal:
      return each(in, out, [](uint32_t a, uint32_t b) { return truth(_mm_cmpeq_ss(load(a), load(b))); });
    case Operation::NotEqual:
      return each(in, out, [](uint32_t a, uint32_t b) { return truth(_mm_cmpneq_ss(load(a), load(b))); });
    case Operation::Less:
      return each(in, out, [](uint32_t a, uint32_t b) { return truth(_mm_cmplt_ss(load(a), load(b))); });
    case Operation::LessEqual:
      return each(in, out, [](uint32_t a, uint32_t b) { return truth(_mm_cmple_ss(load(a), load(b))); });
    case Operation::Greater:
      return each(in, out, [](uint32_t a, uint32_t b) { return truth(_mm_cmpgt_ss(load(a), load(b))); });
    case Operation::GreaterEqual:
      return each(in, out, [](uint32_t a, uint32_t b) { return truth(_mm_cmpge_ss(load(a), load(b))); });
    case Operation::Fma:
      if (host_has_fma() && !with_mpfr) return fuse(in, out);
      break;
    case Operation::Rsqrt:
      if (!with_mpfr) return each(in, out, [flush](uint32_t a, uint32_t) { return inverse_root(a, flush); });
      break;
    case Operation::Min:
    case Operation::Max:
      break;
  }
  const HostMode plain(false);
  wide(operation, in, flush, out);
}

/// The correct results of a block with a significand of less than 24 bits: of operands without the others.
inline void narrow_results(Operation operation, const OperandBlock& in, bool flush, uint32_t significand,
                           std::vector<uint32_t>& out) {
  OperandBlock cut = in;
  if (operation != Operation::FromInt) {
    for (std::vector<uint32_t>* operands : {&cut.a, &cut.b, &cut.c}) {
      for (uint32_t& operand : *operands) operand = operand >> (24 - significand) << (24 - significand);
    }
  }
  switch (operation) {
    case Operation::ToInt:
    case Operation::Equal:
    case Operation::NotEqual:
    case Operation::Less:
    case Operation::LessEqual:
    case Operation::Greater:
    case Operation::GreaterEqual:
      return results(operation, cut, flush, false, out);
    default:
      out.resize(in.size());
      wide(operation, cut, flush, out, significand);
  }
}

}  // namespace oracle
}  // namespace raypool::arith
