#include "kernel/liveness.hpp"

namespace raypool::kernel {

std::vector<std::vector<size_t>> find_successors(const Function& function) {
  const std::vector<Op>& ops = function.ops;
  std::vector<size_t> label_at(function.labels, 0);
  std::vector<size_t> loop_at(function.labels, 0);
  for (size_t i = 0; i < ops.size(); ++i) {
    if (ops[i].kind == Op::Kind::Label || ops[i].kind == Op::Kind::LoopEnd)
      label_at[ops[i].label] = i;
    else if (is(ops[i], Opcode::Loop))
      loop_at[ops[i].label] = i;
  }
  std::vector<std::vector<size_t>> successors(ops.size());
  for (size_t i = 0; i < ops.size(); ++i) {
    const Op& op = ops[i];
    if (op.kind == Op::Kind::LoopEnd) {
      successors[i] = {loop_at[op.label]};  // the loop runs again and decides
    } else if (is(op, Opcode::Loop)) {
      successors[i] = {i + 1, label_at[op.label] + 1};
    } else if (is(op, Opcode::Jnone) || is(op, Opcode::Jany)) {
      successors[i] = {i + 1, label_at[op.label]};
    } else if (!is(op, Opcode::Exit)) {
      successors[i] = {i + 1};
    }
  }
  return successors;
}

Liveness find_liveness(const Function& function, bool through_reloads) {
  const size_t size = function.ops.size();
  Liveness after;
  after.registers_after.assign(size, NumberSet(function.registers));
  after.predicates_after.assign(size, NumberSet(function.predicates));
  Liveness before_ops = after;  // the same shape: what is needed before each op
  const auto successors = find_successors(function);
  bool changed = true;
  while (changed) {
    changed = false;
    for (size_t i = size; i-- > 0;) {
      NumberSet& registers = after.registers_after[i];
      NumberSet& predicates = after.predicates_after[i];
      for (const size_t next : successors[i]) {
        registers.merge(before_ops.registers_after[next]);
        predicates.merge(before_ops.predicates_after[next]);
      }
      const bool skipped = through_reloads && function.ops[i].spill == Spill::Reload;
      const Effects effect = skipped ? Effects() : effects(function.ops[i]);
      NumberSet registers_before = registers;
      NumberSet predicates_before = predicates;
      // A partial write neither ends the old value nor needs it: what reads it behind the write needs it before too. So
      // what a loop only writes is needed nowhere.
      for (int e = 0; e < (effect.partial ? 0 : effect.registers_defined); ++e)
        registers_before.erase(effect.register_defined + e);
      if (effect.predicate_defined != kNothing) predicates_before.erase(effect.predicate_defined);
      for (size_t n = 0; n < effect.operands; ++n) registers_before.insert(effect.register_uses[n]);
      for (const int used : effect.predicate_uses) {
        if (used != kNothing) predicates_before.insert(used);
      }
      changed |= before_ops.registers_after[i].merge(registers_before);
      changed |= before_ops.predicates_after[i].merge(predicates_before);
    }
  }
  return after;
}

}  // namespace raypool::kernel
