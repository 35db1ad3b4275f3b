// Every case of the catalogue on engines native and functional, in every mode.
// scripts/tests/extremes.sh has the hardware.
#include "numerics/extremes.hpp"

#include <gtest/gtest.h>

#include <set>

#include "machine/chip/chip_model.hpp"
#include "machine/compute/functional_unit.hpp"
#include "machine/compute/model.hpp"
#include "numerics/extreme_parts.hpp"

namespace raypool::numerics {
namespace {

Configuration small_unit() { return load_configuration("4w4c"); }

class Extremes : public testing::TestWithParam<ArithmeticMode> {
 public:
  static void run_all(const ExtremeMachine& machine) {
    for (const ExtremeCase& extreme : extreme_cases()) {
      const std::string failure = run_extreme(extreme, machine).failure;
      EXPECT_EQ(failure, "") << extreme.theme << ": " << extreme.name << " (" << extreme.expected << ")";
    }
  }
};

TEST_P(Extremes, AreDefinedOnEngineNative) { run_all({"native", GetParam(), small_unit()}); }

TEST_P(Extremes, AreTheSameOnEngineFunctional) {
  run_all({"functional", GetParam(), small_unit(), make_functional_unit});
}

/// The model of the chip around functional units, with the model's traverser.
std::unique_ptr<ChipDevice> chip_model(const Configuration& configuration, Memory& memory) {
  return make_chip_model(configuration, make_model(configuration, memory, 1).device);
}

TEST(ExtremesOnTheChip, AreTheSameInItsModel) {
  Extremes::run_all({"chip", arithmetic_modes().front(), load_configuration("tiny"), chip_model});
}

INSTANTIATE_TEST_SUITE_P(Modes, Extremes, testing::ValuesIn(arithmetic_modes()), [](const auto& instance) {
  std::string name = instance.param.name;
  for (char& c : name) c = c == '-' ? '_' : c;
  return name;
});

TEST(ExtremeCatalogue, NamesAreUnique) {
  std::set<std::string> names;
  for (const ExtremeCase& extreme : extreme_cases())
    EXPECT_TRUE(names.insert(extreme.theme + extreme.name).second) << extreme.name;
  EXPECT_GT(names.size(), 55u);
}

/// A unit with the results of another arithmetic.
UnitMaker functional_in(const arith::Mode& mode) {
  return [mode](const Configuration& configuration, Memory& memory) {
    Configuration other = configuration;
    other.slow_unit = mode.slow_unit;
    other.subnormals = mode.subnormals;
    return make_functional_unit(other, memory);
  };
}

TEST(ExtremeCatalogue, AnEngineOfOtherArithmeticFails) {
  const ArithmeticMode& ieee = arithmetic_modes().front();
  const ExtremeMachine flushing("functional", ieee, small_unit(), functional_in({Subnormals::Flush, SlowUnit::Exact}));
  const ExtremeMachine coarse("functional", ieee, small_unit(), functional_in({Subnormals::Ieee, SlowUnit::Newton0}));
  int flush_failures = 0, coarse_failures = 0;
  for (const ExtremeCase& extreme : extreme_cases()) {
    flush_failures += !run_extreme(extreme, flushing).failure.empty();
    coarse_failures += !run_extreme(extreme, coarse).failure.empty();
  }
  EXPECT_GT(flush_failures, 5);
  EXPECT_GT(coarse_failures, 5);
}

TEST(ExtremeCatalogue, WhatMayBreakWithFewBitsMustBreakAlike) {
  ArithmeticMode narrow = arithmetic_modes().front();
  narrow.mode.significand = 13;
  const ExtremeMachine same("functional", narrow, small_unit(), make_functional_unit);
  const ExtremeMachine other("functional", narrow, small_unit(),
                             [](const Configuration& configuration, Memory& memory) {
                               Configuration wider = configuration;
                               wider.significand = 14;
                               return make_functional_unit(wider, memory);
                             });
  int breaking = 0;
  for (const ExtremeCase& extreme : extreme_cases()) {
    if (extreme.least_significand <= 13) continue;
    const ExtremeOutcome outcome = run_extreme(extreme, same);
    breaking += !outcome.holds;
    EXPECT_EQ(outcome.failure, "") << extreme.name;
    EXPECT_NE(run_extreme(extreme, other).failure, "") << extreme.name;
  }
  EXPECT_EQ(breaking, 1);
}

TEST(ExtremeCatalogue, AFrameThatDoesNotEndFails) {
  // A unit that never takes a launch.
  class Deaf : public ComputeUnit {
   public:
    void reset(uint32_t, uint32_t) override {}
    void set_argument(uint32_t, uint32_t) override {}
    const UnitOutputs& outputs() const override { return outputs_; }
    void clock(const UnitInputs&) override {}
    const UnitTrace& trace() const override { return trace_; }
    uint64_t counter(int) override { return 0; }
    bool timed() const override { return true; }

   private:
    UnitOutputs outputs_;
    UnitTrace trace_;
  };
  const ExtremeMachine machine("deaf", arithmetic_modes().front(), small_unit(),
                               [](const Configuration&, Memory&) { return std::make_unique<Deaf>(); });
  EXPECT_NE(run_extreme(image_extremes().front(), machine).failure, "");
}

}  // namespace
}  // namespace raypool::numerics
