// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// What a comparison throws when RTL and model differ, and what the inspection finds inside;
// the lockstep makes the report of them.
#pragma once

#include <cstdint>
#include <string>

namespace raypool::lockstep {

/// What the report has beside the details.
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

/// What is not as it should be inside the RTL.
struct Finding {
  uint64_t cycle = 0;  ///< of the model
  std::string files;   ///< of rtl/, the likeliest first
  std::string text;    ///< one sentence
};

}  // namespace raypool::lockstep
