// For tests: Verilated libraries, built when they are not up to date and kept between runs.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "config/configuration.hpp"

namespace raypool::test {

/// Runs scripts/verilate.sh of the tree `tree` with `options` in the folder `name` below `units`. Returns this folder.
/// The script's output is shown if it fails.
inline std::string verilate(const std::string& name, const std::string& options, const std::string& tree = ".",
                            const std::string& units = RAYPOOL_TEST_UNITS) {
  std::string folder = units + "/" + name;
  std::filesystem::create_directories(folder);
  const std::string log = folder + "/verilate.log";
  const std::string command = "flock " + folder + "/.lock " + tree + "/scripts/verilate.sh " + folder + options;
  const std::string shown = command + " > " + log + " 2>&1 || { cat " + log + "; false; }";
  if (std::system(shown.c_str()) != 0) throw std::runtime_error("this command failed: " + command);
  return folder;
}
inline std::string words_of(const std::vector<std::pair<std::string, int>>& parameters) {
  std::string words;
  for (const auto& [name, value] : parameters) words += " " + name + "=" + std::to_string(value);
  return words;
}

/// Path of the library of `units` units of `configuration`, in a folder of its name. Runs in the folder of the sources.
inline std::string build_library(const Configuration& configuration, int units = 1, bool waves = false) {
  return verilate(configuration.name + (units == 1 ? "" : "-" + std::to_string(units) + "cu"),
                  (waves ? " --trace UNITS=" : " UNITS=") + std::to_string(units) +
                      words_of(verilog_parameters(configuration))) +
         "/libraypool_unit.so";
}

}  // namespace raypool::test
