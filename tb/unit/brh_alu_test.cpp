// rtl/brh_alu.v in both subnormal modes against the model of arithmetic: compares, predicate logic, decisions of control.
#include "Vbrh_units.h"
#include "alu_bench.hpp"
#include "alu_model.hpp"

namespace raypool {
namespace {

constexpr uint64_t kSeed = 1301;
constexpr int kFirstLogic = 16, kOperations = 20, kFirstControl = 24, kJnone = 25, kPastControl = 30;

std::vector<AluUnderTest> units() {
  return {{"ieee", {Subnormals::Ieee, SlowUnit::Exact}, 2}, {"flush", {Subnormals::Flush, SlowUnit::Exact}, 5}};
}

/// Control decides for all lanes.
uint32_t compared(int operation, uint32_t mask, arith::Mode) {
  return operation >= kFirstControl ? (1u << kBenchLanes) - 1 : mask;
}

TEST(BrhAlu, EveryPairOfBoundaryValuesComparesAsTheModelDoes) {
  AluBench<Vbrh_units> bench(units(), brh_model, kSeed, compared);
  const std::vector<uint32_t> values = arith::boundary_operands();
  for (int operation = 0; operation < kFirstLogic; ++operation) {
    for (const uint32_t a : values) {
      for (const uint32_t b : values) bench.add(operation, a, b);
    }
  }
  bench.finish();
  EXPECT_EQ(bench.compared(), 2 * kFirstLogic * values.size() * values.size());
}

TEST(BrhAlu, RandomPairsAgreeWithTheModel) {
  AluBench<Vbrh_units> bench(units(), brh_model, kSeed, compared);
  arith::OperandSource source(kSeed);
  std::mt19937_64 random(kSeed);
  for (int i = 0; i < 600000; i += kBenchLanes) {
    const int operation = static_cast<int>(random() % kOperations);
    for (int l = 0; l < kBenchLanes; ++l) {
      auto [a, b] = source.next();
      if (random() % 4 == 0) b = a ^ (random() % 2 != 0 ? 0 : 1u << random() % 32);  // equal, or but for one bit
      bench.add(operation, a, b, static_cast<uint32_t>(random()));
    }
  }
  bench.finish();
  EXPECT_GE(bench.compared(), 1000000u);
}

TEST(BrhAlu, ControlDecidesForEveryLaneWhetherAnyIsInTheMask) {
  AluBench<Vbrh_units> bench(units(), brh_model, kSeed, compared);
  std::mt19937_64 random(kSeed);
  for (int i = 0; i < 20000; ++i) {
    const int operation = kFirstControl + static_cast<int>(random() % (kPastControl - kFirstControl));
    const bool asks = operation == 24 || operation == kJnone || operation == 27;  // jany, jnone, loop
    if (random() % 2 != 0) {
      bench.add(operation, static_cast<uint32_t>(random()), 0, static_cast<uint32_t>(random()));
    } else {
      bench.add_outside(operation, operation == kJnone || !asks ? 1 : 0);
    }
  }
  bench.finish();
  EXPECT_GE(bench.compared(), 80000u);
}

}  // namespace
}  // namespace raypool
