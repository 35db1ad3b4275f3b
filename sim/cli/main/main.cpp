// The command line: what each subcommand takes, what it does with errors.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>

#include "chip/chip.hpp"
#include "cli/about.hpp"
#include "cli/command_description.hpp"
#include "cli/commands.hpp"
#include "cli/engine.hpp"
#include "cli/exit_code.hpp"
#include "cli/inspecting_run.hpp"
#include "files/unfinished.hpp"
#include "lockstep/lockstep_unit.hpp"
#include "machine/box_ray.hpp"
#include "machine/narrow_float.hpp"
#include "scene/native_renderer.hpp"

namespace raypool {
namespace {

/// The end of --help.
std::string exit_codes() {
  std::string text = "Exit codes:\n";
  for (const ExitCode& row : kExitCodes) text += fmt::format("  {}  {}\n", row.code, row.meaning);
  return text;
}

CLI::Option* add_set(CLI::App& app, std::vector<std::string>& set) {
  return app
      .add_option("--set", set, "change a field of the configuration, alus.flt.count=2 or chip.ray_pool.size=256")
      ->type_name("FIELD=VALUE")
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

void add_config(CLI::App& app, std::string& config, std::vector<std::string>& set) {
  app.add_option("--config", config, "machine: a name in configs/, NwMc (N warps, M lanes) or a JSON file")
      ->capture_default_str();
  add_set(app, set);
}

CLI::Option* add_unit(CLI::App& app, std::string& engine, std::string& library) {
  app.add_option("--unit-library", library, "Verilated unit (default: where raypool unit builds it)");
  return app
      .add_option("--engine", engine,
                  "what plays the machine; native, the kernels as C++, and sampled are for sim only")
      ->type_name("native|functional|sampled|model|rtl|lockstep")
      ->capture_default_str();
}

void add_threads(CLI::App& app, uint32_t& threads, const std::string& whose) {
  app.add_option("--threads", threads, whose + " (default: as many as the machine has cores)")
      ->check(CLI::Range(1u, kMostRenderThreads));
}

void add_inspect(CLI::App& app, uint64_t& until) {
  app.add_option("--inspect", until,
                 "lockstep: look inside the RTL up to this cycle, in which an earlier run met a difference; that run "
                 "does it by itself")
      ->type_name("CYCLE")
      ->check(CLI::PositiveNumber);
}

void add_scene(CLI::App& app, std::string& scene, std::string& size, std::string& view, ViewWords& look,
               double& detail) {
  app.add_option("--scene,scene", scene, "cornell, room, or the path of a .obj, .gltf, .glb or .ply file")
      ->capture_default_str();
  app.add_option("--size", size, "image, WIDTHxHEIGHT in pixels, 1 to 16384 each")->capture_default_str();
  app.add_option("--view", view, "JSON file with camera and light (default: the scene's own, or framed automatically)");
  app.add_option("--camera", look.camera, "camera of a glTF file, by its name or its node's (default: the first one)");
  app.add_option("--eye", look.eye, "place of the camera, x,y,z (default, as of the next four: the view's)");
  app.add_option("--look-at", look.look_at, "point in the middle of the picture, x,y,z");
  app.add_option("--up", look.up, "upwards, x,y,z");
  app.add_option("--fov", look.fov, "vertical field of view, degrees, 1 to 170");
  app.add_option("--light", look.light, "place of the light, x,y,z");
  app.add_option("--detail", detail, "triangles of a built-in scene, 0.01 to 16, 1 = as designed")
      ->capture_default_str();
}

void add_units_and_depth(CLI::App& app, int& units, int& depth) {
  app.add_option("--units", units, "compute units: 1, 2 or 4")->capture_default_str();
  app.add_option("--depth", depth, "1: eye and shadow rays only; up to 254: with reflections")->capture_default_str();
}

/// "--size is given 2 times (8x8, 16x16): give it once", of an option that takes one
/// value; empty if there is none such.
std::string given_twice(const CLI::App& app) {
  for (const CLI::App* sub : app.get_subcommands()) {
    for (const CLI::Option* option : sub->get_options()) {
      const std::vector<std::string>& values = option->results();
      if (option->get_expected_max() != 1 || values.size() < 2) continue;
      return fmt::format("{} is given {} times ({}): give it once", option->get_name(), values.size(),
                         fmt::join(values, ", "));
    }
  }
  return "";
}

/// The commands with their options, as CLI11 takes them.
class CommandLine {
 public:
  CommandLine(int argc, char** argv);
  /// Parses, runs the command and returns its exit code.
  int run(int argc, char** argv);

 private:
  void add_sim_command();
  void add_compare_command();
  void add_run_command();
  void add_cosim_command();
  void add_configurations_command();
  void add_config_command();
  void add_unit_command();
  void add_isa_command();
  void add_assembly_command();
  void add_kernels_command();
  void add_errors_command();
  void add_scene_command();
  void add_bench_command();
  void add_numerics_command();
  void add_significands_command();
  void add_widths_command(CLI::App& app, WidthsOptions& options, uint32_t least, uint32_t most);
  void add_widths_commands();
  void add_fit_command();
  void add_descriptions_command();

  CLI::App app_{
      "raypool: a ray-tracing GPU to render on, measure, verify and synthesise. RAYPOOL COMMAND --help tells more of a "
      "command.",
      "raypool"};
  int code_ = 0;
  SimOptions sim_;
  CompareOptions compare_;
  RunOptions compute_;
  CosimOptions cosim_;
  ConfigurationsOptions configurations_;
  ConfigOptions config_;
  UnitOptions unit_;
  bool verilog_ = false, functions_ = false, markdown_ = false, write_ = false;
  std::string text_path_, text_out_;
  std::string kernel_, kernels_config_ = "8w8c";
  std::vector<std::string> kernels_set_;
  uint32_t grid_ = 4096;
  SceneCommandOptions scene_;
  BenchCommandOptions bench_;
  NumericsOptions numerics_;
  SignificandsOptions significands_;
  BoxesOptions boxes_;
  TrianglesOptions triangles_;
  FitOptions fit_;
  std::string shell_ = "bash";
};

CommandLine::CommandLine(int argc, char** argv) {
  app_.require_subcommand(1);
  app_.set_help_all_flag("--help-all", "help of every command");
  app_.set_version_flag(
      "--version", [] { return about(); }, "version, and those of the libraries");
  app_.footer(exit_codes());
  sim_.command.assign(argv, argv + argc);
  fit_.command = sim_.command;
  add_sim_command();
  add_compare_command();
  add_run_command();
  add_cosim_command();
  add_configurations_command();
  add_config_command();
  add_unit_command();
  add_isa_command();
  add_assembly_command();
  add_kernels_command();
  add_errors_command();
  add_scene_command();
  add_bench_command();
  add_numerics_command();
  add_significands_command();
  add_widths_commands();
  add_fit_command();
  add_descriptions_command();
}

void CommandLine::add_sim_command() {
  CLI::App* sim_app =
      app_.add_subcommand("sim", "draw a scene on the simulated chip; leaves image.png and report.json");
  add_scene(*sim_app, sim_.scene, sim_.size, sim_.view, sim_.look, sim_.detail);
  add_config(*sim_app, sim_.config, sim_.set);
  add_unit(*sim_app, sim_.engine, sim_.unit_library);
  sim_app
      ->add_option("--boundary", sim_.boundary,
                   "rtl and lockstep: what is Verilog, the units in the model of the chip, or the whole chip (default: "
                   "unit)")
      ->type_name("unit|chip");
  sim_app->add_option("--hits", sim_.hits, "native: hits of its own, or Embree's (default: own)")
      ->type_name("own|embree");
  add_units_and_depth(*sim_app, sim_.units, sim_.depth);
  add_threads(*sim_app, sim_.threads, "native and sampled: threads");
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

void CommandLine::add_compare_command() {
  CLI::App* compare_app =
      app_.add_subcommand("compare", "two reports of sim: what differs in the set-up, and what that did");
  compare_app->add_option("a", compare_.a, "report.json, or the folder it is in")->required();
  compare_app->add_option("b", compare_.b, "another")->required();
  compare_app
      ->add_option(
          "--synthesis", compare_.synthesis,
          "report of make synth, or a folder of such folders, for the area (default: synth beside the program)")
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  compare_app->add_flag("--json", compare_.json, "all of it as JSON");
  compare_app->callback([this] { code_ = compare_command(compare_); });
}

void CommandLine::add_run_command() {
  CLI::App* run_app = app_.add_subcommand("run", "run a compute kernel on one compute unit");
  run_app->add_option("kernel", compute_.kernel, "saxpy, matmul, or the path of an assembly file")->required();
  add_config(*run_app, compute_.config, compute_.set);
  add_unit(*run_app, compute_.engine, compute_.unit_library);
  run_app->add_option("--n", compute_.n, "size of saxpy (elements) or matmul (rows of a square matrix)");
  run_app->add_option("--blocks", compute_.blocks, "assembly file: blocks to launch")->capture_default_str();
  run_app->add_option("--threads", compute_.threads, "assembly file: threads a block (default: warps x lanes)");
  run_app
      ->add_option("--arg", compute_.arguments,
                   "assembly file: next kernel argument; integer, 0x..., or float (with a point)")
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  run_app->add_option("--memory", compute_.memory_bytes, "assembly file: bytes of memory, program first")
      ->capture_default_str();
  run_app->add_option("--print", compute_.print, "assembly file: ADDRESS:WORDS of memory to print afterwards")
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  run_app->add_option("--waves", compute_.waves, "leave a waveform (FST) in this file; rtl and lockstep only");
  add_inspect(*run_app, compute_.inspect_until);
  run_app
      ->add_option(
          "--cycles", compute_.cycle_limit,
          "give up after this many cycles; functional: warp instructions (default: 100000000, and after 10000000 "
          "without a transfer)")
      ->check(CLI::PositiveNumber);
  run_app->add_flag("--quiet", compute_.quiet, "no progress");
  run_app->callback([this] { code_ = run_command(compute_); });
}

void CommandLine::add_cosim_command() {
  CLI::App* cosim_app =
      app_.add_subcommand("cosim", "random programs, with stalls on every port, in lockstep with the golden model");
  auto* config = cosim_app->add_option("--config", cosim_.config,
                                       "machine: a name in configs/, NwMc (N warps, M lanes) or a JSON file (default: "
                                       "the small ones that --machines prints, which share the programs)");
  add_set(*cosim_app, cosim_.set)->needs(config);
  add_unit(*cosim_app, cosim_.engine, cosim_.unit_library);
  cosim_app->add_option("--units", cosim_.units, "compute units of --config: 1, 2 or 4")
      ->needs(config)
      ->check(CLI::IsMember({1, 2, 4}))
      ->capture_default_str();
  cosim_app->add_option("--programs", cosim_.programs, "how many")->capture_default_str();
  cosim_app->add_option("--seed", cosim_.seed, "of the first; the next one has the next seed")->capture_default_str();
  cosim_app->add_option("--length", cosim_.length, "about how many instructions a program has, 1 to 2000")
      ->check(CLI::Range(1, 2000))
      ->capture_default_str();
  cosim_app->add_option("--mix", cosim_.mix, "one mix of instructions for all programs: mixed, memory, ..., operands");
  cosim_app->add_flag("--quiet", cosim_.quiet, "no progress");
  cosim_app->add_flag("!--no-shrink", cosim_.shrink, "leave a program that fails as it is");
  cosim_app->add_option("--save", cosim_.save, "folder for the shrunk program")->capture_default_str();
  cosim_app->add_option("--coverage", cosim_.coverage, "JSON file with what was covered");
  cosim_app->add_option("--vectors", cosim_.vectors, "record every cycle in this file, for tb/icarus");
  cosim_app->add_flag("--machines", cosim_.machines, "print the machines of a run without --config: file and units");
  auto* replay = cosim_app->add_option("--replay", cosim_.replay, "run a saved program instead of random ones");
  cosim_app->add_flag("--show-config", cosim_.show_configuration, "print the configuration of the saved program")
      ->needs(replay);
  cosim_app->add_flag("--unchecked", cosim_.unchecked, "run the saved program even if it breaks the rules")
      ->needs(replay);
  cosim_app->callback([this] { code_ = cosim_command(cosim_); });
}

void CommandLine::add_configurations_command() {
  CLI::App* configurations_app =
      app_.add_subcommand("configurations", "a set of machines with every pair of parameter values");
  configurations_app->add_flag("--all-pairs", configurations_.all_pairs, "large machines too (default: small ones)");
  configurations_app->add_option("--most", configurations_.most,
                                 "only the first so many of those that bring pairs of values");
  configurations_app->add_option("--out", configurations_.folder, "folder that gets a JSON file for each");
  configurations_app->callback([this] { code_ = configurations_command(configurations_); });
}

void CommandLine::add_config_command() {
  CLI::App* config_app = app_.add_subcommand("config", "print a configuration");
  config_app->add_option("config", config_.config, "a name in configs/, NwMc or a JSON file")->capture_default_str();
  add_set(*config_app, config_.set);
  auto* formats = config_app->add_option_group("format");
  formats->add_flag("--json", config_.json, "as a configuration file");
  CLI::Option* verilog = formats->add_flag("--verilog-parameters", config_.verilog_parameters,
                                           "as NAME=VALUE lines for rtl/multiprocessor.v");
  formats->add_flag("--unit-library", config_.unit_library, "path of its Verilated unit");
  formats->require_option(0, 1);
  config_app->add_flag("--in-use", config_.in_use, "refuse a field of --set that a frame on it does not look at");
  config_app->add_flag("--chip", config_.chip, "with --verilog-parameters: those of rtl/chip.v")->needs(verilog);
  config_app->add_option("--units", config_.units, "with --unit-library or --chip: compute units, 1, 2 or 4")
      ->check(CLI::IsMember({1, 2, 4}));
  config_app->callback([this] { code_ = config_command(config_); });
}

void CommandLine::add_unit_command() {
  CLI::App* unit_app = app_.add_subcommand(
      "unit", "build the Verilated unit that engines rtl and lockstep run (takes a minute or more)");
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

void CommandLine::add_isa_command() {
  CLI::App* isa_app = app_.add_subcommand("isa", "print the instruction table (default: as Markdown)");
  auto* isa_formats = isa_app->add_option_group("format");
  isa_formats->add_flag("--markdown", markdown_, "docs/isa.md");
  isa_formats->add_flag("--verilog", verilog_, "rtl/isa.vh: constants");
  isa_formats->add_flag("--verilog-functions", functions_, "rtl/isa_functions.vh: decoding");
  isa_formats->add_flag("--write", write_, "all files that are derived from the table, in place");
  isa_formats->require_option(0, 1);
  isa_app->callback([this] {
    if (write_) {
      code_ = isa_write_command();
      return;
    }
    code_ = isa_command(verilog_ ? IsaFormat::Verilog : functions_ ? IsaFormat::VerilogFunctions : IsaFormat::Markdown);
  });
}

void CommandLine::add_assembly_command() {
  CLI::App* asm_app = app_.add_subcommand("asm", "assemble: one hexadecimal 64-bit word a line");
  CLI::App* disasm_app = app_.add_subcommand("disasm", "disassemble what asm has written");
  for (CLI::App* sub : {asm_app, disasm_app}) {
    sub->add_option("file", text_path_, "input, - for standard input")->required();
    sub->add_option("--out,-o", text_out_, "output (default: standard output)");
  }
  asm_app->callback([this] { code_ = asm_command(text_path_, text_out_); });
  disasm_app->callback([this] { code_ = disasm_command(text_path_, text_out_); });
}

void CommandLine::add_kernels_command() {
  CLI::App* kernels_app =
      app_.add_subcommand("kernels", "the ray kernels' instruction counts by ALU, or the listing of one kernel");
  kernels_app->add_option("name", kernel_, "kernel to list");
  add_config(*kernels_app, kernels_config_, kernels_set_);
  kernels_app->callback([this] { code_ = kernels_command(kernel_, kernels_config_, kernels_set_); });
}

void CommandLine::add_errors_command() {
  CLI::App* errors_app =
      app_.add_subcommand("errors", "measure the errors of division and roots of every slow unit, in ulp");
  errors_app->add_option("--grid", grid_, "fdiv: GRID x GRID pairs of mantissas, 2 to 32768")
      ->check(CLI::Range(2u, 32768u))
      ->capture_default_str();
  errors_app->callback([this] { code_ = errors_command(grid_); });
}

void CommandLine::add_scene_command() {
  CLI::App* scene_app = app_.add_subcommand("scene", "what a scene holds: triangles, materials, box, camera, light");
  CLI::App* hits_app = app_.add_subcommand("hits", "compare our traversal's hits on a frame with Embree's");
  for (CLI::App* sub : {scene_app, hits_app})
    add_scene(*sub, scene_.scene, scene_.size, scene_.view, scene_.look, scene_.detail);
  scene_app->add_option("--write-obj", scene_.write_obj, "write it as an OBJ, with its MTL beside it");
  scene_app->add_option(
      "--write-bvh", scene_.write_bvh,
      "write its tree as the traverser's memory holds it, a binary file that docs/scenes.md describes");
  scene_app->callback([this] { code_ = scene_command(scene_); });
  hits_app->callback([this] { code_ = hits_command(scene_); });
}

void CommandLine::add_bench_command() {
  CLI::App* bench_app = app_.add_subcommand(
      "bench", "how fast our intersection is beside Embree's, on the eye, reflection and shadow rays of a frame");
  add_scene(*bench_app, bench_.scene, bench_.size, bench_.view, bench_.look, bench_.detail);
  bench_app->add_option("--depth", bench_.depth, "of the frame's rays")
      ->check(CLI::Range(1, kLargestDepth))
      ->capture_default_str();
  add_threads(*bench_app, bench_.threads, "threads of the second half of the table");
  bench_app->add_option("--repetitions", bench_.repetitions, "turns, each of both sides")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  bench_app->add_flag("--processor-time", bench_.processor_time,
                      "what the threads used of the processor, divided by their number, in place of the time on the "
                      "wall: for a machine that does other things too");
  bench_app->add_flag("--json", bench_.json, "the figures as JSON on standard output, and nothing else there");
  bench_app->add_flag("--quiet", bench_.quiet, "no progress");
  bench_app->callback([this] { code_ = bench_command(bench_); });
}

void CommandLine::add_numerics_command() {
  CLI::App* numerics_app = app_.add_subcommand(
      "numerics", "what each arithmetic mode does to pictures, and costs; seams; offsets; extremes");
  add_config(*numerics_app, numerics_.config, numerics_.set);
  numerics_app->add_option("--mode", numerics_.mode, "all, or one: ieee-exact, flush-newton1, ...")
      ->capture_default_str();
  numerics_app->add_option("--size", numerics_.size, "pictures, WIDTHxHEIGHT in pixels")->capture_default_str();
  numerics_app->add_option("--depth", numerics_.depth, "of the pictures' rays")
      ->check(CLI::Range(1, 254))
      ->capture_default_str();
  numerics_app->add_option(
      "--out", numerics_.out,
      "folder for numerics.json and plots (default: out/numerics beside the program; installed: in raypool-out)");
  numerics_app->add_option("--synthesis", numerics_.synthesis,
                           "folder of synthesis reports (default: synth beside the program)");
  numerics_app->add_flag("--extremes", numerics_.extremes, "the catalogue of hard cases, by mode and engine");
  numerics_app->add_flag("--catalogue", numerics_.catalogue, "only list those cases, with what is expected of them");
  numerics_app->add_option("--configurations", numerics_.configurations,
                           "only write a configuration file of each mode into this folder");
  numerics_app->add_flag("--quiet", numerics_.quiet, "no progress");
  numerics_app->callback([this] { code_ = numerics_command(numerics_); });
}

void CommandLine::add_significands_command() {
  CLI::App* significands_app = app_.add_subcommand(
      "significands", "what floats of fewer bits do to a scene's picture, and how few bits nobody sees");
  add_scene(*significands_app, significands_.scene, significands_.size, significands_.view, significands_.look,
            significands_.detail);
  significands_app->add_option("--depth", significands_.depth, "of the picture's rays")
      ->check(CLI::Range(1, 254))
      ->capture_default_str();
  add_config(*significands_app, significands_.config, significands_.set);
  significands_app->add_flag("--quiet", significands_.quiet, "no progress");
  significands_app->callback([this] { code_ = significands_command(significands_); });
}

void CommandLine::add_widths_command(CLI::App& app, WidthsOptions& options, uint32_t least, uint32_t most) {
  add_scene(app, options.scene, options.size, options.view, options.look, options.detail);
  app.add_option("--depth", options.depth, "of the rays")->check(CLI::Range(1, 254))->capture_default_str();
  app.add_option("--bits", options.bits, "widths, with commas between")
      ->delimiter(',')
      ->check(CLI::Range(least, most))
      ->capture_default_str();
  app.add_flag("--quiet", options.quiet, "no progress");
}

void CommandLine::add_widths_commands() {
  CLI::App* boxes_app = app_.add_subcommand(
      "boxes", "what a scene's rays visit when boxes are tested in integers of few bits: nodes and triangles a ray");
  add_widths_command(*boxes_app, boxes_, kLeastBoxBits, kMostBoxBits);
  boxes_app->callback([this] { code_ = boxes_command(boxes_); });
  CLI::App* triangles_app = app_.add_subcommand(
      "triangles", "what triangle tests without double do to a scene's hits and picture, to seams and to hard cases");
  add_widths_command(*triangles_app, triangles_, kLeastTimeBits, kMostTimeBits);
  triangles_app->callback([this] { code_ = triangles_command(triangles_); });
}

void CommandLine::add_fit_command() {
  CLI::App* fit_app = app_.add_subcommand(
      "fit", "what a scene needs of a machine: leaves a configuration with only that, for the other commands");
  add_scene(*fit_app, fit_.scene, fit_.size, fit_.view, fit_.look, fit_.detail);
  add_config(*fit_app, fit_.config, fit_.set);
  add_units_and_depth(*fit_app, fit_.units, fit_.depth);
  fit_app->add_option("--traverser", fit_.traverser, "as --set chip.traverser=NAME");
  fit_app->add_option("--slower", fit_.slower, "cycles that the whole may take more, in percent")
      ->type_name("N%")
      ->capture_default_str();
  fit_app->add_option("--out", fit_.out,
                      "file for the configuration (default: out/fit/NAME.json beside the program; installed: in "
                      "raypool-out)");
  fit_app->add_option("--json", fit_.json, "file for all that was found, as JSON");
  fit_app->add_flag("--quiet", fit_.quiet, "no progress");
  fit_app->callback([this] { code_ = fit_command(fit_); });
}

void CommandLine::add_descriptions_command() {
  CLI::App* completion_app =
      app_.add_subcommand("completion", "print what completes raypool's commands and options in a shell");
  completion_app->add_option("shell", shell_, "whose")->type_name("bash|zsh|fish")->capture_default_str();
  completion_app->callback([this] { std::fputs(completion(app_, shell_).c_str(), stdout); });
  CLI::App* man_app = app_.add_subcommand("man", "print the man page: raypool man | man -l -");
  man_app->callback([this] { std::fputs(man_page(app_).c_str(), stdout); });
}

int CommandLine::run(int argc, char** argv) {
  try {
    app_.parse(argc, argv);
  } catch (const CLI::Success& success) {
    return app_.exit(success);
  } catch (const CLI::ParseError& error) {
    const std::string twice = given_twice(app_);
    std::fprintf(stderr, "raypool: %s (raypool --help shows what there is)\n",
                 twice.empty() ? error.what() : twice.c_str());
    return kInputFailure;
  }
  return code_;
}

/// What has been printed is a result too: lost, it is an error.
int close_output(int code) {
  const bool lost = std::ferror(stdout) != 0;
  int error = std::fflush(stdout) != 0 ? errno : 0;
  // Why a write before this one failed is forgotten: one more is asked for the reason.
  if (lost && error == 0) error = write(STDOUT_FILENO, "\n", 1) < 0 ? errno : EIO;
  // Network file systems tell of a full disk when the file is closed; one that was closed before is none.
  if (std::fclose(stdout) != 0 && error == 0 && errno != EBADF) error = errno;
  if (error == 0) return code;
  std::fprintf(stderr, "raypool: cannot write to standard output (%s): what was printed is not complete\n",
               std::strerror(error));
  return code == 0 ? kInputFailure : code;
}

/// Runs a command; what it throws becomes a sentence and an exit code.
int run_and_report(int argc, char** argv) {
  try {
    return CommandLine(argc, argv).run(argc, argv);
  } catch (const InputError& error) {
    std::fprintf(stderr, "raypool: %s\n", error.what());
    return kInputFailure;
  } catch (const LockstepDifference& difference) {
    if (difference.inspect_until != 0 && run_inspecting(argc, argv, difference)) return kDifference;
    std::fprintf(stderr, "raypool: %s\n", difference.what());
    return kDifference;
  } catch (const ChipStalled& stalled) {
    std::fprintf(stderr, "raypool: %s\n", stalled.what());
    return kOtherFailure;
  } catch (const Stopped& stopped) {
    std::fprintf(stderr, "raypool: %s\n", stopped.what());
    return kOtherFailure;
  } catch (const std::exception& error) {
    if (std::ferror(stdout) != 0) return kInputFailure;  // which close_output() says
    std::fprintf(stderr, "raypool: failed: %s\n", error.what());
    return kOtherFailure;
  }
}

}  // namespace
}  // namespace raypool

int main(int argc, char** argv) {
  raypool::handle_stop_signals();
  raypool::tell_unfinished([](const std::string& what) { std::fprintf(stderr, "raypool: %s\n", what.c_str()); });
  const int code = raypool::close_output(raypool::run_and_report(argc, argv));
  if (const int signal = raypool::stop_signal()) raypool::end_by(signal);
  return code;
}
