// Writes what modules of rtl/ include for their parameters: lists, connections, checks.
#include <fmt/format.h>

#include <algorithm>

#include "config/parameter_table.hpp"
#include "config/reference.hpp"

namespace raypool {
namespace {

constexpr const char* kGenerated =
    "  // Generated from cpp_model/config/parameters.hpp by `raypool isa --write`; a test compares. Do not edit.\n";

std::string parameter_line(const std::string& name, int value) {
  return fmt::format("  parameter integer {} = {},\n", name, value);
}

std::string connection_line(const std::string& name) { return fmt::format("  .{0}({0}),\n", name); }

/// Elaboration stops at the missing module; its name is the message.
std::string check(const std::string& name, Range range) {
  std::string wrong = fmt::format("{0} < {1} || {0} > {2}", name, range.least, range.greatest);
  if (range.form == Range::Form::Instructions)
    wrong = fmt::format("({} & ~{}) != 0", name, range.greatest);
  else if (range.form == Range::Form::PowerOfTwo)
    wrong += fmt::format(" ||\n        ({0} & ({0} - 1)) != 0", name);
  else
    range.form = Range::Form::Integer;  // as which the Verilog knows it
  std::string must =
      range.form == Range::Form::Instructions ? "bits of instructions that a unit may lack" : text_of(range);
  std::replace(must.begin(), must.end(), ' ', '_');
  return fmt::format("    if ({}) begin : gen_bad_{}\n      {}_must_be_{} illegal ();\n    end\n", wrong, name, name,
                     must);
}

std::string as_body(const std::string& checks) {
  return fmt::format("{}  generate\n{}  endgenerate\n", kGenerated, checks);
}

std::string unit_checks() {
  std::string checks;
  for (const Parameter& parameter : parameter::kAll)
    if (!parameter.of_part) checks += check(verilog_name(parameter), parameter.range);
  for (const AluParameter& parameter : parameter::kOfAlu) {
    for (const AluType alu : kEveryAluType) {
      if (!alu_info(alu).timed_by_events() && applies(parameter, alu))
        checks += check(verilog_name(alu, parameter), range_of(parameter, alu));
    }
  }
  return as_body(checks);
}

GeneratedFile file_of(std::string_view owner, const char* what, const std::string& text) {
  return {fmt::format("rtl/include/rp_{}_{}.vh", owner, what), text};
}

}  // namespace

std::vector<GeneratedFile> parameters_verilog() {
  std::string list = kGenerated, map = kGenerated;
  for (const auto& [name, value] : verilog_parameters(Configuration())) {
    list += parameter_line(name, value);
    map += connection_line(name);
  }
  std::vector<GeneratedFile> files = {file_of("unit", "parameters", list), file_of("unit", "parameter_map", map),
                                      file_of("unit", "parameter_checks", unit_checks())};
  list = kGenerated;
  const auto of_chip = chip_verilog_parameters(Configuration(), 1);
  for (size_t i = 1 + verilog_parameters(Configuration()).size(); i < of_chip.size(); ++i)
    list += parameter_line(of_chip[i].first, of_chip[i].second);
  files.push_back(file_of("chip", "parameters", list));
  for (const std::string_view section : sections()) {
    std::string checks;
    list = map = kGenerated;
    for (const Parameter& parameter : parameter::kAll) {
      if (parameter.section != section || !parameter.of_part) continue;
      list += parameter_line(verilog_name(parameter), parameter.get(Configuration()));
      map += connection_line(verilog_name(parameter));
      checks += check(verilog_name(parameter), parameter.range);
    }
    if (checks.empty()) continue;
    files.push_back(file_of(section, "parameters", list));
    files.push_back(file_of(section, "parameter_map", map));
    files.push_back(file_of(section, "parameter_checks", as_body(checks)));
  }
  return files;
}

std::vector<GeneratedFile> generated_parameter_files() {
  std::vector<GeneratedFile> files = parameters_verilog();
  for (GeneratedFile& file : files) file.text.insert(0, kLicence);
  files.push_back({"docs/machine/parameters.md", parameters_markdown()});
  files.push_back({"schemas/configuration.json", configuration_schema()});
  return files;
}

}  // namespace raypool
