// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Text to machine code and back. docs/machine/isa.md describes the text.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "isa/program.hpp"

namespace raypool {

/// Assembles a whole program. Throws InputError "source_name:line:column: what is wrong; what is right".
Program assemble(std::string_view text, const std::string& source_name);

/// One instruction as text that assembles to the same 64 bits: targets as numbers, a malformed instruction as `.word`.
std::string disassemble(uint64_t encoding);

/// A whole program, with labels and `.kernel` lines; it assembles to the same program. Each
/// line ends with its instruction number.
std::string listing(const Program& program);

}  // namespace raypool
