// GLSL's functions in the kernel language: their errors against MPFR, their edges, and that machine code gives the bits
// of the same function run natively.
#include "shader/math.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mpfr.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include "bits.hpp"
#include "kernel/test_interpreter.hpp"
#include "random.hpp"

namespace raypool::shader::math {
namespace {

using kernel::NativeKernel;
using Operands = std::array<uint32_t, 4>;

using Ieee = NativeKernel<Subnormals::Ieee, SlowUnit::Exact>;
using Fused = NativeKernel<Subnormals::Ieee, SlowUnit::Exact, true>;
using Flush = NativeKernel<Subnormals::Flush, SlowUnit::Exact>;
using Newton2 = NativeKernel<Subnormals::Ieee, SlowUnit::Newton2>;
using Newton1 = NativeKernel<Subnormals::Flush, SlowUnit::Newton1, true>;
using Narrow = NativeKernel<Subnormals::Flush, SlowUnit::Newton0, true, true>;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// Runs a function of four words natively.
template <typename K, typename Function>
uint32_t native(const Function& function, const Operands& in, uint32_t significand = arith::kFullSignificand) {
  NativeThread thread;
  thread.mode = K::mode();
  thread.mode.significand = significand;
  K k(thread);
  using Int = typename K::Int;
  const Int result = function(k, Int(in[0]), Int(in[1]), Int(in[2]), Int(in[3]));
  return result.bits;
}

// A function of the header as one of four words that gives a word, for every K.
#define RAYPOOL_WORDS(expression)                                           \
  [](auto& k, const auto& a, const auto& b, const auto& c, const auto& d) { \
    (void)a, (void)b, (void)c, (void)d;                                     \
    return expression;                                                      \
  }

/// Calls visit(name, function) for every function of the header.
template <typename Visit>
// NOLINTNEXTLINE(readability-function-size): a list of functions
void each_function(const Visit& visit) {
  visit("trunc", RAYPOOL_WORDS(as_int(math::trunc(k, as_float(a)))));
  visit("floor", RAYPOOL_WORDS(as_int(math::floor(k, as_float(a)))));
  visit("ceil", RAYPOOL_WORDS(as_int(math::ceil(k, as_float(a)))));
  visit("round", RAYPOOL_WORDS(as_int(math::round(k, as_float(a)))));
  visit("fract", RAYPOOL_WORDS(as_int(math::fract(k, as_float(a)))));
  visit("modf_fraction", RAYPOOL_WORDS(as_int(math::modf_fraction(k, as_float(a)))));
  visit("abs", RAYPOOL_WORDS(as_int(math::abs(k, as_float(a)))));
  visit("sign", RAYPOOL_WORDS(as_int(math::sign(k, as_float(a)))));
  visit("sqrt", RAYPOOL_WORDS(as_int(math::sqrt(k, as_float(a)))));
  visit("inversesqrt", RAYPOOL_WORDS(as_int(math::inversesqrt(k, as_float(a)))));
  visit("radians", RAYPOOL_WORDS(as_int(math::radians(k, as_float(a)))));
  visit("degrees", RAYPOOL_WORDS(as_int(math::degrees(k, as_float(a)))));
  visit("sin", RAYPOOL_WORDS(as_int(math::sin(k, as_float(a)))));
  visit("cos", RAYPOOL_WORDS(as_int(math::cos(k, as_float(a)))));
  visit("tan", RAYPOOL_WORDS(as_int(math::tan(k, as_float(a)))));
  visit("asin", RAYPOOL_WORDS(as_int(math::asin(k, as_float(a)))));
  visit("acos", RAYPOOL_WORDS(as_int(math::acos(k, as_float(a)))));
  visit("atan", RAYPOOL_WORDS(as_int(math::atan(k, as_float(a)))));
  visit("exp2", RAYPOOL_WORDS(as_int(math::exp2(k, as_float(a)))));
  visit("exp", RAYPOOL_WORDS(as_int(math::exp(k, as_float(a)))));
  visit("log2", RAYPOOL_WORDS(as_int(math::log2(k, as_float(a)))));
  visit("log", RAYPOOL_WORDS(as_int(math::log(k, as_float(a)))));
  visit("sinh", RAYPOOL_WORDS(as_int(math::sinh(k, as_float(a)))));
  visit("cosh", RAYPOOL_WORDS(as_int(math::cosh(k, as_float(a)))));
  visit("tanh", RAYPOOL_WORDS(as_int(math::tanh(k, as_float(a)))));
  visit("asinh", RAYPOOL_WORDS(as_int(math::asinh(k, as_float(a)))));
  visit("acosh", RAYPOOL_WORDS(as_int(math::acosh(k, as_float(a)))));
  visit("atanh", RAYPOOL_WORDS(as_int(math::atanh(k, as_float(a)))));
  visit("frexp_significand", RAYPOOL_WORDS(as_int(math::frexp_significand(k, as_float(a)))));
  visit("mod", RAYPOOL_WORDS(as_int(math::mod(k, as_float(a), as_float(b)))));
  visit("rem", RAYPOOL_WORDS(as_int(math::rem(k, as_float(a), as_float(b)))));
  visit("min", RAYPOOL_WORDS(as_int(math::min(k, as_float(a), as_float(b)))));
  visit("max", RAYPOOL_WORDS(as_int(math::max(k, as_float(a), as_float(b)))));
  visit("step", RAYPOOL_WORDS(as_int(math::step(k, as_float(a), as_float(b)))));
  visit("atan2", RAYPOOL_WORDS(as_int(math::atan2(k, as_float(a), as_float(b)))));
  visit("pow", RAYPOOL_WORDS(as_int(math::pow(k, as_float(a), as_float(b)))));
  visit("clamp", RAYPOOL_WORDS(as_int(math::clamp(k, as_float(a), as_float(b), as_float(c)))));
  visit("smoothstep", RAYPOOL_WORDS(as_int(math::smoothstep(k, as_float(a), as_float(b), as_float(c)))));
  visit("mix", RAYPOOL_WORDS(as_int(math::mix(k, as_float(a), as_float(b), as_float(c)))));
  visit("ldexp", RAYPOOL_WORDS(as_int(math::ldexp(k, as_float(a), b))));
  visit("frexp_exponent", RAYPOOL_WORDS(math::frexp_exponent(k, as_float(a))));
  visit("isnan", RAYPOOL_WORDS(select(math::isnan(k, as_float(a)), a, b)));
  visit("isinf", RAYPOOL_WORDS(select(math::isinf(k, as_float(a)), a, b)));
  visit("unsigned_to_float", RAYPOOL_WORDS(as_int(math::unsigned_to_float(k, a))));
  visit("float_to_unsigned", RAYPOOL_WORDS(math::float_to_unsigned(k, as_float(a))));
  visit("pack_half_2x16", RAYPOOL_WORDS(math::pack_half_2x16(k, as_float(a), as_float(b))));
  visit("pack_unorm_2x16", RAYPOOL_WORDS(math::pack_unorm_2x16(k, as_float(a), as_float(b))));
  visit("pack_snorm_2x16", RAYPOOL_WORDS(math::pack_snorm_2x16(k, as_float(a), as_float(b))));
  visit("pack_unorm_4x8", RAYPOOL_WORDS(math::pack_unorm_4x8(k, as_float(a), as_float(b), as_float(c), as_float(d))));
  visit("pack_snorm_4x8", RAYPOOL_WORDS(math::pack_snorm_4x8(k, as_float(a), as_float(b), as_float(c), as_float(d))));
  visit("unpack_half_2x16.x", RAYPOOL_WORDS(as_int(math::unpack_half_2x16(k, a).x)));
  visit("unpack_half_2x16.y", RAYPOOL_WORDS(as_int(math::unpack_half_2x16(k, a).y)));
  visit("unpack_unorm_2x16.x", RAYPOOL_WORDS(as_int(math::unpack_unorm_2x16(k, a).x)));
  visit("unpack_unorm_2x16.y", RAYPOOL_WORDS(as_int(math::unpack_unorm_2x16(k, a).y)));
  visit("unpack_snorm_2x16.x", RAYPOOL_WORDS(as_int(math::unpack_snorm_2x16(k, a).x)));
  visit("unpack_snorm_2x16.y", RAYPOOL_WORDS(as_int(math::unpack_snorm_2x16(k, a).y)));
  visit("unpack_unorm_4x8.x", RAYPOOL_WORDS(as_int(math::unpack_unorm_4x8(k, a).x)));
  visit("unpack_unorm_4x8.y", RAYPOOL_WORDS(as_int(math::unpack_unorm_4x8(k, a).y)));
  visit("unpack_unorm_4x8.z", RAYPOOL_WORDS(as_int(math::unpack_unorm_4x8(k, a).z)));
  visit("unpack_unorm_4x8.w", RAYPOOL_WORDS(as_int(math::unpack_unorm_4x8(k, a).w)));
  visit("unpack_snorm_4x8.x", RAYPOOL_WORDS(as_int(math::unpack_snorm_4x8(k, a).x)));
  visit("unpack_snorm_4x8.y", RAYPOOL_WORDS(as_int(math::unpack_snorm_4x8(k, a).y)));
  visit("unpack_snorm_4x8.z", RAYPOOL_WORDS(as_int(math::unpack_snorm_4x8(k, a).z)));
  visit("unpack_snorm_4x8.w", RAYPOOL_WORDS(as_int(math::unpack_snorm_4x8(k, a).w)));
  visit("find_lsb", RAYPOOL_WORDS(math::find_lsb(k, a)));
  visit("find_umsb", RAYPOOL_WORDS(math::find_umsb(k, a)));
  visit("find_smsb", RAYPOOL_WORDS(math::find_smsb(k, a)));
  visit("bit_count", RAYPOOL_WORDS(math::bit_count(k, a)));
  visit("bit_reverse", RAYPOOL_WORDS(math::bit_reverse(k, a)));
  visit("abs of int", RAYPOOL_WORDS(math::abs(k, a)));
  visit("sign of int", RAYPOOL_WORDS(math::sign(k, a)));
  visit("clamp of int", RAYPOOL_WORDS(math::clamp(k, a, b, c)));
  visit("clamp_unsigned", RAYPOOL_WORDS(math::clamp_unsigned(k, a, b, c)));
  visit("bitfield_extract_signed", RAYPOOL_WORDS(math::bitfield_extract_signed(k, a, b, c)));
  visit("bitfield_extract_unsigned", RAYPOOL_WORDS(math::bitfield_extract_unsigned(k, a, b, c)));
  visit("bitfield_insert", RAYPOOL_WORDS(math::bitfield_insert(k, a, b, c, d)));
  visit("divide_unsigned", RAYPOOL_WORDS(math::divide_unsigned(k, a, b)));
  visit("remainder_unsigned", RAYPOOL_WORDS(math::remainder_unsigned(k, a, b)));
  visit("divide_signed", RAYPOOL_WORDS(math::divide_signed(k, a, b)));
  visit("remainder_signed", RAYPOOL_WORDS(math::remainder_signed(k, a, b)));
  visit("modulo_signed", RAYPOOL_WORDS(math::modulo_signed(k, a, b)));
}

/// Bits of numbers of all kinds: every exponent, small integers and their neighbours, and what is at the edges.
std::vector<uint32_t> some_words(size_t random_ones) {
  std::vector<uint32_t> words = {0, 1, 2, 3, 7, 31, 32, 33, 255, 0x7fffffffu, 0x80000000u, 0x80000001u, ~0u};
  for (const float value :
       {0.0f,  0x1p-149f, 0x1p-126f,  1e-20f,      0.25f,   0.5f,          1.0f,    1.5f,    2.5f,      3.14159265f,
        88.0f, 127.6f,    8388607.5f, 16777216.0f, 0x1p31f, 4294967040.0f, 0x1p32f, 3.4e38f, kInfinity, kNan}) {
    for (const uint32_t bits : {as_bits(value), as_bits(value) - 1, as_bits(value) + 1}) {
      words.push_back(bits);
      words.push_back(bits ^ 0x80000000u);
    }
  }
  Random random(7);
  for (size_t i = 0; i < random_ones; ++i) {
    const auto bits = static_cast<uint32_t>(random());
    switch (i % 4) {
      case 0:
        words.push_back(bits);
        break;
      case 1:  // -4 .. 4
        words.push_back(as_bits(static_cast<float>(static_cast<int32_t>(bits)) * 0x1p-29f));
        break;
      case 2:  // -2000 .. 2000
        words.push_back(as_bits(static_cast<float>(static_cast<int32_t>(bits)) * 1e-6f));
        break;
      default:
        words.push_back(bits >> (bits & 31));
        break;
    }
  }
  return words;
}

// Machine code

template <typename K, typename Function>
void expect_native_bits(const char* name, const Function& function, const std::vector<Operands>& operands,
                        uint32_t significand = arith::kFullSignificand) {
  arith::Mode mode = K::mode();
  mode.significand = significand;
  Program program;
  kernel::add_kernel(
      program, "k",
      [&](auto& k) {
        k.ray_in();
        using Int = typename std::decay_t<decltype(k)>::Int;
        const Int a = k.int_word(0);
        const Int b = k.int_word(1);
        const Int c = k.int_word(2);
        const Int d = k.int_word(3);
        k.store(k.thread() << 2, 0, function(k, a, b, c, d));
      },
      KernelTarget(mode.fused, false));
  test::Interpreter machine;
  machine.mode = mode;
  machine.memory.grow(4 * test::Interpreter::kLanes);
  for (size_t first = 0; first + test::Interpreter::kLanes <= operands.size(); first += test::Interpreter::kLanes) {
    for (uint32_t lane = 0; lane < test::Interpreter::kLanes; ++lane)
      std::copy_n(operands[first + lane].begin(), 4, machine.input[lane].begin());
    machine.run(program, 0);
    for (uint32_t lane = 0; lane < test::Interpreter::kLanes; ++lane) {
      const Operands& in = operands[first + lane];
      ASSERT_EQ(machine.memory.load(4 * lane), native<K>(function, in, significand))
          << fmt::format("{} of {:08x} {:08x} {:08x} {:08x}", name, in[0], in[1], in[2], in[3]);
    }
  }
}

TEST(ShaderMath, MachineCodeGivesTheBitsOfNativeKernels) {
  const std::vector<uint32_t> words = some_words(1000);
  std::vector<Operands> operands;
  Random random(8);
  const auto any = [&] { return words[static_cast<size_t>(random()) % words.size()]; };
  for (const uint32_t word : words) operands.push_back({word, any(), any(), any()});
  each_function([&](const char* name, const auto& function) {
    expect_native_bits<Ieee>(name, function, operands);
    expect_native_bits<Newton1>(name, function, operands);
    expect_native_bits<Narrow>(name, function, operands, 13);
  });
}

// Errors of the functions of floats

using MpfrFunction = int (*)(mpfr_t, const mpfr_t, mpfr_rnd_t);
using MpfrFunction2 = int (*)(mpfr_t, const mpfr_t, const mpfr_t, mpfr_rnd_t);

/// A float in 70 bits.
class Wide {
 public:
  Wide() { mpfr_init2(value_, 70); }
  explicit Wide(float value) : Wide() { mpfr_set_flt(value_, value, MPFR_RNDN); }
  ~Wide() { mpfr_clear(value_); }
  Wide(const Wide&) = delete;
  Wide& operator=(const Wide&) = delete;
  mpfr_ptr get() { return value_; }
  double number() const { return mpfr_get_d(value_, MPFR_RNDN); }

 private:
  mpfr_t value_;
};

double exact(MpfrFunction function, float x) {
  Wide in(x), out;
  function(out.get(), in.get(), MPFR_RNDN);
  return out.number();
}
double exact(MpfrFunction2 function, float x, float y) {
  Wide first(x), second(y), out;
  function(out.get(), first.get(), second.get(), MPFR_RNDN);
  return out.number();
}

/// Distance of floats around a number.
double ulp(double value) { return std::ldexp(1.0, std::max(std::ilogb(value), -126) - 23); }

/// Interval of operands, drawn uniformly or with uniform exponents.
struct Interval {
  float low, high;
};

std::vector<float> samples(const std::vector<Interval>& intervals) {
  std::vector<float> values;
  Random random(3);
  constexpr int kCount = 3000;
  for (const Interval& in : intervals) {
    for (int i = 0; i <= kCount; ++i)
      values.push_back(static_cast<float>(in.low + (double{in.high} - double{in.low}) * i / kCount));
    for (int i = 0; i < kCount; ++i) {  // of bits in order
      const auto order = [](float value) {
        const auto bits = static_cast<int64_t>(as_bits(std::fabs(value)));
        return value < 0 ? -bits : bits;
      };
      const int64_t low = order(in.low), high = order(in.high);
      const int64_t at = low + static_cast<int64_t>(random() % static_cast<uint64_t>(high - low + 1));
      const float magnitude = as_float(static_cast<uint32_t>(at < 0 ? -at : at));
      values.push_back(at < 0 ? -magnitude : magnitude);
    }
  }
  return values;
}

/// Of the slow unit's modes: what a Newton unit adds to the bound, in units of the bound's own and relative to the
/// larger of 1 and the result.
struct Slack {
  double ulps = 0, relative = 0;
};

struct Worst {
  double share = 0;  ///< of the bound
  std::string where = "nowhere";
  void add(double error, double bound, float x, float y) {
    const double of_bound = std::isnan(error) ? kInfinity : error / bound;
    if (of_bound <= share) return;
    share = of_bound;
    where = fmt::format("{:a}, {:a}: {} of {}", x, y, error, bound);
  }
};

/// `bound(x, exact)`: the largest absolute error.
template <typename Function, typename Bound>
void expect_close(const char* name, const Function& function, MpfrFunction oracle,
                  const std::vector<Interval>& intervals, const Bound& bound) {
  Worst exact_unit, newton2, newton1;
  for (const float x : samples(intervals)) {
    const double expected = exact(oracle, x);
    const double allowed = bound(std::fabs(static_cast<double>(x)), std::fabs(expected));
    const Operands in = {as_bits(x), 0, 0, 0};
    const auto error = [&](uint32_t bits) { return std::fabs(static_cast<double>(as_float(bits)) - expected); };
    const bool tiny = std::fabs(expected) < 0x1p-126 || std::fabs(x) < 0x1p-126f;
    exact_unit.add(error(native<Ieee>(function, in)), allowed, x, 0);
    exact_unit.add(error(native<Fused>(function, in)), allowed, x, 0);
    if (!tiny) exact_unit.add(error(native<Flush>(function, in)), allowed, x, 0);
    const double size = std::max(std::fabs(expected), 1.0);
    newton2.add(error(native<Newton2>(function, in)), allowed + size * 0x1p-20, x, 0);
    newton1.add(error(native<Newton1>(function, in)), allowed + size * 0x1p-9, x, 0);
  }
  EXPECT_LE(exact_unit.share, 1) << name << " " << exact_unit.where;
  EXPECT_LE(newton2.share, 1) << name << ", newton2: " << newton2.where;
  EXPECT_LE(newton1.share, 1) << name << ", newton1: " << newton1.where;
}

constexpr auto ulps(double count) {
  return [count](double, double result) { return count * ulp(result); };
}
constexpr auto absolute(double error) {
  return [error](double, double) { return error; };
}

TEST(ShaderMath, SineAndCosineAreCloseUpTo8192) {
  const auto bound = [](double x, double) { return x <= 8192 ? 0x1p-22 : x * 0x1p-22; };
  const std::vector<Interval> intervals = {{-4, 4}, {-8192, 8192}, {8192, 0x1p22f}};
  expect_close("sin", RAYPOOL_WORDS(as_int(math::sin(k, as_float(a)))), mpfr_sin, intervals, bound);
  expect_close("cos", RAYPOOL_WORDS(as_int(math::cos(k, as_float(a)))), mpfr_cos, intervals, bound);
  // Where the sine is its angle it keeps its relative error.
  expect_close("sin", RAYPOOL_WORDS(as_int(math::sin(k, as_float(a)))), mpfr_sin, {{-1.5f, 1.5f}}, ulps(2.5));
}

TEST(ShaderMath, TangentIsThatOfANearbyAngle) {
  const auto tangent = RAYPOOL_WORDS(as_int(math::tan(k, as_float(a))));
  expect_close("tan", tangent, mpfr_tan, {{-0.785f, 0.785f}}, ulps(4));
  const auto bound = [](double x, double result) {
    const double off = x <= 4096 ? 0x1p-23 : x * 0x1p-23;
    // Close to a pole the error is not its derivative's.
    return off * result > 0x1p-4 ? static_cast<double>(kInfinity) : 4 * ulp(result) + 1.1 * off * (1 + result * result);
  };
  expect_close("tan", tangent, mpfr_tan, {{-4, 4}, {-4096, 4096}, {4096, 0x1p16f}}, bound);
}

TEST(ShaderMath, ArcFunctionsKeepTheirErrors) {
  const std::vector<Interval> unit = {{-1, 1}, {0.49f, 0.51f}};
  expect_close("asin", RAYPOOL_WORDS(as_int(math::asin(k, as_float(a)))), mpfr_asin, unit, ulps(5));
  expect_close("acos", RAYPOOL_WORDS(as_int(math::acos(k, as_float(a)))), mpfr_acos, unit, ulps(16));
  expect_close("atan", RAYPOOL_WORDS(as_int(math::atan(k, as_float(a)))), mpfr_atan, {{-4, 4}, {-3e38f, 3e38f}},
               ulps(16));
}

TEST(ShaderMath, ExponentialsAndLogarithmsKeepTheirErrors) {
  const auto power = RAYPOOL_WORDS(as_int(math::exp2(k, as_float(a))));
  expect_close("exp2", power, mpfr_exp2, {{-2, 2}, {-126, 127.5f}}, ulps(2));
  expect_close("exp2", power, mpfr_exp2, {{127.5f, 127.99f}}, ulps(100));
  expect_close("exp2", power, mpfr_exp2, {{-1000, -126}}, absolute(0x1p-126));
  const auto exponential = [](double x, double result) { return (3 + x) * ulp(result); };
  expect_close("exp", RAYPOOL_WORDS(as_int(math::exp(k, as_float(a)))), mpfr_exp, {{-2, 2}, {-87, 88}}, exponential);
  const auto logarithm = RAYPOOL_WORDS(as_int(math::log2(k, as_float(a))));
  expect_close("log2", logarithm, mpfr_log2, {{0x1p-126f, 0.5f}, {2, 100}, {2, 3e38f}}, ulps(3));
  expect_close("log2", logarithm, mpfr_log2, {{0.5f, 2}, {0.999f, 1.001f}},
               [](double, double result) { return std::min(5 * ulp(result), 0x1p-22); });
  const auto natural = RAYPOOL_WORDS(as_int(math::log(k, as_float(a))));
  expect_close("log", natural, mpfr_log, {{0x1p-126f, 0.5f}, {2, 100}, {2, 3e38f}}, ulps(4));
  expect_close("log", natural, mpfr_log, {{0.5f, 2}, {0.999f, 1.001f}},
               [](double, double result) { return std::min(6 * ulp(result), 0x1p-22); });
}

TEST(ShaderMath, HyperbolicFunctionsKeepTheirErrors) {
  const auto sine = RAYPOOL_WORDS(as_int(math::sinh(k, as_float(a))));
  expect_close("sinh", sine, mpfr_sinh, {{-1, 1}}, absolute(0x1p-22));
  const auto exponential = [](double x, double result) { return (4 + 2 * x) * ulp(result); };
  expect_close("sinh", sine, mpfr_sinh, {{1, 4}, {1, 88.5f}}, exponential);
  expect_close("cosh", RAYPOOL_WORDS(as_int(math::cosh(k, as_float(a)))), mpfr_cosh, {{-4, 4}, {-88.5f, 88.5f}},
               exponential);
  expect_close("tanh", RAYPOOL_WORDS(as_int(math::tanh(k, as_float(a)))), mpfr_tanh, {{-4, 4}, {-1000, 1000}},
               absolute(0x1p-22));
  const auto area_sine = RAYPOOL_WORDS(as_int(math::asinh(k, as_float(a))));
  expect_close("asinh", area_sine, mpfr_asinh, {{-1, 1}}, absolute(0x1p-22));
  expect_close("asinh", area_sine, mpfr_asinh, {{1, 10}, {-1.8e19f, -1}}, ulps(4));
  const auto area_cosine = RAYPOOL_WORDS(as_int(math::acosh(k, as_float(a))));
  expect_close("acosh", area_cosine, mpfr_acosh, {{1, 2}}, absolute(0x1p-22));
  expect_close("acosh", area_cosine, mpfr_acosh, {{2, 10}, {2, 1.8e19f}}, ulps(4));
  const auto area_tangent = RAYPOOL_WORDS(as_int(math::atanh(k, as_float(a))));
  expect_close("atanh", area_tangent, mpfr_atanh, {{-0.5f, 0.5f}}, absolute(0x1p-22));
  expect_close("atanh", area_tangent, mpfr_atanh, {{0.5f, 0.999f}}, ulps(6));
}

template <typename Function, typename Bound>
void expect_close(const char* name, const Function& function, MpfrFunction2 oracle, const std::vector<float>& first,
                  const std::vector<float>& second, const Bound& bound) {
  Worst worst;
  for (size_t i = 0; i < first.size(); ++i) {
    const float x = first[i], y = second[(i * 7919) % second.size()];
    const double expected = exact(oracle, x, y);
    if (std::min(std::fabs(x), std::fabs(y)) < 0x1p-126f || std::fabs(expected) < 0x1p-125 ||
        std::fabs(expected) > 0x1p127)
      continue;
    const Operands in = {as_bits(x), as_bits(y), 0, 0};
    for (const uint32_t bits : {native<Ieee>(function, in), native<Fused>(function, in), native<Flush>(function, in)})
      worst.add(std::fabs(static_cast<double>(as_float(bits)) - expected), bound(x, y, expected), x, y);
  }
  EXPECT_LE(worst.share, 1) << name << " " << worst.where;
}

TEST(ShaderMath, FunctionsOfTwoOperandsKeepTheirErrors) {
  const auto bound = [](double, double, double result) { return 16 * ulp(result); };
  expect_close("atan2", RAYPOOL_WORDS(as_int(math::atan2(k, as_float(a), as_float(b)))), mpfr_atan2,
               samples({{-4, 4}, {-1e30f, 1e30f}}), samples({{-4, 4}, {-1e20f, 1e20f}, {0.1f, 3}}), bound);
  // Vulkan's bound: that of exp2(y log2(x)).
  const auto power = [](double x, double y, double result) {
    const double logarithm = std::fabs(std::log2(x));
    const double off = std::max(3 * ulp(logarithm), x >= 0.5 && x <= 2 ? 0x1p-21 : 0) + ulp(logarithm);
    return (3 + 2 * std::fabs(y) * logarithm) * ulp(result) + std::fabs(y) * off * result;
  };
  expect_close("pow", RAYPOOL_WORDS(as_int(math::pow(k, as_float(a), as_float(b)))), mpfr_pow,
               samples({{0.001f, 4}, {0x1p-126f, 1e38f}}), samples({{-3, 3}, {0, 100}}), power);
}

TEST(ShaderMath, EdgesGiveWhatTheHeaderSays) {
  struct Edge {
    const char* name;
    float x, y, expected;
    bool same_zero = true;  ///< the sign of a zero counts
  };
  const float pi = 3.14159265f, half_pi = 1.57079633f;
  const std::vector<Edge> edges = {
      {"sin", 0.0f, 0, 0.0f},
      {"sin", -0.0f, 0, -0.0f},
      {"sin", kInfinity, 0, kNan},
      {"sin", 1e20f, 0, 0.0f},
      {"sin", kNan, 0, kNan},
      {"cos", 0.0f, 0, 1.0f},
      {"cos", -0.0f, 0, 1.0f},
      {"cos", -kInfinity, 0, kNan},
      {"cos", kNan, 0, kNan},
      {"tan", -0.0f, 0, -0.0f},
      {"tan", kInfinity, 0, kNan},
      {"tan", kNan, 0, kNan},
      {"asin", -0.0f, 0, -0.0f},
      {"asin", 1.0f, 0, half_pi},
      {"asin", -1.0f, 0, -half_pi},
      {"asin", 1.001f, 0, kNan},
      {"asin", kNan, 0, kNan},
      {"acos", 1.0f, 0, 0.0f},
      {"acos", -1.0f, 0, pi},
      {"acos", -1.001f, 0, kNan},
      {"acos", kNan, 0, kNan},
      {"atan", -0.0f, 0, -0.0f},
      {"atan", kInfinity, 0, half_pi},
      {"atan", -kInfinity, 0, -half_pi},
      {"atan", kNan, 0, kNan},
      {"atan2", 0.0f, 0.0f, 0.0f},
      {"atan2", 0.0f, -0.0f, pi},
      {"atan2", -0.0f, 0.0f, -0.0f},
      {"atan2", -0.0f, -1.0f, -pi},
      {"atan2", 1.0f, 0.0f, half_pi},
      {"atan2", -1.0f, 0.0f, -half_pi},
      {"atan2", kInfinity, 2.0f, half_pi},
      {"atan2", 1.0f, -kInfinity, pi},
      {"exp2", 0.0f, 0, 1.0f},
      {"exp2", 1.0f, 0, 2.0f},
      {"exp2", -126.0f, 0, 0x1p-126f},
      {"exp2", 127.0f, 0, 0x1p127f},
      {"exp2", 129.0f, 0, kInfinity},
      {"exp2", kInfinity, 0, kInfinity},
      {"exp2", -kInfinity, 0, 0.0f},
      {"exp2", kNan, 0, kNan},
      {"exp2", -3e38f, 0, 0.0f},
      {"exp", 0.0f, 0, 1.0f},
      {"exp", 100.0f, 0, kInfinity},
      {"exp", -kInfinity, 0, 0.0f},
      {"exp", kNan, 0, kNan},
      {"log2", 1.0f, 0, 0.0f},
      {"log2", 8.0f, 0, 3.0f},
      {"log2", 0.25f, 0, -2.0f},
      {"log2", 0.0f, 0, -kInfinity},
      {"log2", -0.0f, 0, -kInfinity},
      {"log2", -1.0f, 0, kNan},
      {"log2", -kInfinity, 0, kNan},
      {"log2", kInfinity, 0, kInfinity},
      {"log2", kNan, 0, kNan},
      {"log", 0.0f, 0, -kInfinity},
      {"log", kInfinity, 0, kInfinity},
      {"pow", 0.0f, 2.0f, 0.0f},
      {"pow", 2.0f, 3.0f, 8.0f},
      {"pow", 5.0f, 0.0f, 1.0f},
      {"pow", -1.0f, 2.0f, kNan},
      {"pow", 0.0f, 0.0f, kNan},
      {"pow", 0.0f, -1.0f, kInfinity},
      {"sinh", 0.0f, 0, 0.0f},
      {"sinh", kInfinity, 0, kInfinity},
      {"sinh", -kInfinity, 0, -kInfinity},
      {"sinh", kNan, 0, kNan},
      {"cosh", 0.0f, 0, 1.0f},
      {"cosh", -kInfinity, 0, kInfinity},
      {"tanh", kInfinity, 0, 1.0f},
      {"tanh", -kInfinity, 0, -1.0f},
      {"tanh", 0.0f, 0, 0.0f},
      {"tanh", kNan, 0, kNan},
      {"asinh", 0.0f, 0, 0.0f},
      {"asinh", -kInfinity, 0, -kInfinity},
      {"acosh", 1.0f, 0, 0.0f},
      {"acosh", 0.5f, 0, kNan},
      {"acosh", kInfinity, 0, kInfinity},
      {"atanh", 0.0f, 0, 0.0f},
      {"atanh", 1.0f, 0, kInfinity},
      {"atanh", -1.0f, 0, -kInfinity},
      {"atanh", 1.5f, 0, kNan},
      {"floor", -0.5f, 0, -1.0f},
      {"floor", 1e30f, 0, 1e30f},
      {"floor", kInfinity, 0, kInfinity},
      {"floor", kNan, 0, kNan},
      {"fract", -0.25f, 0, 0.75f},
      {"fract", 1e20f, 0, 0.0f},
      {"fract", kInfinity, 0, kNan},
      {"mod", -1.0f, 3.0f, 2.0f},
      {"mod", 7.5f, 2.0f, 1.5f},
      {"rem", -1.0f, 3.0f, -1.0f},
      {"sign", -2.0f, 0, -1.0f},
      {"sign", 3.0f, 0, 1.0f},
      {"sign", 0.0f, 0, 0.0f},
      {"sign", kNan, 0, 0.0f},
      {"step", 1.0f, 1.0f, 1.0f},
      {"step", 1.0f, 0.5f, 0.0f},
      {"min", 1.0f, kNan, 1.0f},
      {"max", kNan, 1.0f, 1.0f},
  };
  size_t tried = 0;
  each_function([&](const char* name, const auto& function) {
    for (const Edge& edge : edges) {
      if (std::string(name) != edge.name) continue;
      ++tried;
      const Operands in = {as_bits(edge.x), as_bits(edge.y), 0, 0};
      for (const uint32_t bits :
           {native<Ieee>(function, in), native<Fused>(function, in), native<Flush>(function, in)}) {
        const float result = as_float(bits);
        const std::string what = fmt::format("{}({}, {}) = {}, not {}", name, edge.x, edge.y, result, edge.expected);
        if (std::isnan(edge.expected))
          EXPECT_TRUE(std::isnan(result)) << what;
        else if (edge.expected == 0 || std::isinf(edge.expected))
          EXPECT_EQ(bits, as_bits(edge.expected)) << what;
        else  // the arc functions' approximations are off here too
          EXPECT_NEAR(result, edge.expected, std::fabs(edge.expected) * 1e-6) << what;
      }
    }
  });
  EXPECT_EQ(tried, edges.size());
}

TEST(ShaderMath, PowersOfTwoAndTheirLogarithmsAreExact) {
  const auto power = RAYPOOL_WORDS(as_int(math::exp2(k, as_float(a))));
  const auto logarithm = RAYPOOL_WORDS(as_int(math::log2(k, as_float(a))));
  for (int n = -126; n < 128; ++n) {
    const uint32_t exponent = as_bits(static_cast<float>(n)), value = as_bits(std::ldexp(1.0f, n));
    EXPECT_EQ(native<Ieee>(power, {exponent}), value) << n;
    EXPECT_EQ(native<Fused>(power, {exponent}), value) << n;
    EXPECT_EQ(native<Newton2>(power, {exponent}), value) << n;
    EXPECT_EQ(native<Ieee>(logarithm, {value}), exponent) << n;
  }
}

// Functions that are exact: the host's own give what they must

template <typename Function, typename Expected>
void expect_equal(const char* name, const Function& function, const Expected& expected) {
  for (const uint32_t a : some_words(20000)) {
    const Operands in = {a, 0, 0, 0};
    const uint32_t wanted = expected(a);
    ASSERT_EQ(native<Ieee>(function, in), wanted) << fmt::format("{} of {:08x} ({})", name, a, as_float(a));
    ASSERT_EQ(native<Fused>(function, in), wanted) << fmt::format("{} of {:08x} ({})", name, a, as_float(a));
  }
}

/// -0 counts as 0, and every NaN as one.
uint32_t without_sign_of_zero(uint32_t bits) { return bits == 0x80000000u ? 0 : bits; }

#define RAYPOOL_ROUNDING(name) RAYPOOL_WORDS(as_int(math::name(k, as_float(a)) + 0.0f))

TEST(ShaderMath, RoundingIsThatOfTheHost) {
  const auto host = [](float (*function)(float)) {
    return [function](uint32_t bits) {
      const float result = function(as_float(bits));
      return std::isnan(result) ? arith::kQuietNan : without_sign_of_zero(as_bits(result));
    };
  };
  expect_equal("trunc", RAYPOOL_ROUNDING(trunc), host(std::trunc));
  expect_equal("floor", RAYPOOL_ROUNDING(floor), host(std::floor));
  expect_equal("ceil", RAYPOOL_ROUNDING(ceil), host(std::ceil));
  expect_equal("round", RAYPOOL_ROUNDING(round), host(std::nearbyint));
  expect_equal("fract", RAYPOOL_ROUNDING(fract), host([](float x) { return x - std::floor(x); }));
}

TEST(ShaderMath, PartsOfFloatsAreThoseOfTheHost) {
  const auto normal = [](float x) { return std::isnormal(x); };
  expect_equal("frexp", RAYPOOL_WORDS(as_int(math::frexp_significand(k, as_float(a)))), [&](uint32_t bits) {
    int exponent = 0;
    return normal(as_float(bits)) ? as_bits(std::frexp(as_float(bits), &exponent)) : bits;
  });
  expect_equal("frexp", RAYPOOL_WORDS(math::frexp_exponent(k, as_float(a))), [&](uint32_t bits) {
    int exponent = 0;
    if (normal(as_float(bits))) std::frexp(as_float(bits), &exponent);
    return static_cast<uint32_t>(exponent);
  });
  const auto scaled = RAYPOOL_WORDS(as_int(math::ldexp(k, as_float(a), b)));
  for (const float x : {1.0f, -0.75f, 3.5f, 0x1p-126f, 0x1p100f, 0.0f, kInfinity}) {
    for (int n = -300; n <= 128; ++n) {
      const uint32_t expected = as_bits(std::ldexp(x, n));
      if (std::ldexp(std::fabs(double{x}), n) < 0x1p-126) continue;  // rounded twice, or flushed
      EXPECT_EQ(native<Ieee>(scaled, {as_bits(x), static_cast<uint32_t>(n)}), expected) << x << " " << n;
      EXPECT_EQ(native<Flush>(scaled, {as_bits(x), static_cast<uint32_t>(n)}), expected) << x << " " << n;
    }
    EXPECT_EQ(as_float(native<Ieee>(scaled, {as_bits(1.0f), static_cast<uint32_t>(-2000)})), 0.0f);
  }
}

TEST(ShaderMath, UnsignedConversionsAreThoseOfTheHost) {
  expect_equal("unsigned_to_float", RAYPOOL_WORDS(as_int(math::unsigned_to_float(k, a))),
               [](uint32_t bits) { return as_bits(static_cast<float>(bits)); });
  expect_equal("float_to_unsigned", RAYPOOL_WORDS(math::float_to_unsigned(k, as_float(a))), [](uint32_t bits) {
    const float x = as_float(bits);
    if (std::isnan(x)) return 0u;
    if (x < 0) return static_cast<uint32_t>(x <= -0x1p31f ? INT32_MIN : static_cast<int32_t>(x));
    return x >= 0x1p32f ? ~0u : static_cast<uint32_t>(x);
  });
}

TEST(ShaderMath, BitsAreThoseOfTheHost) {
  const auto highest = [](uint32_t x) { return x == 0 ? ~0u : 31u - static_cast<uint32_t>(__builtin_clz(x)); };
  expect_equal("find_lsb", RAYPOOL_WORDS(math::find_lsb(k, a)),
               [](uint32_t x) { return x == 0 ? ~0u : static_cast<uint32_t>(__builtin_ctz(x)); });
  expect_equal("find_umsb", RAYPOOL_WORDS(math::find_umsb(k, a)), highest);
  expect_equal("find_smsb", RAYPOOL_WORDS(math::find_smsb(k, a)),
               [&](uint32_t x) { return highest(static_cast<int32_t>(x) < 0 ? ~x : x); });
  expect_equal("bit_count", RAYPOOL_WORDS(math::bit_count(k, a)),
               [](uint32_t x) { return static_cast<uint32_t>(__builtin_popcount(x)); });
  expect_equal("bit_reverse", RAYPOOL_WORDS(math::bit_reverse(k, a)), [](uint32_t x) {
    uint32_t reversed = 0;
    for (uint32_t bit = 0; bit < 32; ++bit) reversed |= (x >> bit & 1) << (31 - bit);
    return reversed;
  });
  expect_equal("abs", RAYPOOL_WORDS(math::abs(k, a)),
               [](uint32_t x) { return static_cast<int32_t>(x) < 0 ? 0u - x : x; });
  expect_equal("sign", RAYPOOL_WORDS(math::sign(k, a)), [](uint32_t x) {
    const auto value = static_cast<int32_t>(x);
    return static_cast<uint32_t>(value < 0 ? -1 : value > 0 ? 1 : 0);
  });
}

TEST(ShaderMath, BitFieldsAreExactForAllOffsetsAndSizes) {
  const auto signed_field = RAYPOOL_WORDS(math::bitfield_extract_signed(k, a, b, c));
  const auto unsigned_field = RAYPOOL_WORDS(math::bitfield_extract_unsigned(k, a, b, c));
  const auto inserted = RAYPOOL_WORDS(math::bitfield_insert(k, a, b, c, d));
  for (const uint32_t value : {0x12345678u, 0xfedcba98u, 0u, ~0u}) {
    for (uint32_t offset = 0; offset < 32; ++offset) {
      for (uint32_t bits = 0; offset + bits <= 32; ++bits) {
        const uint64_t mask = (uint64_t{1} << bits) - 1;
        const uint64_t field = value >> offset & mask;
        const bool negative = bits > 0 && (field >> (bits - 1) & 1) != 0;
        EXPECT_EQ(native<Ieee>(unsigned_field, {value, offset, bits}), field);
        EXPECT_EQ(native<Ieee>(signed_field, {value, offset, bits}),
                  static_cast<uint32_t>(negative ? field | ~mask : field));
        const uint64_t place = mask << offset;
        EXPECT_EQ(native<Ieee>(inserted, {value, 0xa5c3f00fu, offset, bits}),
                  static_cast<uint32_t>((value & ~place) | (uint64_t{0xa5c3f00fu} << offset & place)));
      }
    }
  }
}

TEST(ShaderMath, HalfFloatsAreThoseOfTheHost) {
  const auto packed = RAYPOOL_WORDS(math::pack_half_2x16(k, as_float(a), as_float(b)));
  const auto low = RAYPOOL_WORDS(as_int(math::unpack_half_2x16(k, a).x));
  const auto high = RAYPOOL_WORDS(as_int(math::unpack_half_2x16(k, a).y));
  const auto value_of = [](uint32_t half) {
    const auto exponent = static_cast<int>(half >> 10 & 31);
    const double fraction = half & 1023;
    const double magnitude = exponent == 0 ? std::ldexp(fraction, -24) : std::ldexp(1024 + fraction, exponent - 25);
    const double special = fraction == 0 ? static_cast<double>(kInfinity) : static_cast<double>(kNan);
    return static_cast<float>(std::copysign(exponent == 31 ? special : magnitude, half >> 15 != 0 ? -1.0 : 1.0));
  };
  const auto check = [&](uint32_t half) {
    const float value = value_of(half);
    for (const uint32_t bits :
         {native<Ieee>(low, {half}), native<Flush>(low, {half}), native<Ieee>(high, {half << 16})})
      ASSERT_TRUE(std::isnan(value) ? std::isnan(as_float(bits)) : bits == as_bits(value)) << half;
    if (std::isnan(value)) {
      EXPECT_EQ(native<Ieee>(packed, {as_bits(value)}) & 0x7fffu, 0x7e00u);
      return;
    }
    ASSERT_EQ(native<Ieee>(packed, {as_bits(value), as_bits(value)}), half | half << 16);
    if ((half & 0x7fffu) >= 0x7bffu) return;
    // Between this one and the next: the middle goes to the even one, its neighbours to the nearer one.
    const auto middle = static_cast<float>((double{value} + double{value_of(half + 1)}) / 2);
    ASSERT_EQ(native<Ieee>(packed, {as_bits(middle)}), half + (half & 1));
    ASSERT_EQ(native<Ieee>(packed, {as_bits(middle) - 1}), half);
    ASSERT_EQ(native<Ieee>(packed, {as_bits(middle) + 1}), half + 1);
    ASSERT_EQ(native<Flush>(packed, {as_bits(middle) + 1}), half + 1);
  };
  for (uint32_t half = 0; half < 0x10000; ++half) check(half);
  EXPECT_EQ(native<Ieee>(packed, {as_bits(65519.99f), as_bits(65520.0f)}), 0x7c007bffu);
  EXPECT_EQ(native<Ieee>(packed, {as_bits(1e30f), as_bits(-kInfinity)}), 0xfc007c00u);
}

TEST(ShaderMath, NormalizedIntegersAreTheNearest) {
  struct Format {
    double scale, least;
    uint32_t bits;
    double tie;  ///< how far from a tie the result must be right
  };
  const auto check = [](const char* name, const auto& packed, const auto& unpacked, const Format& format) {
    for (const float x : samples({{-1.2f, 1.2f}, {-2, 2}})) {
      const double scaled = std::clamp(double{x}, format.least, 1.0) * format.scale;
      const uint32_t bits = native<Ieee>(packed, {as_bits(x), as_bits(0.25f), as_bits(0.75f), as_bits(1.0f)});
      const uint32_t mask = (1u << format.bits) - 1;
      auto stored = static_cast<double>(bits & mask);
      if (format.least < 0 && (bits >> (format.bits - 1) & 1) != 0) stored -= static_cast<double>(mask) + 1;
      EXPECT_LE(std::fabs(stored - scaled), 0.5 + format.tie) << name << " " << x;
      const double value = as_float(native<Ieee>(unpacked, {bits}));
      EXPECT_NEAR(value, std::max(stored / format.scale, format.least), 0x1p-23) << name << " " << x;
      EXPECT_EQ(native<Flush>(packed, {as_bits(x), as_bits(0.25f), as_bits(0.75f), as_bits(1.0f)}), bits);
    }
  };
  check("unorm_2x16", RAYPOOL_WORDS(math::pack_unorm_2x16(k, as_float(a), as_float(b))),
        RAYPOOL_WORDS(as_int(math::unpack_unorm_2x16(k, a).x)), {65535, 0, 16, 0x1p-7});
  check("snorm_2x16", RAYPOOL_WORDS(math::pack_snorm_2x16(k, as_float(a), as_float(b))),
        RAYPOOL_WORDS(as_int(math::unpack_snorm_2x16(k, a).x)), {32767, -1, 16, 0x1p-7});
  check("unorm_4x8", RAYPOOL_WORDS(math::pack_unorm_4x8(k, as_float(a), as_float(b), as_float(c), as_float(d))),
        RAYPOOL_WORDS(as_int(math::unpack_unorm_4x8(k, a).x)), {255, 0, 8, 0x1p-15});
  check("snorm_4x8", RAYPOOL_WORDS(math::pack_snorm_4x8(k, as_float(a), as_float(b), as_float(c), as_float(d))),
        RAYPOOL_WORDS(as_int(math::unpack_snorm_4x8(k, a).x)), {127, -1, 8, 0x1p-15});
  // Each channel at its place, and back.
  const auto unorm = RAYPOOL_WORDS(math::pack_unorm_4x8(k, as_float(a), as_float(b), as_float(c), as_float(d)));
  const auto snorm = RAYPOOL_WORDS(math::pack_snorm_4x8(k, as_float(a), as_float(b), as_float(c), as_float(d)));
  const Operands channels = {as_bits(0.0f), as_bits(0.2f), as_bits(1.0f), as_bits(-1.0f)};
  EXPECT_EQ(native<Ieee>(unorm, channels), 0x00ff3300u);
  EXPECT_EQ(native<Ieee>(snorm, channels), 0x817f1900u);
  EXPECT_EQ(native<Ieee>(unorm, {as_bits(kNan), as_bits(kInfinity)}), 0x0000ff00u);
  const auto second = RAYPOOL_WORDS(as_int(math::unpack_snorm_4x8(k, a).y));
  const auto third = RAYPOOL_WORDS(as_int(math::unpack_unorm_4x8(k, a).z));
  const auto fourth = RAYPOOL_WORDS(as_int(math::unpack_snorm_4x8(k, a).w));
  EXPECT_EQ(as_float(native<Ieee>(second, {0x80ff8100u})), -1.0f);
  EXPECT_EQ(as_float(native<Ieee>(third, {0x80ff8100u})), 1.0f);
  EXPECT_EQ(as_float(native<Ieee>(fourth, {0x80ff8100u})), -1.0f);
}

TEST(ShaderMath, MixingAndClampingFollowGlsl) {
  const auto word = [](float value) { return as_bits(value); };
  const auto mixed = RAYPOOL_WORDS(as_int(math::mix(k, as_float(a), as_float(b), as_float(c))));
  EXPECT_EQ(as_float(native<Ieee>(mixed, {word(2), word(6), word(0)})), 2.0f);
  EXPECT_EQ(as_float(native<Ieee>(mixed, {word(2), word(6), word(1)})), 6.0f);
  EXPECT_EQ(as_float(native<Ieee>(mixed, {word(2), word(6), word(0.25f)})), 3.0f);
  const auto smooth = RAYPOOL_WORDS(as_int(math::smoothstep(k, as_float(a), as_float(b), as_float(c))));
  EXPECT_EQ(as_float(native<Ieee>(smooth, {word(1), word(3), word(0.5f)})), 0.0f);
  EXPECT_EQ(as_float(native<Ieee>(smooth, {word(1), word(3), word(5)})), 1.0f);
  EXPECT_EQ(as_float(native<Ieee>(smooth, {word(1), word(3), word(1.5f)})), 0.15625f);
  const auto clamped = RAYPOOL_WORDS(as_int(math::clamp(k, as_float(a), as_float(b), as_float(c))));
  EXPECT_EQ(as_float(native<Ieee>(clamped, {word(5), word(1), word(3)})), 3.0f);
  EXPECT_EQ(as_float(native<Ieee>(clamped, {word(-5), word(1), word(3)})), 1.0f);
  EXPECT_EQ(as_float(native<Ieee>(clamped, {word(kNan), word(1), word(3)})), 1.0f);
  const auto clamped_int = RAYPOOL_WORDS(math::clamp(k, a, b, c));
  EXPECT_EQ(native<Ieee>(clamped_int, {~0u, 2, 5}), 2u);
  EXPECT_EQ(native<Ieee>(RAYPOOL_WORDS(math::clamp_unsigned(k, a, b, c)), {~0u, 2, 5}), 5u);
  const auto nan = RAYPOOL_WORDS(select(math::isnan(k, as_float(a)), b, c));
  const auto infinite = RAYPOOL_WORDS(select(math::isinf(k, as_float(a)), b, c));
  for (const float value : {0.0f, 1.0f, kInfinity, -kInfinity, kNan}) {
    EXPECT_EQ(native<Ieee>(nan, {word(value), 1, 0}), std::isnan(value) ? 1u : 0u);
    EXPECT_EQ(native<Ieee>(infinite, {word(value), 1, 0}), std::isinf(value) ? 1u : 0u);
  }
  EXPECT_FLOAT_EQ(as_float(native<Ieee>(RAYPOOL_WORDS(as_int(math::radians(k, as_float(a)))), {word(180)})),
                  3.14159265f);
  EXPECT_FLOAT_EQ(as_float(native<Ieee>(RAYPOOL_WORDS(as_int(math::degrees(k, as_float(a)))), {word(3.14159265f)})),
                  180.0f);
}

template <typename K>
void expect_exact_division(const std::vector<uint32_t>& words, uint32_t significand = arith::kFullSignificand) {
  const auto quotient = RAYPOOL_WORDS(math::divide_unsigned(k, a, b));
  const auto remainder = RAYPOOL_WORDS(math::remainder_unsigned(k, a, b));
  const auto signed_quotient = RAYPOOL_WORDS(math::divide_signed(k, a, b));
  const auto signed_remainder = RAYPOOL_WORDS(math::remainder_signed(k, a, b));
  const auto modulo = RAYPOOL_WORDS(math::modulo_signed(k, a, b));
  Random random(11);
  for (size_t i = 0; i < words.size(); ++i) {
    for (int n = 0; n < 30; ++n) {
      const uint32_t a = words[i], b = words[static_cast<size_t>(random()) % words.size()];
      const std::string what = fmt::format("{:08x} / {:08x}", a, b);
      const Operands in = {a, b, 0, 0};
      if (b == 0) {  // undefined, but it ends
        ASSERT_EQ(native<K>(quotient, in, significand), a);
        continue;
      }
      ASSERT_EQ(native<K>(quotient, in, significand), a / b) << what;
      ASSERT_EQ(native<K>(remainder, in, significand), a % b) << what;
      const int64_t x = static_cast<int32_t>(a), y = static_cast<int32_t>(b);
      const int64_t rest = x % y;
      ASSERT_EQ(native<K>(signed_quotient, in, significand), static_cast<uint32_t>(x / y)) << what;
      ASSERT_EQ(native<K>(signed_remainder, in, significand), static_cast<uint32_t>(rest)) << what;
      ASSERT_EQ(native<K>(modulo, in, significand),
                static_cast<uint32_t>(rest != 0 && (rest < 0) != (y < 0) ? rest + y : rest))
          << what;
    }
  }
}

TEST(ShaderMath, IntegerDivisionIsExactInEveryArithmeticMode) {
  std::vector<uint32_t> words = some_words(1000);
  Random random(12);
  for (uint32_t i = 0; i < 500; ++i) {
    const auto bits = static_cast<uint32_t>(random());
    words.push_back(bits >> (i % 32));
    words.push_back(~uint32_t{0} - (bits >> (i % 32)));
    words.push_back(1u << (i % 32));
    words.push_back((1u << (i % 32)) - 1);
  }
  expect_exact_division<Ieee>(words);
  expect_exact_division<Fused>(words);
  expect_exact_division<Newton1>(words);
  expect_exact_division<Narrow>(words, 24);
  expect_exact_division<Narrow>(words, arith::kLeastSignificand);
}

}  // namespace
}  // namespace raypool::shader::math
