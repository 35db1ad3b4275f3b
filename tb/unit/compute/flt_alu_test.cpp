// rtl/compute/rp_flt_alu.v in both subnormal modes, with and without fused multiply-add, against the model of
// arithmetic.
#ifdef RAYPOOL_LARGE
#include "Vflt_units_13.h"
#include "Vflt_units_16.h"
#include "Vflt_units_20.h"
#else
#include "Vflt_units.h"
#include "Vflt_units_11.h"
#endif
#include "isa/isa.hpp"
#include "unit/arith/significands.hpp"
#include "unit/compute/alu_bench.hpp"
#include "unit/compute/alu_model.hpp"

namespace raypool {
namespace {

constexpr uint64_t kSeed = 4711;

uint32_t compared(Opcode opcode, uint32_t mask, arith::Mode mode) {
  return opcode != Opcode::Ffma || mode.fused ? mask : 0;
}

std::vector<AluUnderTest> units(uint32_t significand) {
  return {{"ieee", {Subnormals::Ieee, SlowUnit::Exact, false, significand}, 3},
          {"flush", {Subnormals::Flush, SlowUnit::Exact, false, significand}, 5},
          {"ieee fma", {Subnormals::Ieee, SlowUnit::Exact, true, significand}, 5},
          {"flush fma", {Subnormals::Flush, SlowUnit::Exact, true, significand}, 7}};
}

/// The operand `a`, of a conversion of a magnitude that makes a difference.
uint32_t converted(Opcode opcode, uint32_t a, std::mt19937_64& random) {
  if (opcode == Opcode::F2i && random() % 2)
    return (a & 0x807fffffu) | static_cast<uint32_t>(120 + random() % 42) << 23;
  if (opcode == Opcode::I2f) return static_cast<uint32_t>(static_cast<int32_t>(a) >> random() % 32);
  return a;
}

#ifdef RAYPOOL_LARGE  // flt_alu_large_test, of make test-long
using Significands =
    testing::Types<Significand<Vflt_units_20, 20>, Significand<Vflt_units_16, 16>, Significand<Vflt_units_13, 13>>;
#else
using Significands = testing::Types<Significand<Vflt_units, 24>, Significand<Vflt_units_11, 11>>;
#endif
template <typename Type>
class FltAlu : public testing::Test {};
TYPED_TEST_SUITE(FltAlu, Significands, SignificandName);
template <typename Type>
class FltAluLong : public testing::Test {};
TYPED_TEST_SUITE(FltAluLong, Significands, SignificandName);

TYPED_TEST(FltAlu, EveryPairOfSpecialValuesAgreesWithTheModel) {
  constexpr uint32_t kSignificand = TypeParam::kSignificand;
  AluBench<typename TypeParam::Top> bench(units(kSignificand), flt_model, kSeed, compared);
  const std::vector<uint32_t> specials = arith::special_operands(kSignificand);
  const std::vector<Opcode> opcodes = opcodes_of(AluType::Flt);
  for (const Opcode opcode : opcodes) {
    if (opcode == Opcode::Ffma) continue;
    for (const uint32_t a : specials) {
      for (const uint32_t b : specials) bench.add(opcode, a, b);
    }
  }
  bench.finish();
  EXPECT_EQ(bench.compared(), 4 * (opcodes.size() - 1) * specials.size() * specials.size());
}

TYPED_TEST(FltAlu, TriplesOfSpecialValuesFuseAsTheModelDoes) {
  constexpr uint32_t kSignificand = TypeParam::kSignificand;
  AluBench<typename TypeParam::Top> bench(units(kSignificand), flt_model, kSeed, compared);
  const std::vector<uint32_t> specials = arith::special_operands(kSignificand);
  std::mt19937_64 random(kSeed);
  for (const uint32_t a : specials) {
    for (const uint32_t b : specials) {
      // Every pair with a fifth of the addends, or less of more; over the pairs all of them.
      const size_t step = specials.size() / 19;
      for (size_t i = random() % step; i < specials.size(); i += step) bench.add(Opcode::Ffma, a, b, specials[i]);
    }
  }
  bench.finish();
  EXPECT_GE(bench.compared(), 300000u);
}

TYPED_TEST(FltAlu, RandomPairsAgreeWithTheModel) {
  constexpr uint32_t kSignificand = TypeParam::kSignificand;
  AluBench<typename TypeParam::Top> bench(units(kSignificand), flt_model, kSeed, compared);
  arith::OperandSource source(kSeed, kSignificand);
  std::mt19937_64 random(kSeed);
  // Sums and products most of all; conversions see operands of every magnitude.
  constexpr Opcode kOpcodes[] = {Opcode::Fadd, Opcode::Fadd, Opcode::Fsub, Opcode::Fmul, Opcode::Fmul, Opcode::Fmin,
                                 Opcode::Fmax, Opcode::F2i,  Opcode::I2f,  Opcode::Ffma, Opcode::Ffma, Opcode::Ffma};
  for (int i = 0; i < TypeParam::share(1500000); i += kBenchLanes) {
    const Opcode opcode = kOpcodes[random() % std::size(kOpcodes)];
    for (int l = 0; l < kBenchLanes; ++l) {
      const auto [a, b] = source.next();
      bench.add(opcode, converted(opcode, a, random), b, source.third(a, b));
    }
  }
  bench.finish();
  EXPECT_GE(bench.compared(), uint64_t{TypeParam::share(5000000)});
}

// Names with Long: in `make numerics-long` only. 10^7 operands of each operation.
template <typename TypeParam>
void many_operands(const std::string& what, const std::vector<Opcode>& opcodes, uint64_t seed) {
  constexpr uint32_t kSignificand = TypeParam::kSignificand;
  AluBench<typename TypeParam::Top> bench(units(kSignificand), flt_model, seed, compared);
  arith::OperandSource source(seed, kSignificand);
  std::mt19937_64 random(seed);
  for (size_t i = 0; i < 10'000'000 * opcodes.size(); ++i) {
    const Opcode opcode = opcodes[i / kBenchLanes % opcodes.size()];
    const auto [a, b] = source.next();
    bench.add(opcode, converted(opcode, a, random), b, source.third(a, b));
  }
  bench.finish();
  print_long_row("RTL " + what + ", random" + of_significand(kSignificand), bench.count(Subnormals::Ieee),
                 bench.count(Subnormals::Flush));
}

TYPED_TEST(FltAluLong, ManyRandomPairsAgreeWithTheModel) {
  many_operands<TypeParam>("fadd fsub fmul ffma", {Opcode::Fadd, Opcode::Fsub, Opcode::Fmul, Opcode::Ffma}, kSeed + 1);
}

TYPED_TEST(FltAluLong, ManyExtremesAndConversionsAgreeWithTheModel) {
  many_operands<TypeParam>("fmin fmax f2i i2f", {Opcode::Fmin, Opcode::Fmax, Opcode::F2i, Opcode::I2f}, kSeed + 2);
}

}  // namespace
}  // namespace raypool
