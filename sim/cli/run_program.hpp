// What both programs do: parse a command line, run its command, and make a sentence and an exit code of what is wrong.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

namespace raypool {

/// Adds commands to `app` and returns what they refer to, which is kept as long as `app`. `words` is the command line;
/// the command that is parsed leaves its exit code in `code`.
using AddCommands = std::shared_ptr<void> (*)(CLI::App& app, const std::vector<std::string>& words, int& code);

/// Runs the command of `argv`. Returns the program's exit code (cli/exit_code.hpp); ends by a signal that has come.
int run_program(int argc, char** argv, AddCommands add);

}  // namespace raypool
