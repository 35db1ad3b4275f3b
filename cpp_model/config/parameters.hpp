// The one table of a machine's parameters. Members of Configuration, what a configuration file may say and its schema,
// docs/parameters.md, parameter lists of the Verilog and their checks, raypool.core and the configurations that tests
// walk are derived from it. docs/where.md adds a parameter.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace raypool {

enum class Subnormals : uint8_t { Ieee = 0, Flush = 1 };
enum class SlowUnit : uint8_t { Exact = 0, Newton2 = 1, Newton1 = 2, Newton0 = 3 };

// A row: [part,] name, type in C++, default, values it may have, values that tests try, what it is.
//   UNIT(name, ...)        of the whole unit: `name` in configuration files and in C++, NAME in the Verilog
//   PART(part, name, ...)  of one part: `part.name` in files, part_name in C++, PART_NAME in the Verilog. Its modules
//                          include part_parameters.vh, and whoever instantiates them part_parameter_map.vh
//   ARITHMETIC(name, ...)  a mode of the arithmetic: `arithmetic.name` in files, name in C++, NAME in the Verilog
// clang-format off
#define RAYPOOL_PARAMETERS(UNIT, PART, ARITHMETIC) \
  UNIT(warps, int, 8, powers_of_two(1, 32), tried(1, 2, 4, 8, 16, 32), "warps of a compute unit") \
  UNIT(lanes, int, 8, powers_of_two(1, 32), tried(1, 2, 4, 8, 16, 32), "lanes of an ALU, and threads in a warp") \
  UNIT(stack_depth, int, 8, integers(2, 32), tried(2, 3, 8, 32), "entries of a warp's PC stack") \
  PART(instruction_cache, bytes, int, 4096, powers_of_two(512, 65536), tried(512, 1024, 4096, 65536), "size") \
  PART(data_cache, bytes, int, 8192, powers_of_two(512, 65536), tried(512, 1024, 8192, 65536), "size") \
  PART(data_cache, mshrs, int, 4, integers(1, 16), tried(1, 2, 3, 4, 16), \
       "miss-status holding registers: lines that may be on their way at once") \
  ARITHMETIC(subnormals, Subnormals, Subnormals::Ieee, names("ieee", "flush"), all(), \
             "subnormal numbers: as IEEE 754 says, or zero") \
  ARITHMETIC(slow_unit, SlowUnit, SlowUnit::Exact, names("exact", "newton2", "newton1", "newton0"), all(), \
             "how slw divides and takes roots: with one rounding, or by Newton's method of that many steps") \
  ARITHMETIC(fma, bool, false, on_or_off(), all(), "fused multiply-add: the instruction ffma") \
  /* The table ends here: the backslash above lets a row follow it. */

// What each ALU type has, but for mem and ray, which stand once and are timed by events: `alus.int.count` in files,
// alu(AluType::Int).count in C++, INT_COUNT in the Verilog. A depth begins at least_depth(), which is also its default.
#define RAYPOOL_ALU_PARAMETERS(ROW) \
  ROW(count, 1, integers(1, 4), tried(1, 2, 3, 4), "instances") \
  ROW(latency, 1, integers(1, 16), tried(1, 2, 3, 16), "cycles between new tasks") \
  ROW(depth, 1, integers(0, 32), tried(0, 1, 32), "pipeline stages") \
  /* The table ends here: the backslash above lets a row follow it. */
// clang-format on

/// The values that a parameter may have.
struct Range {
  enum class Form : uint8_t { Integer, PowerOfTwo, Name, OnOff };
  Form form;
  int least, greatest;
  std::array<std::string_view, 4> names{};  ///< of 0, 1, ... of form Name

  constexpr bool has(int value) const {
    return value >= least && value <= greatest && (form != Form::PowerOfTwo || (value & (value - 1)) == 0);
  }
};

/// The values that tests try: the ends, and what lies between and matters. None: all that the parameter may have.
struct Tried {
  std::array<int, 8> values{};
  size_t count = 0;
};

/// What the rows are written with.
namespace parameter {
inline constexpr Range integers(int least, int greatest) { return {Range::Form::Integer, least, greatest}; }
inline constexpr Range powers_of_two(int least, int greatest) { return {Range::Form::PowerOfTwo, least, greatest}; }
inline constexpr Range on_or_off() { return {Range::Form::OnOff, 0, 1}; }
template <typename... Names>
constexpr Range names(Names... of_values) {
  return {Range::Form::Name, 0, static_cast<int>(sizeof...(Names)) - 1, {of_values...}};
}

inline constexpr Tried all() { return {}; }
template <typename... Values>
constexpr Tried tried(Values... values) {
  return {{values...}, sizeof...(Values)};
}
}  // namespace parameter

}  // namespace raypool
