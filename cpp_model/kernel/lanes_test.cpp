#include "kernel/lanes.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "arith/test_operands.hpp"

namespace raypool::kernel {
namespace {

using Pairs = std::vector<std::pair<uint32_t, uint32_t>>;

Pairs operands() {
  Pairs pairs;
  const std::vector<uint32_t> special = arith::special_operands();
  for (const uint32_t a : special)
    for (const uint32_t b : special) pairs.emplace_back(a, b);
  arith::OperandSource source(3);
  for (int i = 0; i < 20000; ++i) pairs.push_back(source.next());
  pairs.resize(pairs.size() / kLanes * kLanes);
  return pairs;
}

/// Both sides of each pair, in lanes.
template <typename OfLanes, typename Scalar>
void compare(const char* name, const OfLanes& of_lanes, const Scalar& scalar) {
  const Pairs pairs = operands();
  for (size_t first = 0; first < pairs.size(); first += kLanes) {
    Words a{}, b{};
    for (size_t l = 0; l < kLanes; ++l) a[l] = pairs[first + l].first, b[l] = pairs[first + l].second;
    const Words result = of_lanes(a, b);
    for (size_t l = 0; l < kLanes; ++l) {
      const uint32_t lane = result[l];
      ASSERT_EQ(lane, scalar(pairs[first + l].first, pairs[first + l].second))
          << name << " of " << std::hex << pairs[first + l].first << " and " << pairs[first + l].second;
    }
  }
}

template <bool kPlain>
void compare_all(const arith::Mode& mode) {
  const LaneArithmetic<kPlain> lanes(mode);
  const auto same = [&](const char* name, auto of_lanes, auto scalar) {
    compare(
        name, [&](const Words& a, const Words& b) { return of_lanes(a, b); },
        [&](uint32_t a, uint32_t b) { return scalar(a, b); });
  };
  const auto truth = [](bool value) { return value ? ~0u : 0u; };
#define RAYPOOL_SAME(name)                                                     \
  same(                                                                        \
      #name, [&](const Words& a, const Words& b) { return lanes.name(a, b); }, \
      [&](uint32_t a, uint32_t b) { return arith::name(a, b, mode); })
#define RAYPOOL_SAME_OF_ONE(name)                                         \
  same(                                                                   \
      #name, [&](const Words& a, const Words&) { return lanes.name(a); }, \
      [&](uint32_t a, uint32_t) { return arith::name(a, mode); })
#define RAYPOOL_SAME_TRUTH(name)                                               \
  same(                                                                        \
      #name, [&](const Words& a, const Words& b) { return lanes.name(a, b); }, \
      [&](uint32_t a, uint32_t b) { return truth(arith::name(a, b, mode)); })
  RAYPOOL_SAME(add);
  RAYPOOL_SAME(sub);
  RAYPOOL_SAME(mul);
  RAYPOOL_SAME(min);
  RAYPOOL_SAME(max);
  RAYPOOL_SAME(div);
  RAYPOOL_SAME_OF_ONE(rcp);
  RAYPOOL_SAME_OF_ONE(sqrt);
  RAYPOOL_SAME_OF_ONE(rsqrt);
  RAYPOOL_SAME_OF_ONE(from_int);
  RAYPOOL_SAME_OF_ONE(to_int);
  RAYPOOL_SAME_TRUTH(equal);
  RAYPOOL_SAME_TRUTH(not_equal);
  RAYPOOL_SAME_TRUTH(less);
  RAYPOOL_SAME_TRUTH(less_equal);
  same(
      "fma", [&](const Words& a, const Words& b) { return lanes.fma(a, b, b ^ 0x80000001u); },
      [&](uint32_t a, uint32_t b) { return arith::fma(a, b, b ^ 0x80000001u, mode); });
}

TEST(Lanes, HaveTheArithmeticOfOneThread) {
  for (const SlowUnit unit : {SlowUnit::Exact, SlowUnit::Newton1}) {
    compare_all<true>({Subnormals::Ieee, unit, false, arith::kFullSignificand});
    compare_all<false>({Subnormals::Ieee, unit, false, arith::kFullSignificand});
    compare_all<false>({Subnormals::Flush, unit, false, arith::kFullSignificand});
    compare_all<false>({Subnormals::Ieee, unit, false, 17});
  }
}

}  // namespace
}  // namespace raypool::kernel
