// rtl/flt_alu.v in both subnormal modes, with and without fused multiply-add, against the model of arithmetic.
#include "Vflt_units.h"
#include "alu_bench.hpp"
#include "alu_model.hpp"
#include "isa/isa.hpp"

namespace raypool {
namespace {

constexpr uint64_t kSeed = 4711;

uint32_t compared(Opcode opcode, uint32_t mask, arith::Mode mode) {
  return opcode != Opcode::Ffma || mode.fused ? mask : 0;
}

std::vector<AluUnderTest> units() {
  return {{"ieee", {Subnormals::Ieee, SlowUnit::Exact}, 3},
          {"flush", {Subnormals::Flush, SlowUnit::Exact}, 5},
          {"ieee fma", {Subnormals::Ieee, SlowUnit::Exact, true}, 5},
          {"flush fma", {Subnormals::Flush, SlowUnit::Exact, true}, 7}};
}

TEST(FltAlu, EveryPairOfSpecialValuesAgreesWithTheModel) {
  AluBench<Vflt_units> bench(units(), flt_model, kSeed, compared);
  const std::vector<uint32_t> specials = arith::special_operands();
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

TEST(FltAlu, TriplesOfSpecialValuesFuseAsTheModelDoes) {
  AluBench<Vflt_units> bench(units(), flt_model, kSeed, compared);
  const std::vector<uint32_t> specials = arith::special_operands();
  std::mt19937_64 random(kSeed);
  for (const uint32_t a : specials) {
    for (const uint32_t b : specials) {
      // Every pair with a fifth of the addends; over the pairs all of them.
      for (size_t i = random() % 5; i < specials.size(); i += 5) bench.add(Opcode::Ffma, a, b, specials[i]);
    }
  }
  bench.finish();
  EXPECT_GE(bench.compared(), 300000u);
}

TEST(FltAlu, RandomPairsAgreeWithTheModel) {
  AluBench<Vflt_units> bench(units(), flt_model, kSeed, compared);
  arith::OperandSource source(kSeed);
  std::mt19937_64 random(kSeed);
  // Sums and products most of all; conversions see operands of every magnitude.
  constexpr Opcode kOpcodes[] = {Opcode::Fadd, Opcode::Fadd, Opcode::Fsub, Opcode::Fmul, Opcode::Fmul, Opcode::Fmin,
                                 Opcode::Fmax, Opcode::F2i,  Opcode::I2f,  Opcode::Ffma, Opcode::Ffma, Opcode::Ffma};
  for (int i = 0; i < 1500000; i += kBenchLanes) {
    const Opcode opcode = kOpcodes[random() % std::size(kOpcodes)];
    for (int l = 0; l < kBenchLanes; ++l) {
      auto [a, b] = source.next();
      if (opcode == Opcode::F2i && random() % 2)
        a = (a & 0x807fffffu) | static_cast<uint32_t>(120 + random() % 42) << 23;
      if (opcode == Opcode::I2f) a = static_cast<uint32_t>(static_cast<int32_t>(a) >> random() % 32);
      bench.add(opcode, a, b, source.third(a, b));
    }
  }
  bench.finish();
  EXPECT_GE(bench.compared(), 5000000u);
}

// Names with Long: in `make numerics-long` only.
TEST(FltAluLong, ManyRandomPairsAgreeWithTheModel) {
  AluBench<Vflt_units> bench(units(), flt_model, kSeed + 1, compared);
  arith::OperandSource source(kSeed + 1);
  for (int i = 0; i < 40000000; ++i) {
    const auto [a, b] = source.next();
    constexpr Opcode kLongOpcodes[] = {Opcode::Fadd, Opcode::Fsub, Opcode::Fmul, Opcode::Ffma};
    bench.add(kLongOpcodes[i / kBenchLanes % 4], a, b, source.third(a, b));
  }
  bench.finish();
  print_long_row("RTL fadd fsub fmul ffma, random", bench.count(Subnormals::Ieee), bench.count(Subnormals::Flush));
}

}  // namespace
}  // namespace raypool
