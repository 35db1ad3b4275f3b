// The lower half of the generator of random programs: random choices, and instructions appended one by one.
#pragma once

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
  explicit ProgramEmitter(uint64_t seed) : random_(seed) {}

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
        i.rb = below(16);
      }
    }
    return emit(i);
  }
  void patch(size_t at, uint32_t immediate) { code_[at] = (code_[at] & ~uint64_t{0xffffffff}) | immediate; }
  uint32_t here() const { return size32(code_); }

  std::vector<uint64_t> code_;

 private:
  std::mt19937_64 random_;
};

}  // namespace raypool
