// Passes over intermediate code that make it shorter or easier to allocate. None changes what a kernel computes.
#include "kernel/passes.hpp"

#include <algorithm>
#include <optional>

#include "kernel/compiler.hpp"
#include "kernel/liveness.hpp"

namespace raypool::kernel {

std::vector<int> find_single_definitions(const Function& function, bool predicates) {
  std::vector<int> definitions(predicates ? function.predicates : function.registers, kNothing);
  std::vector<bool> several(definitions.size(), false);
  for (size_t i = 0; i < function.ops.size(); ++i) {
    const Effects effect = effects(function.ops[i]);
    const int defined = predicates ? effect.predicate_defined : effect.register_defined;
    if (defined == kNothing) continue;
    const size_t number = defined;
    if (definitions[number] != kNothing) several[number] = true;
    definitions[number] = static_cast<int>(i);
  }
  for (size_t i = 0; i < definitions.size(); ++i) {
    if (several[i]) definitions[i] = kNothing;
  }
  return definitions;
}

Op clearing(int predicate, const Location& where) {
  Op op;
  op.info = &instruction(Opcode::Pxor);
  op.px = op.rb = 0;
  op.rd = predicate;
  op.fresh = true;
  op.where = where;
  return op;
}

std::optional<Opcode> exchanged(Opcode opcode) {
  switch (opcode) {
    case Opcode::Iadd:
    case Opcode::Imul:
    case Opcode::And:
    case Opcode::Or:
    case Opcode::Xor:
    case Opcode::Imin:
    case Opcode::Imax:
    case Opcode::Umin:
    case Opcode::Umax:
    case Opcode::Fadd:
    case Opcode::Fmul:
    case Opcode::Fmin:
    case Opcode::Fmax:
    case Opcode::Ffma:
    case Opcode::Ieq:
    case Opcode::Ine:
    case Opcode::Feq:
    case Opcode::Fne:
      return opcode;
    case Opcode::Ilt:
      return Opcode::Igt;
    case Opcode::Ile:
      return Opcode::Ige;
    case Opcode::Igt:
      return Opcode::Ilt;
    case Opcode::Ige:
      return Opcode::Ile;
    case Opcode::Ult:
      return Opcode::Ugt;
    case Opcode::Ule:
      return Opcode::Uge;
    case Opcode::Ugt:
      return Opcode::Ult;
    case Opcode::Uge:
      return Opcode::Ule;
    case Opcode::Flt:
      return Opcode::Fgt;
    case Opcode::Fle:
      return Opcode::Fge;
    case Opcode::Fgt:
      return Opcode::Flt;
    case Opcode::Fge:
      return Opcode::Fle;
    default:
      return std::nullopt;
  }
}

namespace {

/// Needs no register: its value can be made anywhere before its use.
bool is_leaf(const Op& op) {
  if (op.kind != Op::Kind::Instruction || !op.fresh || !writes_register(*op.info)) return false;
  return op.info->alu() == AluType::Tid || is(op, Opcode::Rld) || (is(op, Opcode::Mov) && op.b_is_immediate);
}

/// True if the leaf must stay before `op`.
bool blocks_leaf(const Op& leaf, const Op& op) {
  if (ends_block(op)) return true;
  const Effects effect = effects(op);
  if (effect.predicate_defined != kNothing && effect.predicate_defined == leaf.guard.predicate) return true;
  if (effect.register_defined == leaf.rd) return true;
  for (const int used : effect.register_uses) {
    if (used == leaf.rd) return true;
  }
  if (!is(leaf, Opcode::Rld) || op.kind == Op::Kind::Undefined) return false;
  return op.info->kind == Kind::Swap || (is(op, Opcode::Rst) && op.word == leaf.word);
}

}  // namespace

void fold_constants(Function& function) {
  bool changed = true;
  while (changed) {
    changed = false;
    const std::vector<int> definitions = find_single_definitions(function, false);
    const auto constant = [&](int number) -> std::optional<uint32_t> {
      if (number == kNothing || definitions[number] == kNothing) return std::nullopt;
      const Op& op = function.ops[definitions[number]];
      if (!is(op, Opcode::Mov) || !op.b_is_immediate || !op.fresh) return std::nullopt;
      return op.immediate;
    };
    for (Op& op : function.ops) {
      if (op.kind != Op::Kind::Instruction || !has_operand(*op.info, Operand::B) || op.b_is_immediate) continue;
      std::optional<uint32_t> value = constant(op.rb);
      const std::optional<Opcode> other = exchanged(op.info->opcode);
      if (!value && constant(op.ra) && other) {
        op.info = &instruction(*other);
        std::swap(op.ra, op.rb);
        value = constant(op.rb);
      }
      if (!value) continue;
      op.b_is_immediate = true;
      op.immediate = *value;
      op.rb = kNothing;
      changed = true;
    }
  }
}

void fold_addresses(Function& function) {
  bool changed = true;
  while (changed) {
    changed = false;
    const std::vector<int> definitions = find_single_definitions(function, false);
    for (Op& op : function.ops) {
      if (op.kind != Op::Kind::Instruction || !has_operand(*op.info, Operand::Address)) continue;
      const int sum = definitions[op.ra];
      if (sum == kNothing) continue;
      const Op& add = function.ops[sum];
      if (!is(add, Opcode::Iadd) || !add.b_is_immediate || !add.fresh) continue;
      // The base must hold the same value at the access as at the addition: it is written once, before both.
      const int base = definitions[add.ra];
      if (base == kNothing || !function.ops[base].fresh) continue;
      op.ra = add.ra;
      op.immediate += add.immediate;
      changed = true;
    }
  }
}

void join_conditions(Function& function) {
  // c = a and (x < y): the compare, guarded by a, gives c at once, since a compare's result is ANDed with its mask.
  const std::vector<int> definitions = find_single_definitions(function, true);
  std::vector<int> uses(function.predicates, 0);
  for (const Op& op : function.ops) {
    const Effects effect = effects(op);
    for (const int used : effect.predicate_uses) {
      if (used != kNothing) ++uses[used];
    }
  }
  std::vector<size_t> removed;
  for (size_t i = 0; i < function.ops.size(); ++i) {
    const Op& op = function.ops[i];
    if (!is(op, Opcode::Pand) || op.px == op.rb || op.px == 0 || op.rb == 0) continue;
    const int first = definitions[op.px];
    const int second = definitions[op.rb];
    if (first == kNothing || second == kNothing) continue;
    // Either operand may be the compare, if the other one is there before it.
    const int late = std::max(first, second);
    const int early_predicate = late == second ? op.px : op.rb;
    const Op& early = function.ops[std::min(first, second)];
    Op& compare = function.ops[late];
    const bool is_compare = has_operand(*compare.info, Operand::Ra);
    if (!is_compare || !early.fresh || !compare.fresh || uses[compare.rd] != 1) continue;
    if (!(compare.guard == op.guard) || !(early.guard == op.guard)) continue;
    // All three in one straight piece of code, in which neither the result nor the mask is written otherwise.
    bool straight = true;
    for (int k = late + 1; k < static_cast<int>(i) && straight; ++k) {
      const Op& between = function.ops[k];
      const Effects effect = effects(between);
      straight = !ends_block(between) && effect.predicate_defined != op.rd &&
                 (effect.predicate_defined == kNothing || effect.predicate_defined != op.guard.predicate);
      for (const int used : effect.predicate_uses) straight = straight && (used == kNothing || used != op.rd);
    }
    for (const Operand operand : compare.info->operands) straight = straight && operand != Operand::Px;
    if (!straight) continue;
    compare.guard = {early_predicate, false};
    compare.rd = op.rd;
    compare.fresh = op.fresh;
    removed.push_back(i);
  }
  for (auto index = removed.rbegin(); index != removed.rend(); ++index) {
    function.ops.erase(function.ops.begin() + *index);
  }
}

void sink_leaves(Function& function) {
  const std::vector<int> definitions = find_single_definitions(function, false);
  // From the end, so that a leaf does not stop at one that moves on.
  for (size_t i = function.ops.size(); i-- > 0;) {
    const Op leaf = function.ops[i];
    if (!is_leaf(leaf) || definitions[leaf.rd] == kNothing) continue;
    // It is needed wherever a value is spilled.
    if (function.spill_memory && leaf.rd == function.spill_memory->offset) continue;
    size_t place = i + 1;
    while (place < function.ops.size() && !blocks_leaf(leaf, function.ops[place])) ++place;
    const auto begin = function.ops.begin();
    std::rotate(begin + i, begin + i + 1, begin + place);
  }
}

void remove_dead(Function& function) {
  bool changed = true;
  while (changed) {
    changed = false;
    const Liveness liveness = find_liveness(function);
    std::vector<Op> kept;
    kept.reserve(function.ops.size());
    for (size_t i = 0; i < function.ops.size(); ++i) {
      const Op& op = function.ops[i];
      const Effects effect = effects(op);
      const bool needed =
          (function.spill_memory && effect.register_defined == function.spill_memory->offset) ||
          (effect.register_defined != kNothing && liveness.registers_after[i].has(effect.register_defined)) ||
          (effect.predicate_defined != kNothing && liveness.predicates_after[i].has(effect.predicate_defined));
      if (needed || !is_pure(op))
        kept.push_back(op);
      else
        changed = true;
    }
    function.ops = std::move(kept);
  }
}

}  // namespace raypool::kernel
