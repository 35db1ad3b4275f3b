// What a comparison throws when RTL and model differ; the lockstep adds where and when, and makes the report.
#pragma once

#include <cstdint>
#include <string>

namespace raypool::lockstep {

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
  uint32_t unit = 0, warp = 0;  ///< meaningful unless the context is Unit
};

}  // namespace raypool::lockstep
