// The commands that draw a frame, and build the Verilated unit for it, with their options.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "chip/sampling.hpp"
#include "cli/commands.hpp"

namespace raypool {

class DrawingCommands {
 public:
  /// Adds them to `app`, which must outlive this. `command` is the command line; `estimating`: engines sampled and
  /// estimate, null: there are none. The command that is parsed leaves its exit code in `code`.
  DrawingCommands(CLI::App& app, const std::vector<std::string>& command, const EstimatingEngines* estimating,
                  int& code);
  DrawingCommands(const DrawingCommands&) = delete;
  DrawingCommands& operator=(const DrawingCommands&) = delete;

 private:
  void add_sim_command();
  void add_shader_options(CLI::App& sim_app);
  void add_engine_options(CLI::App& sim_app);
  void add_sampling_options(CLI::App& sim_app);
  void add_output_options(CLI::App& sim_app);
  void add_config_command();
  void add_unit_command();

  CLI::App& app_;
  int& code_;
  SimOptions sim_;
  ConfigOptions config_;
  UnitOptions unit_;
};

}  // namespace raypool
