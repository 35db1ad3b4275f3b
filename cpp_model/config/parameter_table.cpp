#include "config/parameter_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "isa/encoding.hpp"
#include "isa/reference.hpp"

namespace raypool {

std::string path_of(const Parameter& parameter) {
  return fmt::format("{}{}{}", parameter.section, parameter.section.empty() ? "" : ".", parameter.key);
}

std::string verilog_name(const Parameter& parameter) { return upper(parameter.name); }

std::string verilog_name(AluType type, const AluParameter& parameter) {
  return fmt::format("{}_{}", verilog_name(type), upper(parameter.key));
}

namespace {

template <size_t count>
std::vector<std::string_view> sections_of(const Parameter (&rows)[count]) {
  std::vector<std::string_view> names;
  for (const Parameter& parameter : rows) {
    if (!parameter.section.empty() && (names.empty() || names.back() != parameter.section))
      names.push_back(parameter.section);
  }
  return names;
}

}  // namespace

std::vector<std::string_view> sections() { return sections_of(parameter::kAll); }

std::vector<std::string_view> chip_sections() { return sections_of(parameter::kOfChip); }

bool applies(const AluParameter& parameter, AluType type) {
  if (parameter.range.form == Range::Form::Instructions) return optional_operations(type) != 0;
  return parameter.value == &AluConfiguration::count || !alu_info(type).timed_by_events();
}

Range range_of(const AluParameter& parameter, AluType type, const Configuration& configuration) {
  Range range = parameter.range;
  if (parameter.value == &AluConfiguration::depth) range.least = least_depth(configuration, type);
  if (range.form == Range::Form::Instructions) {
    range.greatest = static_cast<int>(optional_operations(type));
    range.alu = to_underlying(type);
  }
  return range;
}

namespace {

/// What a type's depth must be with each value of a parameter, the others being as by default.
std::vector<DepthRule> depths(const Parameter& parameter, AluType type) {
  std::vector<DepthRule> rules;
  for (const int value : values_of(parameter.range)) {
    Configuration configuration;
    parameter.set(configuration, value);
    rules.push_back({&parameter, value, type, least_depth(configuration, type)});
  }
  return rules;
}

bool shallower(const DepthRule& a, const DepthRule& b) { return a.least < b.least; }

}  // namespace

Range range_of(const AluParameter& parameter, AluType type) {
  Range range = range_of(parameter, type, Configuration());
  if (parameter.value != &AluConfiguration::depth) return range;
  for (const Parameter& each : parameter::kAll)
    for (const DepthRule& rule : depths(each, type)) range.least = std::min<int>(range.least, rule.least);
  return range;
}

std::vector<DepthRule> depth_rules() {
  std::vector<DepthRule> rules;
  for (const Parameter& parameter : parameter::kAll) {
    for (const AluType type : kEveryAluType) {
      const std::vector<DepthRule> all = depths(parameter, type);
      const DepthRule& least = *std::min_element(all.begin(), all.end(), shallower);
      for (const DepthRule& rule : all)
        if (shallower(least, rule)) rules.push_back(rule);
    }
  }
  return rules;
}

std::vector<std::string_view> names_of(const Range& range) {
  if (range.form == Range::Form::Instructions) {
    std::vector<std::string_view> names;
    for (const InstructionInfo& info : kInstructions)
      if (to_underlying(info.alu()) == range.alu && info.needs == Feature::Optional) names.push_back(info.mnemonic);
    return names;
  }
  return {range.names.begin(), range.names.begin() + range.greatest + 1};
}

std::optional<int> operation_named(const Range& range, std::string_view mnemonic) {
  const InstructionInfo* info = find_instruction(mnemonic);
  if (info == nullptr || to_underlying(info->alu()) != range.alu || info->needs != Feature::Optional)
    return std::nullopt;
  return info->operation();
}

std::vector<int> values_of(const Range& range) {
  std::vector<int> values;
  if (range.form == Range::Form::PowerOfTwo) {
    for (uint32_t value = 0; value <= static_cast<uint32_t>(range.greatest); value = std::max(1u, 2 * value))
      if (range.has(static_cast<int>(value))) values.push_back(static_cast<int>(value));
    return values;
  }
  for (int value = std::min(range.least, 0); value <= range.greatest; ++value)
    if (range.has(value)) values.push_back(value);
  return values;
}

std::string text_of(const Range& range) {
  switch (range.form) {
    case Range::Form::Integer:
      return fmt::format("an integer from {} to {}", range.least, range.greatest);
    case Range::Form::PowerOfTwo:
      return fmt::format("a power of two from {} to {}", range.least, range.greatest);
    case Range::Form::Name:
      return fmt::format("one of {}", fmt::join(names_of(range), ", "));
    case Range::Form::Instructions:
      return fmt::format("a list of some of {}", fmt::join(names_of(range), ", "));
    case Range::Form::OnOff:
      break;
  }
  return "true or false";
}

nlohmann::ordered_json json_of(const Range& range, int value) {
  switch (range.form) {
    case Range::Form::Name:
      return range.names.at(value);
    case Range::Form::OnOff:
      return value != 0;
    case Range::Form::Instructions: {
      nlohmann::ordered_json list = nlohmann::ordered_json::array();
      for (const InstructionInfo& info : kInstructions)
        if (to_underlying(info.alu()) == range.alu && (value >> info.operation() & 1) != 0 && !is_triple(info))
          list.push_back(info.mnemonic);
      return list;
    }
    default:
      return value;
  }
}

nlohmann::ordered_json json_of(const Parameter& parameter, int value) { return json_of(parameter.range, value); }

std::string text_of(const Parameter& parameter, int value) {
  const nlohmann::ordered_json json = json_of(parameter, value);
  return json.is_string() ? json.get<std::string>() : json.dump();
}

}  // namespace raypool
