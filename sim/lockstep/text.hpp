// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Texts of the lockstep's reports.
#pragma once

#include <cstdint>
#include <string>

#include "machine/compute/cycle_unit.hpp"

namespace raypool::lockstep {

std::string word_text(uint32_t word);             ///< "3f800000 (1)": bits and float
std::string mask_text(uint32_t mask, int lanes);  ///< bits, lane 0 rightmost
std::string instruction_text(uint64_t encoding);  ///< assembly text
std::string fault_text(const Fault& fault);       ///< "misaligned address (code 5) at warp 1, PC 17"
/// RTL files that make the result of an instruction, the likeliest first, at most three.
std::string result_files(const DecodedInstruction& instruction, const Configuration& configuration);

/// The first `most` of a list of files, each once.
std::string first_files(const std::string& files, size_t most);

/// Operands and results of an instruction, a line a lane. `rtl` and `model` are null when it writes no register.
std::string lane_table(const CycleUnit::Issue& issue, int lanes, const uint32_t* rtl, const uint32_t* model);

}  // namespace raypool::lockstep
