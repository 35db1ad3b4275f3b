// The blocks inside rtl/traverser/rp_ray_finish.v: products, sizes and quotients of what a ray carries on of its hit.
#include <algorithm>
#include <cmath>

#include "lockstep/block_rules.hpp"
#include "machine/traverser/ray_finish.hpp"

namespace raypool::lockstep {
namespace {

constexpr uint32_t kBits = 43, kFraction = 31;

/// As hardware has it, with a fraction of 31 bits.
uint64_t word_of(const Significand& number) {
  if (number.value == 0) return 0;
  const uint64_t exponent = static_cast<uint64_t>(number.exponent + static_cast<int>(kFraction) + kExponentBias);
  return uint64_t{number.negative} << (kBits - 1) | exponent << kFraction | (number.value & ((1u << kFraction) - 1));
}

class CrossProductsRule : public BlockRule {
 public:
  explicit CrossProductsRule(const Block& block) : BlockRule(block) {}
  void forget() override {
    pairs_.clear();
    wraps_.clear();
  }
  void compare(Findings& findings) override {
    check_normaliser(findings);
    // The products of three pairs follow each other, the first one eight cycles after the first pair.
    constexpr size_t kFirst = 8, kWrap = 3;
    for (size_t number = 0; number < 3; ++number) {
      const size_t since = kFirst + number;
      const bool* const wraps = wraps_.ago(since - kWrap);
      if (wraps == nullptr || !*wraps) continue;
      const Pair *a = pairs_.ago(since - number), *b = pairs_.ago(since - (number + 1) % 3);
      if (a == nullptr || b == nullptr) continue;
      expect(findings, product_.wide(0, kBits), word_of(cross_product(b->x, a->y, b->y, a->x)), "cross product");
    }
  }
  void take() override {
    pairs_.push({significand(x_), significand(y_)});
    wraps_.push(wrap_.value() != 0);
  }

 private:
  struct Pair {
    Significand x, y;
  };
  static Significand significand(const Wire& wire) {
    const uint32_t fraction = wire.width() - 1 - kExponentBits;
    const Number number = Number::of(wire.wide(0, wire.width()), fraction);
    Significand result;
    result.negative = number.negative;
    if (number.exponent == 0) return result;
    result.value = uint64_t{1} << fraction | number.fraction;
    result.exponent = static_cast<int>(number.exponent) - kExponentBias - static_cast<int>(fraction);
    return result;
  }
  // By an even number of places, so that the first bit is one of the first two.
  void check_normaliser(Findings& findings) const {
    const std::string files = "rtl/arith/rp_normaliser.v, rtl/arith/rp_cross_products.v";
    const uint32_t width = sum_.width();
    uint32_t zeros = 0;
    while (zeros < width && !sum_.flag(width - 1 - zeros)) ++zeros;
    if (zeros == width) return;
    const uint32_t places = zeros & ~1u;
    expect(findings, places_.value(), places, "places that a sum is moved", files);
    for (uint32_t bit = 0; bit < width; ++bit)
      if (!expect(findings, moved_.flag(bit), bit >= places && sum_.flag(bit - places), "sum that is moved", files))
        return;
  }

  Wire wrap_ = wire("wrap_i"), x_ = wire("x_i"), y_ = wire("y_i"), product_ = wire("product_o"), sum_ = wire("sum_6"),
       moved_ = wire("moved_6"), places_ = wire("places_6");
  History<Pair> pairs_;
  History<bool> wraps_;
};

/// Of three numbers, while all of them are shown.
class LargestExponentRule : public BlockRule {
 public:
  explicit LargestExponentRule(const Block& block) : BlockRule(block) {}
  void forget() override {
    exponents_.clear();
    firsts_.clear();
  }
  void compare(Findings& findings) override {
    constexpr size_t kDelay = 4;
    for (size_t number = 0; number < 3; ++number) {
      const bool* const first = firsts_.ago(kDelay + number);
      if (first == nullptr || !*first) continue;
      uint32_t largest = 0;
      for (size_t i = 0; i < 3; ++i) largest = std::max(largest, *exponents_.ago(kDelay + number - i));
      expect(findings, largest_.value(), largest, "largest exponent");
    }
  }
  void take() override {
    exponents_.push(Number::of(number_.wide(0, kBits), kFraction).exponent);
    firsts_.push(first_.value() != 0);
  }

 private:
  Wire first_ = wire("first_i"), number_ = wire("number_i"), largest_ = wire("largest_o");
  History<uint32_t> exponents_;
  History<bool> firsts_;
};

/// A normal's length, of the normal; and the normal once more.
class NormalLengthRule : public BlockRule {
 public:
  explicit NormalLengthRule(const Block& block) : BlockRule(block) {}
  void forget() override {
    normals_.clear();
    firsts_.clear();
  }
  void compare(Findings& findings) override {
    constexpr size_t kMade = 14, kLength = 40, kAgain = 59;
    const auto begun = [&](size_t ago) {
      const bool* const first = firsts_.ago(ago);
      return first != nullptr && *first;
    };
    if (begun(kLength - kMade)) check_length(findings, kLength - kMade);
    for (size_t number = 0; number < 3; ++number)
      if (begun(kAgain - kMade + number))
        expect(findings, again_.wide(0, kBits), *normals_.ago(kAgain - kMade), "component of a normal, later",
               "rtl/traverser/rp_triangle_normal.v, rtl/common/rp_ram_delay.v");
  }
  void take() override {
    constexpr uint32_t kFirst = 14 - 1;  // bits are numbered from 1
    normals_.push(normal_.wide(0, kBits));
    firsts_.push(first_.flag(kFirst));
  }

 private:
  void check_length(Findings& findings, size_t ago) const {
    uint32_t largest = 0;
    for (size_t i = 0; i < 3; ++i) largest = std::max(largest, Number::of(*normals_.ago(ago - i), kFraction).exponent);
    if (largest == 0) return;
    uint64_t sum = 0;
    for (size_t i = 0; i < 3; ++i) {
      const Number normal = Number::of(*normals_.ago(ago - i), kFraction);
      const uint32_t places = largest - normal.exponent;
      if (normal.exponent == 0 || places > 31) continue;
      const uint64_t units = ((1u << 30) | normal.fraction >> 1) >> places;
      sum += units * units;
    }
    const uint32_t more = sum >> 62 != 0 ? 1 : 0;
    sum >>= 2 * more;
    auto root = static_cast<uint64_t>(std::sqrt(static_cast<double>(sum)));
    while (root * root > sum) --root;
    while ((root + 1) * (root + 1) <= sum) ++root;
    const uint64_t length = uint64_t{largest + more} << kFraction | (root & ((1u << 30) - 1)) << 1;
    expect(findings, length_.wide(0, kBits), length, "length of a normal",
           "rtl/traverser/rp_triangle_normal.v, rtl/arith/rp_root_digits.v");
  }

  Wire first_ = wire("first_i"), normal_ = wire("normal_14"), length_ = wire("length_40_o"),
       again_ = wire("normal_59_o");
  History<uint64_t> normals_;
  History<bool> firsts_;
};

}  // namespace

void add_finish_rules(std::vector<std::unique_ptr<BlockRule>>& rules, const Block& finish) {
  const Block normal = finish.inner("normal", "triangle_normal"), shares = finish.inner("shares", "triangle_shares");
  add_rule<CrossProductsRule>(rules, normal.inner("normals", "cross_products"));
  add_rule<CrossProductsRule>(rules, shares.inner("weights", "cross_products"));
  add_rule<LargestExponentRule>(rules, normal.inner("largest", "largest_exponent"));
  add_rule<LargestExponentRule>(rules, shares.inner("largest", "largest_exponent"));
  add_rule<NormalLengthRule>(rules, normal);
  add_quotient_rule(rules, finish.inner("quotients", "quotient_digits"));
  for (const char* shorten : {"shorten", "shorten_normal"})
    add_shorten_rule(rules, finish.inner(shorten, "float_shorten"));
}

}  // namespace raypool::lockstep
