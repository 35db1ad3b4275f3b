// For tests: Verilated libraries, built when they are not up to date and kept between runs.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>

#include "config/configuration.hpp"

namespace raypool::test {

/// Path of the library of `units` units of `configuration`, in a folder of its name below
/// RAYPOOL_TEST_UNITS. Runs in the folder of the sources.
inline std::string build_library(const Configuration& configuration, int units = 1, bool waves = false) {
  const std::string folder = std::string(RAYPOOL_TEST_UNITS) + "/" + configuration.name +
                             (units == 1 ? "" : "-" + std::to_string(units) + "cu");
  std::filesystem::create_directories(folder);
  std::string command = "flock " + folder + "/.lock scripts/verilate.sh " + folder + (waves ? " --trace" : "");
  command += " UNITS=" + std::to_string(units);
  for (const auto& [name, value] : verilog_parameters(configuration))
    command += " " + name + "=" + std::to_string(value);
  if (std::system(command.c_str()) != 0) throw std::runtime_error("this command failed: " + command);
  return folder + "/libraypool_unit.so";
}

}  // namespace raypool::test
