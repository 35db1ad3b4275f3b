// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The compiler's intermediate code: machine instructions with registers and predicates that are not yet numbered as the
// machine's.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "isa/encoding.hpp"

namespace raypool::kernel {

/// A line of a kernel's source.
struct Location {
  const char* file = "";
  int line = 0;
  /// As a default argument: the place of the call.
  static constexpr Location here(const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
    return {file, line};
  }
};
/// "kernels.cpp:57"
std::string to_string(const Location& location);

/// The mask under which code runs: a virtual predicate, 0 = p0.
struct Guard {
  int predicate = 0;
  bool negated = false;
  bool all() const { return predicate == 0 && !negated; }
  friend bool operator==(const Guard& a, const Guard& b) {
    return a.predicate == b.predicate && a.negated == b.negated;
  }
};

inline constexpr int kNothing = -1;

/// Why an op stands where the kernel's source has none.
enum class Spill : uint8_t {
  None,
  Store,   ///< keeps a value outside its register
  Reload,  ///< gives a register the value back that it has held before: no new value
};

struct Op {
  /// Undefined: rd is a register in which nothing is held yet.
  enum class Kind : uint8_t { Instruction, Label, LoopEnd, Undefined };
  Kind kind = Kind::Instruction;
  const InstructionInfo* info = nullptr;
  Guard guard;
  int rd = kNothing;  ///< virtual register, or predicate if the instruction writes one
  int ra = kNothing;  ///< virtual register
  int rb = kNothing;  ///< virtual register or predicate, as the instruction has it
  int rc = kNothing;  ///< virtual register
  int px = kNothing;  ///< virtual predicate
  bool b_is_immediate = false;
  uint32_t immediate = 0;
  uint8_t word = 0;      ///< ray word
  int label = kNothing;  ///< Label, LoopEnd: its number; jumps and loop: where they go
  /// Lanes outside the guard need nothing of rd's old value, so that whatever rd's register held before is dead. Of a
  /// Spill::Store: the same of the ray word.
  bool fresh = false;
  /// Of a load whose value no op reads: when it is done, all that the thread has stored is in the memory.
  bool fence = false;
  Spill spill = Spill::None;
  int slot = kNothing;  ///< of spill memory, if the op stores to it or reloads from it
  Location where;
};

/// Memory of the threads' own, for values that find no place in registers and ray words. Value n of a thread lies at
/// byte `offset` + base + n stride. A value outside all guards is stored by every lane of the warp: lanes without work
/// must not have the offset of one that has some.
struct SpillMemory {
  int offset = kNothing;  ///< virtual register that one op writes, before all else and in every lane: bytes
  uint32_t base = 0;      ///< byte address, a multiple of 4
  uint32_t stride = 4;    ///< bytes, a multiple of 4
  int slots = 0;          ///< how many values it has room for
};

/// One kernel. Virtual registers are 0 .. registers-1; virtual predicate 0 is p0.
struct Function {
  std::string name;
  std::vector<Op> ops;
  int registers = 0;
  int predicates = 1;
  int labels = 0;
  /// First registers of groups of three that get places in a row.
  std::vector<int> groups;
  /// Words of the machine's ray memory a thread, 12 .. 21: those that hold nothing that is needed take spilled values.
  int slice_words = kPackageWords;
  std::optional<SpillMemory> spill_memory;
  /// Equal values are computed once, and ray words not written with what they hold: for code that was not written by
  /// hand.
  bool reuses_values = false;
};

/// What an op reads and writes. Predicate p0 is left out.
struct Effects {
  /// First `operands` numbers that are read as such, then those of which a partial write leaves lanes as they are.
  std::array<int, 3 * kElements + 1> register_uses;
  size_t operands = 0;
  int predicate_uses[4] = {kNothing, kNothing, kNothing, kNothing};
  int register_defined = kNothing;
  int registers_defined = 0;  ///< how many from it on
  int predicate_defined = kNothing;
  /// The defined register's old value lives on in some lanes; it is then among the uses.
  bool partial = false;

  Effects() { register_uses.fill(kNothing); }
};
Effects effects(const Op& op);

/// True for an instruction that may be left out when its result is never read.
bool is_pure(const Op& op);
/// What loads and other such ops stay in front of or behind: a store, and an inval.
bool changes_memory(const Op& op);
/// True for a copy of one register or predicate to another, in all lanes that matter.
bool is_copy(const Op& op);
/// How many instructions an op is: 3 of a triple.
inline int elements(const Op& op) { return op.info != nullptr && is_triple(*op.info) ? kElements : 1; }
/// Threads part or meet there.
inline bool ends_block(const Op& op) {
  if (op.kind == Op::Kind::Undefined) return false;
  return op.kind != Op::Kind::Instruction || op.info->kind == raypool::Kind::Control;
}
inline bool is(const Op& op, Opcode opcode) { return op.info != nullptr && op.info->opcode == opcode; }

}  // namespace raypool::kernel
