// What the Brh, Flt and Slw ALUs do with one lane's operands: the golden model's lanes, and what control decides.
#pragma once

#include <cstdint>
#include <vector>

#include "arith/arith.hpp"
#include "isa/encoding.hpp"
#include "machine/compute/brh_alu.hpp"
#include "machine/compute/flt_alu.hpp"
#include "machine/compute/slw_alu.hpp"

namespace raypool {

using ModelFunction = uint32_t (*)(Opcode opcode, uint32_t a, uint32_t b, uint32_t c, arith::Mode mode);

/// Of a type, in the order of the table.
inline std::vector<Opcode> opcodes_of(AluType type, Kind kind = Kind::Plain) {
  std::vector<Opcode> opcodes;
  for (const InstructionInfo& info : kInstructions)
    if (info.alu() == type && info.kind == kind && !is_triple(info)) opcodes.push_back(info.opcode);
  return opcodes;
}

/// Compares, and predicate logic on the bits 0 and 1 of c; control as a task with lanes decides.
inline uint32_t brh_model(Opcode opcode, uint32_t a, uint32_t b, uint32_t c, arith::Mode mode) {
  if (instruction(opcode).kind == Kind::Control) return BrhAlu::taken(opcode, 1);
  return BrhAlu::compare(opcode, Lanes<1>{1, nullptr, &a, &b, nullptr}, c & 1, c >> 1 & 1, mode) & 1;
}

inline uint32_t flt_model(Opcode opcode, uint32_t a, uint32_t b, uint32_t c, arith::Mode mode) {
  uint32_t result = 0;
  FltAlu::execute(opcode, Lanes<1>{1, &result, &a, &b, &c}, mode);
  return result;
}

inline uint32_t slw_model(Opcode opcode, uint32_t a, uint32_t b, uint32_t, arith::Mode mode) {
  uint32_t result = 0;
  SlwAlu::execute(opcode, Lanes<1>{1, &result, &a, &b, nullptr}, mode);
  return result;
}

}  // namespace raypool
