#include "isa/encoding.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "enum_array.hpp"

namespace raypool {
namespace {

constexpr uint64_t put(const Field& field, uint64_t value) {
  return (value & ((uint64_t{1} << field.bits) - 1)) << field.lsb;
}
constexpr uint32_t take(const Field& field, uint64_t encoding) {
  return static_cast<uint32_t>(encoding >> field.lsb & ((uint64_t{1} << field.bits) - 1));
}

using Table = EnumArray<Opcode, const InstructionInfo*, 512>;  // index: Opcode, or type and operation of no row

Table make_table() {
  Table table{};
  for (const InstructionInfo& info : kInstructions) table[info.opcode] = &info;
  return table;
}

const Table& table() {
  static const Table kTable = make_table();
  return kTable;
}

}  // namespace

const InstructionInfo& instruction(Opcode opcode) { return *table()[opcode]; }

const InstructionInfo* find_instruction(int type, int operation) {
  return table()[(type & 15) << 5 | (operation & 31)];
}

const InstructionInfo* find_instruction(std::string_view mnemonic) {
  for (const InstructionInfo& info : kInstructions) {
    if (info.mnemonic == mnemonic) return &info;
  }
  return nullptr;
}

const InstructionInfo& instruction(std::string_view mnemonic) {
  const InstructionInfo* info = find_instruction(mnemonic);
  if (info == nullptr) throw std::logic_error("the instruction table has no " + std::string(mnemonic));
  return *info;
}

bool has_operand(const InstructionInfo& info, Operand operand) {
  for (const Operand each : info.operands) {
    if (each == operand) return true;
  }
  return false;
}

std::string_view task_operand_name(TaskOperand operand) {
  switch (operand) {
    case TaskOperand::OperandA:
      return "operand_a";
    case TaskOperand::OperandB:
      return "operand_b";
    case TaskOperand::OperandC:
      return "operand_c";
    case TaskOperand::Immediate:
      return "immediate";
    case TaskOperand::Word:
      return "word";
    case TaskOperand::PredicateX:
      return "predicate_x";
    case TaskOperand::PredicateB:
      return "predicate_b";
  }
  return "";
}

bool looks_at(const InstructionInfo& info, TaskOperand operand) {
  switch (operand) {
    case TaskOperand::OperandA:
      return has_operand(info, Operand::Ra) || has_operand(info, Operand::Address);
    case TaskOperand::OperandB:
      return has_operand(info, Operand::Rb) || has_operand(info, Operand::B);
    case TaskOperand::OperandC:
      return has_operand(info, Operand::Rc);
    case TaskOperand::Immediate:
      return has_operand(info, Operand::Address) || has_operand(info, Operand::Argument);
    case TaskOperand::Word:
      return has_operand(info, Operand::Word);
    case TaskOperand::PredicateX:
      return has_operand(info, Operand::Px);
    case TaskOperand::PredicateB:
      return has_operand(info, Operand::Pb);
  }
  return false;
}

namespace {

constexpr uint8_t kTriple = 16, kOneRa = 8, kElementOperation = 7;  // of a triple's operation

bool moves_on(const InstructionInfo& triple, Operand operand) {
  return has_operand(triple, operand) && !(operand == Operand::Ra && has_one_ra(triple));
}

uint8_t register_of(uint8_t first, int element) { return static_cast<uint8_t>((first + element) % kRegisters); }

}  // namespace

bool has_one_ra(const InstructionInfo& triple) { return is_triple(triple) && (triple.operation() & kOneRa) != 0; }

const InstructionInfo* find_triple(const InstructionInfo& element, bool one_ra) {
  if (element.operation() > kElementOperation) return nullptr;
  const InstructionInfo* found =
      find_instruction(static_cast<int>(element.alu()), element.operation() | kTriple | (one_ra ? kOneRa : 0));
  return found != nullptr && is_triple(*found) ? found : nullptr;
}

Instruction element(const Instruction& triple, int number) {
  const InstructionInfo& info = *triple.info;
  Instruction result = triple;
  result.info = find_instruction(static_cast<int>(info.alu()), info.operation() & kElementOperation);
  if (moves_on(info, Operand::Rd)) result.rd = register_of(triple.rd, number);
  if (moves_on(info, Operand::Ra)) result.ra = register_of(triple.ra, number);
  if (moves_on(info, Operand::B) && !triple.b_is_immediate) result.rb = register_of(triple.rb, number);
  if (moves_on(info, Operand::Rc)) result.x = register_of(triple.x, number);
  if (moves_on(info, Operand::Word)) result.x = static_cast<uint8_t>(triple.x + number);
  if (moves_on(info, Operand::Argument)) result.immediate = triple.immediate + static_cast<uint32_t>(number);
  if (moves_on(info, Operand::Address)) result.immediate = triple.immediate | static_cast<uint32_t>(4 * number);
  return result;
}

bool elements_depend(const Instruction& triple) {
  const InstructionInfo& info = *triple.info;
  for (int earlier = 0; earlier < kElements; ++earlier) {
    const uint8_t written = element(triple, earlier).rd;
    for (int later = earlier + 1; later < kElements; ++later) {
      const Instruction reader = element(triple, later);
      if (has_operand(info, Operand::Ra) && reader.ra == written) return true;
      if (has_operand(info, Operand::B) && !reader.b_is_immediate && reader.rb == written) return true;
      if (has_operand(info, Operand::Rc) && reader.x % kRegisters == written) return true;
    }
  }
  return false;
}

Numbers numbers_of(const Instruction& instruction) {
  Numbers numbers = {0, instruction.guard + 1u, 0};
  if (instruction.info == nullptr) return numbers;
  const auto at_least = [](uint32_t& number, uint32_t index) { number = std::max(number, index + 1); };
  const bool triple = is_triple(*instruction.info);
  for (int e = 0; e < (triple ? kElements : 1); ++e) {
    const Instruction each = triple ? element(instruction, e) : instruction;
    for (const Operand operand : instruction.info->operands) {
      if (operand == Operand::Rd) at_least(numbers.registers, each.rd);
      if (operand == Operand::Ra || operand == Operand::Address) at_least(numbers.registers, each.ra);
      if (operand == Operand::Rb || (operand == Operand::B && !each.b_is_immediate))
        at_least(numbers.registers, each.rb);
      if (operand == Operand::Rc) at_least(numbers.registers, each.x % kRegisters);
      if (operand == Operand::Pd) at_least(numbers.predicates, each.rd);
      if (operand == Operand::Px) at_least(numbers.predicates, each.x % kPredicates);
      if (operand == Operand::Pb) at_least(numbers.predicates, each.rb);
      if (operand == Operand::Argument) at_least(numbers.arguments, each.immediate % kArguments);
    }
  }
  return numbers;
}

uint64_t encode(const Instruction& parts) {
  return put(field::kType, static_cast<uint64_t>(parts.info->alu())) | put(field::kOperation, parts.info->operation()) |
         put(field::kGuardNegated, parts.guard_negated ? 1 : 0) | put(field::kGuard, parts.guard) |
         put(field::kRd, parts.rd) | put(field::kRa, parts.ra) | put(field::kRb, parts.rb) |
         put(field::kBIsImmediate, parts.b_is_immediate ? 1 : 0) | put(field::kX, parts.x) |
         put(field::kImmediate, parts.immediate);
}

Instruction unpack(uint64_t encoding) {
  Instruction parts;
  parts.info = find_instruction(static_cast<int>(take(field::kType, encoding)),
                                static_cast<int>(take(field::kOperation, encoding)));
  parts.guard_negated = take(field::kGuardNegated, encoding) != 0;
  parts.guard = take(field::kGuard, encoding);
  parts.rd = take(field::kRd, encoding);
  parts.ra = take(field::kRa, encoding);
  parts.rb = take(field::kRb, encoding);
  parts.b_is_immediate = take(field::kBIsImmediate, encoding) != 0;
  parts.x = take(field::kX, encoding);
  parts.immediate = take(field::kImmediate, encoding);
  return parts;
}

}  // namespace raypool
