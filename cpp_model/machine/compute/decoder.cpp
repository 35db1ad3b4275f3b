#include "machine/compute/decoder.hpp"

#include "isa/encoding.hpp"

namespace raypool {

namespace {

bool is_legal(const Instruction& fields, const Configuration& configuration) {
  if (fields.info == nullptr || !configuration.has(*fields.info)) return false;
  const Numbers numbers = numbers_of(fields);
  if (numbers.registers > configuration.registers || numbers.predicates > configuration.predicates ||
      numbers.arguments > configuration.arguments)
    return false;
  return !(is_triple(*fields.info) && has_operand(*fields.info, Operand::Word) &&
           fields.x > last_triple_word(configuration.intersection_words));
}

}  // namespace

int elements(uint64_t encoding, const Configuration& configuration) {
  const Instruction fields = unpack(encoding);
  return is_legal(fields, configuration) && is_triple(*fields.info) ? kElements : 1;
}

DecodedInstruction decode(uint64_t encoding, const Configuration& configuration, int element) {
  Instruction fields = unpack(encoding);
  DecodedInstruction result;
  const bool legal = is_legal(fields, configuration);
  if (legal && is_triple(*fields.info)) {
    result.elements_depend = elements_depend(fields);
    fields = raypool::element(fields, element);
  }
  result.encoding = encoding;
  result.immediate = fields.immediate;
  result.info = legal ? fields.info : nullptr;
  result.guard = fields.guard;
  result.guard_negated = fields.guard_negated;
  result.rd = fields.rd;
  result.ra = fields.ra;
  result.rb = fields.rb;
  result.b_is_immediate = fields.b_is_immediate;
  result.x = fields.x;
  if (result.info == nullptr) return result;
  result.opcode = fields.info->opcode;
  result.kind = fields.info->kind;
  result.uses_b = has_operand(*fields.info, Operand::B) || has_operand(*fields.info, Operand::Rb);
  result.writes_register = raypool::writes_register(*fields.info);
  result.writes_predicate = raypool::writes_predicate(*fields.info);
  // `st` stores register rb, whatever bit 37 is.
  if (has_operand(*fields.info, Operand::Rb)) result.b_is_immediate = false;
  return result;
}

}  // namespace raypool
