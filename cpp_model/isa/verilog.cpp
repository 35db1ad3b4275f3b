// Writes the Verilog files of the instruction set, the counters and the records.
#include <fmt/format.h>

#include <algorithm>
#include <bitset>
#include <cctype>
#include <initializer_list>

#include "isa/counters.hpp"
#include "isa/encoding.hpp"
#include "isa/records.hpp"
#include "isa/reference.hpp"

namespace raypool {
namespace {

// Before constants are made of the rows: a number of its own for each instruction of an ALU.
#define RAYPOOL_CHECK_NUMBER(name, type, operation, ...) \
  static_assert((operation) < 32, "an ALU has operations 0 to 31: give " #name " a free number");
RAYPOOL_INSTRUCTIONS(RAYPOOL_CHECK_NUMBER)
#undef RAYPOOL_CHECK_NUMBER
constexpr bool numbers_are_distinct() {
  for (const InstructionInfo& one : kInstructions)
    for (const InstructionInfo& other : kInstructions)
      if (&one != &other && one.opcode == other.opcode) return false;
  return true;
}
static_assert(numbers_are_distinct(), "two rows of RAYPOOL_INSTRUCTIONS have the same ALU and number");

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
std::string function_of_row(std::string_view name, std::string_view meaning, Wanted wanted) {
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

/// Written and read in elements of a float triple: rd + i and r + j with i < j, or r for all elements.
std::string elements_depend_verilog() {
  return fmt::format(
      "\n  // an element of this float triple reads what an earlier one has written\n"
      "  function isa_elements_depend;\n"
      "    /* verilator lint_off UNUSEDSIGNAL */\n"
      "    input [63:0] encoding;\n"
      "    /* verilator lint_on UNUSEDSIGNAL */\n"
      "    reg [3:0] a, b, c;\n"
      "    begin\n"
      "      a = {0} - {1};\n"
      "      b = {0} - {2};\n"
      "      c = {0} - {3};\n"
      "      isa_elements_depend = ({4} ? a == 4'd0 || a == 4'd15 : a == 4'd1 || a == 4'd2) ||\n"
      "                            (!{5} && (b == 4'd1 || b == 4'd2)) ||\n"
      "                            ({6} == 3'd{7} && (c == 4'd1 || c == 4'd2));\n"
      "    end\n"
      "  endfunction\n",
      slice(field::kRd, "encoding"), slice(field::kRa, "encoding"), slice(field::kRb, "encoding"),
      fmt::format("encoding[{}:{}]", field::kX.lsb + 3, field::kX.lsb),
      fmt::format("encoding[{}]", field::kOperation.lsb + 3), slice(field::kBIsImmediate, "encoding"),
      fmt::format("encoding[{}:{}]", field::kOperation.lsb + 2, field::kOperation.lsb), operation_of(Opcode::Ffma));
}

/// Of Verilog, for numbers_of().
std::string named_numbers_verilog() {
  const auto names = [](std::string_view function, std::string_view what, std::initializer_list<Operand> operands) {
    return function_of_row(function, what, [operands](const InstructionInfo& info) {
      return std::any_of(operands.begin(), operands.end(), [&](Operand each) { return has_operand(info, each); });
    });
  };
  const std::string x = fmt::format("encoding[{}:{}]", field::kX.lsb + 3, field::kX.lsb);
  return names("isa_names_ra", "has a register in ra", {Operand::Ra, Operand::Address}) +
         names("isa_names_b", "has a register in rb, unless bit 37 makes b the immediate", {Operand::B}) +
         names("isa_names_rb", "has a register in rb", {Operand::Rb}) +
         names("isa_names_rc", "has a register in x", {Operand::Rc}) +
         names("isa_names_px", "has a predicate in x", {Operand::Px}) +
         names("isa_names_pb", "has a predicate in rb", {Operand::Pb}) +
         names("isa_names_argument", "has an argument's number in the immediate", {Operand::Argument}) +
         fmt::format(
             "\n  // all registers, predicates and arguments that the instruction names are there, where there are so "
             "many; of a\n"
             "  // triple those of its last element too. Numbers go on behind the last of 16 registers and 32 "
             "arguments\n"
             "  function isa_numbers_fit;\n"
             "    input [63:0] encoding;\n"
             "    input [4:0] registers;\n"
             "    input [4:0] predicates;\n"
             "    input [5:0] arguments;\n"
             "    reg three, same_ra;\n"
             "    reg [4:0] last, last_moving, last_predicate;\n"
             "    reg [5:0] last_argument;\n"
             "    begin\n"
             "      three = isa_triple(encoding);\n"
             "      same_ra = {6} || {7} == 4'd{8};\n"
             "      last = registers - 5'd1;\n"
             "      last_moving = three && registers != 5'd{0} ? registers - 5'd{2} : last;\n"
             "      last_predicate = predicates - 5'd1;\n"
             "      last_argument = three && arguments != 6'd{1} ? arguments - 6'd{2} : arguments - 6'd1;\n"
             "      isa_numbers_fit = !(\n"
             "        {{1'b0, {3}}} > last_predicate ||\n"
             "        (isa_writes_register(encoding) && {{1'b0, {4}}} > last_moving) ||\n"
             "        (isa_names_ra(encoding) && {{1'b0, {5}}} > (same_ra ? last : last_moving)) ||\n"
             "        (isa_names_b(encoding) && !{9} && {{1'b0, {10}}} > last_moving) ||\n"
             "        (isa_names_rb(encoding) && {{1'b0, {10}}} > last) ||\n"
             "        (isa_names_rc(encoding) && {{1'b0, {11}}} > last_moving) ||\n"
             "        (isa_writes_predicate(encoding) && {{1'b0, {4}}} > last_predicate) ||\n"
             "        (isa_names_px(encoding) && {{1'b0, {11}}} > last_predicate) ||\n"
             "        (isa_names_pb(encoding) && {{1'b0, {10}}} > last_predicate) ||\n"
             "        (isa_names_argument(encoding) && {{1'b0, encoding[4:0]}} > last_argument));\n"
             "    end\n"
             "  endfunction\n",
             kRegisters, kArguments, kElements, slice(field::kGuard, "encoding"), slice(field::kRd, "encoding"),
             slice(field::kRa, "encoding"), fmt::format("encoding[{}]", field::kOperation.lsb + 3),
             slice(field::kType, "encoding"), to_underlying(AluType::Mem),
             fmt::format("encoding[{}]", field::kBIsImmediate.lsb), slice(field::kRb, "encoding"), x);
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
      "  // Constants of the instruction set. To be included inside a module body; rtl/include/rp_isa_functions.vh "
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
  text += function_of_row("isa_optional_op", "a machine has this instruction unless its ALU is without it",
                          [](const InstructionInfo& info) { return info.needs == Feature::Optional; });
  text += function_of_row("isa_legal_fma_op", "machines with arithmetic.fma have this instruction",
                          [](const InstructionInfo& info) { return info.needs == Feature::FusedMultiplyAdd; });
  text += function_of_row("isa_legal_triple_op", "machines with triples have this instruction",
                          [](const InstructionInfo& info) { return info.needs == Feature::Triples; });
  text += function_of_row("isa_legal_fused_triple_op", "machines with both have this instruction",
                          [](const InstructionInfo& info) { return info.needs == Feature::FusedTriples; });
  text += function_of_row("isa_legal_sharing_op", "machines with sharing have this instruction",
                          [](const InstructionInfo& info) { return info.needs == Feature::Sharing; });
  text +=
      function_of_row("isa_triple_of_words", "the instruction accesses three words of a ray package",
                      [](const InstructionInfo& info) { return is_triple(info) && has_operand(info, Operand::Word); });
  text += named_numbers_verilog();
  text += fmt::format(
      "\n  // the instruction has a table row, and the machine what it needs; fma: arithmetic.fma. A triple's words "
      "are\n"
      "  // all there, in packages of package_words. lacking: it is one that its ALU is without, or names what is not "
      "there\n"
      "  function isa_legal;\n"
      "    input [63:0] encoding;\n"
      "    input fma;\n"
      "    input triples;\n"
      "    input sharing;\n"
      "    input [4:0] package_words;\n"
      "    input lacking;\n"
      "    begin\n"
      "      isa_legal = isa_legal_op(encoding) || (!lacking && isa_optional_op(encoding)) ||\n"
      "                  (fma && isa_legal_fma_op(encoding)) ||\n"
      "                  (sharing && isa_legal_sharing_op(encoding)) ||\n"
      "                  (triples && isa_legal_triple_op(encoding) &&\n"
      "                   !(isa_triple_of_words(encoding) && {} > package_words - 5'd{})) ||\n"
      "                  (fma && triples && isa_legal_fused_triple_op(encoding));\n"
      "    end\n"
      "  endfunction\n",
      slice(field::kX, "encoding"), kElements);
  text += function_of_row("isa_triple", "the instruction does three",
                          [](const InstructionInfo& info) { return is_triple(info); });
  text += elements_depend_verilog();
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

std::string records_verilog() {
  std::string text =
      "  // Generated from cpp_model/isa/records.hpp by `raypool isa --write`; a test compares. Do not edit.\n"
      "  // Of each record how many bits it has, and of each of its fields the lowest bit and how many. To be "
      "included\n"
      "  // inside a module body. A module uses some of them only.\n"
      "  /* verilator lint_off UNUSEDPARAM */\n";
  for (const Record& record : record::kAll) {
    const std::string name = upper(record.name);
    text += fmt::format("\n  // {}\n  localparam integer {}_BITS = {};\n", record.meaning, name, record.bits());
    for (int i = 0; i < record.count; ++i) {
      const RecordField& field = record.fields[i];
      text += fmt::format("  localparam integer {0}_{1} = {2}, {0}_{1}_BITS = {3};\n", name, upper(field.name),
                          record.low(field.name), field.bits);
    }
  }
  text += "  /* verilator lint_on UNUSEDPARAM */\n";
  return text;
}

}  // namespace raypool
