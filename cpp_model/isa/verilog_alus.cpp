// Writes what rtl/compute_unit.v and rtl/multiprocessor.v include for the ALU types: parameters, instances.
#include <fmt/format.h>

#include "isa/encoding.hpp"
#include "isa/reference.hpp"

namespace raypool {
namespace {

constexpr const char* kGenerated =
    "// Generated from cpp_model/isa/isa.hpp by `raypool isa --write`; a test compares. Do not edit.\n";

/// Calls function(name in upper case, table row, type) for each type.
template <typename Function>
void for_each_alu(Function function) {
  for (int type = 0; type < kAluTypes; ++type)
    function(verilog_name(static_cast<AluType>(type)), kAluTable[type], static_cast<AluType>(type));
}

/// Instances of a type, as a Verilog expression.
std::string count_of(const std::string& name, const AluInfo& info) {
  return info.timed_by_events() ? "1" : name + "_COUNT";
}

/// A row's parameters, each as `, .NAME(NAME)`.
std::string further_parameters(std::string_view names) {
  std::string text;
  while (!names.empty()) {
    const size_t end = names.find(", ");
    text += fmt::format(", .{0}({0})", names.substr(0, end));
    names = end == std::string_view::npos ? std::string_view{} : names.substr(end + 2);
  }
  return text;
}

}  // namespace

std::string alu_parameters_verilog() {
  std::string text =
      fmt::format("  {}  // Instances of each ALU type, cycles between their tasks, pipeline stages.\n", kGenerated);
  for (const char* what : {"COUNT", "LATENCY", "DEPTH"}) {
    for_each_alu([&](const std::string& name, const AluInfo& info, AluType) {
      if (info.timed_by_events()) return;
      text += fmt::format("  parameter integer {}_{} = {},\n", name, what, *what == 'D' ? info.depth : 1);
    });
  }
  return text;
}

std::string alu_parameter_map_verilog() {
  std::string text = fmt::format("  {}", kGenerated);
  for_each_alu([&](const std::string& name, const AluInfo& info, AluType) {
    if (info.timed_by_events()) return;
    text += fmt::format("  .{0}_COUNT({0}_COUNT), .{0}_LATENCY({0}_LATENCY), .{0}_DEPTH({0}_DEPTH),\n", name);
  });
  return text;
}

std::string alu_instance_types_verilog() {
  std::string text = fmt::format("  {}", kGenerated);
  text += fmt::format("  localparam integer ALU_TYPES = {};\n", kAluTypes);
  std::string instances, types, wrong;
  for_each_alu([&](const std::string& name, const AluInfo& info, AluType) {
    const std::string count = count_of(name, info);
    instances += fmt::format("{}{}", instances.empty() ? "" : " + ", count);
    types = fmt::format("{{{}{{ISA_TYPE_{}}}}}{}{}", count, name, types.empty() ? "" : ",\n    ", types);
    if (!info.timed_by_events())
      wrong += fmt::format("{0}{1}_COUNT < 1 || {1}_COUNT > 4", wrong.empty() ? "" : " ||\n        ", name);
  });
  text += fmt::format("  localparam integer INSTANCES = {};\n", instances);
  text += "  // The type of each instance, the first one's lowest: by type, in the order of the types' numbers.\n";
  text += fmt::format("  localparam [INSTANCES*4-1:0] INSTANCE_TYPES = {{\n    {}}};\n\n", types);
  text += fmt::format(
      "  generate\n    if ({}) begin : gen_bad_count\n      compute_unit_counts_of_ALUs_must_be_from_1_to_4 illegal "
      "();\n    "
      "end\n"
      "  endgenerate\n",
      wrong);
  return text;
}

std::string alu_instances_verilog() {
  std::string text = fmt::format("      {}", kGenerated);
  for_each_alu([&](const std::string& name, const AluInfo& info, AluType) {
    if (info.ports != Ports::Framework) return;
    text += fmt::format(
        "      if (TYPE == ISA_TYPE_{0}) begin : gen_{1}\n"
        "        {1}_alu #(\n"
        "          .WARPS(WARPS), .LANES(LANES), .WARP_BITS(WARP_BITS), .LATENCY({0}_LATENCY),\n"
        "          .DEPTH({0}_DEPTH){2}\n"
        "        ) {1}_alu (\n"
        "`include \"alu_port_map.vh\"\n"
        "        );\n"
        "      end\n",
        name, info.name, further_parameters(info.parameters));
  });
  return text;
}

std::vector<GeneratedFile> generated_files() {
  return {{"rtl/isa.vh", isa_verilog()},
          {"rtl/isa_fields.vh", isa_fields_verilog()},
          {"rtl/isa_functions.vh", isa_verilog_functions()},
          {"rtl/counters.vh", counters_verilog()},
          {"rtl/alu_parameters.vh", alu_parameters_verilog()},
          {"rtl/alu_parameter_map.vh", alu_parameter_map_verilog()},
          {"rtl/alu_instance_types.vh", alu_instance_types_verilog()},
          {"rtl/alu_instances.vh", alu_instances_verilog()},
          {"docs/isa.md", isa_markdown()}};
}

}  // namespace raypool
