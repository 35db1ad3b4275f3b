#include "arith/error_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "arith/arith.hpp"
#include "bits.hpp"

namespace raypool::arith {
namespace {

constexpr const char* kUnitNames[] = {"exact", "newton2", "newton1", "newton0"};
constexpr const char* kOperationNames[kSlowOperations] = {"frcp", "frsqrt", "fsqrt", "fdiv"};
constexpr const char* kResultNames[kResults] = {"middle", "largest", "smallest"};
constexpr uint32_t kOne = 0x3f800000u;

uint32_t compute(SlowOperation operation, uint32_t a, uint32_t b, Mode mode) {
  switch (operation) {
    case SlowOperation::Rcp:
      return rcp(a, mode);
    case SlowOperation::Rsqrt:
      return rsqrt(a, mode);
    case SlowOperation::Sqrt:
      return sqrt(a, mode);
    case SlowOperation::Div:
      break;
  }
  return div(a, b, mode);
}

/// A double is some 2^29 times finer than what it judges.
double in_doubles(SlowOperation operation, double x, double y) {
  switch (operation) {
    case SlowOperation::Rcp:
      return 1 / x;
    case SlowOperation::Rsqrt:
      return 1 / std::sqrt(x);
    case SlowOperation::Sqrt:
      return std::sqrt(x);
    case SlowOperation::Div:
      break;
  }
  return x / y;
}

class Measurement {
 public:
  Measurement(SlowUnit slow_unit, SlowOperation operation, Results results) {
    row_.slow_unit = slow_unit;
    row_.operation = operation;
    row_.results = results;
  }

  void add(uint32_t a, uint32_t b) {
    const uint32_t result = compute(row_.operation, a, b, {Subnormals::Ieee, row_.slow_unit});
    const uint32_t rounded = compute(row_.operation, a, b, {Subnormals::Ieee, SlowUnit::Exact});
    bool exponent_right = result >> 23 == rounded >> 23;
    if (row_.results != Results::Middle) {
      exponent_right &= compute(row_.operation, a, b, {Subnormals::Flush, row_.slow_unit}) >> 23 ==
                        compute(row_.operation, a, b, {Subnormals::Flush, SlowUnit::Exact}) >> 23;
    }
    ++row_.inputs;
    row_.exponents += exponent_right ? 0 : 1;
    row_.rounded += result == rounded ? 1 : 0;
    if ((rounded & detail::kMagnitude) != detail::kInfinity) add_error(a, b, result);
  }

  ErrorRow finish() {
    row_.mean_ulp /= static_cast<double>(finite_);
    row_.bias_ulp /= static_cast<double>(finite_);
    row_.rounded /= static_cast<double>(row_.inputs);
    return row_;
  }

 private:
  void add_error(uint32_t a, uint32_t b, uint32_t result) {
    const double exact = in_doubles(row_.operation, as_float(a), as_float(b));
    const int exponent = std::max(std::ilogb(exact), -126);  // subnormal numbers have the smallest normal one's unit
    const double ulps = std::ldexp(double{as_float(result)} - exact, 23 - exponent);
    const double magnitude = std::fabs(ulps);
    if (magnitude > row_.largest_ulp) row_.largest_ulp = magnitude, row_.a = a, row_.b = b;
    row_.mean_ulp += magnitude;
    row_.bias_ulp += ulps;
    ++finite_;
  }

  uint64_t finite_ = 0;
  ErrorRow row_{};
};

/// The operands of a unary operation: from `first` to below `end`.
struct OperandRange {
  uint32_t first, end, step;
};
OperandRange range_of(SlowOperation operation, Results results) {
  constexpr uint32_t kSparse = 7;
  const OperandRange smallest_operands{0x00000001u, 0x01000000u, kSparse},
      largest_operands{0x7e000000u, 0x7f800000u, kSparse};
  switch (results) {
    case Results::Middle:
      return {kOne, kOne + ((operation == SlowOperation::Rcp ? 1u : 2u) << 23), 1};
    case Results::Largest:
      return operation == SlowOperation::Sqrt ? largest_operands : smallest_operands;
    case Results::Smallest:
      break;
  }
  return operation == SlowOperation::Sqrt ? smallest_operands : largest_operands;
}

/// Exponents that bring the quotient of two numbers in 1 .. 2 to 2^125 .. 2^129, or to
/// 2^-151 .. 2^-123; added to a and b.
std::pair<uint32_t, uint32_t> exponents_of(Results results, uint32_t hash) {
  const int offset = static_cast<int>(hash % 32), choice = static_cast<int>(hash / 32);
  int a = 127, b = 127;
  if (results == Results::Largest) a = 254 - offset, b = a - 126 - choice % 3;
  if (results == Results::Smallest) a = 1 + offset, b = a + 124 + choice % 27;
  return {static_cast<uint32_t>(a - 127) << 23, static_cast<uint32_t>(b - 127) << 23};
}

}  // namespace

ErrorRow measure_errors(SlowUnit slow_unit, SlowOperation operation, Results results, uint32_t grid) {
  Measurement measurement(slow_unit, operation, results);
  if (operation != SlowOperation::Div) {
    const OperandRange range = range_of(operation, results);
    for (uint32_t a = range.first; a < range.end; a += range.step) measurement.add(a, 0);
    return measurement.finish();
  }
  if (results != Results::Middle) grid /= 2;
  const uint32_t step = (1u << 23) / grid;
  for (uint32_t i = 0; i < grid; ++i) {
    for (uint32_t j = 0; j < grid; ++j) {
      // The last bits of both come from a multiplicative hash of the pair.
      const uint32_t hash = (i * grid + j) * 2654435761u;
      const auto [a, b] = exponents_of(results, hash >> 16);
      measurement.add(kOne + a + i * step + (hash >> 8) % step, kOne + b + j * step + (hash >> 20) % step);
    }
  }
  return measurement.finish();
}

std::vector<ErrorRow> error_table(uint32_t grid) {
  std::vector<ErrorRow> rows;
  for (int unit = 0; unit < 4; ++unit) {
    for (int operation = 0; operation < kSlowOperations; ++operation) {
      for (int results = 0; results < kResults; ++results) {
        rows.push_back(measure_errors(static_cast<SlowUnit>(unit), static_cast<SlowOperation>(operation),
                                      static_cast<Results>(results), grid));
      }
    }
  }
  return rows;
}

double error_bound(SlowUnit slow_unit, SlowOperation operation) {
  if (slow_unit == SlowUnit::Exact) return 0.5;
  if (slow_unit == SlowUnit::Newton2) return operation == SlowOperation::Div ? 2 : 1;
  return std::numeric_limits<double>::infinity();
}

bool keeps_promise(const ErrorRow& row) {
  return row.exponents == 0 && row.largest_ulp <= error_bound(row.slow_unit, row.operation) + 1e-6;
}

std::string to_text(const std::vector<ErrorRow>& rows) {
  std::string text =
      fmt::format("{:<9}{:<8}{:<9}{:>9}{:>14}  {:<19}{:>12}{:>12}{:>11}{:>11}  {}\n", "unit", "op", "results", "inputs",
                  "largest ulp", "at", "mean ulp", "bias ulp", "rounded", "exponents", "promise");
  for (const ErrorRow& row : rows) {
    const double bound = error_bound(row.slow_unit, row.operation);
    std::string at = fmt::format("{:08x}", row.a);
    if (row.operation == SlowOperation::Div) at += fmt::format(" / {:08x}", row.b);
    text +=
        fmt::format("{:<9}{:<8}{:<9}{:>9}{:>14.4f}  {:<19}{:>12.4f}{:>+12.4f}{:>10.4f}%{:>11}  {} {}\n",
                    kUnitNames[to_underlying(row.slow_unit)], kOperationNames[to_underlying(row.operation)],
                    kResultNames[to_underlying(row.results)], row.inputs, row.largest_ulp, at, row.mean_ulp,
                    row.bias_ulp, 100 * row.rounded, row.exponents,
                    std::isinf(bound) ? "exponent" : fmt::format("{}", bound), keeps_promise(row) ? "kept" : "BROKEN");
  }
  return text;
}

}  // namespace raypool::arith
