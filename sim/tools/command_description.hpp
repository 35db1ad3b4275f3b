// The command line described to shells and to man, from the parser's own table of commands and options.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace raypool {

/// A completion script; `shell` is bash, zsh or fish. Throws InputError for any other. An option with a list such as
/// "model|rtl" as type name is completed with its words, every other value with file names.
std::string completion(const CLI::App& app, const std::string& shell);

/// The man page, section 1: commands in the groups of --help, which must stand together.
std::string man_page(const CLI::App& app);

}  // namespace raypool
