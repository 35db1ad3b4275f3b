// The middle of the generator of random programs: the statements that the body of a kernel is made of. Each leaves the
// program valid (program_check.hpp) wherever it is put.
#pragma once

#include <algorithm>
#include <array>
#include <optional>

#include "arith/test_operands.hpp"
#include "cosim/program_emitter.hpp"
#include "cosim/program_profile.hpp"

namespace raypool {

/// Where a warp's own words lie: word e of warp w at base + ((e << shift) + w * stride).
struct OwnWords {
  uint32_t entries = 64;  ///< power of two
  uint32_t shift = 2;
  uint32_t stride = 256;
  uint32_t way_entries = 64;  ///< words of that many entries apart lie in one set of the data cache
  uint32_t bytes = 0;         ///< of all warps
};

class ProgramStatements : public ProgramEmitter {
 protected:
  // Of 16 registers r0 .. r9 hold data, r10 .. r12 count loops, r13 is an address, r14 the base of what is
  // only read, r15 of the warp's own words. With fewer there are fewer data and loops.
  static constexpr int kMostLoopDepth = 3, kLeastDataRegisters = 4;
  static constexpr uint32_t kWild = 40;                                        // one operand in so many
  static constexpr uint32_t kTameBits = 0x9fffffff, kTameOffset = 0x20000000;  // of the exponent the upper bits

  ProgramStatements(const Configuration& configuration, const ProgramProfile& profile, uint64_t seed)
      : ProgramEmitter(seed, configuration.registers),
        configuration_(configuration),
        warps_(configuration.warps),
        stack_depth_(configuration.stack_depth),
        intersection_words_(configuration.intersection_words),
        instruction_cache_bytes_(configuration.instruction_cache_bytes),
        predicates_(configuration.predicates),
        arguments_(configuration.arguments),
        profile_(profile),
        operands_(seed) {
    for (size_t type = 0; type < kAluTypes; ++type)
      weights_[type] = has_any(static_cast<AluType>(type)) ? profile.weight(type) : 0;
  }

  /// `entries`: entries of the PC stack in use.
  void body(int length, int loops, int entries);
  int source() { return below(registers_); }
  int destination() { return below(data_registers_); }
  int any_predicate() { return below(predicates_); }
  /// These instructions do what they do whatever their mask is.
  int control_guard() { return chance(3) ? any_predicate() : 0; }
  int free_predicate() { return 1 + below(loop_predicate_ - 1); }
  bool has(Opcode opcode) const;
  /// Of the type.
  bool has_any(AluType type) const;
  /// rd = ra * factor, or without imul the next lower power of two as factor.
  void times(int rd, int ra, uint32_t factor);
  /// On machines without subnormal numbers nearly every program would stop at once: there what a float instruction
  /// reads is brought into 2^-63 .. 2 before it, where no product, quotient or sum is tiny. Not once in a while; and
  /// not in the lanes that the instruction's guard leaves out.
  static uint32_t tamed(uint32_t word) { return (word & kTameBits) + kTameOffset; }
  void tame(Instruction& i);
  void tame(int number, const Instruction& guarded);
  bool tames() { return guarded_ && !chance(kWild); }
  /// An ALU type, as often as the mix wants it.
  size_t plain_type();
  const InstructionInfo& plain_row(std::optional<size_t> type);
  /// One instruction that touches neither memory, rays nor control, of any type or this one, with random operands,
  /// or of registers a and b, which stay.
  void plain(int a = -1, int b = -1, std::optional<size_t> type = std::nullopt);
  /// An instruction of slw for the first or the last lanes: whole groups have none.
  void some_groups();
  /// A triple in its place, of floats or arguments; its elements may depend on each other.
  void triple(int a, int b);
  /// First of three registers for data, among which a and b are not. There must be three.
  int destination_of_three(int a, int b);
  bool has_three(int a, int b) const;
  static bool are_three(int first, int a, int b);
  /// A few of them with a pair of operands that meet: sums that cancel or need rounding, products and
  /// quotients at the ends of the range.
  void arithmetic();
  /// A loop in which threads each load another pair of operands in each round, for a few dozen instructions that
  /// compute.
  void pairs(int loops);
  uint32_t way_bytes() const { return configuration_.data_cache_bytes / 2; }
  /// r13 = an aligned address among the first `entries` words: one for all lanes, neighbours, a stride, lines of
  /// one set, or anywhere; off by -offset. `of_four`: the first of four that lie in a quadword's order.
  void address(bool own, uint32_t offset, uint32_t entries, bool of_four = false);
  /// `st` or `ld` at r13 + offset; `of_four`: or ld3.
  void access(bool store, uint32_t offset, bool of_four = false);
  void memory();
  /// Loads and stores at addresses up to the given limit, far beyond the program's data: in lines of the warp's own, or
  /// in lines that no warp stores to. Addresses of the lanes, of the warps or of one access after the other differ in
  /// one upper bit.
  void far_memory();
  /// r13 = what far addresses have below their upper bits; `spread`: an upper bit from
  /// which on lanes or warps differ, or 32.
  void far_address(bool own, uint32_t spread);
  /// At the top level the words of the current slice are known from statement to statement; elsewhere a
  /// statement writes all that it reads.
  void ray(bool top);
  void load_word(int guard);
  /// Word `word`, or with triples, three words of which `left` may be written; returns how many.
  int store_words(int word, int left);
  void rotate();
  void loop(int length, int loops, int entries);
  /// Where no predicate is left to keep loops going: around what writes none.
  void short_loop();
  void jump(int loops, int entries);
  /// Out of the innermost loop or function: beyond its end, or back to before its begin, and from there beyond its end.
  void leave();
  /// Begins and ends what leave() leaves. `pad`: code before it to which it may jump back.
  void begin_frame(int counter, int going, bool pad);
  void end_frame();
  /// Over instructions that are never executed, so that what follows lies in another
  /// line of the cache, or in the same set.
  void far_jump();
  void filler(uint32_t count);
  void early_exit();
  /// Each call has a function of its own, so that the number of instructions executed stays bounded.
  void call(int loops, int entries);
  void functions();

  Configuration configuration_;
  bool guarded_ = configuration_.subnormals == Subnormals::None;
  uint32_t warps_;
  int stack_depth_;
  uint32_t intersection_words_;
  uint32_t instruction_cache_bytes_;
  uint32_t predicates_, arguments_;
  /// With what is never executed.
  uint32_t most_instructions_ = configuration_.pc_bits < 16 ? (1u << configuration_.pc_bits) / 2 : 60000;
  int loop_depth_ = std::min(
      {kMostLoopDepth, static_cast<int>(registers_) - 3 - kLeastDataRegisters, static_cast<int>(predicates_) - 2});
  int address_ = static_cast<int>(registers_) - 3, shared_ = address_ + 1, base_ = shared_ + 1;
  int data_registers_ = address_ - loop_depth_;                       ///< behind them those that count loops
  int loop_predicate_ = static_cast<int>(predicates_) - loop_depth_;  ///< from it on they keep loops going
  ProgramProfile profile_;
  std::array<uint32_t, kAluTypes> weights_{};  ///< of each type, in the mix
  arith::OperandSource operands_;
  OwnWords own_;
  uint32_t shared_bytes_ = 1024;
  uint32_t pair_rounds_ = 1;
  bool far_memory_told_ = chance(4);
  uint32_t block_mask_ = 1;       ///< bits of the block word that choose the kernel's words
  std::vector<size_t> plain_at_;  ///< instructions that plain() has made: any other of its instructions could be there
  bool import_pending_ = false;
  int written_words_ = 0;  ///< words 0 .. n-1 of the current slice are defined

  struct Call {
    size_t at;
    int loops, entries;
  };
  std::vector<Call> calls_;  ///< of functions that are not there yet

 private:
  /// A loop, with its registers, or a function, with counter -1.
  struct Frame {
    int counter, going;
    std::optional<uint32_t> pad;
    std::vector<size_t> leaves;  ///< jumps with a target beyond the end
  };
  std::vector<Frame> frames_;
  int call_sites_ = 0;
  bool in_function_ = false;
};

}  // namespace raypool
