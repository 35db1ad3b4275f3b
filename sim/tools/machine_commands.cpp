#include "tools/machine_commands.hpp"

#include <cstdio>

#include "cli/command_options.hpp"
#include "cli/help.hpp"
#include "scene/native_renderer.hpp"
#include "tools/command_description.hpp"

namespace raypool {

using command_group::kConvert;
using command_group::kSimulate;
using command_group::kVerify;

MachineCommands::MachineCommands(CLI::App& app, const std::vector<std::string>& command,
                                 const EstimatingEngines& estimating, int& code)
    : app_(app), code_(code), drawing_(app, command, &estimating, code) {
  add_compare_command();
  add_run_command();
  add_cosim_command();
  add_configurations_command();
  add_isa_command();
  add_assembly_command();
  add_kernels_command();
  add_errors_command();
  add_scene_command();
  add_bench_command();
  add_descriptions_command();
}

CLI::App* MachineCommands::add(const char* group, const std::string& name, const std::string& what) {
  return app_.add_subcommand(name, what)->group(group);
}

void MachineCommands::add_compare_command() {
  CLI::App* compare_app =
      add(kSimulate, "compare", "compare two reports of sim: what differs in the set-up, and its effect");
  compare_app->add_option("a", compare_.a, "report.json of a run, or the folder it is in")->required();
  compare_app->add_option("b", compare_.b, "report.json of the other run, or the folder it is in")->required();
  compare_app
      ->add_option("--synthesis", compare_.synthesis,
                   "for the area: report of make synth, or a folder of them (default: synth beside the program)")
      ->type_name("PLACE")
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  compare_app
      ->add_option(
          "--map", compare_.map,
          "picture of the pixels that differ, of frames drawn with --precision; red: another hit, blue: only the "
          "shadow, yellow: only the rounding of the colour")
      ->type_name("FILE.png");
  compare_app->add_flag("--json", compare_.json, "print all of it as JSON");
  compare_app->callback([this] { code_ = compare_command(compare_); });
}

void MachineCommands::add_run_command() {
  CLI::App* run_app = add(kSimulate, "run", "run a compute kernel on one compute unit");
  run_app->add_option("kernel", compute_.kernel, "saxpy, matmul, or an assembly file")->required();
  add_config(*run_app, compute_.config, compute_.set);
  add_engine(*run_app, compute_.engine, compute_.unit_library, kEnginesOfPrograms);
  run_app
      ->add_option("--cycles", compute_.cycle_limit,
                   "stop after this many cycles; functional: warp instructions (default: 100000000, and after 10000000 "
                   "without a transfer)")
      ->group(option_group::kEngine)
      ->check(CLI::PositiveNumber);
  add_inspect(*run_app, compute_.inspect_until);
  run_app->add_option("--n", compute_.n, "saxpy: elements; matmul: rows of a square matrix")->group("saxpy and matmul");
  const auto of_file = [run_app](const char* name, auto& value, const char* what) {
    return run_app->add_option(name, value, what)->group("Assembly file");
  };
  of_file("--blocks", compute_.blocks, "blocks to launch")->capture_default_str();
  of_file("--threads", compute_.threads, "threads per block (default: warps x lanes)");
  of_file("--arg", compute_.arguments, "next kernel argument; integer, 0x..., or float (with a point)")
      ->type_name("WORD")
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  of_file("--memory", compute_.memory_bytes, "bytes of memory, program first")->capture_default_str();
  of_file("--print", compute_.print, "memory to print at the end, ADDRESS:WORDS")
      ->type_name("RANGE")
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  run_app->add_option("--waves", compute_.waves, "rtl, lockstep: write a waveform (FST)")
      ->type_name("FILE")
      ->group(option_group::kOutput);
  run_app->add_flag("--quiet", compute_.quiet, "no progress")->group(option_group::kOutput);
  run_app->callback([this] { code_ = run_command(compute_); });
}

void MachineCommands::add_cosim_command() {
  CLI::App* cosim_app =
      add(kVerify, "cosim", "run random programs in lockstep with the golden model, with stalls on every port");
  auto* config = cosim_app
                     ->add_option("--config", cosim_.config,
                                  "a name in configs/, NwMc or a JSON file (default: small machines that share the "
                                  "programs; --machines prints them)")
                     ->type_name("NAME")
                     ->group(option_group::kMachine);
  add_set(*cosim_app, cosim_.set)->needs(config);
  cosim_app->add_option("--units", cosim_.units, "compute units: 1, 2 or 4")
      ->group(option_group::kMachine)
      ->needs(config)
      ->check(CLI::IsMember({1, 2, 4}))
      ->capture_default_str();
  add_engine(*cosim_app, cosim_.engine, cosim_.unit_library, kEnginesOfPrograms);
  const auto programs = [cosim_app](const char* name, auto& value, const char* what) {
    return cosim_app->add_option(name, value, what)->group("Programs");
  };
  programs("--programs", cosim_.programs, "how many")->capture_default_str();
  programs("--seed", cosim_.seed, "of the first; each next one has the next seed")->capture_default_str();
  programs("--length", cosim_.length, "about how many instructions each has, 1 to 2000")
      ->check(CLI::Range(1, 2000))
      ->capture_default_str();
  programs("--mix", cosim_.mix, "one mix of instructions for all: mixed, memory, ..., operands")->type_name("NAME");
  CLI::Option* replay =
      programs("--replay", cosim_.replay, "run a saved program instead of random ones")->type_name("FILE");
  cosim_app->add_flag("--unchecked", cosim_.unchecked, "run the saved program even if it breaks the rules")
      ->group("Programs")
      ->needs(replay);
  cosim_app->add_flag("!--no-minimise", cosim_.minimise, "leave a program that fails as it is")->group("Programs");
  add_cosim_output(*cosim_app, replay);
  cosim_app->callback([this] { code_ = cosim_command(cosim_); });
}

void MachineCommands::add_cosim_output(CLI::App& cosim_app, CLI::Option* replay) {
  const auto file = [&cosim_app](const char* name, auto& value, const char* type, const char* what) {
    return cosim_app.add_option(name, value, what)->type_name(type)->group(option_group::kOutput);
  };
  file("--save", cosim_.save, "FOLDER", "for the minimised program")->capture_default_str();
  file("--coverage", cosim_.coverage, "FILE", "what was covered, JSON");
  file("--vectors", cosim_.vectors, "FILE", "record every cycle, for tb/icarus");
  cosim_app.add_flag("--machines", cosim_.machines, "print the machines of a run without --config: file and units")
      ->group(option_group::kOutput);
  cosim_app.add_flag("--show-config", cosim_.show_configuration, "print the configuration of the saved program")
      ->group(option_group::kOutput)
      ->needs(replay);
  cosim_app.add_flag("--quiet", cosim_.quiet, "no progress")->group(option_group::kOutput);
}

void MachineCommands::add_configurations_command() {
  CLI::App* configurations_app =
      add(kVerify, "configurations", "list machines that cover every pair of parameter values");
  configurations_app->add_flag("--all-pairs", configurations_.all_pairs, "large machines too (default: small ones)");
  configurations_app->add_option("--most", configurations_.most,
                                 "only the first N of those that bring pairs of values");
  configurations_app->add_option("--out", configurations_.folder, "write a JSON file of each")->type_name("FOLDER");
  configurations_app->callback([this] { code_ = configurations_command(configurations_); });
}

void MachineCommands::add_isa_command() {
  CLI::App* isa_app = add(command_group::kMachine, "isa", "print the instruction table (default: as Markdown)");
  auto* isa_formats = isa_app->add_option_group("Format (at most one)");
  isa_formats->add_flag("--markdown", markdown_, "docs/machine/isa.md");
  isa_formats->add_flag("--verilog", verilog_, "rtl/include/rp_isa.vh: constants");
  isa_formats->add_flag("--verilog-functions", functions_, "rtl/include/rp_isa_functions.vh: decoding");
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

void MachineCommands::add_assembly_command() {
  CLI::App* asm_app = add(kConvert, "asm", "assemble: one hexadecimal 64-bit word a line");
  CLI::App* disasm_app = add(kConvert, "disasm", "disassemble what asm has written");
  for (CLI::App* sub : {asm_app, disasm_app}) {
    sub->add_option("file", text_path_, "input, - for standard input")->required();
    sub->add_option("--out,-o", text_out_, "output (default: standard output)")->type_name("FILE");
  }
  asm_app->callback([this] { code_ = asm_command(text_path_, text_out_); });
  disasm_app->callback([this] { code_ = disasm_command(text_path_, text_out_); });
}

void MachineCommands::add_kernels_command() {
  CLI::App* kernels_app =
      add(kConvert, "kernels", "print the ray kernels' instruction counts by ALU, or list one kernel");
  kernels_app->add_option("name", kernel_, "kernel to list");
  add_config(*kernels_app, kernels_config_, kernels_set_);
  kernels_app->callback([this] { code_ = kernels_command(kernel_, kernels_config_, kernels_set_); });
}

void MachineCommands::add_errors_command() {
  CLI::App* errors_app = add(kVerify, "errors", "measure the errors of division and roots of every slow unit, in ulp");
  errors_app->add_option("--grid", grid_, "fdiv: GRID x GRID pairs of mantissas, 2 to 32768")
      ->check(CLI::Range(2u, 32768u))
      ->capture_default_str();
  errors_app->callback([this] { code_ = errors_command(grid_); });
}

void MachineCommands::add_scene_command() {
  CLI::App* scene_app = add(kConvert, "scene", "print what a scene holds; write it as an OBJ, or its tree");
  CLI::App* hits_app = add(kVerify, "hits", "compare our traversal's hits on a frame with Embree's");
  for (CLI::App* sub : {scene_app, hits_app})
    add_scene(*sub, scene_.scene, scene_.size, scene_.view, scene_.look, scene_.detail);
  scene_app->add_option("--write-obj", scene_.write_obj, "write it as an OBJ, with its MTL beside it")
      ->type_name("FILE")
      ->group(option_group::kOutput);
  scene_app
      ->add_option("--write-bvh", scene_.write_bvh,
                   "write its tree as the traverser's memory holds it, in binary (docs/use/tree-file.md)")
      ->type_name("FILE")
      ->group(option_group::kOutput);
  scene_app
      ->add_option("--cache", scene_.cache, "show or clear the cache of scenes and their trees, and do nothing else")
      ->type_name("show|clear");
  scene_app->callback([this] { code_ = scene_command(scene_); });
  hits_app->callback([this] { code_ = hits_command(scene_); });
}

void MachineCommands::add_bench_command() {
  CLI::App* bench_app = add(kSimulate, "bench", "measure our intersection beside Embree's on the rays of a frame");
  add_scene(*bench_app, bench_.scene, bench_.size, bench_.view, bench_.look, bench_.detail);
  bench_app->add_option("--depth", bench_.depth, "of the frame's rays")
      ->group(option_group::kScene)
      ->check(CLI::Range(1, kLargestDepth))
      ->capture_default_str();
  add_threads(*bench_app, bench_.threads, "threads of the second half of the table");
  bench_app->add_option("--repetitions", bench_.repetitions, "turns, each of both sides")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  bench_app->add_flag("--processor-time", bench_.processor_time,
                      "count the threads' processor time, not wall time: for a computer that does other things too");
  bench_app->add_flag("--json", bench_.json, "print the figures as JSON, and nothing else, on standard output");
  bench_app->add_flag("--quiet", bench_.quiet, "no progress");
  bench_app->callback([this] { code_ = bench_command(bench_); });
}

void MachineCommands::add_descriptions_command() {
  CLI::App* completion_app = add(command_group::kShell, "completion", "print the completion of commands and options");
  completion_app->add_option("shell", shell_, "which shell")->type_name("bash|zsh|fish")->capture_default_str();
  completion_app->callback([this] { std::fputs(completion(app_, shell_).c_str(), stdout); });
  CLI::App* man_app = add(command_group::kShell, "man", "print the man page: raypool man | man -l -");
  man_app->callback([this] { std::fputs(man_page(app_).c_str(), stdout); });
}

}  // namespace raypool
