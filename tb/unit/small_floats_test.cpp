// Adder, multiplier and fused multiply-add are parameterised by their widths, so that narrow ones can be tried with all operands
// there are. Against exact integers: every triple of 8-bit numbers, every pair of 16-bit ones (long).
#include <gtest/gtest.h>
#include <verilated.h>

#include <array>
#include <cstdint>
#include <cstdio>
#include <deque>
#include <memory>
#include <random>

#include "Vsmall_floats_16.h"
#include "Vsmall_floats_8.h"
#include "exact_float.hpp"

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
  uint64_t compared() const { return compared_; }
  bool failed() const { return failures_ > 0; }

 private:
  struct Due {
    uint32_t a, b, c;
    bool subtract;
    uint8_t what;
  };

  uint32_t result(uint32_t port, int mode) const { return port >> (mode * bits_) & ((1u << bits_) - 1); }

  void compare(const char* unit, int mode, const Due& due, uint32_t rtl, uint32_t exact) {
    ++compared_;
    if (rtl == exact || ++failures_ > 10) return;
    ADD_FAILURE() << unit << (mode != 0 ? " flush" : " ieee") << std::hex << ": a " << due.a << " b " << due.b << " c " << due.c
                  << (due.subtract ? " subtract" : "") << ": RTL " << rtl << " exact " << exact;
  }
  void check_separate(const Due& due) {
    for (int mode = 0; mode < 2; ++mode) {
      const ExactFloat& reference = references_[static_cast<size_t>(mode)];
      if (due.what & kSum) {
        compare("adder", mode, due, result(top_.sum_o, mode),
                due.subtract ? reference.sub(due.a, due.b) : reference.add(due.a, due.b));
      }
      if (due.what & kProduct) compare("multiplier", mode, due, result(top_.product_o, mode), reference.mul(due.a, due.b));
    }
  }
  void check_fused(const Due& due) {
    for (int mode = 0; mode < 2; ++mode) {
      const ExactFloat& reference = references_[static_cast<size_t>(mode)];
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
  uint64_t now_ = 0, compared_ = 0;
  int failures_ = 0;
};
using Eight = SmallFloats<Vsmall_floats_8>;
using Sixteen = SmallFloats<Vsmall_floats_16>;

TEST(SmallFloats, EveryTripleOfEightBitNumbersIsRight) {
  Eight run(4, 3);
  for (uint32_t a = 0; a < 256; ++a) {
    for (uint32_t b = 0; b < 256; ++b) {
      for (const bool subtract : {false, true}) run(a, b, 0, subtract, Eight::kSum | Eight::kProduct | Eight::kFusedProduct);
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

// Names with Long: in `make numerics-long` only.
TEST(SmallFloatsLong, EveryPairOfSixteenBitNumbersIsRight) {
  Sixteen run(5, 10);
  for (uint32_t a = 0; a < 65536 && !run.failed(); ++a) {
    for (uint32_t b = 0; b < 65536; ++b) run(a, b, 0, (a ^ b) % 2 != 0, Sixteen::kSum | Sixteen::kProduct);
    if (a % 4096 == 0) std::fprintf(stderr, "%u of 65536 first operands\n", a);
  }
  run.finish();
  std::printf("%llu results compared\n", static_cast<unsigned long long>(run.compared()));
}

TEST(SmallFloatsLong, ManyTriplesOfSixteenBitNumbersAreRight) {
  Sixteen run(5, 10);
  std::mt19937_64 random(6);
  for (int i = 0; i < 300000000 && !run.failed(); ++i) {
    const uint64_t bits = random();
    run(bits & 0xffff, bits >> 16 & 0xffff, bits >> 32 & 0xffff, false, Sixteen::kFused);
  }
  run.finish();
  std::printf("%llu results compared\n", static_cast<unsigned long long>(run.compared()));
}

}  // namespace
}  // namespace raypool
