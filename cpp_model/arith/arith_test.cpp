// The model of arithmetic against the host's SSE unit, whose MXCSR register is set to the mode under test, and against wider
// arithmetic.
#include "arith/arith.hpp"

#include <gtest/gtest.h>
#include <xmmintrin.h>

#include <algorithm>
#include <cstdio>

#include "arith/test_operands.hpp"

namespace raypool::arith {
namespace {

constexpr Mode kIeee{Subnormals::Ieee, SlowUnit::Exact};
constexpr Mode kFlush{Subnormals::Flush, SlowUnit::Exact};
constexpr uint64_t kSeed = 20240607;
constexpr int kPairs = 400000;

enum class Sse { Add, Sub, Mul, Div, Sqrt, Equal, Less, LessEqual };

/// One operation of the SSE unit with flush-to-zero and denormals-are-zero on or off; its NaN made canonical.
__attribute__((noinline)) uint32_t sse(Sse operation, uint32_t a, uint32_t b, bool flush) {
  const unsigned before = _mm_getcsr();
  _mm_setcsr(0x1f80u | (flush ? 0x8040u : 0u));
  volatile float x = detail::to_float(a), y = detail::to_float(b);
  const __m128 p = _mm_set_ss(x), q = _mm_set_ss(y);
  volatile float result = 0;
  volatile int truth = 0;
  switch (operation) {
    case Sse::Add:
      result = _mm_cvtss_f32(_mm_add_ss(p, q));
      break;
    case Sse::Sub:
      result = _mm_cvtss_f32(_mm_sub_ss(p, q));
      break;
    case Sse::Mul:
      result = _mm_cvtss_f32(_mm_mul_ss(p, q));
      break;
    case Sse::Div:
      result = _mm_cvtss_f32(_mm_div_ss(p, q));
      break;
    case Sse::Sqrt:
      result = _mm_cvtss_f32(_mm_sqrt_ss(p));
      break;
    case Sse::Equal:
      truth = _mm_comieq_ss(p, q) && !detail::is_nan(a) && !detail::is_nan(b);
      break;
    case Sse::Less:
      truth = _mm_comilt_ss(p, q) && !detail::is_nan(a) && !detail::is_nan(b);
      break;
    case Sse::LessEqual:
      truth = _mm_comile_ss(p, q) && !detail::is_nan(a) && !detail::is_nan(b);
      break;
  }
  _mm_setcsr(before);
  if (operation >= Sse::Equal) return static_cast<uint32_t>(truth);
  const uint32_t bits = detail::to_bits(result);
  return detail::is_nan(bits) ? kQuietNan : bits;
}

void check_pair(uint32_t a, uint32_t b) {
  for (const bool flush : {false, true}) {
    const Mode mode = flush ? kFlush : kIeee;
    const struct {
      const char* name;
      uint32_t ours, host;
    } cases[] = {
        {"add", add(a, b, mode), sse(Sse::Add, a, b, flush)},
        {"sub", sub(a, b, mode), sse(Sse::Sub, a, b, flush)},
        {"mul", mul(a, b, mode), sse(Sse::Mul, a, b, flush)},
        {"div", div(a, b, mode), sse(Sse::Div, a, b, flush)},
        {"rcp", rcp(a, mode), sse(Sse::Div, 0x3f800000u, a, flush)},
        {"sqrt", sqrt(a, mode), sse(Sse::Sqrt, a, b, flush)},
        {"equal", equal(a, b, mode), sse(Sse::Equal, a, b, flush)},
        {"less", less(a, b, mode), sse(Sse::Less, a, b, flush)},
        {"less_equal", less_equal(a, b, mode), sse(Sse::LessEqual, a, b, flush)},
    };
    for (const auto& c : cases) {
      ASSERT_EQ(c.ours, c.host) << std::hex << c.name << ' ' << a << ' ' << b << (flush ? " flush" : " ieee") << " seed "
                                << std::dec << kSeed;
    }
  }
}

TEST(Arith, EveryPairOfSpecialValuesGivesWhatSseGives) {
  for (const uint32_t a : special_operands()) {
    for (const uint32_t b : special_operands()) check_pair(a, b);
  }
}

TEST(Arith, RandomPairsGiveWhatSseGives) {
  OperandSource source(kSeed);
  for (int i = 0; i < kPairs; ++i) {
    const auto [a, b] = source.next();
    check_pair(a, b);
    if (HasFatalFailure()) return;
  }
}

TEST(Arith, TinyProductsAreJudgedAfterRounding) {
  // All below 2^-126. The first rounds up to it at 24 bits and stays; the others have 24 bits themselves and are flushed,
  // although IEEE rounding to a multiple of 2^-149 gives 2^-126.
  const uint32_t below = 0x3f7ffffeu, next = 0x3f7fffffu, smallest = 0x00800000u;
  check_pair(0x00800001u, below);  // (1 + 2^-23)(1 - 2^-23)
  check_pair(0x00ffffffu, 0x3f000000u);
  check_pair(smallest, next);
  EXPECT_EQ(mul(0x00ffffffu, 0x3f000000u, kFlush), 0u);
  EXPECT_EQ(mul(0x00ffffffu, 0x3f000000u, kIeee), 0x00800000u);
  EXPECT_EQ(mul(0x00800001u, below, kFlush), 0x00800000u);
}

TEST(Arith, MinAndMaxPreferNumbersAndOrderZeros) {
  const uint32_t nan = 0x7f800001u, one = 0x3f800000u, minus_zero = 0x80000000u;
  for (const Mode mode : {kIeee, kFlush}) {
    EXPECT_EQ(min(nan, one, mode), one);
    EXPECT_EQ(max(one, nan, mode), one);
    EXPECT_EQ(min(nan, 0xffffffffu, mode), kQuietNan);
    EXPECT_EQ(min(0u, minus_zero, mode), minus_zero);
    EXPECT_EQ(max(minus_zero, 0u, mode), 0u);
    EXPECT_EQ(min(0xbf800000u, 0xc0000000u, mode), 0xc0000000u);
    EXPECT_EQ(max(0xbf800000u, 0xc0000000u, mode), 0xbf800000u);
  }
  EXPECT_EQ(max(1u, 0u, kIeee), 1u);
  EXPECT_EQ(max(1u, 0u, kFlush), 0u);
  EXPECT_EQ(min(nan, 0x80000001u, kFlush), minus_zero);
}

TEST(Arith, ConversionsTruncateAndSaturate) {
  EXPECT_EQ(to_int(detail::to_bits(-1.99f), kIeee), 0xffffffffu);
  EXPECT_EQ(to_int(0x4effffffu, kIeee), 0x7fffff80u);
  EXPECT_EQ(to_int(0x4f000000u, kIeee), 0x7fffffffu);
  EXPECT_EQ(to_int(0xcf000000u, kIeee), 0x80000000u);
  EXPECT_EQ(to_int(0xcf000001u, kIeee), 0x80000000u);
  EXPECT_EQ(to_int(0xff800000u, kIeee), 0x80000000u);
  EXPECT_EQ(to_int(0xffc00000u, kIeee), 0u);
  EXPECT_EQ(from_int(0xffffffffu, kIeee), 0xbf800000u);
  EXPECT_EQ(from_int(0x01000001u, kIeee), 0x4b800000u);  // tie to even
  EXPECT_EQ(from_int(0x01000003u, kIeee), 0x4b800002u);
  EXPECT_EQ(from_int(0x7fffffffu, kIeee), 0x4f000000u);
}

/// Whether `result` is the float nearest to 1/sqrt(x), by comparing squares in 128-bit integers.
bool is_nearest_inverse_root(uint32_t x, uint32_t result) {
  // The result lies within half a unit if (r - u/2)^2 x < 1 < (r + u/2)^2 x; r has 24 bits, its middles 25.
  int exponent_x = static_cast<int>(x >> 23) - 127;
  uint64_t mantissa_x = (x & 0x7fffffu) | 0x800000u;
  if (x >> 23 == 0) {
    exponent_x = -126;
    mantissa_x = x;
  }
  const int exponent_r = static_cast<int>(result >> 23) - 127;
  const uint64_t mantissa_r = (result & 0x7fffffu) | 0x800000u;
  const uint64_t low = 2 * mantissa_r - 1, high = 2 * mantissa_r + 1;
  const int weight = -(2 * (exponent_r - 24) + exponent_x - 23);  // the bit that weighs 1
  const unsigned __int128 one = static_cast<unsigned __int128>(1) << weight;
  return static_cast<unsigned __int128>(low * low) *
         mantissa_x<one&& static_cast<unsigned __int128>(high * high) * mantissa_x> one;
}

TEST(Arith, InverseRootIsCorrectlyRounded) {
  // Every mantissa under two exponents; the rest is a power of two. One of them (403a18e3) is so near to a middle that doubles
  // fail.
  for (uint32_t x = 0x3f800000u; x < 0x40800000u; ++x) ASSERT_TRUE(is_nearest_inverse_root(x, rsqrt(x, kIeee))) << std::hex << x;
  for (uint32_t x = 1; x < 0x00800000u; x += 1009) ASSERT_TRUE(is_nearest_inverse_root(x, rsqrt(x, kIeee))) << std::hex << x;
  EXPECT_EQ(rsqrt(0u, kIeee), 0x7f800000u);
  EXPECT_EQ(rsqrt(0x80000000u, kIeee), 0xff800000u);
  EXPECT_EQ(rsqrt(0x80000001u, kIeee), kQuietNan);
  EXPECT_EQ(rsqrt(0x80000001u, kFlush), 0xff800000u);
  EXPECT_EQ(rsqrt(0x7f800000u, kIeee), 0u);
  EXPECT_EQ(rsqrt(0x40800000u, kIeee), 0x3f000000u);
}

struct Error {
  double largest = 0;  ///< units in the last place of the exact result
  double mean = 0;     ///< signed: negative means too near to zero
};

enum class Slow { Rcp, Rsqrt, Sqrt, Div };
constexpr const char* kSlowNames[] = {"frcp", "frsqrt", "fsqrt", "fdiv"};

Error measure(Slow operation, SlowUnit unit) {
  const Mode mode{Subnormals::Ieee, unit};
  std::mt19937_64 random(kSeed);
  Error error;
  constexpr int kSamples = 1000000;
  for (int i = 0; i < kSamples; ++i) {
    const uint32_t a = (static_cast<uint32_t>(random()) & 0x007fffffu) + (i & 1 ? 0x3f800000u : 0x40000000u);
    const uint32_t b = (static_cast<uint32_t>(random()) & 0x00ffffffu) + 0x3f800000u;
    const double x = detail::to_float(a), y = detail::to_float(b);
    uint32_t result = 0;
    double exact = 0;
    switch (operation) {
      case Slow::Rcp:
        result = rcp(a, mode), exact = 1 / x;
        break;
      case Slow::Rsqrt:
        result = rsqrt(a, mode), exact = 1 / std::sqrt(x);
        break;
      case Slow::Sqrt:
        result = sqrt(a, mode), exact = std::sqrt(x);
        break;
      case Slow::Div:
        result = div(a, b, mode), exact = x / y;
        break;
    }
    int exponent;
    std::frexp(exact, &exponent);
    const double units = (double{detail::to_float(result)} - exact) / std::ldexp(1.0, exponent - 24);
    error.largest = std::max(error.largest, std::fabs(units));
    error.mean += units / kSamples;
  }
  return error;
}

TEST(Arith, NewtonErrorsStayWithinTheirBounds) {
  // Rows of docs/numerics.md.
  const double bounds[4][4] = {{0.5001, 0.5001, 0.5001, 0.5001}, {1, 1, 1, 2}, {1000, 1200, 1200, 1200}, {8e4, 8e4, 8e4, 8e4}};
  const char* names[] = {"exact", "newton2", "newton1", "newton0"};
  for (int unit = 0; unit < 4; ++unit) {
    for (const Slow operation : {Slow::Rcp, Slow::Rsqrt, Slow::Sqrt, Slow::Div}) {
      const Error error = measure(operation, static_cast<SlowUnit>(unit));
      std::printf("%-8s %-7s largest %10.3f ulp, mean %+10.4f ulp\n", names[unit], kSlowNames[static_cast<int>(operation)],
                  error.largest, error.mean);
      EXPECT_LE(error.largest, bounds[unit][static_cast<int>(operation)])
          << names[unit] << kSlowNames[static_cast<int>(operation)];
    }
  }
}

TEST(Arith, NewtonReciprocalsOfPowersOfTwoAreExactWithTwoSteps) {
  const Mode mode{Subnormals::Ieee, SlowUnit::Newton2};
  for (int field = 1; field < 254; ++field) {
    const uint32_t power = static_cast<uint32_t>(field) << 23;
    EXPECT_EQ(rcp(power, mode), rcp(power, kIeee));
    EXPECT_EQ(div(0x40490fdbu, power, mode), div(0x40490fdbu, power, kIeee)) << field;
  }
}

TEST(Arith, NewtonResultsOutsideTheNormalRangeKeepTheRulesOfTheMode) {
  for (const SlowUnit unit : {SlowUnit::Newton0, SlowUnit::Newton1, SlowUnit::Newton2}) {
    const Mode ieee{Subnormals::Ieee, unit}, flush{Subnormals::Flush, unit};
    EXPECT_EQ(div(0x7f000000u, 0x00800000u, ieee), 0x7f800000u);
    EXPECT_EQ(rcp(1u, ieee), 0x7f800000u);
    EXPECT_EQ(rcp(0x80000001u, flush), 0xff800000u);
    EXPECT_EQ(rcp(0x7f7fffffu, flush), 0u);
    EXPECT_NEAR(static_cast<double>(rcp(0x7f7fffffu, ieee)), 0x200000, unit == SlowUnit::Newton0 ? 0x8000 : 0x100);
    EXPECT_EQ(div(1u, 0x7f7fffffu, ieee), 0u);
    EXPECT_EQ(rsqrt(0x7f800000u, ieee), 0u);
    EXPECT_EQ(rsqrt(0u, ieee), 0x7f800000u);
    EXPECT_EQ(sqrt(0xbf800000u, ieee), kQuietNan);
    EXPECT_EQ(sqrt(0x80000000u, ieee), 0x80000000u);
  }
}

}  // namespace
}  // namespace raypool::arith
