// The lower half of the generator of random programs: random choices, and instructions appended one by one.
#pragma once

#include <algorithm>
#include <cstdint>
#include <random>
#include <string_view>
#include <vector>

#include "bits.hpp"
#include "cosim/random_program.hpp"
#include "isa/encoding.hpp"

namespace raypool {

class ProgramEmitter {
 public:
  ProgramEmitter(uint64_t seed, uint32_t registers) : registers_(registers), random_(seed) {}

 protected:
  uint64_t random() { return random_(); }
  uint32_t below(uint32_t n) { return static_cast<uint32_t>(random_() % n); }
  bool chance(uint32_t n) { return below(n) == 0; }  ///< one in n
  bool percent(uint32_t n) { return below(100) < n; }
  uint32_t value() { return random_word(random_()); }

  size_t emit(const Instruction& i) {
    code_.push_back(encode(i));
    return code_.size() - 1;
  }
  size_t emit(Opcode opcode, int rd = 0, int ra = 0, int rb = 0, int guard = 0) {
    Instruction i;
    i.info = &instruction(opcode);
    i.rd = rd;
    i.ra = ra;
    i.rb = rb;
    i.guard = guard;
    return emit(i);
  }
  size_t emit_immediate(Opcode opcode, int rd, int ra, uint32_t immediate, int guard = 0) {
    Instruction i;
    i.info = &instruction(opcode);
    i.rd = rd;
    i.ra = ra;
    i.immediate = immediate;
    i.guard = guard;
    i.b_is_immediate = has_operand(*i.info, Operand::B);
    return emit(i);
  }
  /// Ray memory: `rld`, `rst`.
  size_t emit_word(Opcode opcode, int word, int rd = 0, int guard = 0) {
    Instruction i;
    i.info = &instruction(opcode);
    i.x = word;
    i.rd = rd;
    i.guard = guard;
    if (has_operand(*i.info, Operand::B)) {
      if (chance(2)) {
        i.b_is_immediate = true;
        i.immediate = value();
      } else {
        i.rb = first_of(below(registers_), is_triple(*i.info));
      }
    }
    return emit(i);
  }
  /// With fewer than all registers a triple's must all be there.
  int first_of(uint32_t number, bool triple) const {
    const uint32_t last = triple && registers_ < kRegisters ? registers_ - kElements : registers_ - 1;
    return static_cast<int>(std::min(number, last));
  }
  void patch(size_t at, uint32_t immediate) { code_[at] = (code_[at] & ~uint64_t{0xffffffff}) | immediate; }
  uint32_t here() const { return size32(code_); }

  uint32_t registers_;
  std::vector<uint64_t> code_;

 private:
  std::mt19937_64 random_;
};

}  // namespace raypool
