// Writes what rtl/compute_unit.v and rtl/multiprocessor.v include for the ALU types: parameters, slots, instances.
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
std::string count_of(const std::string& name, const AluInfo& info) { return info.timed_by_events() ? "1" : name + "_COUNT"; }

bool has_third_operand(AluType type) {
  for (const InstructionInfo& info : kInstructions) {
    if (info.alu() == type && has_operand(info, Operand::Rc)) return true;
  }
  return false;
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

std::string alu_slots_verilog() {
  std::string text = fmt::format("  {}", kGenerated);
  text += fmt::format("  localparam integer UNITS = {};\n", kAluTypes);
  text += "  // ALU instances, by type in the order of the unit numbers\n";
  std::string next = "0", units, wrong;
  for_each_alu([&](const std::string& name, const AluInfo& info, AluType) {
    const std::string count = count_of(name, info);
    text += fmt::format("  localparam integer {}_SLOT = {};\n", name, next);
    next = fmt::format("{}_SLOT + {}", name, count);
    units = fmt::format("{{{}{{ISA_UNIT_{}}}}}{}{}", count, name, units.empty() ? "" : ",\n    ", units);
    if (!info.timed_by_events())
      wrong += fmt::format("{0}{1}_COUNT < 1 || {1}_COUNT > 4", wrong.empty() ? "" : " ||\n        ", name);
  });
  text += fmt::format("  localparam integer SLOTS = {};\n", next);
  text += fmt::format("  localparam [SLOTS*4-1:0] SLOT_UNITS = {{\n    {}}};\n\n", units);
  text += fmt::format(
      "  generate\n    if ({}) begin : gen_bad_count\n      compute_unit_counts_of_ALUs_must_be_from_1_to_4 illegal ();\n    "
      "end\n"
      "  endgenerate\n",
      wrong);
  return text;
}

std::string alu_instances_verilog() {
  std::string text = fmt::format("    {}", kGenerated);
  for_each_alu([&](const std::string& name, const AluInfo& info, AluType type) {
    if (info.ports != Ports::Framework) return;
    text += fmt::format(
        "    for (k = 0; k < {0}_COUNT; k = k + 1) begin : gen_{1}\n"
        "      {1}_alu #(\n"
        "        .WARPS(WARPS), .LANES(LANES), .WARP_BITS(WARP_BITS), .LATENCY({0}_LATENCY), .DEPTH({0}_DEPTH){2}\n"
        "      ) {1}_alu (\n"
        "        .clk_i(clk_i), .rst_ni(rst_ni),\n"
        "        .task_valid_i(task_valid[{0}_SLOT + k]), .task_warp_i(task_warp[({0}_SLOT + k)*WARP_BITS +: WARP_BITS]),\n"
        "        .task_op_i(task_op[({0}_SLOT + k)*5 +: 5]), .task_mask_i(task_mask[({0}_SLOT + k)*LANES +: LANES]),\n"
        "        .task_a_i(task_a[({0}_SLOT + k)*DATA +: DATA]), .task_b_i(task_b[({0}_SLOT + k)*DATA +: DATA]),\n"
        "{3}"
        "        .task_imm_i(task_imm[({0}_SLOT + k)*32 +: 32]), .task_x_i(task_x[({0}_SLOT + k)*5 +: 5]),\n"
        "        .task_px_i(task_px[({0}_SLOT + k)*LANES +: LANES]), .task_pb_i(task_pb[({0}_SLOT + k)*LANES +: LANES]),\n"
        "        .ready_o(ready[{0}_SLOT + k]), .done_valid_o(done_valid[{0}_SLOT + k]),\n"
        "        .done_warp_o(done_warp[({0}_SLOT + k)*WARP_BITS +: WARP_BITS]),\n"
        "        .done_data_o(done_data[({0}_SLOT + k)*DATA +: DATA]), .done_pred_o(done_pred[({0}_SLOT + k)*LANES +: LANES]));\n"
        "    end\n",
        name, info.name, further_parameters(info.parameters),
        has_third_operand(type) ? fmt::format("        .task_c_i(task_c[({0}_SLOT + k)*DATA +: DATA]),\n", name) : "");
  });
  return text;
}

std::vector<GeneratedFile> generated_files() {
  return {{"rtl/isa.vh", isa_verilog()},
          {"rtl/isa_functions.vh", isa_verilog_functions()},
          {"rtl/alu_parameters.vh", alu_parameters_verilog()},
          {"rtl/alu_parameter_map.vh", alu_parameter_map_verilog()},
          {"rtl/alu_slots.vh", alu_slots_verilog()},
          {"rtl/alu_instances.vh", alu_instances_verilog()},
          {"docs/isa.md", isa_markdown()}};
}

}  // namespace raypool
