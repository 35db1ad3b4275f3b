// rtl/compute/rp_brh_alu.v in both subnormal modes against the model of arithmetic: compares,
// predicate logic, decisions of control.
#include "Vbrh_units.h"
#include "Vbrh_units_11.h"
#include "Vbrh_units_13.h"
#include "Vbrh_units_16.h"
#include "Vbrh_units_20.h"
#include "unit/arith/significands.hpp"
#include "unit/compute/alu_bench.hpp"
#include "unit/compute/alu_model.hpp"

namespace raypool {
namespace {

constexpr uint64_t kSeed = 1301;

std::vector<AluUnderTest> units(uint32_t significand) {
  return {{"ieee", {Subnormals::Ieee, SlowUnit::Exact, false, significand}, 2},
          {"flush", {Subnormals::Flush, SlowUnit::Exact, false, significand}, 5}};
}

/// Control decides for all lanes.
uint32_t compared(Opcode opcode, uint32_t mask, arith::Mode) {
  return instruction(opcode).kind == Kind::Control ? (1u << kBenchLanes) - 1 : mask;
}

/// The operand `b`, a quarter of them equal to `a` or but for one bit.
uint32_t nearly(uint32_t a, uint32_t b, std::mt19937_64& random) {
  return random() % 4 != 0 ? b : a ^ (random() % 2 != 0 ? 0 : 1u << random() % 32);
}

using Significands =
    testing::Types<Significand<Vbrh_units, 24>, Significand<Vbrh_units_20, 20>, Significand<Vbrh_units_16, 16>,
                   Significand<Vbrh_units_13, 13>, Significand<Vbrh_units_11, 11>>;
template <typename Type>
class BrhAlu : public testing::Test {};
TYPED_TEST_SUITE(BrhAlu, Significands, SignificandName);
template <typename Type>
class BrhAluLong : public testing::Test {};
TYPED_TEST_SUITE(BrhAluLong, Significands, SignificandName);

TYPED_TEST(BrhAlu, EveryPairOfBoundaryValuesComparesAsTheModelDoes) {
  constexpr uint32_t kSignificand = TypeParam::kSignificand;
  AluBench<typename TypeParam::Top> bench(units(kSignificand), brh_model, kSeed, compared);
  const std::vector<uint32_t> values = arith::boundary_operands(kSignificand);
  uint64_t compares = 0;
  for (const Opcode opcode : opcodes_of(AluType::Brh)) {
    if (!has_operand(instruction(opcode), Operand::Ra)) continue;
    ++compares;
    for (const uint32_t a : values) {
      for (const uint32_t b : values) bench.add(opcode, a, b);
    }
  }
  bench.finish();
  EXPECT_EQ(compares, 16u);
  EXPECT_EQ(bench.compared(), 2 * compares * values.size() * values.size());
}

TYPED_TEST(BrhAlu, RandomPairsAgreeWithTheModel) {
  constexpr uint32_t kSignificand = TypeParam::kSignificand;
  AluBench<typename TypeParam::Top> bench(units(kSignificand), brh_model, kSeed, compared);
  arith::OperandSource source(kSeed, kSignificand);
  std::mt19937_64 random(kSeed);
  const std::vector<Opcode> opcodes = opcodes_of(AluType::Brh);
  for (int i = 0; i < TypeParam::share(600000); i += kBenchLanes) {
    const Opcode opcode = opcodes[random() % opcodes.size()];
    for (int l = 0; l < kBenchLanes; ++l) {
      const auto [a, b] = source.next();
      bench.add(opcode, a, nearly(a, b, random), static_cast<uint32_t>(random()));
    }
  }
  bench.finish();
  EXPECT_GE(bench.compared(), uint64_t{TypeParam::share(1000000)});
}

TYPED_TEST(BrhAlu, ControlDecidesForEveryLaneWhetherAnyIsInTheMask) {
  constexpr uint32_t kSignificand = TypeParam::kSignificand;
  AluBench<typename TypeParam::Top> bench(units(kSignificand), brh_model, kSeed, compared);
  std::mt19937_64 random(kSeed);
  const std::vector<Opcode> opcodes = opcodes_of(AluType::Brh, Kind::Control);
  for (int i = 0; i < 20000; ++i) {
    const Opcode opcode = opcodes[random() % opcodes.size()];
    const bool asks = opcode == Opcode::Jany || opcode == Opcode::Jnone || opcode == Opcode::Loop;
    if (random() % 2 != 0) {
      bench.add(opcode, static_cast<uint32_t>(random()), 0, static_cast<uint32_t>(random()));
    } else {
      bench.add_outside(opcode, opcode == Opcode::Jnone || !asks ? 1 : 0);
    }
  }
  bench.finish();
  EXPECT_GE(bench.compared(), 80000u);
}

// Names with Long: in `make numerics-long` only. 10^7 pairs of each compare.
TYPED_TEST(BrhAluLong, ManyRandomPairsCompareAsTheModelDoes) {
  constexpr uint32_t kSignificand = TypeParam::kSignificand;
  AluBench<typename TypeParam::Top> bench(units(kSignificand), brh_model, kSeed + 1, compared);
  arith::OperandSource source(kSeed + 1, kSignificand);
  std::mt19937_64 random(kSeed + 1);
  constexpr Opcode kCompares[] = {Opcode::Feq, Opcode::Fne, Opcode::Flt, Opcode::Fle, Opcode::Fgt, Opcode::Fge};
  for (size_t i = 0; i < 10'000'000 * std::size(kCompares); ++i) {
    const auto [a, b] = source.next();
    bench.add(kCompares[i / kBenchLanes % std::size(kCompares)], a, nearly(a, b, random));
  }
  bench.finish();
  print_long_row("RTL feq fne flt fle fgt fge, random" + of_significand(kSignificand), bench.count(Subnormals::Ieee),
                 bench.count(Subnormals::Flush));
}

}  // namespace
}  // namespace raypool
