// Writes docs/machine/parameters.md.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "config/parameter_table.hpp"
#include "config/reference.hpp"

namespace raypool {
namespace {

constexpr const char* kIntroduction = R"(# Parameters

Generated from the one table, `cpp_model/config/parameters.hpp`, by `raypool isa --write`; a test compares. Do not edit.

A configuration is a JSON file: one in `configs/`, or your own. What it leaves out has its default;
`raypool config FILE` prints all of it. [where.md](../develop/where.md#a-parameter-from-json-to-its-module) shows a
parameter's path to the module that uses it, and adds one.

| in the file | in the Verilog | values | default | what it is |
| --- | --- | --- | --- | --- |
)";

constexpr const char* kChipTable = R"(
What stands around the unit, which [chip.md](chip.md) describes, has its own. None of them is in the Verilog, so
machines that differ in nothing else share a Verilated unit. The defaults are the thesis' chip.

| in the file | values | default | what it is |
| --- | --- | --- | --- |
)";

constexpr const char* kChipRules = R"(
A row of an eye tile, 2^ceil(k/2) pixels for 2^k contents, must fit into `chip.held_limit`, and that into
`chip.intersection_pool.size`, which is its default.
)";

constexpr const char* kAlus = R"(
Each ALU type but mem and ray, which stand once and are timed by events, has these, the least depth being also the
default:

| in the file | in the Verilog | values | default | what it is |
| --- | --- | --- | --- | --- |
)";

constexpr const char* kDepths = R"(
| ALU type | least depth |
| --- | --- |
)";

constexpr const char* kInstructionsLacked = R"(
A unit may lack instructions, and then has nothing that only these need: `"without": ["imul", "sar"]`, or `--set
alus.int.without=imul,sar`. In the Verilog they are a number with a bit for each operation. They are illegal there
([architecture.md](architecture.md)).

| ALU type | may be without |
| --- | --- |
)";

/// `in_verilog`: with the number by which the Verilog knows a name.
std::string values_text(const Parameter& parameter, bool in_verilog) {
  const Range& range = parameter.range;
  switch (range.form) {
    case Range::Form::Integer:
      return fmt::format("{} .. {}", range.least, range.greatest);
    case Range::Form::PowerOfTwo:
      return fmt::format("{}, {}, {} .. {}", range.least, 2 * range.least, 4 * range.least, range.greatest);
    case Range::Form::Name:
    case Range::Form::OnOff:
    case Range::Form::Instructions:
      break;
  }
  std::vector<std::string> values;
  for (const int value : values_of(range)) {
    const std::string text = json_of(parameter, value).dump();
    values.push_back(in_verilog ? fmt::format("{} = {}", text, value) : text);
  }
  return fmt::format("{}", fmt::join(values, ", "));
}

}  // namespace

std::string parameters_markdown() {
  std::string text = kIntroduction;
  const Configuration defaults;
  for (const Parameter& parameter : parameter::kAll) {
    text += fmt::format("| {} | {} | {} | {} | {} |\n", path_of(parameter), verilog_name(parameter),
                        values_text(parameter, true), text_of(parameter, parameter.get(defaults)), parameter.meaning);
  }
  text += kAlus;
  for (const AluParameter& parameter : parameter::kOfAlu) {
    if (parameter.range.form == Range::Form::Instructions) {
      text += fmt::format("| alus.int.{} ... | {} ... | as below | none | {} |\n", parameter.key,
                          verilog_name(AluType::Int, parameter), parameter.meaning);
      continue;
    }
    const bool depth = parameter.value == &AluConfiguration::depth;
    text += fmt::format("| alus.int.{} ... | {} ... | {} .. {} | {} | {} |\n", parameter.key,
                        verilog_name(AluType::Int, parameter), depth ? "least" : std::to_string(parameter.range.least),
                        parameter.range.greatest,
                        depth ? "the least" : std::to_string(AluConfiguration().*parameter.value), parameter.meaning);
  }
  text += kDepths;
  for (const AluType alu : kEveryAluType) {
    if (alu_info(alu).timed_by_events()) continue;
    for (const AluParameter& parameter : parameter::kOfAlu) {
      if (parameter.value != &AluConfiguration::depth) continue;
      text += fmt::format("| {} | {}", kAluNames[alu], range_of(parameter, alu).least);
    }
    for (const DepthRule& rule : depth_rules()) {
      if (rule.type != alu) continue;
      text +=
          fmt::format("; {} with {} {}", rule.least, path_of(*rule.parameter), text_of(*rule.parameter, rule.value));
    }
    text += " |\n";
  }
  text += kInstructionsLacked;
  for (const AluType alu : kEveryAluType) {
    if (optional_operations(alu) == 0) continue;
    for (const AluParameter& parameter : parameter::kOfAlu)
      if (parameter.range.form == Range::Form::Instructions)
        text += fmt::format("| {} | {} |\n", kAluNames[alu], fmt::join(names_of(range_of(parameter, alu)), ", "));
  }
  text += kChipTable;
  for (const Parameter& parameter : parameter::kOfChip) {
    text += fmt::format("| {} | {} | {} | {} |\n", path_of(parameter), values_text(parameter, false),
                        text_of(parameter, parameter.get(defaults)), parameter.meaning);
  }
  return text + kChipRules;
}

}  // namespace raypool
