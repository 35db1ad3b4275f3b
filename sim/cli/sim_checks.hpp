// What the options of `raypool sim` may say, before anything is read.
#pragma once

#include "cli/commands.hpp"
#include "cli/engine.hpp"

namespace raypool {

/// Throws InputError for options that do not go together, or that this engine does not have; with
/// SimOptions::choose_engine no option may be for some engines only.
void check_options(const SimOptions& options, Engine engine);

/// `--error` as a share and `--within` in seconds; 0: not given. Throw InputError when it is no such number.
double error_of(const SimOptions& options);
double seconds_of(const SimOptions& options);

}  // namespace raypool
