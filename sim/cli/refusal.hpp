// What is wrong with a command line, in one sentence.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace raypool {

/// Names it, and where to look, after `app` has thrown `error`. Of a word that no command takes it names the nearest
/// one that a command does.
std::string refusal(const CLI::App& app, const CLI::ParseError& error);

}  // namespace raypool
