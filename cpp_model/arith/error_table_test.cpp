#include "arith/error_table.hpp"

#include <gtest/gtest.h>

#include <cstdio>

#include "arith/arith.hpp"
#include "bits.hpp"

namespace raypool::arith {
namespace {

TEST(ErrorTable, EveryUnitKeepsItsPromise) {
  const std::vector<ErrorRow> rows = error_table(1024);
  std::fputs(to_text(rows).c_str(), stdout);
  ASSERT_EQ(rows.size(), 48u);
  for (const ErrorRow& row : rows) {
    EXPECT_TRUE(keeps_promise(row)) << to_text({row});
    if (row.slow_unit == SlowUnit::Exact) {
      EXPECT_EQ(row.rounded, 1.0);
    }
    if (row.slow_unit == SlowUnit::Newton1) {
      EXPECT_LE(row.largest_ulp, 1200);
    }
    if (row.slow_unit == SlowUnit::Newton0) {
      EXPECT_LE(row.largest_ulp, 8e4);
    }
    EXPECT_LE(std::fabs(row.bias_ulp), row.mean_ulp);
    EXPECT_EQ(row.exponents, 0u);
  }
}

TEST(ErrorTable, TheLargestErrorCanBeSeenAtItsOperand) {
  const ErrorRow row = measure_errors(SlowUnit::Newton1, SlowOperation::Rcp);
  const uint32_t result = rcp(row.a, {Subnormals::Ieee, SlowUnit::Newton1});
  const double exact = 1 / double{as_float(row.a)};
  EXPECT_NEAR(std::fabs(as_float(result) - exact) * 0x1p24, row.largest_ulp, 1e-3);
  EXPECT_EQ(row.inputs, uint64_t{1} << 23);
}

}  // namespace
}  // namespace raypool::arith
