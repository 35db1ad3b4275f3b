// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The rows of config/parameters.hpp as objects: for code that goes through all parameters.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "config/configuration.hpp"
#include "files/json_text.hpp"

namespace raypool {

/// A row of the table. Values are integers here, as in the Verilog.
struct Parameter {
  std::string_view section;  ///< the object of a file in which it stands, "chip.memory"; empty: the file itself
  std::string_view key;      ///< in that object
  std::string_view name;     ///< in C++; in upper case in the Verilog, where the chip has none
  bool of_part;              ///< modules of the part `section` take it
  int (*get)(const Configuration& configuration);
  void (*set)(Configuration& configuration, int value);
  Range range;
  Tried tried;
  std::string_view meaning;
};

/// A row of the table of what each ALU type has.
struct AluParameter {
  std::string_view key;
  uint32_t AluConfiguration::*value;
  Range range;
  Tried tried;
  std::string_view meaning;
};

namespace parameter {
inline constexpr Parameter kAll[] = {
// clang-format off
#define RAYPOOL_ROW(section, key, name, of_part, type, range, tried, meaning) \
  {section, key, #name, of_part, [](const Configuration& c) { return static_cast<int>(c.name); }, \
   [](Configuration& c, int value) { c.name = static_cast<type>(value); }, range, tried, meaning},
#define RAYPOOL_UNIT(name, type, value, ...) RAYPOOL_ROW("", #name, name, false, type, __VA_ARGS__)
#define RAYPOOL_PART(part, name, type, value, ...) RAYPOOL_ROW(#part, #name, part##_##name, true, type, __VA_ARGS__)
#define RAYPOOL_ARITHMETIC(name, type, value, ...) RAYPOOL_ROW("arithmetic", #name, name, false, type, __VA_ARGS__)
    // clang-format on
    RAYPOOL_PARAMETERS(RAYPOOL_UNIT, RAYPOOL_PART, RAYPOOL_ARITHMETIC)
#undef RAYPOOL_ARITHMETIC
#undef RAYPOOL_PART
#undef RAYPOOL_UNIT
#undef RAYPOOL_ROW
};

/// Of the chip.
inline constexpr Parameter kOfChip[] = {
// clang-format off
#define RAYPOOL_ROW(section, key, name, type, range, meaning) \
  {section, key, #name, false, [](const Configuration& c) { return static_cast<int>(c.chip.name); }, \
   [](Configuration& c, int value) { c.chip.name = static_cast<type>(value); }, range, all(), meaning},
#define RAYPOOL_CHIP(name, type, value, ...) RAYPOOL_ROW("chip", #name, name, type, __VA_ARGS__)
#define RAYPOOL_PART(part, name, type, value, ...) \
  RAYPOOL_ROW("chip." #part, #name, part##_##name, type, __VA_ARGS__)
    // clang-format on
    RAYPOOL_CHIP_PARAMETERS(RAYPOOL_CHIP, RAYPOOL_PART)
#undef RAYPOOL_PART
#undef RAYPOOL_CHIP
#undef RAYPOOL_ROW
};

inline constexpr AluParameter kOfAlu[] = {
#define RAYPOOL_ROW(name, value, range, tried, meaning) {#name, &AluConfiguration::name, range, tried, meaning},
    RAYPOOL_ALU_PARAMETERS(RAYPOOL_ROW)
#undef RAYPOOL_ROW
};
}  // namespace parameter

/// As files and messages name it: data_cache.mshrs.
std::string path_of(const Parameter& parameter);
/// DATA_CACHE_MSHRS, INT_COUNT
std::string verilog_name(const Parameter& parameter);
std::string verilog_name(AluType type, const AluParameter& parameter);

/// The objects of a file that hold parameters of the unit, in the order of the table.
std::vector<std::string_view> sections();
/// Those of its chip: "chip", "chip.memory", ...
std::vector<std::string_view> chip_sections();

/// Whether the type has it: those that are timed by events stand once, and have no other; only an ALU that may lack
/// something has what it may lack.
bool applies(const AluParameter& parameter, AluType type);
/// What the parameter may be in a configuration: a depth begins at least_depth().
Range range_of(const AluParameter& parameter, AluType type, const Configuration& configuration);
/// In any configuration.
Range range_of(const AluParameter& parameter, AluType type);

/// With this value of the parameter the least depth of the type is more than in some other configuration.
struct DepthRule {
  const Parameter* parameter;
  int value;
  AluType type;
  uint32_t least;
};
std::vector<DepthRule> depth_rules();

/// Of a range of form Name, or the mnemonics of one of form Instructions.
std::vector<std::string_view> names_of(const Range& range);
/// Number of the operation, if a range of form Instructions has the mnemonic.
std::optional<int> operation_named(const Range& range, std::string_view mnemonic);
/// All values that it has.
std::vector<int> values_of(const Range& range);
/// "an integer from 1 to 16"
std::string text_of(const Range& range);

/// A value as files have it: of form Name the name, of form Instructions a list of mnemonics.
nlohmann::ordered_json json_of(const Range& range, int value);
nlohmann::ordered_json json_of(const Parameter& parameter, int value);
/// A value as people read it: without quotes.
std::string text_of(const Parameter& parameter, int value);

}  // namespace raypool
