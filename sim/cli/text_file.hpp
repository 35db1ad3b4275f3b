// Reading of text files named on the command line.
#pragma once

#include <string>

namespace raypool {

/// The whole file, with lines that end in "\n"; "-" is standard input. Throws InputError when it cannot be read.
std::string read_text(const std::string& path);

}  // namespace raypool
