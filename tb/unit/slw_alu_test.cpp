// rtl/slw_alu.v in every pair of subnormal mode and slow unit against the model of arithmetic.
#include "Vslw_group_units.h"
#include "Vslw_units.h"
#include "alu_bench.hpp"
#include "alu_model.hpp"

namespace raypool {
namespace {

constexpr uint64_t kSeed = 815;

std::vector<AluUnderTest> units() {
  std::vector<AluUnderTest> all;
  for (int m = 0; m < 8; ++m) {
    const auto subnormals = static_cast<Subnormals>(m / 4);
    const auto slow_unit = static_cast<SlowUnit>(m % 4);
    const std::string names[] = {"exact", "newton2", "newton1", "newton0"};
    Configuration configuration;
    configuration.slow_unit = slow_unit;
    all.push_back({names[m % 4] + (m / 4 ? " flush" : " ieee"),
                   {subnormals, slow_unit},
                   least_depth(configuration, AluType::Slw) + (m < 6 ? 0 : 2)});
  }
  return all;
}

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

TEST(SlwAlu, EveryPairOfSpecialValuesAgreesWithTheModel) {
  AluBench<Vslw_units> bench(units(), slw_model, kSeed);
  const std::vector<uint32_t> specials = arith::special_operands();
  const std::vector<Opcode> opcodes = opcodes_of(AluType::Slw);
  for (const Opcode opcode : opcodes) {
    for (const uint32_t a : specials) {
      for (const uint32_t b : specials) bench.add(opcode, a, b);
    }
  }
  bench.finish();
  EXPECT_EQ(bench.compared(), 8 * opcodes.size() * specials.size() * specials.size());
}

TEST(SlwAlu, RandomPairsAgreeWithTheModel) {
  AluBench<Vslw_units> bench(units(), slw_model, kSeed);
  arith::OperandSource source(kSeed);
  std::mt19937_64 random(kSeed);
  const std::vector<Opcode> opcodes = opcodes_of(AluType::Slw);
  for (int i = 0; i < 400000; i += kBenchLanes) {
    const Opcode opcode = random() % 3 == 0 ? Opcode::Fdiv : opcodes[random() % opcodes.size()];
    for (int l = 0; l < kBenchLanes; ++l) {
      auto [a, b] = source.next();
      if (opcode != Opcode::Fdiv && random() % 2) a &= 0x7fffffffu;  // most roots of something positive
      bench.add(opcode, a, b);
    }
  }
  bench.finish();
  EXPECT_GE(bench.compared(), 3200000u);
}

TEST(SlwAlu, MantissasAllOverTheRangeAgreeWithTheModel) {
  // The exact unit's table and rounding depend on the mantissa, a root's also on whether the exponent is odd.
  AluBench<Vslw_units> bench(units(), slw_model, kSeed);
  for (uint32_t a = 0x3f800000u; a < 0x40800000u; a += 127) {
    bench.add(Opcode::Frsqrt, a, 0);
  }
  for (uint32_t a = 0x3f800000u; a < 0x40800000u; a += 211) bench.add(Opcode::Fsqrt, a, 0);
  for (uint32_t a = 0x3f800000u; a < 0x40000000u; a += 101) bench.add(Opcode::Frcp, a, 0);
  bench.finish();
}

// Names with Long: in `make numerics-long` only.
TEST(SlwAluLong, EveryMantissaAgreesWithTheModel) {
  AluBench<Vslw_units> bench(units(), slw_model, kSeed);
  for (uint32_t a = 0x3f800000u; a < 0x40800000u; ++a) bench.add(Opcode::Fsqrt, a, 0);
  for (uint32_t a = 0x3f800000u; a < 0x40800000u; ++a) bench.add(Opcode::Frsqrt, a, 0);
  for (uint32_t a = 0x3f800000u; a < 0x40000000u; ++a) bench.add(Opcode::Frcp, a, 0);
  bench.finish();
  print_long_row("RTL fsqrt frsqrt frcp, every mantissa", bench.count(Subnormals::Ieee),
                 bench.count(Subnormals::Flush));
}

TEST(SlwAluLong, ManyRandomQuotientsAgreeWithTheModel) {
  AluBench<Vslw_units> bench(units(), slw_model, kSeed + 1);
  arith::OperandSource source(kSeed + 1);
  for (int i = 0; i < 10000000; ++i) {
    const auto [a, b] = source.next();
    bench.add(Opcode::Fdiv, a, b);
  }
  bench.finish();
  print_long_row("RTL fdiv, random", bench.count(Subnormals::Ieee), bench.count(Subnormals::Flush));
}

TEST(SlwAlu, SubnormalQuotientsOnTheMiddleGoToEven) {
  // n * 2^-149 / 2^k, whose last bits are shifted out: exact ties among them.
  AluBench<Vslw_units> bench(units(), slw_model, kSeed);
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
