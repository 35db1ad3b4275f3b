// The commands that simulate, verify and describe the machine, with their options.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>
#include <vector>

#include "cli/drawing_commands.hpp"
#include "tools/commands.hpp"

namespace raypool {

class MachineCommands {
 public:
  /// Adds them to `app`, which must outlive this. `command` is the command line; `estimating`: engines sampled and
  /// estimate. The command that is parsed leaves its exit code in `code`.
  MachineCommands(CLI::App& app, const std::vector<std::string>& command, const EstimatingEngines& estimating,
                  int& code);
  MachineCommands(const MachineCommands&) = delete;
  MachineCommands& operator=(const MachineCommands&) = delete;

 private:
  CLI::App* add(const char* group, const std::string& name, const std::string& what);
  void add_compare_command();
  void add_run_command();
  void add_cosim_command();
  void add_cosim_output(CLI::App& cosim_app, CLI::Option* replay);
  void add_configurations_command();
  void add_isa_command();
  void add_assembly_command();
  void add_kernels_command();
  void add_errors_command();
  void add_scene_command();
  void add_bench_command();
  void add_descriptions_command();

  CLI::App& app_;
  int& code_;
  DrawingCommands drawing_;
  CompareOptions compare_;
  RunOptions compute_;
  CosimOptions cosim_;
  ConfigurationsOptions configurations_;
  bool verilog_ = false, functions_ = false, markdown_ = false, write_ = false;
  std::string text_path_, text_out_;
  std::string kernel_, kernels_config_ = "8w8c";
  std::vector<std::string> kernels_set_;
  uint32_t grid_ = 4096;
  SceneCommandOptions scene_;
  BenchCommandOptions bench_;
  std::string shell_ = "bash";
};

}  // namespace raypool
