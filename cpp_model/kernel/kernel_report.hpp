// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// What a program's kernels consist of.
#pragma once

#include <string>

#include "enum_array.hpp"
#include "isa/program.hpp"
#include "kernel/kernels.hpp"

namespace raypool {

/// Instructions of a kernel by ALU type, index = AluType.
using InstructionCounts = EnumArray<AluType, int, kAluTypes>;

/// A kernel's instructions: from its entry to the next entry. Throws InputError, with the names there
/// are, if the program has no such kernel.
Program extract_kernel(const Program& program, const std::string& name);
InstructionCounts count_instructions(const Program& program, const std::string& name);

/// Throws InputError, naming kernel, instruction and what to do, when the machine is without an instruction that the
/// kernel has.
void check_instructions(const Program& program, const std::string& kernel, const Configuration& configuration);

/// The ray kernels by ALU beside those of the thesis this machine starts from, as text with fixed columns.
/// Of such machines.
std::string kernel_table(const KernelTarget& target = {});

}  // namespace raypool
