// The commands that study the machine, with their options.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>
#include <vector>

#include "commands/commands.hpp"

namespace raypool {

class StudyCommands {
 public:
  /// As MachineCommands (tools/machine_commands.hpp).
  StudyCommands(CLI::App& app, const std::vector<std::string>& command, int& code);
  StudyCommands(const StudyCommands&) = delete;
  StudyCommands& operator=(const StudyCommands&) = delete;

 private:
  CLI::App* add(const std::string& name, const std::string& what);
  void add_numerics_command();
  void add_significands_command();
  void add_fit_command();
  void add_explore_command();
  void add_widths_commands();
  void add_referee_command();

  CLI::App& app_;
  int& code_;
  NumericsOptions numerics_;
  SignificandsOptions significands_;
  BoxesOptions boxes_;
  TrianglesOptions triangles_;
  RefereeCommandOptions referee_;
  FitOptions fit_;
  ExploreOptions explore_;
};

}  // namespace raypool
