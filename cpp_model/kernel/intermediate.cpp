#include "kernel/intermediate.hpp"

#include <fmt/format.h>

namespace raypool::kernel {

std::string to_string(const Location& location) {
  std::string file = location.file;
  file = file.substr(file.find_last_of('/') + 1);
  return fmt::format("{}:{}", file, location.line);
}

Effects effects(const Op& op) {
  Effects result;
  if (op.kind == Op::Kind::Undefined) {
    result.register_defined = op.rd;
    result.registers_defined = 1;
  }
  if (op.kind != Op::Kind::Instruction) return result;
  size_t registers = 0;
  int predicates = 0;
  const int count = elements(op);
  const auto use_register = [&](int number, bool moves_on = true) {
    for (int e = 0; number != kNothing && e < (moves_on ? count : 1); ++e)
      result.register_uses[registers++] = number + e;
  };
  const auto use_predicate = [&](int number) {
    if (number > 0) result.predicate_uses[predicates++] = number;
  };
  use_predicate(op.guard.predicate);
  for (const Operand operand : op.info->operands) {
    switch (operand) {
      case Operand::Ra:
        use_register(op.ra, !has_one_ra(*op.info));
        break;
      case Operand::Address:
        use_register(op.ra, false);
        break;
      case Operand::B:
        if (!op.b_is_immediate) use_register(op.rb);
        break;
      case Operand::Rb:
        use_register(op.rb);
        break;
      case Operand::Rc:
        use_register(op.rc);
        break;
      case Operand::Px:
        use_predicate(op.px);
        break;
      case Operand::Pb:
        use_predicate(op.rb);
        break;
      case Operand::Rd:
        result.register_defined = op.rd;
        result.registers_defined = count;
        break;
      case Operand::Pd:
        result.predicate_defined = op.rd;
        break;
      default:
        break;
    }
  }
  // Predicates are written in all lanes, registers in the masked ones.
  result.partial = result.register_defined != kNothing && !op.fresh && !op.guard.all();
  result.operands = registers;
  if (result.partial) use_register(result.register_defined);
  return result;
}

bool is_pure(const Op& op) {
  return op.kind == Op::Kind::Instruction && !op.fence && (writes_register(*op.info) || writes_predicate(*op.info));
}

bool changes_memory(const Op& op) { return is(op, Opcode::St) || is(op, Opcode::Inval); }

bool is_copy(const Op& op) {
  if (op.kind != Op::Kind::Instruction) return false;
  if (is(op, Opcode::Mov)) return !op.b_is_immediate;
  return is(op, Opcode::Pand) && op.px == op.rb && op.guard.all();
}

}  // namespace raypool::kernel
