// A random program as a text file (JSON): what tb/regressions/ is made of.
#pragma once

#include <string>

#include "cosim/random_program.hpp"

namespace raypool {

/// A program with the configuration that it was made for.
struct SavedProgram {
  Configuration configuration;
  RandomProgram program;
  std::string note;  ///< what it has shown, one sentence
};

/// The file's text: configuration, kernels, stalls, arguments, and the code as assembly text, an instruction a line.
std::string to_json(const SavedProgram& saved);
/// Throws InputError naming `where` when the text is no such file, or, with `check`, the program in it
/// breaks the promises of check_program().
SavedProgram parse_saved_program(const std::string& text, const std::string& where, bool check = true);
SavedProgram load_saved_program(const std::string& path, bool check = true);

}  // namespace raypool
