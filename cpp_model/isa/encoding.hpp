// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Encoder and decoder of single instructions, derived from the table in isa.hpp.
#pragma once

#include <cstdint>
#include <string_view>

#include "isa/isa.hpp"

namespace raypool {

/// Lowest bit and width of a field of the 64-bit encoding.
struct Field {
  std::string_view name;
  int lsb;
  int bits;
};

namespace field {
inline constexpr Field kType = {"type", 60, 4};
inline constexpr Field kOperation = {"operation", 55, 5};
inline constexpr Field kGuardNegated = {"guard_negated", 54, 1};
inline constexpr Field kGuard = {"guard", 50, 4};
inline constexpr Field kRd = {"rd", 46, 4};
inline constexpr Field kRa = {"ra", 42, 4};
inline constexpr Field kRb = {"rb", 38, 4};
inline constexpr Field kBIsImmediate = {"b_is_immediate", 37, 1};
inline constexpr Field kX = {"x", 32, 5};
inline constexpr Field kImmediate = {"immediate", 0, 32};
inline constexpr Field kTarget = {"target", 0, 16};
inline constexpr Field kEnd = {"end", 16, 16};
}  // namespace field

/// Fields from the most significant down. target and end are the halves of the immediate of `jany jnone call`.
inline constexpr std::array<Field, 12> kFields = {
    field::kType,         field::kOperation, field::kGuardNegated, field::kGuard,  field::kRd, field::kRa, field::kRb,
    field::kBIsImmediate, field::kX,         field::kImmediate,    field::kTarget, field::kEnd};

inline constexpr uint32_t kLastRayWord = 20;  ///< of a ray memory's set

/// An instruction in parts. Parts that its operands do not use are 0.
struct Instruction {
  const InstructionInfo* info = nullptr;  ///< null: no table row has this type and operation
  bool guard_negated = false;
  uint8_t guard = 0;
  uint8_t rd = 0, ra = 0, rb = 0;
  bool b_is_immediate = false;
  uint8_t x = 0;
  uint32_t immediate = 0;
};

/// Table row of an opcode.
const InstructionInfo& instruction(Opcode opcode);
/// Table row of what stands in the fields type and operation, null if there is none.
const InstructionInfo* find_instruction(int type, int operation);
/// Table row of a mnemonic, null if there is none.
const InstructionInfo* find_instruction(std::string_view mnemonic);
/// Table row of a mnemonic that is known to exist; throws std::logic_error otherwise.
const InstructionInfo& instruction(std::string_view mnemonic);

/// True if the row has this operand.
bool has_operand(const InstructionInfo& info, Operand operand);
inline bool writes_register(const InstructionInfo& info) { return has_operand(info, Operand::Rd); }
inline bool writes_predicate(const InstructionInfo& info) { return has_operand(info, Operand::Pd); }

/// What an ALU is handed with a task, beside warp, operation and mask: the task_* ports of rtl/include/rp_alu_ports.vh.
enum class TaskOperand : uint8_t { OperandA, OperandB, OperandC, Immediate, Word, PredicateX, PredicateB };
inline constexpr std::array<TaskOperand, 7> kTaskOperands = {
    TaskOperand::OperandA, TaskOperand::OperandB,   TaskOperand::OperandC,  TaskOperand::Immediate,
    TaskOperand::Word,     TaskOperand::PredicateX, TaskOperand::PredicateB};
/// As the port is called, between task_ and _i.
std::string_view task_operand_name(TaskOperand operand);
/// True if what the ALU does with the instruction depends on it. An immediate in place of a register is OperandB.
bool looks_at(const InstructionInfo& info, TaskOperand operand);

/// An instruction that does three, its elements.
inline constexpr int kElements = 3;
constexpr bool is_triple(const InstructionInfo& info) {
  return info.needs == Feature::Triples || info.needs == Feature::FusedTriples;
}
/// The instruction that element 0 .. 2 of a triple is.
Instruction element(const Instruction& triple, int number);
/// The triple made of such instructions, with one register ra for all or not; null: there is none.
const InstructionInfo* find_triple(const InstructionInfo& element, bool one_ra);
/// All elements of the triple have the same register ra.
bool has_one_ra(const InstructionInfo& triple);
/// The triple reads in an element what an earlier one has written: its elements must wait for each other.
bool elements_depend(const Instruction& triple);
/// The last word that a triple may begin with, of packages of so many words.
constexpr uint32_t last_triple_word(uint32_t package_words) { return package_words - kElements; }

/// How many registers, predicates and argument words a thread has.
struct Numbers {
  uint32_t registers = 0, predicates = 0, arguments = 0;
};
/// The fewest with which a machine has all that the instruction names, its guard and what the elements of a triple name
/// too.
Numbers numbers_of(const Instruction& instruction);

/// `instruction.info` must not be null.
uint64_t encode(const Instruction& instruction);
/// All fields as they are encoded, also those that the row does not use.
Instruction unpack(uint64_t encoding);

}  // namespace raypool
