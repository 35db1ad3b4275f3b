// Takes out ops that no lane executes: those under predicates that are never true.
#include <algorithm>

#include "kernel/compiler.hpp"

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

}  // namespace

void remove_unreached(Function& function) {
  const std::vector<bool> may = find_possible(function);
  const auto is_for_no_lane = [&](const Op& op) {
    return op.kind == Op::Kind::Instruction && !op.guard.negated && op.guard.predicate != 0 &&
           !may[static_cast<size_t>(op.guard.predicate)];
  };
  std::vector<Op> kept;
  int until = kNothing;  // label up to which all is jumped over
  for (const Op& op : function.ops) {
    if (until != kNothing) {
      const bool ends = (op.kind == Op::Kind::Label || op.kind == Op::Kind::LoopEnd) && op.label == until;
      if (ends) until = kNothing;
      continue;
    }
    const bool jumps = is(op, Opcode::Jnone) || is(op, Opcode::Loop);
    // It changes the slice of the whole warp, under an empty mask too.
    const bool stays = !is_for_no_lane(op) || op.info->kind == raypool::Kind::Swap;
    if (stays)
      kept.push_back(op);
    else if (jumps)
      until = op.label;
  }
  function.ops = std::move(kept);
}

}  // namespace raypool::kernel
