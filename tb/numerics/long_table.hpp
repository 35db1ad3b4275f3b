// The table that `make numerics-long` ends with: every program of it prints rows of this form,
// scripts/numerics_long.sh gathers them.
#pragma once

#include <cstdint>
#include <cstdio>
#include <string>

namespace raypool {

/// What was tried in one subnormal mode, and how much of it was wrong.
struct LongCount {
  uint64_t inputs = 0, errors = 0;
};

inline void print_long_head() {
  std::printf("%-48s %16s %8s %16s %8s\n", "operation", "inputs, ieee", "errors", "inputs, flush", "errors");
}
/// For the first column: nothing of the full one.
inline std::string of_significand(uint32_t bits) { return bits == 24 ? "" : ", " + std::to_string(bits) + " bits"; }
inline void print_long_row(const std::string& what, const LongCount& ieee, const LongCount& flush) {
  const auto number = [](uint64_t value) { return static_cast<unsigned long long>(value); };
  std::printf("%-48s %16llu %8llu %16llu %8llu\n", what.c_str(), number(ieee.inputs), number(ieee.errors),
              number(flush.inputs), number(flush.errors));
  std::fflush(stdout);
}

}  // namespace raypool
