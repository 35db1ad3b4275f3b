// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Values that find no register, and conditions that find no predicate, are kept elsewhere or computed again.
#pragma once

#include "kernel/intermediate.hpp"

namespace raypool::kernel {

/// How many values and conditions lie elsewhere than in a register for some time.
struct SpillCounts {
  int to_words = 0;    ///< values in words of the current ray slice
  int to_memory = 0;   ///< values in spill memory
  int recomputed = 0;  ///< values that an instruction without register operands gives again
  int predicates = 0;  ///< conditions in registers, or computed again
};

/// Spills until 16 registers and 15 predicates suffice; false if they do not, and the function is then of no more use.
/// A value first goes to a word of the ray slice that holds nothing that is needed, else to the function's spill
/// memory. For code without triples.
bool spill(Function& function, SpillCounts& counts);

}  // namespace raypool::kernel
