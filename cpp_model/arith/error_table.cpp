#include "arith/error_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "arith/arith.hpp"

namespace raypool::arith {
namespace {

constexpr const char* kUnitNames[] = {"exact", "newton2", "newton1", "newton0"};
constexpr const char* kOperationNames[kSlowOperations] = {"frcp", "frsqrt", "fsqrt", "fdiv"};
constexpr uint32_t kOne = 0x3f800000u;

class Measurement {
 public:
  Measurement(SlowUnit slow_unit, SlowOperation operation) : mode_{Subnormals::Ieee, slow_unit} {
    row_.slow_unit = slow_unit;
    row_.operation = operation;
  }

  void add(uint32_t a, uint32_t b) {
    // A double is some 2^29 times finer than what it judges; whether a result is correctly rounded the exact unit knows.
    const double x = detail::to_float(a), y = detail::to_float(b);
    uint32_t result = 0, rounded = 0;
    double exact = 0;
    switch (row_.operation) {
      case SlowOperation::Rcp:
        result = rcp(a, mode_), rounded = rcp(a, kExact), exact = 1 / x;
        break;
      case SlowOperation::Rsqrt:
        result = rsqrt(a, mode_), rounded = rsqrt(a, kExact), exact = 1 / std::sqrt(x);
        break;
      case SlowOperation::Sqrt:
        result = sqrt(a, mode_), rounded = sqrt(a, kExact), exact = std::sqrt(x);
        break;
      case SlowOperation::Div:
        result = div(a, b, mode_), rounded = div(a, b, kExact), exact = x / y;
        break;
    }
    const int exponent = std::ilogb(exact);
    const double ulps = std::ldexp(double{detail::to_float(result)} - exact, 23 - exponent);
    const double magnitude = std::fabs(ulps);
    if (magnitude > row_.largest_ulp) row_.largest_ulp = magnitude, row_.a = a, row_.b = b;
    row_.mean_ulp += magnitude;
    row_.bias_ulp += ulps;
    row_.rounded += result == rounded ? 1 : 0;
    ++row_.inputs;
  }

  ErrorRow finish() {
    const auto count = static_cast<double>(row_.inputs);
    row_.mean_ulp /= count;
    row_.bias_ulp /= count;
    row_.rounded /= count;
    return row_;
  }

 private:
  static constexpr Mode kExact{Subnormals::Ieee, SlowUnit::Exact};
  Mode mode_;
  ErrorRow row_{};
};

}  // namespace

ErrorRow measure_errors(SlowUnit slow_unit, SlowOperation operation, uint32_t grid) {
  Measurement measurement(slow_unit, operation);
  if (operation == SlowOperation::Div) {
    const uint32_t step = (1u << 23) / grid;
    for (uint32_t i = 0; i < grid; ++i) {
      for (uint32_t j = 0; j < grid; ++j) {
        // The last bits of both come from a multiplicative hash of the pair.
        const uint32_t hash = (i * grid + j) * 2654435761u;
        measurement.add(kOne + i * step + (hash >> 8) % step, kOne + j * step + (hash >> 20) % step);
      }
    }
  } else {
    const uint32_t binades = operation == SlowOperation::Rcp ? 1 : 2;
    for (uint32_t a = kOne; a < kOne + (binades << 23); ++a) measurement.add(a, 0);
  }
  return measurement.finish();
}

std::vector<ErrorRow> error_table(uint32_t grid) {
  std::vector<ErrorRow> rows;
  for (int unit = 0; unit < 4; ++unit) {
    for (int operation = 0; operation < kSlowOperations; ++operation) {
      rows.push_back(measure_errors(static_cast<SlowUnit>(unit), static_cast<SlowOperation>(operation), grid));
    }
  }
  return rows;
}

double error_bound(SlowUnit slow_unit, SlowOperation operation) {
  if (slow_unit == SlowUnit::Exact) return 0.5;
  if (slow_unit == SlowUnit::Newton2) return operation == SlowOperation::Div ? 2 : 1;
  return std::numeric_limits<double>::infinity();
}

bool keeps_promise(const ErrorRow& row) { return row.largest_ulp <= error_bound(row.slow_unit, row.operation) + 1e-6; }

std::string to_text(const std::vector<ErrorRow>& rows) {
  std::string text = fmt::format("{:<9}{:<8}{:>10}{:>14}  {:<19}{:>14}{:>14}{:>11}  {}\n", "unit", "op", "inputs", "largest ulp",
                                 "at", "mean ulp", "bias ulp", "rounded", "promise");
  for (const ErrorRow& row : rows) {
    const double bound = error_bound(row.slow_unit, row.operation);
    std::string at = fmt::format("{:08x}", row.a);
    if (row.operation == SlowOperation::Div) at += fmt::format(" / {:08x}", row.b);
    text += fmt::format("{:<9}{:<8}{:>10}{:>14.4f}  {:<19}{:>14.4f}{:>+14.4f}{:>10.4f}%  {}\n",
                        kUnitNames[static_cast<int>(row.slow_unit)], kOperationNames[static_cast<int>(row.operation)], row.inputs,
                        row.largest_ulp, at, row.mean_ulp, row.bias_ulp, 100 * row.rounded,
                        std::isinf(bound) ? "none" : fmt::format("{} {}", bound, keeps_promise(row) ? "kept" : "BROKEN"));
  }
  return text;
}

}  // namespace raypool::arith
