// Parts of a ray's finish that the bench of the whole takes too seldom to their edges: the differences of products,
// with their class compared with rational numbers too, and the digits of a root.
#include <gmp.h>
#include <gtest/gtest.h>
#include <verilated.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <random>

#include "Vcross_products_23.h"
#include "Vcross_products_35.h"
#include "Vroot_digits_15.h"
#include "Vroot_digits_3.h"
#include "machine/traverser/ray_finish.hpp"
#include "scene/exact_rational.hpp"

namespace raypool::bench {
namespace {

/// As rtl/arith/rp_float_widen.v has it: `bits` of them, and a sign.
uint64_t word_of(const Significand& number, int bits) {
  const uint64_t exponent = number.value == 0 ? 0 : static_cast<uint64_t>(number.exponent + bits - 1 + 1023);
  return (uint64_t{number.negative} << 11 | exponent) << (bits - 1) | (number.value & ~(uint64_t{1} << (bits - 1)));
}

/// Three pairs in turn, each product and every sum of theirs: near to each other, far apart, equal, with zeros.
template <typename Unit>
void compare_products(int bits, int triples) {
  Unit u;
  std::mt19937_64 random(5);
  std::array<Significand, 11> expected;
  std::array<Significand, 3> x, y;
  int cancelled = 0, zeros = 0;
  const uint64_t one = uint64_t{1} << (bits - 1);
  const auto draw = [&](int spread) {
    Significand number;
    if (random() % 16 == 0) return number;
    number.negative = random() % 2 == 0;
    number.exponent = static_cast<int>(random() % static_cast<uint64_t>(spread));
    number.value = one | (random() & (one - 1));
    if (random() % 4 == 0) number.value &= ~uint64_t{0} << (bits - 8);
    if (random() % 4 == 0) number.value |= (one - 1) & ~uint64_t{0xff};
    return number;
  };
  for (int cycle = 0; cycle < 3 * triples; ++cycle) {
    const int pair = cycle % 3;
    if (pair == 0) {
      const int spread = random() % 2 == 0 ? 3 : 100;
      for (int k = 0; k < 3; ++k) {
        x[k] = draw(spread);
        y[k] = k > 0 && random() % 2 == 0 ? y[k - 1] : draw(spread);
        if (k > 0 && random() % 2 == 0) x[k] = x[k - 1];
        if (y[k].value != 0 && random() % 4 == 0) y[k].value ^= random() % 4;  // so that differences cancel
      }
    }
    u.x_i = word_of(x[pair], bits);
    u.y_i = word_of(y[pair], bits);
    u.wrap_i = pair == 0;
    u.clk_i = 0;
    u.eval();
    // Eight cycles after pair 0.
    if (cycle >= 12) {
      ASSERT_EQ(u.product_o, word_of(expected[cycle % 11], 32)) << "cycle " << cycle;
    }
    for (int k = 0; pair == 0 && k < 3; ++k) {
      const int next = (k + 1) % 3;
      const Significand product = cross_product(x[next], y[k], y[next], x[k]);
      expected[(cycle + 8 + k) % 11] = product;
      zeros += product.value == 0;
      cancelled += product.value != 0 && product.exponent + 31 < x[next].exponent + y[k].exponent + 2 * bits - 10;
    }
    u.clk_i = 1;
    u.eval();
  }
  u.final();
  EXPECT_GT(zeros, triples / 50);
  EXPECT_GT(cancelled, triples / 50);
}

TEST(CrossProducts, AreThoseOfTheClass) {
  compare_products<Vcross_products_35>(36, 300'000);
  compare_products<Vcross_products_23>(24, 300'000);
}

TEST(CrossProducts, OfTheClassAreRationalNumbersRoundedOnce) {
  std::mt19937_64 random(6);
  int cancelled = 0, ties = 0, zeros = 0;
  for (int i = 0; i < 200'000; ++i) {
    const auto draw = [&] {
      const uint64_t value = (uint64_t{1} << 39 | random() >> 25) & ~uint64_t{0} << random() % 32;
      const double size = std::ldexp(static_cast<double>(value), static_cast<int>(random() % (i % 2 == 0 ? 3 : 90)));
      return random() % 32 == 0 ? 0 : random() % 2 == 0 ? -size : size;
    };
    const double a = draw(), b = draw(), c = random() % 2 == 0 ? a : draw();
    double d = random() % 2 == 0 ? b : draw();
    if (random() % 4 == 0 && d != 0) d += std::ldexp(random() % 2 == 0 ? -1 : 1, std::ilogb(d) - 37);
    const Significand product = cross_product({a, 40}, {b, 40}, {c, 40}, {d, 40});
    const Exact exact = Exact(a) * Exact(b) - Exact(c) * Exact(d);
    const double expected = exact.rounded(32), shown = std::ldexp(static_cast<double>(product.value), product.exponent);
    ASSERT_EQ(product.negative ? -shown : shown, expected) << a << " " << b << " " << c << " " << d;
    const Exact off = exact - Exact(expected), half(std::ldexp(0.5, product.exponent));
    zeros += expected == 0;
    ties += expected != 0 && ((off - half).sign() == 0 || (off + half).sign() == 0);
    cancelled += expected != 0 && std::fabs(expected) < std::fabs(a * b) * 0x1p-10;
  }
  EXPECT_GT(zeros, 1'000);
  EXPECT_GT(ties, 1'000);
  EXPECT_GT(cancelled, 1'000);
}

/// A number in three cycles, or more.
template <typename Unit>
void compare_roots(int digits, int numbers, const std::function<uint64_t(int)>& number) {
  Unit u;
  std::mt19937 random(7);
  const int blocks = digits / 3;
  uint64_t taken = 0;  // bit k: k cycles ago
  std::array<uint64_t, 64> values{};
  int next = 0, wait = 0, found = 0;
  for (int cycle = 0; next < numbers || taken != 0; ++cycle) {
    const bool comes = wait == 0 && next < numbers;
    if (comes) {
      values[cycle % 64] = number(next++);
      wait = random() % 4 == 0 ? 3 + static_cast<int>(random() % 4) : 3;
    }
    wait -= wait > 0;
    taken = (taken << 1 | uint64_t{comes}) & ((uint64_t{2} << digits) - 1);
    u.value_i = comes ? values[cycle % 64] : random() % 4;
    u.take_i = 0;
    for (int block = 0; block < blocks; ++block) u.take_i |= static_cast<uint32_t>(taken >> (3 * block) & 1) << block;
    u.clk_i = 0;
    u.eval();
    if ((taken >> digits & 1) != 0) {
      const uint64_t value = values[(cycle - digits) % 64], root = u.root_o;
      ASSERT_TRUE(root * root <= value && value - root * root <= 2 * root) << value << ": " << root;
      ++found;
    }
    u.clk_i = 1;
    u.eval();
  }
  u.final();
  EXPECT_EQ(found, numbers);
}

TEST(RootDigits, AreThoseOfTheRootCutOff) {
  compare_roots<Vroot_digits_3>(3, 3 << 12, [](int i) { return (uint64_t{1} << 12) + static_cast<uint64_t>(i); });
  std::mt19937_64 random(8);
  compare_roots<Vroot_digits_15>(15, 300'000, [&](int i) {
    const uint64_t root = uint64_t{1} << 30 | random() >> 34;
    if (i % 3 == 0) return root * root - (random() % 2 != 0 && root > uint64_t{1} << 30 ? 1 : 0);
    return std::max(random() >> 2, uint64_t{1} << 60);
  });
}

}  // namespace
}  // namespace raypool::bench
