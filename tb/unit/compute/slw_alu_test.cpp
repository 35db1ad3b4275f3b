// rtl/compute/rp_slw_alu.v in every pair of subnormal mode and slow unit against the model of arithmetic.
#include <algorithm>
#include <cmath>

#ifdef RAYPOOL_LARGE
#include "Vslw_units_11.h"
#include "Vslw_units_13.h"
#include "Vslw_units_16.h"
#include "Vslw_units_20.h"
#else
#include "Vslw_group_units.h"
#include "Vslw_units.h"
#endif
#include "unit/arith/significands.hpp"
#include "unit/compute/alu_bench.hpp"
#include "unit/compute/alu_model.hpp"

namespace raypool {
namespace {

constexpr uint64_t kSeed = 815;

std::vector<AluUnderTest> units(uint32_t significand) {
  std::vector<AluUnderTest> all;
  for (int m = 0; m < 8; ++m) {
    const auto subnormals = static_cast<Subnormals>(m / 4);
    const auto slow_unit = static_cast<SlowUnit>(m % 4);
    const std::string names[] = {"exact", "newton2", "newton1", "newton0"};
    Configuration configuration;
    configuration.slow_unit = slow_unit;
    all.push_back({names[m % 4] + (m / 4 ? " flush" : " ieee"),
                   {subnormals, slow_unit, false, significand},
                   least_depth(configuration, AluType::Slw) + (m < 6 ? 0 : 2)});
  }
  return all;
}

#ifndef RAYPOOL_LARGE
/// With fewer lanes than a task has: as slw_group_units.v has them.
std::vector<AluUnderTest> group_units() {
  std::vector<AluUnderTest> all;
  for (uint32_t u = 0; u < 4; ++u) {
    Configuration configuration;
    configuration.lanes = kBenchLanes;
    configuration.slow_unit = u % 2 == 0 ? SlowUnit::Exact : SlowUnit::Newton0;
    configuration.slow_lanes = 1 + u / 2;
    configuration.alus[AluType::Slw] = {1, u == 2 ? 3u : 1u, least_depth(configuration, AluType::Slw) + u};
    const AluConfiguration task = configuration.task_of(AluType::Slw);
    all.push_back({"unit " + std::to_string(u), {Subnormals::Ieee, configuration.slow_unit}, task.depth, task.latency});
  }
  return all;
}

TEST(SlwAlu, GroupsOfLanesGiveWhatAllLanesGive) {
  AluBench<Vslw_group_units> bench(group_units(), slw_model, kSeed);
  arith::OperandSource source(kSeed);
  std::mt19937_64 random(kSeed);
  const std::vector<Opcode> opcodes = opcodes_of(AluType::Slw);
  for (int i = 0; i < 20000; i += kBenchLanes) {
    const Opcode opcode = opcodes[random() % opcodes.size()];
    for (int l = 0; l < kBenchLanes; ++l) {
      const auto [a, b] = source.next();
      bench.add(opcode, a, b);
    }
  }
  bench.finish();
  EXPECT_GE(bench.compared(), 80000u);
}
#endif

/// The operand `a`, of most roots something positive.
uint32_t positive(Opcode opcode, uint32_t a, std::mt19937_64& random) {
  return opcode != Opcode::Fdiv && random() % 2 ? a & 0x7fffffffu : a;
}

#ifdef RAYPOOL_LARGE  // slw_alu_large_test, of make test-long
using Significands = testing::Types<Significand<Vslw_units_20, 20>, Significand<Vslw_units_16, 16>,
                                    Significand<Vslw_units_13, 13>, Significand<Vslw_units_11, 11>>;
#else
using Significands = testing::Types<Significand<Vslw_units, 24>>;
#endif
template <typename Type>
class SlwAlu : public testing::Test {};
TYPED_TEST_SUITE(SlwAlu, Significands, SignificandName);
template <typename Type>
class SlwAluLong : public testing::Test {};
TYPED_TEST_SUITE(SlwAluLong, Significands, SignificandName);

TYPED_TEST(SlwAlu, EveryPairOfSpecialValuesAgreesWithTheModel) {
  constexpr uint32_t kSignificand = TypeParam::kSignificand;
  AluBench<typename TypeParam::Top> bench(units(kSignificand), slw_model, kSeed);
  const std::vector<uint32_t> specials = arith::special_operands(kSignificand);
  const std::vector<Opcode> opcodes = opcodes_of(AluType::Slw);
  for (const Opcode opcode : opcodes) {
    for (const uint32_t a : specials) {
      for (const uint32_t b : specials) bench.add(opcode, a, b);
    }
  }
  bench.finish();
  EXPECT_EQ(bench.compared(), 8 * opcodes.size() * specials.size() * specials.size());
}

TYPED_TEST(SlwAlu, RandomPairsAgreeWithTheModel) {
  constexpr uint32_t kSignificand = TypeParam::kSignificand;
  AluBench<typename TypeParam::Top> bench(units(kSignificand), slw_model, kSeed);
  arith::OperandSource source(kSeed, kSignificand);
  std::mt19937_64 random(kSeed);
  const std::vector<Opcode> opcodes = opcodes_of(AluType::Slw);
  for (int i = 0; i < TypeParam::share(400000); i += kBenchLanes) {
    const Opcode opcode = random() % 3 == 0 ? Opcode::Fdiv : opcodes[random() % opcodes.size()];
    for (int l = 0; l < kBenchLanes; ++l) {
      const auto [a, b] = source.next();
      bench.add(opcode, positive(opcode, a, random), b);
    }
  }
  bench.finish();
  EXPECT_GE(bench.compared(), uint64_t{TypeParam::share(3200000)});
}

TYPED_TEST(SlwAlu, MantissasAllOverTheRangeAgreeWithTheModel) {
  constexpr uint32_t kSignificand = TypeParam::kSignificand;
  // The exact unit's table and rounding depend on the mantissa, a root's also on whether the exponent is odd.
  AluBench<typename TypeParam::Top> bench(units(kSignificand), slw_model, kSeed);
  for (uint32_t a = 0x3f800000u; a < 0x40800000u; a += 127) {
    bench.add(Opcode::Frsqrt, a, 0);
  }
  for (uint32_t a = 0x3f800000u; a < 0x40800000u; a += 211) bench.add(Opcode::Fsqrt, a, 0);
  for (uint32_t a = 0x3f800000u; a < 0x40000000u; a += 101) bench.add(Opcode::Frcp, a, 0);
  bench.finish();
}

// Names with Long: in `make numerics-long` only.
TYPED_TEST(SlwAluLong, EveryMantissaAgreesWithTheModel) {
  constexpr uint32_t kSignificand = TypeParam::kSignificand;
  AluBench<typename TypeParam::Top> bench(units(kSignificand), slw_model, kSeed);
  constexpr uint32_t kNext = 1u << (24 - kSignificand);
  for (uint32_t a = 0x3f800000u; a < 0x40800000u; a += kNext) bench.add(Opcode::Fsqrt, a, 0);
  for (uint32_t a = 0x3f800000u; a < 0x40800000u; a += kNext) bench.add(Opcode::Frsqrt, a, 0);
  for (uint32_t a = 0x3f800000u; a < 0x40000000u; a += kNext) bench.add(Opcode::Frcp, a, 0);
  bench.finish();
  print_long_row("RTL fsqrt frsqrt frcp, every mantissa" + of_significand(kSignificand), bench.count(Subnormals::Ieee),
                 bench.count(Subnormals::Flush));
}

// 10^7 operands of each operation.
template <typename TypeParam>
void many_operands(const std::string& what, const std::vector<Opcode>& opcodes, uint64_t seed) {
  constexpr uint32_t kSignificand = TypeParam::kSignificand;
  AluBench<typename TypeParam::Top> bench(units(kSignificand), slw_model, seed);
  arith::OperandSource source(seed, kSignificand);
  std::mt19937_64 random(seed);
  for (size_t i = 0; i < 10'000'000 * opcodes.size(); ++i) {
    const Opcode opcode = opcodes[i / kBenchLanes % opcodes.size()];
    const auto [a, b] = source.next();
    bench.add(opcode, positive(opcode, a, random), b);
  }
  bench.finish();
  print_long_row("RTL " + what + ", random" + of_significand(kSignificand), bench.count(Subnormals::Ieee),
                 bench.count(Subnormals::Flush));
}

TYPED_TEST(SlwAluLong, ManyRandomQuotientsAgreeWithTheModel) {
  many_operands<TypeParam>("fdiv", {Opcode::Fdiv}, kSeed + 1);
}

TYPED_TEST(SlwAluLong, ManyRandomRootsAgreeWithTheModel) {
  if (TypeParam::kSignificand == 24) return;  // has more than 10^7 mantissas of each
  many_operands<TypeParam>("fsqrt frsqrt frcp", {Opcode::Fsqrt, Opcode::Frsqrt, Opcode::Frcp}, kSeed + 2);
}

#ifndef RAYPOOL_LARGE
// What rp_slow_exact.v leaves out of the square of the middle m between two floats, times v, must not matter: for every
// v of every significand the product differs from 4 by more, and by so little that its lower bits give the sign.
TEST(SlwAluExact, NoInverseRootIsAsNearToAMiddleAsTheTreeIsWrong) {
  for (int p = 11; p <= 24; ++p) {
    const int cut = p - 6, out = 2 * p + 4;  // CUT and OUT there
    const uint64_t wrong = static_cast<uint64_t>((cut + 1) / 2) << cut;
    uint64_t least = UINT64_MAX, most = 0;
    for (const int odd : {0, 1}) {
      for (uint64_t mantissa = uint64_t{1} << (p - 1); mantissa < uint64_t{1} << p; ++mantissa) {
        const uint64_t v = mantissa << odd;  // p - 1 fraction bits
        const double q = 2 / std::sqrt(std::ldexp(static_cast<double>(v), 1 - p));
        if (q >= 2) continue;  // of 1, a power of four
        // m has p fraction bits, the last one set. The estimate is nearer to q than 2^-p, and m no further from that.
        const auto middle = static_cast<uint64_t>(std::ldexp(q, p - 1)) * 2 + 1;
        for (const uint64_t m : {middle - 2, middle, middle + 2}) {
          if (std::fabs(std::ldexp(static_cast<double>(m), -p) - q) > std::ldexp(1.0, 1 - p)) continue;
          const uint64_t difference = m * m * v - (uint64_t{4} << (3 * p - 1));  // modulo 2^64, as 4 may be zero
          const uint64_t magnitude = static_cast<int64_t>(difference) < 0 ? 0 - difference : difference;
          least = std::min(least, magnitude);
          most = std::max(most, magnitude);
        }
      }
    }
    EXPECT_GT(least, wrong) << p;
    EXPECT_LT(most, uint64_t{1} << (out - 1)) << p;
  }
}
#endif

TYPED_TEST(SlwAlu, SubnormalQuotientsOnTheMiddleGoToEven) {
  constexpr uint32_t kSignificand = TypeParam::kSignificand;
  // n * 2^-149 / 2^k, with last bits that are shifted out: exact ties among them.
  AluBench<typename TypeParam::Top> bench(units(kSignificand), slw_model, kSeed);
  std::mt19937_64 random(kSeed);
  for (int k = 1; k <= 27; ++k) {
    for (int i = 0; i < 500; ++i) {
      const uint32_t n = (static_cast<uint32_t>(random()) & 0x00ffffffu & ~((1u << random() % 24) - 1)) |
                         static_cast<uint32_t>(i & 1) << 23;
      bench.add(Opcode::Fdiv, n, static_cast<uint32_t>(127 + k) << 23);
      bench.add(Opcode::Fdiv, n | 0x80000000u, (static_cast<uint32_t>(127 + k) << 23) + static_cast<uint32_t>(i % 3));
    }
  }
  bench.finish();
}

}  // namespace
}  // namespace raypool
