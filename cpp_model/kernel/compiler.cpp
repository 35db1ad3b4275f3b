// Runs the passes and writes machine code.
#include "kernel/compiler.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <climits>

#include "bits.hpp"
#include "isa/input_error.hpp"
#include "kernel/passes.hpp"
#include "kernel/schedule.hpp"
#include "kernel/triples.hpp"

namespace raypool::kernel {
namespace {

constexpr size_t kLongestProgram = 65535;

/// The instruction with machine registers; label targets are not filled in.
Instruction with_places(const Op& op, const Allocation& places) {
  const auto reg = [&](int number) { return static_cast<uint8_t>(places.registers[number]); };
  const auto predicate = [&](int number) { return static_cast<uint8_t>(places.predicates[number]); };
  Instruction parts;
  parts.info = op.info;
  parts.guard = predicate(op.guard.predicate);
  parts.guard_negated = op.guard.negated;
  parts.immediate = op.immediate;
  for (const Operand operand : op.info->operands) {
    switch (operand) {
      case Operand::Rd:
        parts.rd = reg(op.rd);
        break;
      case Operand::Pd:
        parts.rd = predicate(op.rd);
        break;
      case Operand::Ra:
      case Operand::Address:
        parts.ra = reg(op.ra);
        break;
      case Operand::Rb:
        parts.rb = reg(op.rb);
        break;
      case Operand::Pb:
        parts.rb = predicate(op.rb);
        break;
      case Operand::Rc:
        parts.x = reg(op.rc);
        break;
      case Operand::Px:
        parts.x = predicate(op.px);
        break;
      case Operand::Word:
        parts.x = op.word;
        break;
      case Operand::B:
        parts.b_is_immediate = op.b_is_immediate;
        if (!op.b_is_immediate) parts.rb = reg(op.rb);
        break;
      default:
        break;
    }
  }
  return parts;
}

/// A copy of a register or predicate to itself.
bool does_nothing(const Op& op, const Instruction& parts) { return is_copy(op) && parts.rd == parts.rb; }

/// As many triples as registers suffice for.
Function with_triples(const Function& function) {
  for (int most = INT_MAX;;) {
    Function formed = function;
    most = form_triples(formed, most);
    if (most == 0) return function;
    if (has_places(formed)) return formed;
    // A kernel that was written by hand gets as many as possible.
    most = function.reuses_values ? most / 2 : most - 1;
  }
}

/// Throws InputError if registers and predicates do not suffice.
void make_room(Function& function, CompileCounts& counts) {
  if (has_places(function, false) && has_places(function, true)) return;
  Function spilled = function;
  if (!spill(spilled, counts.spilled)) allocate(function);
  function = std::move(spilled);
  if (function.reuses_values) apply_where_places_suffice(function, remove_idle_writes);
}

/// All that happens to intermediate code before it gets machine registers.
void run_passes(Function& function, CompileCounts& counts, const KernelTarget& target) {
  fold_constants(function);
  fold_addresses(function);
  if (function.reuses_values) {
    reuse_values(function);
    fold_constants(function);
    remove_idle_writes(function);
  }
  remove_dead(function);
  if (function.reuses_values) remove_short_jumps(function);
  join_conditions(function);
  sink_leaves(function);
  remove_dead(function);
  if (function.reuses_values) schedule(function);
  make_room(function, counts);
  if (target.triples) function = with_triples(function);
}

}  // namespace

CompileCounts compile(Function function, Program& program, const KernelTarget& target) {
  if (function.spill_memory) {
    // Its address takes instructions, and a register: only for what finds no place without.
    Function without = function;
    without.spill_memory.reset();
    Program extended = program;
    try {
      const CompileCounts counts = compile(std::move(without), extended, target);
      program = std::move(extended);
      return counts;
    } catch (const InputError&) {
      // With memory it may do, or there is a better reason.
    }
  }
  CompileCounts counts;
  run_passes(function, counts, target);
  const Allocation places = allocate(function);

  const auto entry = size32(program.code);
  std::vector<Instruction> code;
  std::vector<std::pair<size_t, int>> jumps;  // instruction, label
  std::vector<uint32_t> label_at(function.labels, 0);
  for (const Op& op : function.ops) {
    if (op.kind == Op::Kind::Undefined) continue;
    if (op.kind != Op::Kind::Instruction) {
      label_at[op.label] = entry + size32(code);
      continue;
    }
    const Instruction parts = with_places(op, places);
    if (does_nothing(op, parts)) continue;
    if (op.label != kNothing) jumps.emplace_back(code.size(), op.label);
    code.push_back(parts);
    counts.slots = std::max(counts.slots, op.slot + 1);
    if (op.spill != Spill::None) ++(op.spill == Spill::Store ? counts.stores : counts.loads);
  }
  for (const auto& [index, label] : jumps) code[index].immediate = label_at[label];

  if (program.code.size() + code.size() > kLongestProgram) {
    throw InputError(fmt::format("kernel '{}' makes the program longer than {} instructions; divide it", function.name,
                                 kLongestProgram));
  }
  if (!program.entries.emplace(function.name, entry).second) {
    throw InputError(fmt::format("kernel '{}' is in the program twice; give one of them another name", function.name));
  }
  for (const Instruction& parts : code) program.code.push_back(encode(parts));
  counts.instructions = static_cast<int>(code.size());
  return counts;
}

}  // namespace raypool::kernel
