// Reading of files that a user names: the whole of it, or one sentence why not.
#pragma once

#include <string>

namespace raypool {

/// The file's bytes. Throws InputError with the system's reason when it cannot be read, or is a folder; `what`
/// names it in the sentence: "view file".
std::string read_file(const std::string& path, const std::string& what);

}  // namespace raypool
