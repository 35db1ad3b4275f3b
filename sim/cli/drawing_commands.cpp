#include "cli/drawing_commands.hpp"

#include "cli/command_options.hpp"
#include "cli/help.hpp"

namespace raypool {

DrawingCommands::DrawingCommands(CLI::App& app, const std::vector<std::string>& command,
                                 const EstimatingEngines* estimating, int& code)
    : app_(app), code_(code) {
  sim_.command = command;
  sim_.estimating = estimating;
  add_sim_command();
  add_config_command();
  add_unit_command();
}

void DrawingCommands::add_sim_command() {
  CLI::App* sim_app = app_.add_subcommand("sim", "draw a scene on the simulated chip; leaves image.png and report.json")
                          ->group(command_group::kSimulate);
  add_scene(*sim_app, sim_.scene, sim_.size, sim_.view, sim_.look, sim_.detail);
  add_depth(*sim_app, sim_.depth);
  add_shader_options(*sim_app);
  add_config(*sim_app, sim_.config, sim_.set);
  add_units(*sim_app, sim_.units);
  add_traverser(*sim_app, sim_.traverser);
  add_engine_options(*sim_app);
  add_sampling_options(*sim_app);
  add_output_options(*sim_app);
  sim_app->callback([this, sim_app] {
    sim_.choose_engine = sim_app->count("--engine") == 0 && (!sim_.error.empty() || !sim_.within.empty());
    code_ = sim_command(sim_);
  });
}

void DrawingCommands::add_shader_options(CLI::App& sim_app) {
  add_shaders(sim_app, sim_.shaders);
  add_samples(sim_app, sim_.samples);
}

void DrawingCommands::add_engine_options(CLI::App& sim_app) {
  add_engine(sim_app, sim_.engine, sim_.unit_library, kEnginesOfFrames);
  sim_app.add_option("--boundary", sim_.boundary, "rtl, lockstep: what is Verilog, unit or whole chip (default: unit)")
      ->type_name("unit|chip")
      ->group(option_group::kEngine);
  sim_app.add_option("--hits", sim_.hits, "native: its own hits, or Embree's (default: own)")
      ->type_name("own|embree")
      ->group(option_group::kEngine);
  sim_app
      .add_option("--precision", sim_.precision,
                  "native: the machine's arithmetic, or double precision (default: single); leaves decisions.bin for "
                  "raypool compare")
      ->type_name("single|double")
      ->group(option_group::kEngine);
  add_threads(sim_app, sim_.threads, "native, estimate, sampled: threads")->group(option_group::kEngine);
  sim_app
      .add_option("--cycles", sim_.cycle_limit,
                  "model, rtl, lockstep: stop after this many cycles (default: after 10000000 without a transfer)")
      ->group(option_group::kEngine)
      ->check(CLI::PositiveNumber);
  add_inspect(sim_app, sim_.inspect_until);
}

void DrawingCommands::add_sampling_options(CLI::App& sim_app) {
  sim_app
      .add_option("--error", sim_.error,
                  "half of the 95% interval of the cycles: of sampled (default: 2%), or without --engine of the "
                  "quickest that suffices, estimate, sampled or model")
      ->type_name("PERCENT")
      ->group(option_group::kSampling);
  sim_app
      .add_option("--within", sim_.within,
                  "instead of --error, time for the whole command: sampled draws as many tiles as it allows; without "
                  "--engine, the engine with the least error is chosen")
      ->type_name("SECONDS")
      ->group(option_group::kSampling);
  sim_app.add_option("--seed", sim_.seed, "sampled: of the random choice of tiles (default: 1)")
      ->group(option_group::kSampling)
      ->check(CLI::PositiveNumber);
}

void DrawingCommands::add_output_options(CLI::App& sim_app) {
  const auto flag = [&sim_app](const char* name, bool& value, const char* what) {
    sim_app.add_flag(name, value, what)->group(option_group::kOutput);
  };
  sim_app
      .add_option("--out", sim_.out,
                  "results (default: out/<what was run> beside the program; installed: in raypool-out)")
      ->type_name("FOLDER")
      ->group(option_group::kOutput);
  sim_app
      .add_option("--trace", sim_.trace,
                  "model: trace.json for Perfetto and trace.kanata for Konata, of the cycles FROM:CYCLES or "
                  "pixel:X,Y:CYCLES; : is 0:20000")
      ->type_name("WINDOW")
      ->group(option_group::kOutput);
  flag("--waves", sim_.waves, "rtl, lockstep: a waveform, waves.fst");
  sim_app
      .add_option("--unstable", sim_.unstable,
                  "native: unstable.png, the pixels that change in N more frames with last bits of the camera moved")
      ->group(option_group::kOutput)
      ->check(CLI::Range(1, 1000));
  flag("--modules", sim_.modules, "draw nothing: print the chip's SystemC modules and what their ports are bound to");
  flag("--json", sim_.json, "print the report, and nothing else, on standard output");
  flag("--quiet", sim_.quiet, "no progress and no table");
}

void DrawingCommands::add_config_command() {
  CLI::App* config_app = app_.add_subcommand("config", "print a configuration")->group(command_group::kMachine);
  config_app->add_option("config", config_.config, "a name in configs/, NwMc (N warps, M lanes) or a JSON file")
      ->capture_default_str();
  add_set(*config_app, config_.set);
  auto* formats = config_app->add_option_group("Format (at most one)");
  formats->add_flag("--json", config_.json, "as a configuration file");
  CLI::Option* verilog = formats->add_flag("--verilog-parameters", config_.verilog_parameters,
                                           "as NAME=VALUE lines for rtl/compute/rp_multiprocessor.v");
  formats->add_flag("--unit-library", config_.unit_library, "path of its Verilated unit");
  formats->require_option(0, 1);
  config_app->add_flag("--in-use", config_.in_use, "refuse a field of --set that a frame on it does not look at");
  config_app->add_flag("--chip", config_.chip, "those of rtl/chip/rp_chip.v")->needs(verilog);
  config_app->add_option("--units", config_.units, "with --unit-library or --chip: compute units, 1, 2 or 4")
      ->check(CLI::IsMember({1, 2, 4}));
  config_app->callback([this] { code_ = config_command(config_); });
}

void DrawingCommands::add_unit_command() {
  CLI::App* unit_app =
      app_.add_subcommand("unit", "build the Verilated unit that engines rtl and lockstep run (a minute or more)")
          ->group(command_group::kMachine);
  add_config(*unit_app, unit_.config, unit_.set);
  unit_app->add_option("--units", unit_.units, "compute units: 1, 2 or 4")
      ->group(option_group::kMachine)
      ->check(CLI::IsMember({1, 2, 4}))
      ->capture_default_str();
  unit_app->add_option("--boundary", unit_.boundary, "the units, or the whole chip around them, as of sim")
      ->type_name("unit|chip")
      ->capture_default_str();
  unit_app->add_flag("--waves", unit_.waves, "one that can leave a waveform, beside the fast one");
  unit_app->callback([this] { code_ = unit_command(unit_); });
}

}  // namespace raypool
