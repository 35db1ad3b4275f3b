// Writes what rtl/compute/rp_compute_unit.v includes for the ALU types: their instances.
#include <fmt/format.h>

#include "isa/encoding.hpp"
#include "isa/reference.hpp"

namespace raypool {
namespace {

constexpr const char* kGeneratedAlus =
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

/// Broken where it would become too long.
std::string wrapped(std::string line) {
  constexpr size_t kColumns = 120;
  if (line.size() > kColumns) line.replace(line.rfind(", ", kColumns - 1) + 1, 1, "\n          ");
  return line;
}

/// Of a type that may lack instructions.
std::string without(const std::string& name) {
  for (const AluType type : kEveryAluType)
    if (verilog_name(type) == name && optional_operations(type) != 0)
      return fmt::format(", .WITHOUT({}_WITHOUT)", name);
  return "";
}

}  // namespace

std::string alu_instance_types_verilog() {
  std::string text = fmt::format("  {}", kGeneratedAlus);
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
  text += "  // Instructions that the ALUs lack: bit ALU type * 32 + operation.\n";
  std::string lacked;
  for_each_alu([&](const std::string& name, const AluInfo&) {
    if (without(name).empty()) {
      lacked = fmt::format("32'd0{}{}", lacked.empty() ? "" : ", ", lacked);
      return;
    }
    text += fmt::format("  localparam [31:0] {0}_LACKS = {0}_WITHOUT | 32'd0;\n", name);
    lacked = fmt::format("{}_LACKS{}{}", name, lacked.empty() ? "" : ", ", lacked);
  });
  text += fmt::format("  localparam [16*32-1:0] WITHOUT = {{\n    {{{}{{32'd0}}}}, {}}};\n", 16 - kAluTypes, lacked);
  return text;
}

std::string alu_instances_verilog() {
  std::string text = fmt::format("      {}", kGeneratedAlus);
  for_each_alu([&](const std::string& name, const AluInfo& info) {
    if (info.ports == Ports::Own) return;
    text += fmt::format(
        "      if (TYPE == ISA_TYPE_{0}) begin : gen_{1}\n"
        "        rp_{1}_alu #(\n"
        "          .WARPS(WARPS), .LANES(LANES), .WARP_BITS(WARP_BITS), .LATENCY({0}_LATENCY),\n"
        "{2}\n"
        "        ) {1}_alu (\n{3}"
        "`include \"rp_alu_port_map.vh\"\n"
        "        );\n"
        "      end\n",
        name, info.name,
        wrapped(
            fmt::format("          .DEPTH({}_DEPTH){}{}", name, without(name), further_parameters(info.parameters))),
        info.ports == Ports::Guarded ? "          .done_subnormal_o(done_subnormal[k]),\n" : "");
  });
  std::string guarded;
  for_each_alu([&](const std::string& name, const AluInfo& info) {
    if (info.ports == Ports::Guarded)
      guarded += fmt::format("{}TYPE != ISA_TYPE_{}", guarded.empty() ? "" : " && ", name);
  });
  text += fmt::format(
      "      if ({}) begin : gen_unguarded\n"
      "        assign done_subnormal[k] = 1'b0;\n"
      "      end\n",
      guarded);
  return text;
}

std::vector<GeneratedFile> generated_files() {
  return {{"rtl/include/rp_isa.vh", kLicence + isa_verilog()},
          {"rtl/include/rp_isa_fields.vh", kLicence + isa_fields_verilog()},
          {"rtl/include/rp_isa_functions.vh", kLicence + isa_verilog_functions()},
          {"rtl/include/rp_counters.vh", kLicence + counters_verilog()},
          {"rtl/include/rp_records.vh", kLicence + records_verilog()},
          {"rtl/include/rp_alu_instance_types.vh", kLicence + alu_instance_types_verilog()},
          {"rtl/include/rp_alu_instances.vh", kLicence + alu_instances_verilog()},
          {"docs/machine/isa.md", isa_markdown()}};
}

}  // namespace raypool
