// What a checker throws when RTL and model differ; the lockstep adds where and when, and makes the report.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "machine/functional_core.hpp"

namespace raypool::lockstep {

/// An instruction with its operands as the model has them before it is executed.
struct InstructionContext {
  uint32_t warp = 0;
  uint32_t pc = 0;
  const DecodedInstruction* instruction = nullptr;  ///< null: outside the program
  uint32_t mask = 0;
  uint32_t px = 0, pb = 0;              ///< predicates x[3:0] and rb
  std::array<uint32_t, kMaxLanes> a{};  ///< register ra
  std::array<uint32_t, kMaxLanes> b{};  ///< register rb or the immediate
};

/// What belongs into the report beside the details.
enum class Context : uint8_t {
  Unit,         ///< nothing: no single instruction is to blame
  Warp,         ///< the warp's last instructions
  Instruction,  ///< and the instruction being retired
  Operands,     ///< and its operands
};

struct Mismatch {
  std::string title;    ///< one sentence
  std::string details;  ///< lines, each ended by a newline
  std::string module;   ///< files of rtl/ to look at
  Context context = Context::Unit;
};

}  // namespace raypool::lockstep
