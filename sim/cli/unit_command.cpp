// `raypool unit`: the Verilated unit of a configuration, built where the engines rtl and lockstep look for it.
#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <thread>

#include "cli/commands.hpp"
#include "cli/engine.hpp"
#include "cli/folders.hpp"
#include "config/configuration.hpp"
#include "config/data_folder.hpp"

namespace raypool {

namespace fs = std::filesystem;

namespace {

void make_unit_folder(const fs::path& folder) {
  if (folder.string().find(' ') != std::string::npos)
    throw InputError(
        fmt::format("'{}': Verilator's makefiles cannot handle a space in the path of the unit{}", folder.string(),
                    installed() ? ": set XDG_CACHE_HOME to a folder without one" : ": move the build folder"));
  std::error_code error;
  fs::create_directories(folder, error);
  if (error || access(folder.c_str(), W_OK | X_OK) != 0)
    throw InputError(fmt::format("cannot write into folder '{}'{}: {}", folder.string(),
                                 error ? " (" + error.message() + ")" : std::string(),
                                 installed() ? "set XDG_CACHE_HOME to a folder of your own" : "check its permissions"));
}

// $1: the folder; what follows is run.
constexpr const char* kClearAndRun = R"(for left in "$1"/.verilate.*; do
  [ ! -e "$left" ] || { rm -rf "$left" && echo "raypool: removed $left, which a build that was killed left" >&2; }
done
shift
exec "$@")";

}  // namespace

int unit_command(const UnitOptions& options) {
  const Configuration configuration = load_configuration(options.config, options.set);
  const bool chip = parse_boundary(options.boundary) == Boundary::Chip;
  const auto path = chip ? chip_library_path : unit_library_path;
  const fs::path folder = fs::path(path(configuration, options.waves, options.units)).parent_path();
  make_unit_folder(folder);
  // One build at a time in a folder: a second waits here. So what lies there half done is of one that was killed.
  std::vector<std::string> command = {
      "flock",      folder / ".lock", "bash", "-c",
      kClearAndRun, "raypool unit",   folder, fs::path(data_folder()) / "scripts" / "verilate.sh",
      folder};
  if (options.waves) command.emplace_back("--trace");
  if (chip) command.insert(command.end(), {"--top", "chip"});
  auto parameters = chip ? chip_verilog_parameters(configuration, options.units) : verilog_parameters(configuration);
  if (!chip) parameters.emplace_back("UNITS", options.units);
  for (const auto& [name, value] : parameters) command.push_back(fmt::format("{}={}", name, value));

  setenv("JOBS", std::to_string(std::max(1u, std::thread::hardware_concurrency())).c_str(), 0);
  std::vector<char*> words;
  for (std::string& word : command) words.push_back(word.data());
  words.push_back(nullptr);
  execvp(words[0], words.data());
  throw std::runtime_error(
      fmt::format("{} was not found, which locks the folder of the unit (Debian package util-linux)", words[0]));
}

}  // namespace raypool
