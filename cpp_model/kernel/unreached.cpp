// Takes out ops that no lane executes, those under predicates that are never true, and these predicates with them.
#include <algorithm>

#include "kernel/compiler.hpp"
#include "kernel/passes.hpp"

namespace raypool::kernel {
namespace {

/// Whether lanes may have the predicate behind the op that writes it, by what may be true so far.
bool may_be_true(const Op& op, const std::vector<bool>& may) {
  const auto at = [&](int predicate) { return predicate == 0 || may[static_cast<size_t>(predicate)]; };
  if (!op.guard.negated && !at(op.guard.predicate)) return false;
  switch (op.info->opcode) {
    case Opcode::Pand:
      return at(op.px) && at(op.rb);
    case Opcode::Por:
      return at(op.px) || at(op.rb);
    case Opcode::Pxor:
      return op.px != op.rb && (at(op.px) || at(op.rb));
    case Opcode::Pandn:
      return at(op.px) && op.rb != 0;
    default:
      return true;
  }
}

/// [predicate] some lane may have it at some time.
std::vector<bool> find_possible(const Function& function) {
  std::vector<bool> may(static_cast<size_t>(function.predicates), false);
  for (bool changed = true; changed;) {
    changed = false;
    for (const Op& op : function.ops) {
      if (op.kind != Op::Kind::Instruction || !writes_predicate(*op.info)) continue;
      if (may[static_cast<size_t>(op.rd)] || !may_be_true(op, may)) continue;
      may[static_cast<size_t>(op.rd)] = changed = true;
    }
  }
  return may;
}

void make_copy(Op& op, int predicate) {
  op.info = &instruction(Opcode::Pand);
  op.px = op.rb = predicate;
}

/// Reads no predicate that is never true: what defines it goes.
template <typename IsNever>
void simplify(Op& op, const IsNever& is_never) {
  if (op.guard.negated && is_never(op.guard.predicate)) op.guard = {};
  switch (op.info->opcode) {
    case Opcode::Por:
    case Opcode::Pxor:
      if (is_never(op.px) != is_never(op.rb)) make_copy(op, is_never(op.px) ? op.rb : op.px);
      break;
    case Opcode::Pandn:
      if (is_never(op.rb)) make_copy(op, op.px);
      break;
    case Opcode::Sel:
      if (!is_never(op.px)) break;
      op.info = &instruction(Opcode::Mov);
      op.ra = op.px = kNothing;
      break;
    default:
      break;
  }
}

}  // namespace

void remove_unreached(Function& function) {
  const std::vector<bool> may = find_possible(function);
  const auto is_never = [&](int predicate) { return predicate > 0 && !may[static_cast<size_t>(predicate)]; };
  const auto is_for_no_lane = [&](const Op& op) {
    return op.kind == Op::Kind::Instruction && !op.guard.negated && is_never(op.guard.predicate);
  };
  std::vector<Op> kept;
  int until = kNothing;  // label up to which all is jumped over
  for (const Op& op : function.ops) {
    if (until != kNothing) {
      const bool ends = (op.kind == Op::Kind::Label || op.kind == Op::Kind::LoopEnd) && op.label == until;
      if (ends) until = kNothing;
      continue;
    }
    if (op.kind != Op::Kind::Instruction) {
      kept.push_back(op);
    } else if (writes_predicate(*op.info) && op.rd != 0) {
      if (is_never(op.rd)) continue;
      kept.push_back(may_be_true(op, may) ? op : clearing(op.rd, op.where));
      simplify(kept.back(), is_never);
    } else if (!is_for_no_lane(op)) {
      kept.push_back(op);
      simplify(kept.back(), is_never);
    } else if (op.info->kind == raypool::Kind::Swap) {
      // It changes the slice of the whole warp, under an empty mask too.
      kept.push_back(clearing(op.guard.predicate, op.where));
      kept.push_back(op);
    } else if (is(op, Opcode::Jnone) || is(op, Opcode::Loop)) {
      until = op.label;
    }
  }
  function.ops = std::move(kept);
}

}  // namespace raypool::kernel
