// The model of arithmetic against the host's SSE unit, with its MXCSR register set to the mode under test, and against
// MPFR (test_oracle.hpp), and its rules one by one.
#include "arith/arith.hpp"

#include <gtest/gtest.h>

#include "arith/test_newton.hpp"
#include "arith/test_operands.hpp"
#include "arith/test_oracle.hpp"
#include "bits.hpp"

namespace raypool::arith {
namespace {

constexpr Mode kIeee{Subnormals::Ieee, SlowUnit::Exact};
constexpr Mode kFlush{Subnormals::Flush, SlowUnit::Exact};
constexpr uint64_t kSeed = 20240607;
constexpr int kPairs = 400000;

constexpr Operation kBinary[] = {Operation::Add,  Operation::Sub,       Operation::Mul,     Operation::Div,
                                 Operation::Min,  Operation::Max,       Operation::Equal,   Operation::NotEqual,
                                 Operation::Less, Operation::LessEqual, Operation::Greater, Operation::GreaterEqual};
constexpr SlowUnit kNewton[] = {SlowUnit::Newton2, SlowUnit::Newton1, SlowUnit::Newton0};
constexpr Operation kUnary[] = {Operation::ToInt, Operation::FromInt, Operation::Sqrt, Operation::Rsqrt,
                                Operation::Rcp};

/// Every operation of the block, in both modes, against the oracle.
void check(Operation operation, const OperandBlock& in, bool with_mpfr = false) {
  std::vector<uint32_t> expected;
  for (const bool flush : {false, true}) {
    oracle::results(operation, in, flush, with_mpfr, expected);
    const Mode mode = flush ? kFlush : kIeee;
    for (size_t i = 0; i < in.size(); ++i) {
      ASSERT_EQ(model(operation, in.a[i], in.b[i], in.c[i], mode), expected[i])
          << std::hex << kOperationNames[static_cast<int>(operation)] << ' ' << in.a[i] << ' ' << in.b[i] << ' '
          << in.c[i] << (flush ? " flush" : " ieee") << " seed " << std::dec << kSeed;
    }
  }
}

void check_pair(uint32_t a, uint32_t b) {
  OperandBlock in;
  in.push(a, b, 0);
  for (const Operation operation : kBinary) check(operation, in);
}

TEST(Arith, EveryPairOfSpecialValuesGivesWhatTheOracleGives) {
  OperandBlock in;
  for (const uint32_t a : special_operands()) {
    for (const uint32_t b : special_operands()) in.push(a, b, 0);
  }
  for (const Operation operation : kBinary) check(operation, in);
  for (const Operation operation : kUnary) check(operation, in);
  check(Operation::Rsqrt, in, true);
}

TEST(Arith, RandomPairsGiveWhatTheOracleGives) {
  OperandSource source(kSeed);
  OperandBlock in;
  for (int i = 0; i < kPairs; ++i) {
    const auto [a, b] = source.next();
    in.push(a, b, 0);
  }
  for (const Operation operation : kBinary) check(operation, in);
}

TEST(Arith, UnaryOperationsGiveWhatTheOracleGivesAllOverTheRange) {
  OperandBlock in;
  for (uint64_t a = 0; a < uint64_t{1} << 32; a += 4099) in.push(static_cast<uint32_t>(a), 0, 0);
  for (const Operation operation : kUnary) check(operation, in);
  check(Operation::Rsqrt, in, true);
}

TEST(Arith, EveryTripleOfSpecialValuesFusesAsTheHostDoes) {
  if (!host_has_fma()) GTEST_SKIP() << "this host has no fused multiply-add; the next test asks MPFR";
  OperandBlock in;
  for (const uint32_t a : special_operands()) {
    in.clear();
    for (const uint32_t b : special_operands()) {
      for (const uint32_t c : special_operands()) in.push(a, b, c);
    }
    check(Operation::Fma, in);
    if (HasFatalFailure()) return;
  }
}

TEST(Arith, RandomTriplesAreRoundedOnceAsMpfrDoes) {
  OperandSource source(kSeed);
  OperandBlock in;
  for (int i = 0; i < kPairs; ++i) {
    const auto [a, b] = source.next();
    in.push(a, b, source.third(a, b));
  }
  check(Operation::Fma, in, true);
  check(Operation::Fma, in);
}

TEST(Arith, TinyFusedSumsAreJudgedAfterRounding) {
  // 2^-126 - 2^-151, the last number that rounds up to 2^-126 with 24 bits; a subnormal addend is zero under
  // `flush`, so the product alone decides: 2^-126 times 1 - 2^-25 is no product of
  // floats, (1 + 2^-23)(1 - 2^-23) is nearer to 1.
  EXPECT_EQ(fma(0x00800001u, 0x3f7ffffeu, 0u, kFlush), 0x00800000u);
  EXPECT_EQ(fma(0x00800000u, 0x3f7fffffu, 0u, kFlush), 0u);
  EXPECT_EQ(fma(0x80ffffffu, 0x3f000000u, 0x80000000u, kFlush), 0x80000000u);
  // 2^-125 - (2^-126 + 2^-151 + ...): the sum has more than 24 bits and lies just below 2^-126.
  EXPECT_EQ(fma(0x80800001u, 0x3f800000u, 0x01000000u, kFlush), 0u);
  EXPECT_EQ(fma(0x2b800000u, 0xab000000u, 0x01000000u, kIeee), fma(0xab000000u, 0x2b800000u, 0x01000000u, kIeee));
  EXPECT_EQ(muladd(0x3f800001u, 0x3f800001u, 0xbf800002u, kIeee), 0u);  // twice
  EXPECT_EQ(muladd(0x3f800001u, 0x3f800001u, 0xbf800002u, {Subnormals::Ieee, SlowUnit::Exact, true}),
            0x28800000u);  // once
}

TEST(Arith, TinyProductsAreJudgedAfterRounding) {
  // All below 2^-126. The first rounds up to it at 24 bits and stays; the others have 24 bits themselves and are
  // flushed, although IEEE rounding to a multiple of 2^-149 gives 2^-126.
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
  EXPECT_EQ(to_int(as_bits(-1.99f), kIeee), 0xffffffffu);
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

TEST(Arith, InverseRootIsCorrectlyRounded) {
  // Every mantissa under two exponents; the rest is a power of two. One of them (403a18e3) is so
  // near to a middle that doubles fail.
  OperandBlock in;
  for (uint32_t x = 0x3f800000u; x < 0x40800000u; ++x) in.push(x, 0, 0);
  check(Operation::Rsqrt, in);
  check(Operation::Rsqrt, in, true);
  EXPECT_EQ(rsqrt(0u, kIeee), 0x7f800000u);
  EXPECT_EQ(rsqrt(0x80000000u, kIeee), 0xff800000u);
  EXPECT_EQ(rsqrt(0x80000001u, kIeee), kQuietNan);
  EXPECT_EQ(rsqrt(0x80000001u, kFlush), 0xff800000u);
  EXPECT_EQ(rsqrt(0x7f800000u, kIeee), 0u);
  EXPECT_EQ(rsqrt(0x40800000u, kIeee), 0x3f000000u);
}

/// Every operation of the block with shorter significands, in both modes, against the oracle.
void check_narrow(Operation operation, const OperandBlock& in, uint32_t significand) {
  std::vector<uint32_t> expected;
  for (const Subnormals subnormals : {Subnormals::Ieee, Subnormals::Flush}) {
    const Mode mode{subnormals, SlowUnit::Exact, false, significand};
    oracle::narrow_results(operation, in, subnormals == Subnormals::Flush, significand, expected);
    for (size_t i = 0; i < in.size(); ++i) {
      ASSERT_EQ(model(operation, in.a[i], in.b[i], in.c[i], mode), expected[i])
          << std::hex << kOperationNames[static_cast<int>(operation)] << ' ' << in.a[i] << ' ' << in.b[i] << ' '
          << in.c[i] << (subnormals == Subnormals::Flush ? " flush" : " ieee") << std::dec << " significand "
          << significand << " seed " << kSeed;
    }
  }
}

class ArithOfSignificand : public testing::TestWithParam<uint32_t> {};
INSTANTIATE_TEST_SUITE_P(Bits, ArithOfSignificand, testing::Range(11u, 24u));

TEST_P(ArithOfSignificand, SpecialValuesGiveWhatMpfrGives) {
  const std::vector<uint32_t> specials = special_operands(GetParam());
  OperandBlock in;
  for (const uint32_t a : specials) {
    for (const uint32_t b : specials) in.push(a, b, specials[in.size() % 53]);
  }
  for (const Operation operation : kBinary) check_narrow(operation, in, GetParam());
  for (const Operation operation : kUnary) check_narrow(operation, in, GetParam());
  check_narrow(Operation::Fma, in, GetParam());
}

TEST_P(ArithOfSignificand, RandomOperandsGiveWhatMpfrGives) {
  OperandSource source(kSeed, GetParam());
  OperandBlock in;
  for (int i = 0; i < kPairs / 8; ++i) {
    const auto [a, b] = source.next();
    in.push(a, b, source.third(a, b));
  }
  for (const Operation operation : kBinary) check_narrow(operation, in, GetParam());
  for (const Operation operation : kUnary) check_narrow(operation, in, GetParam());
  check_narrow(Operation::Fma, in, GetParam());
}

TEST_P(ArithOfSignificand, EveryInverseRootIsCorrectlyRounded) {
  OperandBlock in;
  for (uint32_t x = 0x3f800000u; x < 0x40800000u; x += 1u << (24 - GetParam())) in.push(x, 0, 0);
  check_narrow(Operation::Rsqrt, in, GetParam());
}

TEST(Arith, WhatIsBelowTheSignificandIsNotThere) {
  const Mode mode{Subnormals::Ieee, SlowUnit::Exact, false, 11};
  EXPECT_EQ(add(0x3f801fffu, 0u, mode), 0x3f800000u);
  EXPECT_EQ(max(0x3f801fffu, 0x3f800000u, mode), 0x3f800000u);
  EXPECT_TRUE(equal(0x3f801fffu, 0x3f800000u, mode));
  EXPECT_EQ(mul(0x7f800001u, 0x3f800000u, mode), 0x7f800000u);  // a NaN only by what is not there
  EXPECT_EQ(add(0x00001fffu, 0u, mode), 0u);
  EXPECT_EQ(from_int(0x00000801u, mode), 0x45000000u);  // a tie, to even
  EXPECT_EQ(div(0x3f800000u, 0x40400000u, mode), 0x3eaaa000u);
}

/// Every Newton unit in both subnormal modes: the oracle's bits, and the exponent of the exact result.
void check_newton(Operation operation, const OperandBlock& in, uint32_t significand = 24) {
  for (const SlowUnit unit : kNewton) {
    for (const bool flush : {false, true}) {
      const Mode mode{flush ? Subnormals::Flush : Subnormals::Ieee, unit, false, significand};
      const Mode exact_mode{mode.subnormals, SlowUnit::Exact, false, significand};
      for (size_t i = 0; i < in.size(); ++i) {
        const uint32_t ours = model(operation, in.a[i], in.b[i], 0, mode);
        ASSERT_EQ(ours, newton_oracle::result(operation, in.a[i], in.b[i], unit, flush, significand))
            << std::hex << kOperationNames[static_cast<int>(operation)] << ' ' << in.a[i] << ' ' << in.b[i]
            << (flush ? " flush" : " ieee") << " unit " << static_cast<int>(unit) << std::dec << " significand "
            << significand;
        const uint32_t exact = model(operation, in.a[i], in.b[i], 0, exact_mode);
        ASSERT_TRUE(newton_oracle::keeps_exponent(operation, in.a[i], in.b[i], ours, exact, significand))
            << std::hex << kOperationNames[static_cast<int>(operation)] << ' ' << in.a[i] << ' ' << in.b[i] << " gives "
            << ours << " for " << exact;
      }
    }
  }
}

TEST(Arith, NewtonResultsAreThoseOfTheirDefinitionAllOverTheRange) {
  OperandBlock in;
  for (uint64_t a = 0; a < uint64_t{1} << 32; a += 8209) in.push(static_cast<uint32_t>(a), 0, 0);
  // Every seed, both parities, all lower bits; the largest mantissas; results at both ends.
  for (uint32_t a = 0x3f800000u; a < 0x40800000u; a += 31) in.push(a, 0, 0);
  for (uint32_t a = 0x407e0000u; a < 0x40800000u; ++a) in.push(a, 0, 0);
  for (uint32_t a = 0x00000000u; a < 0x01000000u; a += 127) in.push(a, 0, 0);
  for (uint32_t a = 0x7e000000u; a < 0x7f800000u; a += 127) in.push(a, 0, 0);
  for (const Operation operation : {Operation::Sqrt, Operation::Rsqrt, Operation::Rcp}) check_newton(operation, in);
}

TEST_P(ArithOfSignificand, NewtonResultsAreThoseOfTheirDefinition) {
  OperandSource source(kSeed, GetParam());
  OperandBlock in;
  for (const uint32_t a : special_operands(GetParam())) {
    for (const uint32_t b : special_operands()) in.push(a, b, 0);
  }
  for (int i = 0; i < kPairs / 16; ++i) {
    const auto [a, b] = source.next();
    in.push(a, b, 0);
  }
  check_newton(Operation::Div, in, GetParam());
  for (uint32_t a = 0x3f800000u; a < 0x40800000u; a += 251) in.push(a, 0, 0);
  for (uint64_t a = 0; a < uint64_t{1} << 32; a += 65521) in.push(static_cast<uint32_t>(a), 0, 0);
  for (const Operation operation : {Operation::Sqrt, Operation::Rsqrt, Operation::Rcp})
    check_newton(operation, in, GetParam());
}

TEST(Arith, NewtonQuotientsAreThoseOfTheirDefinition) {
  OperandSource source(kSeed);
  OperandBlock in;
  for (int i = 0; i < kPairs; ++i) {
    const auto [a, b] = source.next();
    in.push(a, b, 0);
  }
  for (const uint32_t a : special_operands()) {
    for (const uint32_t b : special_operands()) in.push(a, b, 0);
  }
  check_newton(Operation::Div, in);
}

TEST(Arith, NewtonResultsNextToTheNextExponentStayBelowIt) {
  OperandBlock in;
  // Quotients 2 - 2k/d for divisors all over 1 .. 2, in the middle, below infinity,
  // and below the smallest normal number.
  for (uint32_t d = 64; d < 1u << 23; d += 251) {
    for (const uint32_t k : {1u, 2u, 31u, 60u}) {
      in.push(0x3f800000u + d - k, 0x3f800000u + d, 0);
      in.push(0xff000000u + d - k, 0x3f000000u + d, 0);
      in.push(0x00800000u + d - k, 0xbf800000u + d, 0);
    }
  }
  check_newton(Operation::Div, in);
  EXPECT_EQ(div(0xc1001002u, 0x0100100eu, {Subnormals::Ieee, SlowUnit::Newton1}), 0xff7fffffu);
  EXPECT_EQ(div(0xc17fff3eu, 0x017ffffau, {Subnormals::Ieee, SlowUnit::Newton0}), 0xff7fffffu);
  EXPECT_EQ(div(0x3f800100u, 0x3f800101u, {Subnormals::Flush, SlowUnit::Newton1}), 0x3f7fffffu);
  EXPECT_EQ(sqrt(0x407f00ffu, {Subnormals::Flush, SlowUnit::Newton0}), 0x3fffffffu);
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
  for (const SlowUnit unit : kNewton) {
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
