// Extremes of single operations: results are the same in every mode but where subnormal numbers are concerned, and
// with a shorter significand where a row's numbers have one too; elsewhere the engines must agree.
#include <fmt/format.h>

#include <string_view>

#include "numerics/extremes.hpp"

namespace raypool::numerics {
namespace {

constexpr uint32_t kOne = 0x3f800000, kMinusOne = 0xbf800000, kHalf = 0x3f000000, kTwo = 0x40000000;
constexpr uint32_t kZero = 0, kMinusZero = 0x80000000;
constexpr uint32_t kInfinity = 0x7f800000, kMinusInfinity = 0xff800000;
constexpr uint32_t kQuietNan = 0x7fc00000, kOtherNan = 0xffa5a5a5;
constexpr uint32_t kLargest = 0x7f7fffff;
constexpr uint32_t kSmallestNormal = 0x00800000, kLargestSubnormal = 0x007fffff, kSmallest = 0x00000001;

/// One operation and its result, with subnormal numbers and without.
struct Row {
  const char* mnemonic;
  uint32_t a, b;
  uint32_t ieee, flush;
};
constexpr Row same(const char* mnemonic, uint32_t a, uint32_t b, uint32_t result) {
  return {mnemonic, a, b, result, result};
}

/// Whether a float, or a result of this operation, has no bits below the machine's significand. What is rounded to such
/// a number with 24 bits is rounded to it with fewer.
bool has(const ExtremeMachine& machine, uint32_t a) {
  return (a & ~(~uint32_t{0} << (arith::kFullSignificand - machine.mode().mode.significand))) == 0;
}
bool has_result(const ExtremeMachine& machine, std::string_view mnemonic, uint32_t result) {
  return mnemonic == "f2i" || has(machine, result);
}
bool has_operand(const ExtremeMachine& machine, std::string_view mnemonic, uint32_t a) {
  return mnemonic == "i2f" || has(machine, a);
}

ExtremeCase arithmetic_case(const char* name, const char* expected, std::vector<Row> rows) {
  return {"arithmetic", name, expected, [rows = std::move(rows)](const ExtremeMachine& machine) {
            for (const Row& row : rows) {
              const uint32_t wanted = machine.flushes() ? row.flush : row.ieee;
              const uint32_t result = machine.operate(row.mnemonic, row.a, row.b);
              if (!has_operand(machine, row.mnemonic, row.a) || !has(machine, row.b)) continue;
              if (!has_result(machine, row.mnemonic, wanted)) continue;
              require(result == wanted, fmt::format("{} of {:08x} and {:08x} is {:08x}, not {:08x}", row.mnemonic,
                                                    row.a, row.b, result, wanted));
            }
          }};
}

/// a * b + c: with one rounding where the mode has ffma, with two where it has not.
struct SumRow {
  uint32_t a, b, c;
  uint32_t fused_ieee, fused_flush, separate_ieee, separate_flush;
};
constexpr SumRow same_sum(uint32_t a, uint32_t b, uint32_t c, uint32_t result) {
  return {a, b, c, result, result, result, result};
}

ExtremeCase make_sums(const char* name, const char* expected, std::vector<SumRow> rows) {
  return {"arithmetic", name, expected, [rows = std::move(rows)](const ExtremeMachine& machine) {
            const bool fused = machine.mode().mode.fused;
            for (const SumRow& row : rows) {
              const uint32_t with_ffma = machine.flushes() ? row.fused_flush : row.fused_ieee;
              const uint32_t wanted = fused ? with_ffma : machine.flushes() ? row.separate_flush : row.separate_ieee;
              const uint32_t result = fused ? machine.operate("ffma", row.a, row.b, row.c)
                                            : machine.operate("fadd", machine.operate("fmul", row.a, row.b), row.c);
              if (!has(machine, row.a) || !has(machine, row.b) || !has(machine, row.c) || !has(machine, wanted))
                continue;
              require(result == wanted, fmt::format("{:08x} * {:08x} + {:08x} is {:08x}, not {:08x}", row.a, row.b,
                                                    row.c, result, wanted));
            }
          }};
}

}  // namespace

// NOLINTNEXTLINE(readability-function-size): a list
std::vector<ExtremeCase> arithmetic_extremes() {
  return {
      arithmetic_case("division by zero", "infinity of the signs' product",
                      {same("fdiv", kOne, kZero, kInfinity), same("fdiv", kOne, kMinusZero, kMinusInfinity),
                       same("fdiv", kMinusOne, kZero, kMinusInfinity), same("fdiv", kInfinity, kZero, kInfinity),
                       same("frcp", kZero, 0, kInfinity), same("frcp", kMinusZero, 0, kMinusInfinity)}),
      arithmetic_case("division of zero", "zero of the signs' product; by zero or NaN 7FC00000",
                      {same("fdiv", kZero, kOne, kZero), same("fdiv", kZero, kMinusOne, kMinusZero),
                       same("fdiv", kMinusZero, kOne, kMinusZero), same("fdiv", kZero, kInfinity, kZero),
                       same("fdiv", kZero, kZero, kQuietNan), same("fdiv", kMinusZero, kZero, kQuietNan),
                       same("fdiv", kZero, kOtherNan, kQuietNan)}),
      arithmetic_case(
          "division of and by infinity", "zero or infinity; infinity by infinity 7FC00000",
          {same("fdiv", kOne, kInfinity, kZero), same("fdiv", kOne, kMinusInfinity, kMinusZero),
           same("fdiv", kInfinity, kMinusOne, kMinusInfinity), same("fdiv", kInfinity, kMinusInfinity, kQuietNan),
           same("frcp", kMinusInfinity, 0, kMinusZero)}),
      arithmetic_case("division out of range", "infinity above, gradual underflow or zero below",
                      {same("fdiv", kLargest, kHalf, kInfinity),
                       same("fdiv", kSmallestNormal, 0x7f000000, kZero),
                       {"fdiv", kSmallestNormal, kTwo, 0x00400000, kZero},
                       {"fdiv", kMinusOne, 0x7f000000, 0x80400000, kMinusZero},
                       same("fdiv", kOne, 0x7e800000, kSmallestNormal)}),
      arithmetic_case("roots of negatives", "7FC00000; flushed, a subnormal is a zero",
                      {same("fsqrt", kMinusOne, 0, kQuietNan),
                       same("fsqrt", kMinusInfinity, 0, kQuietNan),
                       same("frsqrt", kMinusOne, 0, kQuietNan),
                       same("frsqrt", kMinusInfinity, 0, kQuietNan),
                       {"fsqrt", kMinusZero | kSmallest, 0, kQuietNan, kMinusZero},
                       {"frsqrt", kMinusZero | kSmallest, 0, kQuietNan, kMinusInfinity}}),
      arithmetic_case("roots of zeros and infinity", "fsqrt(-0) = -0, frsqrt(-0) = -infinity",
                      {same("fsqrt", kMinusZero, 0, kMinusZero), same("fsqrt", kZero, 0, kZero),
                       same("frsqrt", kMinusZero, 0, kMinusInfinity), same("frsqrt", kZero, 0, kInfinity),
                       same("fsqrt", kInfinity, 0, kInfinity), same("frsqrt", kInfinity, 0, kZero),
                       same("fsqrt", kOtherNan, 0, kQuietNan)}),
      arithmetic_case(
          "infinity minus infinity", "7FC00000",
          {same("fsub", kInfinity, kInfinity, kQuietNan), same("fadd", kInfinity, kMinusInfinity, kQuietNan),
           same("fadd", kMinusInfinity, kInfinity, kQuietNan), same("fadd", kInfinity, kInfinity, kInfinity),
           same("fsub", kMinusInfinity, kInfinity, kMinusInfinity), same("fadd", kInfinity, kOtherNan, kQuietNan)}),
      arithmetic_case("zero times infinity", "7FC00000",
                      {same("fmul", kZero, kInfinity, kQuietNan),
                       same("fmul", kMinusInfinity, kZero, kQuietNan),
                       same("fmul", kMinusZero, kInfinity, kQuietNan),
                       same("fmul", kMinusOne, kInfinity, kMinusInfinity),
                       {"fmul", kSmallest, kInfinity, kInfinity, kQuietNan}}),
      arithmetic_case("zeros and their signs", "x - x is +0; -0 only from -0 and -0, or a product",
                      {same("fsub", kOne, kOne, kZero), same("fadd", kMinusZero, kZero, kZero),
                       same("fadd", kMinusZero, kMinusZero, kMinusZero), same("fsub", kMinusZero, kZero, kMinusZero),
                       same("fmul", kMinusZero, kOne, kMinusZero), same("fmul", kMinusZero, kMinusOne, kZero)}),
      arithmetic_case("overflow", "infinity from the middle above the largest number on",
                      {same("fadd", kLargest, kLargest, kInfinity), same("fmul", kLargest, kTwo, kInfinity),
                       same("fadd", kLargest, 0x73000000, kInfinity), same("fadd", kLargest, 0x72ffffff, kLargest),
                       same("fmul", 0xff7fffff, kTwo, kMinusInfinity)}),
      arithmetic_case("conversion to integer out of range", "80000000 or 7FFFFFFF; NaN 0",
                      {same("f2i", 0x4f000000, 0, 0x7fffffff), same("f2i", 0x4effffff, 0, 0x7fffff80),
                       same("f2i", 0xcf000000, 0, 0x80000000), same("f2i", 0xcf000001, 0, 0x80000000),
                       same("f2i", kInfinity, 0, 0x7fffffff), same("f2i", kMinusInfinity, 0, 0x80000000),
                       same("f2i", kQuietNan, 0, 0), same("f2i", kOtherNan, 0, 0)}),
      arithmetic_case("conversion to integer near zero", "towards zero; no negative zero",
                      {same("f2i", kMinusZero, 0, 0), same("f2i", 0x3f7fffff, 0, 0), same("f2i", 0xbf7fffff, 0, 0),
                       same("f2i", kSmallest, 0, 0), same("f2i", kMinusOne, 0, 0xffffffff)}),
      arithmetic_case(
          "conversion from integer", "to nearest even",
          {same("i2f", 0x7fffffff, 0, 0x4f000000), same("i2f", 0x80000000, 0, 0xcf000000),
           same("i2f", 0x01000001, 0, 0x4b800000), same("i2f", 0x01000003, 0, 0x4b800002), same("i2f", 0, 0, 0)}),
      arithmetic_case("the smallest normal's neighbours, sums", "exact; flushed, a subnormal operand or result is zero",
                      {{"fsub", kSmallestNormal, kSmallest, kLargestSubnormal, kSmallestNormal},
                       {"fadd", kLargestSubnormal, kSmallest, kSmallestNormal, kZero},
                       {"fsub", kSmallestNormal + 1, kSmallestNormal, kSmallest, kZero},
                       {"fsub", kSmallestNormal, kSmallestNormal + 1, kMinusZero | kSmallest, kMinusZero},
                       same("fadd", kSmallestNormal, kSmallestNormal, 0x01000000)}),
      arithmetic_case("the smallest normal's neighbours, products",
                      "tiny is judged after rounding to 24 bits of any exponent",
                      {{"fmul", kSmallestNormal, kHalf, 0x00400000, kZero},
                       {"fmul", 0x3f7fffff, kSmallestNormal, kSmallestNormal, kZero},
                       same("fmul", 0x3f000001, 0x00fffffe, kSmallestNormal),
                       {"fmul", kSmallest, kHalf, kZero, kZero},
                       {"fmul", kSmallest, 0x3f000001, kSmallest, kZero}}),
      arithmetic_case("the smallest normal's neighbours, reciprocals and roots",
                      "subnormal operands are numbers; flushed, they are zeros",
                      {{"frcp", 0x7f000000, 0, 0x00400000, kZero},
                       {"frcp", 0x00400000, 0, 0x7f000000, kInfinity},
                       same("frcp", 0x00200000, 0, kInfinity),
                       same("frcp", 0x7e800000, 0, kSmallestNormal),
                       {"frsqrt", 0x00200000, 0, 0x5f800000, kInfinity},
                       same("frsqrt", kSmallestNormal, 0, 0x5f000000)}),
      make_sums("products with an addend, NaNs, infinities and zeros",
                "7FC00000 for zero times infinity and unlike infinities; -0 only from -0 and -0",
                {same_sum(kZero, kInfinity, kOne, kQuietNan), same_sum(kMinusInfinity, kZero, kOtherNan, kQuietNan),
                 same_sum(kOne, kOne, kOtherNan, kQuietNan), same_sum(kInfinity, kOne, kMinusInfinity, kQuietNan),
                 same_sum(kInfinity, kMinusOne, kInfinity, kQuietNan), same_sum(kInfinity, kOne, kInfinity, kInfinity),
                 same_sum(kOne, kOne, kMinusInfinity, kMinusInfinity), same_sum(kOne, kOne, kMinusOne, kZero),
                 same_sum(kMinusZero, kOne, kMinusZero, kMinusZero), same_sum(kMinusZero, kOne, kZero, kZero)}),
      make_sums("products with an addend, roundings", "one rounding with ffma, two without",
                {{kLargest, kTwo, 0xff7fffff, kLargest, kLargest, kInfinity, kInfinity},
                 {0x3f800001, 0x3f800001, 0xbf800002, 0x28800000, 0x28800000, kZero, kZero},
                 {0x1a000000, 0x1a000000, kSmallest, 0x00000002, kZero, kSmallest, kZero},
                 {kSmallestNormal, kOne, kMinusZero | (kSmallestNormal + 1), kMinusZero | kSmallest, kMinusZero,
                  kMinusZero | kSmallest, kMinusZero},
                 {0x00c00000, kHalf, kSmallestNormal, 0x00e00000, 0x00e00000, 0x00e00000, kSmallestNormal}}),
      arithmetic_case("smaller and larger", "the number beside a NaN; -0 below +0",
                      {same("fmin", kOtherNan, kOne, kOne),
                       same("fmax", kOne, kOtherNan, kOne),
                       same("fmin", kQuietNan, kOtherNan, kQuietNan),
                       same("fmin", kZero, kMinusZero, kMinusZero),
                       same("fmax", kMinusZero, kZero, kZero),
                       same("fmin", kMinusInfinity, kMinusOne, kMinusInfinity),
                       {"fmax", kSmallest, kMinusOne, kSmallest, kZero}}),
      arithmetic_case("compares", "false with a NaN, but fne true; -0 equals +0",
                      {same("feq", kQuietNan, kQuietNan, 0),
                       same("fne", kQuietNan, kQuietNan, 1),
                       same("flt", kQuietNan, kOne, 0),
                       same("fle", kOne, kQuietNan, 0),
                       same("fgt", kQuietNan, kOne, 0),
                       same("fge", kOne, kQuietNan, 0),
                       same("feq", kZero, kMinusZero, 1),
                       same("flt", kMinusZero, kZero, 0),
                       same("flt", kLargest, kInfinity, 1),
                       {"flt", kZero, kSmallest, 1, 0},
                       {"feq", kSmallest, kMinusZero, 0, 1}}),
  };
}

}  // namespace raypool::numerics
