// What `make convergence` prints: pictures of a path tracer as shaders beside the reference's, and how their variance
// falls.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

#include "cli/exit_code.hpp"
#include "convergence/convergence_command.hpp"

int main(int argc, char** argv) {
  CLI::App app("shader set `path` beside a path tracer in double precision");
  raypool::convergence::CommandOptions options;
  app.add_option("--scenes", options.scenes, "built-in names or scene files")->capture_default_str();
  app.add_option("--shaders", options.shaders, "the shader set that draws")->capture_default_str();
  app.add_option("--size", options.size, "of the pictures, WIDTHxHEIGHT")->capture_default_str();
  app.add_option("--depth", options.depth, "surfaces that a path meets at most")->capture_default_str();
  app.add_option("--samples", options.samples, "of each picture")->capture_default_str();
  app.add_option("--reference", options.reference, "samples of the reference, for each of these")
      ->capture_default_str();
  app.add_option("--block", options.block, "pixels of a block's side")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    return raypool::convergence::convergence_command(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "convergence: %s\n", error.what());
    return raypool::kInputFailure;
  }
}
