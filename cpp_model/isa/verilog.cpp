// Writes the two Verilog files of the instruction set.
#include <fmt/format.h>

#include <bitset>
#include <cctype>

#include "isa/counters.hpp"
#include "isa/encoding.hpp"
#include "isa/reference.hpp"

namespace raypool {
namespace {

/// BusyCycles: BUSY_CYCLES
std::string words_in_upper_case(std::string_view name) {
  std::string text;
  for (const char c : name) {
    if (c >= 'A' && c <= 'Z' && !text.empty()) text += '_';
    text += c;
  }
  return upper(text);
}

/// The bits of a field of a Verilog vector.
std::string slice(const Field& field, std::string_view vector) {
  if (field.bits == 1) return fmt::format("{}[{}]", vector, field.lsb);
  return fmt::format("{}[{}:{}]", vector, field.lsb + field.bits - 1, field.lsb);
}

/// Case labels, one line a type, of the rows for which `wanted` is true.
template <typename Wanted>
std::string labels(Wanted wanted) {
  std::string text;
  for (const AluType type : kEveryAluType) {
    std::string line;
    std::string names;
    int in_line = 0;
    for (const InstructionInfo& info : kInstructions) {
      if (info.alu() != type || !wanted(info)) continue;
      if (in_line > 0) line += in_line % 14 == 0 ? ",\n        " : ", ";
      if (in_line > 0 && in_line % 14 == 0) names += "\n        //  ";
      ++in_line;
      line += fmt::format("9'd{}", to_underlying(info.opcode));
      names += fmt::format(" {}", info.mnemonic);
    }
    if (line.empty()) continue;
    // The comma that parts this type's labels from those before it opens the line: a comment ends it.
    text += fmt::format("        // {}:{}\n        {}{}\n", kAluNames[type], names, text.empty() ? "" : ", ", line);
  }
  return text;
}

/// A function of ALU type and operation, true for the rows for which `wanted` is true.
template <typename Wanted>
std::string function_of_row(const char* name, const char* meaning, Wanted wanted) {
  return fmt::format(
      "\n  // {1}\n"
      "  function {0};\n"
      "    /* verilator lint_off UNUSEDSIGNAL */\n"
      "    input [63:0] encoding;\n"
      "    /* verilator lint_on UNUSEDSIGNAL */\n"
      "    begin\n"
      "      case ({{{3}, {4}}})\n"
      "{2}"
      "          : {0} = 1'b1;\n"
      "        default: {0} = 1'b0;\n"
      "      endcase\n"
      "    end\n"
      "  endfunction\n",
      name, meaning, labels(wanted), slice(field::kType, "encoding"), slice(field::kOperation, "encoding"));
}

/// Constants of the operands that an ALU is handed: bit n is set if an instruction of type n has the operand.
std::string operands_of_types() {
  std::string text = "\n  // whether an ALU type looks at an operand: bit n is that of type n\n";
  for (const TaskOperand operand : kTaskOperands) {
    std::bitset<16> types;
    for (const InstructionInfo& info : kInstructions)
      if (looks_at(info, operand)) types.set(to_underlying(info.alu()));
    text +=
        fmt::format("  localparam [15:0] ISA_HAS_{} = 16'b{};\n", upper(task_operand_name(operand)), types.to_string());
  }
  return text;
}

constexpr const char* kGenerated =
    "  // Generated from cpp_model/isa/isa.hpp by `raypool isa {}`; a test compares. Do not edit.\n";

}  // namespace

std::string upper(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if (c >= 'a' && c <= 'z') c += 'A' - 'a';
  return result;
}

std::string verilog_name(AluType type) { return upper(alu_info(type).name); }

std::string isa_verilog() {
  std::string text = fmt::format(fmt::runtime(kGenerated), "--verilog");
  text +=
      "  // Constants of the instruction set. To be included inside a module body; rtl/isa_functions.vh "
      "decodes.\n";
  text += "  // A module uses some of them only.\n  /* verilator lint_off UNUSEDPARAM */\n\n";
  text += "  // ALU types\n";
  for (const AluType type : kEveryAluType)
    text += fmt::format("  localparam [3:0] ISA_TYPE_{} = 4'd{};\n", verilog_name(type), to_underlying(type));
  text += "\n  // operations\n";
  for (const InstructionInfo& info : kInstructions) {
    text += fmt::format("  localparam [4:0] ISA_{}_{} = 5'd{};\n", verilog_name(info.alu()), upper(info.mnemonic),
                        info.operation());
  }
  text += operands_of_types();
  text += "  /* verilator lint_on UNUSEDPARAM */\n";
  return text;
}

std::string isa_fields_verilog() {
  std::string text = fmt::format(fmt::runtime(kGenerated), "--write");
  text += "  // The fields of `instruction`, to be included behind its declaration. A module uses some of them only.\n";
  text += "  /* verilator lint_off UNUSEDSIGNAL */\n";
  for (const Field& each : kFields) {
    const std::string range = each.bits == 1 ? "" : fmt::format(" [{}:0]", each.bits - 1);
    text += fmt::format("  wire{} field_{} = {};\n", range, each.name, slice(each, "instruction"));
  }
  text += "  /* verilator lint_on UNUSEDSIGNAL */\n";
  return text;
}

std::string isa_verilog_functions() {
  std::string text = fmt::format(fmt::runtime(kGenerated), "--verilog-functions");
  text +=
      "  // Decoding functions of the instruction set. To be included inside a module body; they need no constants. A "
      "label is\n";
  text += "  // ALU type * 32 + operation.\n";
  text += function_of_row("isa_legal_op", "every machine has this instruction",
                          [](const InstructionInfo& info) { return info.needs == Feature::Base; });
  text += function_of_row("isa_legal_fma_op", "machines with arithmetic.fma have this instruction",
                          [](const InstructionInfo& info) { return info.needs == Feature::FusedMultiplyAdd; });
  text +=
      "\n  // the instruction has a table row, and the machine what it needs; fma: arithmetic.fma\n"
      "  function isa_legal;\n"
      "    input [63:0] encoding;\n"
      "    input fma;\n"
      "    begin\n"
      "      isa_legal = isa_legal_op(encoding) || (fma && isa_legal_fma_op(encoding));\n"
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

std::string counters_verilog() {
  std::string text =
      "  // Generated from cpp_model/isa/counters.hpp by `raypool isa --write`; a test compares. Do not edit.\n";
  text +=
      "  // Numbers of the performance counters; those of a row by type are of ALU type 0, and the other types' "
      "follow.\n";
  text += "  // A module uses some of them only.\n  /* verilator lint_off UNUSEDPARAM */\n";
  for (const CounterInfo& info : kCounters) {
    text += fmt::format("  localparam integer COUNTER_{} = {};\n", words_in_upper_case(info.name), info.number);
  }
  text += "  /* verilator lint_on UNUSEDPARAM */\n";
  return text;
}

}  // namespace raypool
