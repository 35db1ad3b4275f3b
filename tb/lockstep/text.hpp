// Texts of the lockstep's reports.
#pragma once

#include <cstdint>
#include <string>

#include "machine/cycle_unit.hpp"

namespace raypool::lockstep {

std::string word_text(uint32_t word);                          ///< "3f800000 (1)": bits and float
std::string mask_text(uint32_t mask, int lanes);               ///< bits, lane 0 rightmost
std::string instruction_text(uint64_t encoding);               ///< assembly text
std::string fault_text(const Fault& fault);                    ///< "misaligned address (code 5) at warp 1, PC 17"
std::string module_of(const DecodedInstruction* instruction);  ///< RTL files that execute it

/// Operands and results of an instruction, a line a lane. `rtl` and `model` are null when it writes no register.
std::string lane_table(const CycleUnit::Issue& issue, int lanes, const uint32_t* rtl, const uint32_t* model);

}  // namespace raypool::lockstep
