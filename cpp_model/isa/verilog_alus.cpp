// Writes what rtl/compute_unit.v includes for the ALU types: their instances.
#include <fmt/format.h>

#include "isa/encoding.hpp"
#include "isa/reference.hpp"

namespace raypool {
namespace {

constexpr const char* kGenerated =
    "// Generated from cpp_model/isa/isa.hpp by `raypool isa --write`; a test compares. Do not edit.\n";

/// Calls function(name in upper case, table row) for each type.
template <typename Function>
void for_each_alu(Function function) {
  for (const AluType type : kEveryAluType) function(verilog_name(type), alu_info(type));
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

std::string alu_instance_types_verilog() {
  std::string text = fmt::format("  {}", kGenerated);
  text += fmt::format("  localparam integer ALU_TYPES = {};\n", kAluTypes);
  std::string instances, types;
  for_each_alu([&](const std::string& name, const AluInfo& info) {
    const std::string count = count_of(name, info);
    instances += fmt::format("{}{}", instances.empty() ? "" : " + ", count);
    types = fmt::format("{{{}{{ISA_TYPE_{}}}}}{}{}", count, name, types.empty() ? "" : ",\n    ", types);
  });
  text += fmt::format("  localparam integer INSTANCES = {};\n", instances);
  text += "  // The type of each instance, the first one's lowest: by type, in the order of the types' numbers.\n";
  text += fmt::format("  localparam [INSTANCES*4-1:0] INSTANCE_TYPES = {{\n    {}}};\n", types);
  return text;
}

std::string alu_instances_verilog() {
  std::string text = fmt::format("      {}", kGenerated);
  for_each_alu([&](const std::string& name, const AluInfo& info) {
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
          {"rtl/alu_instance_types.vh", alu_instance_types_verilog()},
          {"rtl/alu_instances.vh", alu_instances_verilog()},
          {"docs/isa.md", isa_markdown()}};
}

}  // namespace raypool
