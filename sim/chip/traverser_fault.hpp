// What a fault of a traverser inside the chip means, in a sentence.
#pragma once

#include <string>

#include "machine/traverser/tree_fault.hpp"
#include "machine/traverser/tree_setup.hpp"

namespace raypool::chip {

/// What, at which address of its memory, and what to do. `tree`: where it lies, as the host has set it.
std::string fault_sentence(const TreeFault& fault, const TreeSetup& tree);

}  // namespace raypool::chip
