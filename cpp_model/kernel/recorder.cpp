#include "kernel/recorder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "isa/input_error.hpp"

namespace raypool::kernel {
namespace {

thread_local Recorder* active_recorder = nullptr;

// A body that no thread needs is jumped over when it has at least so many instructions:
// the jump costs the time of some two.
constexpr size_t kShortestJump = 6;

}  // namespace

Recorder::Recorder(const std::string& name, bool fused) : fused_(fused) {
  if (active_recorder != nullptr) throw std::logic_error("a kernel is being recorded inside another one");
  function_.name = name;
  predicate_masks_.push_back({});
  active_recorder = this;
}

Recorder::~Recorder() { active_recorder = nullptr; }

Recorder& Recorder::active() {
  if (active_recorder == nullptr) throw std::logic_error("a value of the kernel language is used outside a kernel");
  return *active_recorder;
}

Function Recorder::finish() {
  emit(Opcode::Exit, last_);
  return std::move(function_);
}

int Recorder::new_register() {
  register_masks_.push_back(guard_);
  return function_.registers++;
}

int Recorder::new_predicate() {
  predicate_masks_.push_back({guard_, blocks_.empty() ? 0 : blocks_.back().number});
  return function_.predicates++;
}

Op& Recorder::emit(Opcode opcode, const Location& where) {
  Op op;
  op.info = &instruction(opcode);
  op.guard = guard_;
  op.where = last_ = place_.line != 0 ? place_ : where;
  function_.ops.push_back(op);
  return function_.ops.back();
}

int Recorder::emit_value(Opcode opcode, const Location& where) {
  Op& op = emit(opcode, where);
  op.rd = writes_predicate(*op.info) ? new_predicate() : new_register();
  op.fresh = true;
  return op.rd;
}

int Recorder::emit_unary(Opcode opcode, int ra, const Location& where) {
  const int rd = emit_value(opcode, where);
  function_.ops.back().ra = ra;
  return rd;
}

int Recorder::emit_binary(Opcode opcode, int ra, int rb, const Location& where) {
  const int rd = emit_unary(opcode, ra, where);
  function_.ops.back().rb = rb;
  return rd;
}

int Recorder::emit_multiply_add(int a, int b, int c, const Location& where) {
  if (!fused_) return emit_binary(Opcode::Fadd, emit_binary(Opcode::Fmul, a, b, where), c, where);
  const int rd = emit_binary(Opcode::Ffma, a, b, where);
  function_.ops.back().rc = c;
  return rd;
}

int Recorder::emit_immediate(Opcode opcode, int ra, uint32_t immediate, const Location& where) {
  const int rd = emit_unary(opcode, ra, where);
  function_.ops.back().b_is_immediate = true;
  function_.ops.back().immediate = immediate;
  return rd;
}

int Recorder::emit_constant(uint32_t bits, const Location& where) {
  return emit_immediate(Opcode::Mov, kNothing, bits, where);
}
int Recorder::emit_copy(int source, const Location& where) { return emit_binary(Opcode::Mov, kNothing, source, where); }

int Recorder::emit_predicates(Opcode opcode, int px, int pb, const Location& where) {
  const int pd = emit_value(opcode, where);
  function_.ops.back().px = px;
  function_.ops.back().rb = pb;
  return pd;
}

int Recorder::emit_select(const Condition& condition, int a, int b, const Location& where) {
  const int rd = emit_binary(Opcode::Sel, condition.negated ? b : a, condition.negated ? a : b, where);
  function_.ops.back().px = condition.predicate;
  return rd;
}

bool Recorder::defined_last(int destination, bool predicate) const {
  if (function_.ops.empty()) return false;
  const Op& op = function_.ops.back();
  return op.kind == Op::Kind::Instruction && op.rd == destination && op.fresh && op.guard == guard_ &&
         writes_predicate(*op.info) == predicate && (predicate || writes_register(*op.info));
}

void Recorder::assign_register(int variable, int source, bool temporary) {
  if (!temporary || !defined_last(source, false)) {
    source = emit_copy(source, last_);
  }
  // The operation that has just made the value writes the variable instead. Under the mask of the
  // declaration nothing else of it is left.
  Op& op = function_.ops.back();
  op.rd = variable;
  op.fresh = register_masks_[variable] == guard_;
}

void Recorder::check_unlocked(int predicate, const Location& where) const {
  for (const Block& block : blocks_) {
    if (block.locked != predicate) continue;
    throw InputError(
        fmt::format("{}: kernel '{}' assigns a condition inside the if_ of {} that it decides; assign a copy",
                    to_string(where), function_.name, to_string(block.where)));
  }
}

void Recorder::assign_predicate(int variable, int source, bool temporary) {
  check_unlocked(variable, last_);
  if (guard_.all()) {
    if (!temporary || !defined_last(source, true)) emit_predicates(Opcode::Pand, source, source, last_);
    function_.ops.back().rd = variable;
    return;
  }
  // A predicate is written in all lanes: (source in the mask) or (old value outside it).
  const int inside = emit_predicates(Opcode::Pand, source, source, last_);
  const Guard mask = guard_;
  guard_ = {};
  const int outside = emit_predicates(mask.negated ? Opcode::Pand : Opcode::Pandn, variable, mask.predicate, last_);
  emit_predicates(Opcode::Por, inside, outside, last_);
  function_.ops.back().rd = variable;
  guard_ = mask;
}

int Recorder::materialise(const Condition& condition) {
  return condition.negated ? emit_predicates(Opcode::Pandn, 0, condition.predicate, condition.where)
                           : emit_predicates(Opcode::Pand, condition.predicate, condition.predicate, condition.where);
}

int Recorder::declare_register() {
  const int number = new_register();
  declare_before(function_.ops.size(), {number});
  return number;
}

void Recorder::declare_before(size_t place, const std::vector<int>& registers) {
  std::vector<Op> declarations(registers.size());
  for (size_t i = 0; i < registers.size(); ++i) {
    declarations[i].kind = Op::Kind::Undefined;
    declarations[i].rd = registers[i];
    declarations[i].fresh = true;
    declarations[i].where = last_;
  }
  function_.ops.insert(function_.ops.begin() + static_cast<std::ptrdiff_t>(place), declarations.begin(),
                       declarations.end());
}

int Recorder::declare_predicate() { return emit_predicates(Opcode::Pxor, 0, 0, last_); }

void Recorder::join(int predicate) {
  const int mask = guard_.all() ? 0 : guard_.negated ? emit_predicates(Opcode::Pand, 0, 0, last_) : guard_.predicate;
  const Guard guard = guard_;
  guard_ = {};
  emit_predicates(Opcode::Por, predicate, mask, last_);
  function_.ops.back().rd = predicate;
  guard_ = guard;
}

/// Whether the predicate is 0 outside the current mask.
bool Recorder::is_within_mask(int predicate) const {
  const Mask& mask = predicate_masks_[predicate];
  const auto is_open = [&](const Block& block) { return block.number == mask.block; };
  return mask.guard == guard_ && (mask.block == 0 || std::any_of(blocks_.begin(), blocks_.end(), is_open));
}

Guard Recorder::mask_for(const Condition& condition) {
  const bool inside_mask = is_within_mask(condition.predicate);
  if (guard_.all() || (inside_mask && !condition.negated)) return {condition.predicate, condition.negated};
  return {materialise(condition), false};
}

void Recorder::open(const Condition& condition, const Location& where) {
  Block block;
  block.outer = guard_;
  block.condition = condition;
  block.locked = condition.predicate;
  block.where = where;
  guard_ = mask_for(condition);
  block.first_op = function_.ops.size();
  block.number = ++opened_;
  blocks_.push_back(block);
}

void Recorder::begin_if(const Condition& condition) {
  last_ = condition.where;
  open(condition, condition.where);
}

/// Ends a then- or else-body: puts a jump over it if that can save time.
void Recorder::close_body() {
  const Block& block = blocks_.back();
  bool swaps_slices = false;
  for (size_t i = block.first_op; i < function_.ops.size(); ++i) {
    // That concerns the whole warp: whether it happens must not depend on the data.
    const Op& op = function_.ops[i];
    swaps_slices |= op.kind == Op::Kind::Instruction && op.info->kind == Kind::Swap;
  }
  if (!swaps_slices && function_.ops.size() - block.first_op >= kShortestJump) {
    Op jump;
    jump.info = &instruction(Opcode::Jnone);
    jump.guard = guard_;
    jump.label = function_.labels++;
    jump.where = block.where;
    function_.ops.insert(function_.ops.begin() + block.first_op, jump);
    Op label;
    label.kind = Op::Kind::Label;
    label.label = jump.label;
    function_.ops.push_back(label);
  }
  guard_ = block.outer;
}

void Recorder::begin_else() {
  close_body();
  const Block block = blocks_.back();
  blocks_.pop_back();
  open({block.condition.predicate, !block.condition.negated, block.where}, block.where);
}

void Recorder::end_if() {
  close_body();
  blocks_.pop_back();
}

void Recorder::begin_loop(int condition, const Location& where) {
  // The loop's predicate shrinks as threads leave; outside the mask it has to be 0 from the start.
  if (!is_within_mask(condition)) condition = materialise({condition, false, where});
  Block block;
  block.outer = guard_;
  block.locked = condition;
  block.where = where;
  guard_ = {condition, false};
  Op& op = emit(Opcode::Loop, where);
  op.label = block.label = function_.labels++;
  block.first_op = function_.ops.size();
  block.number = ++opened_;
  blocks_.push_back(block);
}

void Recorder::end_loop(int condition, bool temporary) {
  const Block block = blocks_.back();
  if (!temporary || !defined_last(condition, true)) emit_predicates(Opcode::Pand, condition, condition, block.where);
  function_.ops.back().rd = block.locked;
  Op end;
  end.kind = Op::Kind::LoopEnd;
  end.label = block.label;
  function_.ops.push_back(end);
  guard_ = block.outer;
  blocks_.pop_back();
}

}  // namespace raypool::kernel
