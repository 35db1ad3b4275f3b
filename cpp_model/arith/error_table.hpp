// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Errors of the slow unit's operations, measured.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "config/configuration.hpp"

namespace raypool::arith {

enum class SlowOperation : uint8_t { Rcp, Rsqrt, Sqrt, Div };
inline constexpr int kSlowOperations = 4;
/// Which results: around 1, the largest there are and infinity, or the smallest, subnormal ones and zero among them.
enum class Results : uint8_t { Middle, Largest, Smallest };
inline constexpr int kResults = 3;

/// Errors in units in the last place of the exact result, over a set of operands.
struct ErrorRow {
  SlowUnit slow_unit;
  SlowOperation operation;
  Results results;
  uint64_t inputs;     ///< how many operands, or pairs of them
  uint64_t exponents;  ///< how many results have another exponent than the exact one's, in either subnormal mode
  double largest_ulp;  ///< magnitude, as what follows of those that are finite
  uint32_t a, b;       ///< operands that show it; b of a division only
  double mean_ulp;     ///< of magnitudes
  double bias_ulp;     ///< mean with signs: negative is towards zero
  double rounded;      ///< share that is correctly rounded, 0 .. 1
};

/// Middle: frcp over every mantissa (1 .. 2), frsqrt and fsqrt over every mantissa and both parities of the
/// exponent (1 .. 4); fdiv over `grid` x `grid` pairs of mantissas spread evenly, with varying last bits. Subnormal
/// mode has no influence there. The others: every seventh operand with such a result, of fdiv a quarter of the pairs.
/// A row takes some tenths of a second.
ErrorRow measure_errors(SlowUnit slow_unit, SlowOperation operation, Results results = Results::Middle,
                        uint32_t grid = 4096);

/// All units, operations and ranges of results.
std::vector<ErrorRow> error_table(uint32_t grid = 4096);
std::string to_text(const std::vector<ErrorRow>& rows);

/// The largest error that an operation of the unit may have, ulp: half for exact, 1 (division 2) for newton2;
/// infinity for those without a promise.
double error_bound(SlowUnit slow_unit, SlowOperation operation);
/// Whether the row's largest error is within that bound and every exponent right; doubles judge,
/// so a millionth of a unit is theirs.
bool keeps_promise(const ErrorRow& row);

}  // namespace raypool::arith
