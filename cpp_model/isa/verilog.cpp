// Writes the two Verilog files of the instruction set.
#include <fmt/format.h>

#include <cctype>

#include "isa/encoding.hpp"
#include "isa/reference.hpp"

namespace raypool {
namespace {

std::string upper(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return result;
}

/// Case labels, one line a unit, of the rows for which `wanted` is true. `separator` stands between unit and operation.
template <typename Wanted>
std::string labels(Wanted wanted) {
  std::string text;
  for (int type = 0; type < kAluTypes; ++type) {
    std::string line;
    std::string names;
    int in_line = 0;
    for (const InstructionInfo& info : kInstructions) {
      if (static_cast<int>(info.alu()) != type || !wanted(info)) continue;
      if (in_line > 0) line += in_line % 16 == 0 ? ",\n        " : ", ";
      ++in_line;
      line += fmt::format("9'd{}", type * 32 + info.operation());
      names += fmt::format(" {}", info.mnemonic);
    }
    if (line.empty()) continue;
    // The comma that parts this unit's labels from those before it opens the line: a comment ends it.
    text += fmt::format("        // {}:{}\n        {}{}\n", kAluNames[static_cast<size_t>(type)], names, text.empty() ? "" : ", ",
                        line);
  }
  return text;
}

/// A function of unit and operation, true for the rows for which `wanted` is true.
template <typename Wanted>
std::string function_of_row(const char* name, const char* meaning, Wanted wanted) {
  return fmt::format(
      "\n  // {1}\n"
      "  function {0};\n"
      "    input [3:0] unit;\n"
      "    input [4:0] op;\n"
      "    begin\n"
      "      case ({{unit, op}})\n"
      "{2}"
      "          : {0} = 1'b1;\n"
      "        default: {0} = 1'b0;\n"
      "      endcase\n"
      "    end\n"
      "  endfunction\n",
      name, meaning, labels(wanted));
}

constexpr const char* kGenerated =
    "  // Generated from cpp_model/isa/isa.hpp by `raypool isa {}`; a test compares. Do not edit.\n";

}  // namespace

std::string verilog_name(AluType type) { return upper(alu_info(type).name); }

std::string isa_verilog() {
  std::string text = fmt::format(fmt::runtime(kGenerated), "--verilog");
  text +=
      "  // Constants of the instruction set. To be included inside a module body; rtl/isa_functions.vh has the decoding "
      "functions.\n";
  text += "  // A module uses some of them only.\n  /* verilator lint_off UNUSEDPARAM */\n\n";
  text += "  // units\n";
  for (int type = 0; type < kAluTypes; ++type) {
    text += fmt::format("  localparam [3:0] ISA_UNIT_{} = 4'd{};\n", verilog_name(static_cast<AluType>(type)), type);
  }
  text += "\n  // operations\n";
  for (const InstructionInfo& info : kInstructions) {
    text +=
        fmt::format("  localparam [4:0] ISA_{}_{} = 5'd{};\n", verilog_name(info.alu()), upper(info.mnemonic), info.operation());
  }
  text += "\n  // fields of an instruction\n";
  for (const Field& each : kFields) {
    text += fmt::format("  localparam integer ISA_{0}_LSB = {1};\n  localparam integer ISA_{0}_BITS = {2};\n", upper(each.name),
                        each.lsb, each.bits);
  }
  text += "  /* verilator lint_on UNUSEDPARAM */\n";
  return text;
}

std::string isa_verilog_functions() {
  std::string text = fmt::format(fmt::runtime(kGenerated), "--verilog-functions");
  text +=
      "  // Decoding functions of the instruction set. To be included inside a module body; they need no constants. A label is\n";
  text += "  // unit * 32 + operation.\n";
  text += function_of_row("isa_legal_op", "every machine has this unit and operation",
                          [](const InstructionInfo& info) { return info.needs == Feature::Base; });
  text += function_of_row("isa_legal_fma_op", "machines with arithmetic.fma have this unit and operation",
                          [](const InstructionInfo& info) { return info.needs == Feature::FusedMultiplyAdd; });
  text +=
      "\n  // the instruction has a table row, and the machine what it needs; fma: arithmetic.fma\n"
      "  function isa_legal;\n"
      "    // Only unit and operation decide; the whole instruction is taken for the caller's convenience.\n"
      "    /* verilator lint_off UNUSEDSIGNAL */\n"
      "    input [63:0] instruction;\n"
      "    /* verilator lint_on UNUSEDSIGNAL */\n"
      "    input fma;\n"
      "    begin\n"
      "      isa_legal = isa_legal_op(instruction[63:60], instruction[59:55]) ||\n"
      "                  (fma && isa_legal_fma_op(instruction[63:60], instruction[59:55]));\n"
      "    end\n"
      "  endfunction\n";
  text += function_of_row("isa_writes_register", "writes register rd",
                          [](const InstructionInfo& info) { return writes_register(info); });
  text += function_of_row("isa_writes_predicate", "writes predicate pd",
                          [](const InstructionInfo& info) { return writes_predicate(info); });
  text += function_of_row("isa_control", "stops the instruction routine until its write-back",
                          [](const InstructionInfo& info) { return info.kind == Kind::Control; });
  return text;
}

}  // namespace raypool
