#include "tools/machine_commands.hpp"

#include <cstdio>

#include "cli/command_options.hpp"
#include "scene/native_renderer.hpp"
#include "tools/command_description.hpp"

namespace raypool {
MachineCommands::MachineCommands(CLI::App& app, const std::vector<std::string>& command,
                                 const sampled::Sampler& sampler, int& code)
    : app_(app), code_(code), drawing_(app, command, &sampler, code) {
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

CLI::App* MachineCommands::add(const std::string& name, const std::string& what) {
  return app_.add_subcommand(name, what)->group(kMachineGroup);
}

void MachineCommands::add_compare_command() {
  CLI::App* compare_app = add("compare", "two reports of sim: what differs in the set-up, and what that did");
  compare_app->add_option("a", compare_.a, "report.json, or the folder it is in")->required();
  compare_app->add_option("b", compare_.b, "another")->required();
  compare_app
      ->add_option(
          "--synthesis", compare_.synthesis,
          "report of make synth, or a folder of such folders, for the area (default: synth beside the program)")
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  compare_app
      ->add_option(
          "--map", compare_.map,
          "write a picture of the pixels that differ: red where a ray hits otherwise, blue where only a shadow "
          "falls otherwise, yellow where only the colour is rounded otherwise; of frames drawn with --precision")
      ->type_name("FILE.png");
  compare_app->add_flag("--json", compare_.json, "all of it as JSON");
  compare_app->callback([this] { code_ = compare_command(compare_); });
}

void MachineCommands::add_run_command() {
  CLI::App* run_app = add("run", "run a compute kernel on one compute unit");
  run_app->add_option("kernel", compute_.kernel, "saxpy, matmul, or the path of an assembly file")->required();
  add_config(*run_app, compute_.config, compute_.set);
  add_engine(*run_app, compute_.engine, compute_.unit_library);
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

void MachineCommands::add_cosim_command() {
  CLI::App* cosim_app = add("cosim", "random programs, with stalls on every port, in lockstep with the golden model");
  auto* config = cosim_app->add_option("--config", cosim_.config,
                                       "machine: a name in configs/, NwMc (N warps, M lanes) or a JSON file (default: "
                                       "the small ones that --machines prints, which share the programs)");
  add_set(*cosim_app, cosim_.set)->needs(config);
  add_engine(*cosim_app, cosim_.engine, cosim_.unit_library);
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

void MachineCommands::add_configurations_command() {
  CLI::App* configurations_app = add("configurations", "a set of machines with every pair of parameter values");
  configurations_app->add_flag("--all-pairs", configurations_.all_pairs, "large machines too (default: small ones)");
  configurations_app->add_option("--most", configurations_.most,
                                 "only the first so many of those that bring pairs of values");
  configurations_app->add_option("--out", configurations_.folder, "folder that gets a JSON file for each");
  configurations_app->callback([this] { code_ = configurations_command(configurations_); });
}

void MachineCommands::add_isa_command() {
  CLI::App* isa_app = add("isa", "print the instruction table (default: as Markdown)");
  auto* isa_formats = isa_app->add_option_group("format");
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
  CLI::App* asm_app = add("asm", "assemble: one hexadecimal 64-bit word a line");
  CLI::App* disasm_app = add("disasm", "disassemble what asm has written");
  for (CLI::App* sub : {asm_app, disasm_app}) {
    sub->add_option("file", text_path_, "input, - for standard input")->required();
    sub->add_option("--out,-o", text_out_, "output (default: standard output)");
  }
  asm_app->callback([this] { code_ = asm_command(text_path_, text_out_); });
  disasm_app->callback([this] { code_ = disasm_command(text_path_, text_out_); });
}

void MachineCommands::add_kernels_command() {
  CLI::App* kernels_app = add("kernels", "the ray kernels' instruction counts by ALU, or the listing of one kernel");
  kernels_app->add_option("name", kernel_, "kernel to list");
  add_config(*kernels_app, kernels_config_, kernels_set_);
  kernels_app->callback([this] { code_ = kernels_command(kernel_, kernels_config_, kernels_set_); });
}

void MachineCommands::add_errors_command() {
  CLI::App* errors_app = add("errors", "measure the errors of division and roots of every slow unit, in ulp");
  errors_app->add_option("--grid", grid_, "fdiv: GRID x GRID pairs of mantissas, 2 to 32768")
      ->check(CLI::Range(2u, 32768u))
      ->capture_default_str();
  errors_app->callback([this] { code_ = errors_command(grid_); });
}

void MachineCommands::add_scene_command() {
  CLI::App* scene_app = add("scene", "what a scene holds: triangles, materials, box, camera, light");
  CLI::App* hits_app = add("hits", "compare our traversal's hits on a frame with Embree's");
  for (CLI::App* sub : {scene_app, hits_app})
    add_scene(*sub, scene_.scene, scene_.size, scene_.view, scene_.look, scene_.detail);
  scene_app->add_option("--write-obj", scene_.write_obj, "write it as an OBJ, with its MTL beside it");
  scene_app->add_option(
      "--write-bvh", scene_.write_bvh,
      "write its tree as the traverser's memory holds it, a binary file that docs/use/tree-file.md describes");
  scene_app
      ->add_option("--cache", scene_.cache,
                   "show what is kept of scenes, so that a later run need not read and sort their triangles again, or "
                   "clear it; nothing else is done then")
      ->check(CLI::IsMember({"show", "clear"}));
  scene_app->callback([this] { code_ = scene_command(scene_); });
  hits_app->callback([this] { code_ = hits_command(scene_); });
}

void MachineCommands::add_bench_command() {
  CLI::App* bench_app =
      add("bench", "how fast our intersection is beside Embree's, on the eye, reflection and shadow rays of a frame");
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

void MachineCommands::add_descriptions_command() {
  CLI::App* completion_app = add("completion", "print what completes raypool's commands and options in a shell");
  completion_app->add_option("shell", shell_, "the shell to complete in")
      ->type_name("bash|zsh|fish")
      ->capture_default_str();
  completion_app->callback([this] { std::fputs(completion(app_, shell_).c_str(), stdout); });
  CLI::App* man_app = add("man", "print the man page: raypool man | man -l -");
  man_app->callback([this] { std::fputs(man_page(app_).c_str(), stdout); });
}

}  // namespace raypool
