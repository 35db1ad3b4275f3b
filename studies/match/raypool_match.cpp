// `raypool referee` with others beside ours: what `make referee` prints.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

#include "cli/exit_code.hpp"
#include "commands/commands.hpp"
#include "rivals/rivals.hpp"

int main(int argc, char** argv) {
  CLI::App app("hits of hard rays and triangles beside rational numbers: ours, Embree's and others'");
  raypool::RefereeCommandOptions options;
  raypool::add_referee_options(app, options);
  CLI11_PARSE(app, argc, argv);
  try {
    return raypool::referee_command(options, raypool::referee::rivals);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "referee: %s\n", error.what());
    return raypool::kInputFailure;
  }
}
