// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Collects a kernel's operations as intermediate code while its source runs once. The
// value types of recorded.hpp call it.
#pragma once

#include <string>
#include <vector>

#include "kernel/intermediate.hpp"

namespace raypool::kernel {

/// A condition as a statement takes it: a virtual predicate or its inverse.
struct Condition {
  int predicate = 0;
  bool negated = false;
  Location where;
};

class Recorder {
 public:
  /// Becomes the active recorder of this C++ thread until it is destroyed; there may be one at a time.
  /// `fused`: the machine has a fused multiply-add.
  explicit Recorder(const std::string& name, bool fused = false);
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Throws std::logic_error when values of the recorded kind are used outside a kernel.
  static Recorder& active();

  /// Ends the kernel with `exit` and hands it over.
  Function finish();

  /// An instruction under the current mask, without operands.
  Op& emit(Opcode opcode, const Location& where);
  Op& last_op() { return function_.ops.back(); }
  /// The same with a new destination; returns the destination's number.
  int emit_value(Opcode opcode, const Location& where);
  int emit_unary(Opcode opcode, int ra, const Location& where);
  int emit_binary(Opcode opcode, int ra, int rb, const Location& where);
  /// a * b + c: one instruction if the machine has it, else two.
  int emit_multiply_add(int a, int b, int c, const Location& where);
  int emit_immediate(Opcode opcode, int ra, uint32_t immediate, const Location& where);
  int emit_constant(uint32_t bits, const Location& where);
  int emit_copy(int source, const Location& where);
  int emit_predicates(Opcode opcode, int px, int pb, const Location& where);
  int emit_select(const Condition& condition, int a, int b, const Location& where);

  /// variable = source; `temporary`: the source is not read again.
  void assign_register(int variable, int source, bool temporary);
  void assign_predicate(int variable, int source, bool temporary);
  /// A predicate that equals the condition within the current mask.
  int materialise(const Condition& condition);

  /// A register that holds nothing yet.
  int declare_register();
  /// How many ops, and registers, there are so far.
  size_t ops() const { return function_.ops.size(); }
  int registers() const { return function_.registers; }
  /// Before that op nothing is held in these registers.
  void declare_before(size_t op, const std::vector<int>& registers);
  /// A predicate that no lane of the current mask has.
  int declare_predicate();
  /// Lanes of the current mask get the predicate, which others keep.
  void join(int predicate);
  /// From here on every operation is recorded as of this line; {}: as of its own.
  void set_place(const Location& place) { place_ = place; }

  /// Statements: begin, body, end. `Else` may follow a then-body.
  void begin_if(const Condition& condition);
  void begin_else();
  void end_if();
  /// `condition` is a predicate of the loop alone.
  void begin_loop(int condition, const Location& where);
  /// `condition`: evaluated at the end of the body.
  void end_loop(int condition, bool temporary);

 private:
  struct Block {
    Guard outer;
    Condition condition;  // of an if
    int locked = 0;       // predicate that must not change before the block ends
    size_t first_op = 0;
    int label = kNothing;
    Location where;
    int number = 0;  // of all blocks
  };
  /// Outside `guard` a virtual predicate is 0 as long as the block is open in which it was written: what jumps over the
  /// block leaves the predicate as it was.
  struct Mask {
    Guard guard;
    int block = 0;  // 0: none
  };

  bool is_within_mask(int predicate) const;
  Guard mask_for(const Condition& condition);
  void open(const Condition& condition, const Location& where);
  void close_body();
  int new_register();
  int new_predicate();
  bool defined_last(int destination, bool predicate) const;
  void check_unlocked(int predicate, const Location& where) const;

  bool fused_;
  Function function_;
  Guard guard_;
  std::vector<Guard> register_masks_;  // mask under which a virtual register was declared
  std::vector<Mask> predicate_masks_;  // of virtual predicates
  std::vector<Block> blocks_;
  int opened_ = 0;  // blocks so far
  Location last_, place_;
};

}  // namespace raypool::kernel
