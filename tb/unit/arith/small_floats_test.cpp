// Adder, multiplier and fused multiply-add are parameterised by their widths, so that narrow ones can be
// tried with all operands there are. Against exact integers: every triple of 8-bit numbers, the product
// of every pair of 16-bit ones (long).
#include <gtest/gtest.h>
#include <verilated.h>

#include <array>
#include <cstdint>
#include <cstdio>
#include <deque>
#include <memory>
#include <random>

#include "Vmultiply_tree_11.h"
#include "Vsmall_floats_16.h"
#include "Vsmall_floats_8.h"
#include "Vsmall_products_quick.h"
#include "Vsmall_products_tree.h"
#include "numerics/long_table.hpp"
#include "unit/arith/exact_float.hpp"

namespace raypool {
namespace {

template <typename Top>
class SmallFloats {
 public:
  SmallFloats(int exponent_bits, int mantissa_bits)
      : bits_(1 + exponent_bits + mantissa_bits),
        references_{ExactFloat(exponent_bits, mantissa_bits, false), ExactFloat(exponent_bits, mantissa_bits, true)},
        top_(&context_) {}
  ~SmallFloats() { top_.final(); }

  enum What : uint8_t { kSum = 1, kProduct = 2, kFused = 4, kFusedProduct = 8 };

  /// One operation of each of the wanted units; results of earlier ones are compared.
  void operator()(uint32_t a, uint32_t b, uint32_t c, bool subtract, uint8_t what) {
    top_.a_i = a, top_.b_i = b, top_.c_i = c;
    top_.subtract_i = subtract;
    top_.multiply_i = (what & kFusedProduct) != 0;
    due_[now_ % due_.size()] = {a, b, c, subtract, what};
    // Operands are held, so stage k shows what was put in k cycles before.
    top_.clk_i = 0;
    top_.eval();
    if (now_ >= 2) check_separate(due_[(now_ - 2) % due_.size()]);
    if (now_ >= 4) check_fused(due_[(now_ - 4) % due_.size()]);
    top_.clk_i = 1;
    top_.eval();
    ++now_;
  }
  void finish() {
    for (int i = 0; i < 4; ++i) (*this)(0, 0, 0, false, 0);
  }
  uint64_t compared() const { return counts_[0].inputs + counts_[1].inputs; }
  bool failed() const { return counts_[0].errors + counts_[1].errors > 0; }
  const LongCount& count(int mode) const { return counts_[mode]; }

 private:
  struct Due {
    uint32_t a, b, c;
    bool subtract;
    uint8_t what;
  };

  uint32_t result(uint32_t port, int mode) const { return port >> (mode * bits_) & ((1u << bits_) - 1); }

  void compare(const char* unit, int mode, const Due& due, uint32_t rtl, uint32_t exact) {
    LongCount& count = counts_[mode];
    ++count.inputs;
    if (rtl == exact || ++count.errors > 5) return;
    ADD_FAILURE() << unit << (mode != 0 ? " flush" : " ieee") << std::hex << ": a " << due.a << " b " << due.b << " c "
                  << due.c << (due.subtract ? " subtract" : "") << ": RTL " << rtl << " exact " << exact;
  }
  void check_separate(const Due& due) {
    for (int mode = 0; mode < 2; ++mode) {
      const ExactFloat& reference = references_[mode];
      if (due.what & kSum) {
        compare("adder", mode, due, result(top_.sum_o, mode),
                due.subtract ? reference.sub(due.a, due.b) : reference.add(due.a, due.b));
      }
      if (due.what & kProduct)
        compare("multiplier", mode, due, result(top_.product_o, mode), reference.mul(due.a, due.b));
    }
  }
  void check_fused(const Due& due) {
    for (int mode = 0; mode < 2; ++mode) {
      const ExactFloat& reference = references_[mode];
      if (due.what & kFused) compare("fma", mode, due, result(top_.fused_o, mode), reference.fma(due.a, due.b, due.c));
      if (due.what & kFusedProduct)
        compare("fma as multiplier", mode, due, result(top_.fused_o, mode), reference.mul(due.a, due.b));
    }
  }

  int bits_;
  std::array<ExactFloat, 2> references_;
  VerilatedContext context_;
  Top top_;
  std::array<Due, 8> due_{};
  uint64_t now_ = 0;
  std::array<LongCount, 2> counts_;
};
using Eight = SmallFloats<Vsmall_floats_8>;
using Sixteen = SmallFloats<Vsmall_floats_16>;

TEST(SmallFloats, EveryTripleOfEightBitNumbersIsRight) {
  Eight run(4, 3);
  for (uint32_t a = 0; a < 256; ++a) {
    for (uint32_t b = 0; b < 256; ++b) {
      for (const bool subtract : {false, true})
        run(a, b, 0, subtract, Eight::kSum | Eight::kProduct | Eight::kFusedProduct);
      for (uint32_t c = 0; c < 256; ++c) run(a, b, c, false, Eight::kFused);
    }
    if (run.failed()) break;
  }
  run.finish();
  EXPECT_EQ(run.compared(), 65536u * 2 * (6 + 256));
}

TEST(SmallFloats, RandomSixteenBitNumbersAreRight) {
  Sixteen run(5, 10);
  std::mt19937_64 random(5);
  for (int i = 0; i < 3000000 && !run.failed(); ++i) {
    const uint64_t bits = random();
    auto a = static_cast<uint32_t>(bits & 0xffff), b = static_cast<uint32_t>(bits >> 16 & 0xffff);
    const auto c = static_cast<uint32_t>(bits >> 32 & 0xffff);
    run(a, b, c, (bits >> 48 & 1) != 0, Sixteen::kSum | Sixteen::kProduct | Sixteen::kFused);
  }
  run.finish();
  EXPECT_EQ(run.compared(), 3000000u * 6);
}

// The multipliers take nothing of their tree but the sum of its two numbers.
TEST(SmallFloats, TheTreeMultipliesEveryPairOfElevenBitMantissas) {
  VerilatedContext context;
  Vmultiply_tree_11 top(&context);
  uint64_t wrong = 0;
  for (uint32_t a = 0; a < 2048; ++a) {
    for (uint32_t b = 0; b < 2048; ++b) {
      top.a_i = static_cast<uint16_t>(a), top.b_i = static_cast<uint16_t>(b);
      top.eval();
      wrong += ((top.sum_o + top.carry_o) & 0x3fffff) != a * b;
    }
  }
  top.final();
  EXPECT_EQ(wrong, 0u);
}

/// The product of every pair of 16-bit numbers with a first one below `end`.
template <typename Top>
std::array<LongCount, 2> multiply_every_pair(uint32_t end) {
  constexpr uint32_t kLanes = 16, kBits = 16, kSteps = 65536 / kLanes;
  const std::array<ExactFloat, 2> references{ExactFloat(5, 10, false), ExactFloat(5, 10, true)};
  std::array<LongCount, 2> counts;
  VerilatedContext context;
  Top top(&context);
  for (uint32_t i = 0; i < end * kSteps + 2; ++i) {
    top.a_i = static_cast<uint16_t>(i / kSteps);
    for (uint32_t l = 0; l < kLanes; l += 2) {
      const uint32_t b = i % kSteps * kLanes + l;
      top.b_i[l / 2] = b | (b + 1) << kBits;
    }
    top.clk_i = 0;
    top.eval();
    for (uint32_t lane = 0; i >= 2 && lane < 2 * kLanes; ++lane) {
      const uint32_t a = (i - 2) / kSteps, b = (i - 2) % kSteps * kLanes + lane % kLanes, mode = lane / kLanes;
      const uint32_t rtl = top.product_o[lane / 2] >> (lane % 2 * kBits) & 0xffff, exact = references[mode].mul(a, b);
      ++counts[mode].inputs;
      if (rtl == exact || ++counts[mode].errors > 5) continue;
      ADD_FAILURE() << "multiplier" << (mode != 0 ? " flush" : " ieee") << std::hex << ": a " << a << " b " << b
                    << ": RTL " << rtl << " exact " << exact;
    }
    top.clk_i = 1;
    top.eval();
    if (end == 65536 && i % (4096 * kSteps) == 0) std::fprintf(stderr, "%u of %u first operands\n", i / kSteps, end);
  }
  top.final();
  EXPECT_EQ(counts[0].inputs + counts[1].inputs, uint64_t{2} * end * 65536);
  return counts;
}

TEST(SmallFloats, ProductsAreTheSameWithAndWithoutTheTree) {
  multiply_every_pair<Vsmall_products_quick>(3);
  multiply_every_pair<Vsmall_products_tree>(3);
}

// Names with Long: in `make numerics-long` only.
TEST(SmallFloatsLong, TheProductOfEveryPairOfSixteenBitNumbersIsRight) {
  const auto counts = multiply_every_pair<Vsmall_products_quick>(65536);
  print_long_row("RTL 16-bit multiplier, every pair", counts[0], counts[1]);
}

// Names with Hours: by hand.
TEST(SmallFloatsHours, TheProductOfEveryPairThroughTheTreeIsRight) {
  const auto counts = multiply_every_pair<Vsmall_products_tree>(65536);
  print_long_row("RTL 16-bit multiplier and tree, every pair", counts[0], counts[1]);
}

TEST(SmallFloatsLong, ManyTriplesOfSixteenBitNumbersAreRight) {
  Sixteen run(5, 10);
  std::mt19937_64 random(6);
  for (int i = 0; i < 300000000 && !run.failed(); ++i) {
    const uint64_t bits = random();
    run(bits & 0xffff, bits >> 16 & 0xffff, bits >> 32 & 0xffff, false, Sixteen::kFused);
  }
  run.finish();
  print_long_row("RTL 16-bit fused unit, random triples", run.count(0), run.count(1));
}

}  // namespace
}  // namespace raypool
