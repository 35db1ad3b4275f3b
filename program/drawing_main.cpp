// The program `raypool-sim`: of `raypool` what draws a frame, and is compiled in half the time.
#include "cli/drawing_commands.hpp"
#include "cli/run_program.hpp"

int main(int argc, char** argv) {
  return raypool::run_program(
      argc, argv, [](CLI::App& app, const std::vector<std::string>& words, int& code) -> std::shared_ptr<void> {
        return std::make_shared<raypool::DrawingCommands>(app, words, nullptr, code);
      });
}
