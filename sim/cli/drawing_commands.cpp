#include "cli/drawing_commands.hpp"

#include "cli/command_options.hpp"

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

CLI::App* DrawingCommands::add(const std::string& name, const std::string& what) {
  return app_.add_subcommand(name, what)->group(kMachineGroup);
}

void DrawingCommands::add_sim_command() {
  CLI::App* sim_app = add("sim", "draw a scene on the simulated chip; leaves image.png and report.json");
  add_scene(*sim_app, sim_.scene, sim_.size, sim_.view, sim_.look, sim_.detail);
  add_config(*sim_app, sim_.config, sim_.set);
  add_engine(*sim_app, sim_.engine, sim_.unit_library);
  sim_app
      ->add_option("--boundary", sim_.boundary,
                   "rtl and lockstep: what is Verilog, the units in the model of the chip, or the whole chip (default: "
                   "unit)")
      ->type_name("unit|chip");
  sim_app->add_option("--hits", sim_.hits, "native: hits of its own, or Embree's (default: own)")
      ->type_name("own|embree");
  sim_app
      ->add_option("--precision", sim_.precision,
                   "native: numbers of the machine's arithmetic, or of double precision (default: single); given, it "
                   "leaves decisions.bin too, from which raypool compare says why pixels differ")
      ->type_name("single|double");
  sim_app
      ->add_option("--unstable", sim_.unstable,
                   "native: draw so many frames more, each with last bits of the camera moved, and leave unstable.png, "
                   "which shows the pixels that change")
      ->check(CLI::Range(1, 1000))
      ->type_name("N");
  add_units_and_depth(*sim_app, sim_.units, sim_.depth);
  add_threads(*sim_app, sim_.threads, "native, estimate and sampled: threads");
  sim_app
      ->add_option("--error", sim_.error,
                   "sampled: half of the 95% interval of the cycles; as many tiles as that takes (default: 2%)")
      ->type_name("PERCENT");
  sim_app->add_option("--time", sim_.time, "sampled: in place of --error, as many tiles as the command has time for")
      ->type_name("SECONDS");
  sim_app->add_option("--seed", sim_.seed, "sampled: of the random choice of tiles (default: 1)")
      ->check(CLI::PositiveNumber);
  sim_app->add_option("--traverser", sim_.traverser, "as --set chip.traverser=NAME");
  sim_app->add_option(
      "--out", sim_.out,
      "folder for the results (default: out/<what was run> beside the program; installed: in raypool-out)");
  sim_app->add_option(
      "--trace", sim_.trace,
      "FROM:CYCLES or pixel:X,Y:CYCLES, : for 0:20000; leave what happens in this window too, trace.json "
      "for Perfetto and trace.kanata for Konata; model only");
  sim_app->add_flag("--waves", sim_.waves, "leave a waveform, waves.fst, too; rtl and lockstep only");
  sim_app->add_flag("--modules", sim_.modules,
                    "draw nothing: print the chip's SystemC modules, and what their ports are bound to");
  sim_app
      ->add_option("--cycles", sim_.cycle_limit,
                   "give up after this many cycles (default: after 10000000 without a transfer)")
      ->check(CLI::PositiveNumber);
  add_inspect(*sim_app, sim_.inspect_until);
  sim_app->add_flag("--json", sim_.json, "the report on standard output, and nothing else there");
  sim_app->add_flag("--quiet", sim_.quiet, "no progress and no table");
  sim_app->callback([this] { code_ = sim_command(sim_); });
}

void DrawingCommands::add_config_command() {
  CLI::App* config_app = add("config", "print a configuration");
  config_app->add_option("config", config_.config, "a name in configs/, NwMc or a JSON file")->capture_default_str();
  add_set(*config_app, config_.set);
  auto* formats = config_app->add_option_group("format");
  formats->add_flag("--json", config_.json, "as a configuration file");
  CLI::Option* verilog = formats->add_flag("--verilog-parameters", config_.verilog_parameters,
                                           "as NAME=VALUE lines for rtl/compute/rp_multiprocessor.v");
  formats->add_flag("--unit-library", config_.unit_library, "path of its Verilated unit");
  formats->require_option(0, 1);
  config_app->add_flag("--in-use", config_.in_use, "refuse a field of --set that a frame on it does not look at");
  config_app->add_flag("--chip", config_.chip, "with --verilog-parameters: those of rtl/chip/rp_chip.v")
      ->needs(verilog);
  config_app->add_option("--units", config_.units, "with --unit-library or --chip: compute units, 1, 2 or 4")
      ->check(CLI::IsMember({1, 2, 4}));
  config_app->callback([this] { code_ = config_command(config_); });
}

void DrawingCommands::add_unit_command() {
  CLI::App* unit_app =
      add("unit", "build the Verilated unit that engines rtl and lockstep run (takes a minute or more)");
  add_config(*unit_app, unit_.config, unit_.set);
  unit_app->add_option("--units", unit_.units, "compute units: 1, 2 or 4")
      ->check(CLI::IsMember({1, 2, 4}))
      ->capture_default_str();
  unit_app->add_option("--boundary", unit_.boundary, "the units, or the whole chip around them, as of sim")
      ->type_name("unit|chip")
      ->capture_default_str();
  unit_app->add_flag("--waves", unit_.waves, "one that can leave a waveform, beside the fast one");
  unit_app->callback([this] { code_ = unit_command(unit_); });
}

}  // namespace raypool
