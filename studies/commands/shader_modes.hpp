// `raypool numerics --shaders`: what each arithmetic mode does to the picture that a shader set draws, and costs.
#pragma once

#include <vector>

#include "commands/commands.hpp"
#include "numerics/modes.hpp"

namespace raypool {

/// Draws the frame natively in each of the modes, compares its picture with that of the machine's full arithmetic, and
/// counts the cycles of a small one on the model; prints a table and leaves numerics.json. Returns the exit code.
int shader_modes_command(const NumericsOptions& options, const std::vector<numerics::ArithmeticMode>& modes);

}  // namespace raypool
