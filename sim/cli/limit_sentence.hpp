// What a command prints when a run has come to a limit.
#pragma once

#include <string>

#include "chip/chip.hpp"

namespace raypool {

/// `given`: by --cycles; otherwise how to raise it.
std::string limit_sentence(const LimitPassed& passed, bool given);

}  // namespace raypool
