// What the other commands of the machine do; machine_commands.cpp parses the command line into these options. Each
// throws InputError on input that cannot be used and returns the exit code otherwise.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cli/scene_loading.hpp"

namespace raypool {

/// `raypool compare`
struct CompareOptions {
  std::string a, b;                    ///< reports of raypool sim, or their folders
  std::vector<std::string> synthesis;  ///< reports of synthesis, or folders of them; empty: synth beside the program
  std::string map;                     ///< picture of the pixels that differ, by cause; empty: none
  bool json = false;
};
int compare_command(const CompareOptions& options);

/// `raypool run`
struct RunOptions {
  std::string kernel;  ///< saxpy, matmul or path of an assembly file
  std::string config = "8w8c";
  std::vector<std::string> set;  ///< fields of the configuration to change, "warps=4"
  std::string engine = "model";
  std::string unit_library;
  std::optional<uint32_t> n;  ///< problem size of saxpy and matmul; none: theirs
  uint32_t blocks = 1;        ///< assembly file only, like all below
  uint32_t threads = 0;       ///< a block; 0: as many as the unit holds
  uint32_t memory_bytes = 65536;
  std::vector<std::string> arguments;   ///< integers, 0x..., or floats (with a point or exponent)
  std::vector<std::string> print;       ///< ADDRESS:COUNT words of memory to print afterwards
  std::string waves;                    ///< path of a waveform, empty: none
  uint64_t inspect_until = 0;           ///< as of SimOptions
  std::optional<uint64_t> cycle_limit;  ///< of engine functional, which has no cycles: warp instructions
  bool quiet = false;                   ///< no progress
};
int run_command(const RunOptions& options);

/// `raypool isa`
enum class IsaFormat { Verilog, VerilogFunctions, Markdown };
int isa_command(IsaFormat format);
/// `raypool isa --write`: every file that is derived from the table, in the checkout that
/// the working directory is the root of.
int isa_write_command();

/// `raypool asm FILE`: hexadecimal words, one an instruction. `raypool disasm FILE`: back to text.
int asm_command(const std::string& path, const std::string& out);
int disasm_command(const std::string& path, const std::string& out);

/// `raypool kernels [NAME]`: counts by ALU, or the listing of one kernel, as compiled for a configuration.
int kernels_command(const std::string& name, const std::string& config, const std::vector<std::string>& set);

/// `raypool errors`: measured errors of the slow unit. Exit code 3 if one breaks its promise.
int errors_command(uint32_t grid);

/// `raypool scene` and `raypool hits`
struct SceneCommandOptions {
  std::string scene = "room";
  std::string view;
  ViewWords look;
  std::string size = kDefaultSize;
  double detail = 1;      ///< of a built-in scene, 0.01 .. 16
  std::string write_obj;  ///< path, empty: none
  std::string write_bvh;  ///< path of a TreeFile (scene/tree_file.hpp), empty: none
  std::string cache;      ///< "show" or "clear" what is kept of scenes, and nothing else; empty: neither
};
int scene_command(const SceneCommandOptions& options);
int hits_command(const SceneCommandOptions& options);

/// `raypool bench`
struct BenchCommandOptions {
  std::string scene = "room";
  std::string view;
  ViewWords look;
  std::string size = kDefaultSize;
  double detail = 1;  ///< of a built-in scene, 0.01 .. 16
  uint32_t depth = 3;
  uint32_t threads = 0;  ///< beside one; 0: as many as the machine has cores
  uint32_t repetitions = 7;
  bool processor_time = false;  ///< in place of the time on the wall
  bool json = false;            ///< on standard output, in place of the table
  bool quiet = false;           ///< no progress
};
int bench_command(const BenchCommandOptions& options);

/// `raypool cosim`: random programs, each with its own seed: seed, seed + 1, ...
struct CosimOptions {
  std::string config;            ///< empty: the machines of cosim_machines(), which share the programs
  std::vector<std::string> set;  ///< fields of the configuration to change, "warps=4"
  std::string engine = "lockstep";
  std::string unit_library;
  int units = 1;  ///< compute units of the device
  uint64_t programs = 100;
  uint64_t seed = 1;
  int length = 120;  ///< about how many instructions a program's body has
  std::string mix;   ///< of instructions; empty: each seed chooses one
  bool quiet = false;
  bool minimise = true;                 ///< a program that fails is made short and saved
  std::string save = "tb/regressions";  ///< folder for it
  std::string coverage;                 ///< JSON file with what was covered, empty: none
  std::string vectors;                  ///< file for another simulator to replay, empty: none
  std::string replay;                   ///< a saved program, instead of random ones
  bool show_configuration = false;      ///< of the saved program, instead of running it
  bool unchecked = false;               ///< the saved program may break the rules of random programs
  bool machines = false;                ///< print the machines of an empty `config`, instead of running them
};
int cosim_command(const CosimOptions& options);

/// `raypool configurations`: a set of machines with every pair of parameter values.
struct ConfigurationsOptions {
  bool all_pairs = false;  ///< large machines too; else of at most kSmallThreads
  size_t most = 0;         ///< only so many of those that bring pairs of values; 0: all
  std::string folder;      ///< gets a JSON file for each and their list; empty: only the table is printed
};
int configurations_command(const ConfigurationsOptions& options);

}  // namespace raypool
