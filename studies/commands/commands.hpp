// What the commands of the studies do; study_commands.cpp parses the command line into these options. Each throws
// InputError on input that cannot be used and returns the exit code otherwise.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "cli/scene_loading.hpp"
#include "referee/contender.hpp"

namespace raypool {

/// `raypool numerics`
struct NumericsOptions {
  std::string config = "4w4c";  ///< the base, to which each mode's arithmetic is applied
  std::vector<std::string> set;
  std::string mode = "all";  ///< or one of numerics::arithmetic_modes()
  std::string shaders;       ///< the shader set whose frame is drawn in each mode; empty: three scenes by the kernels
  std::string option_of_shaders;  ///< an option that was given and is for `shaders` alone; empty: none
  std::string scene = "cornell";
  double detail = 1;
  std::string view;
  ViewWords look;
  int samples = 1;
  std::string size = "256x256";
  int depth = 3;
  std::string out;                ///< folder; empty: out/numerics beside the executable
  std::string synthesis;          ///< folder of synthesis reports; empty: synth beside the executable
  std::string configurations;     ///< folder: only write a configuration file for each mode
  std::string boundary = "unit";  ///< chip: the catalogue is drawn on whole chips in Verilog too
  bool extremes = false;          ///< the catalogue of hard cases instead of the trade
  bool catalogue = false;         ///< only its cases and what is expected
  bool quiet = false;             ///< no progress
};
int numerics_command(const NumericsOptions& options);

/// `raypool significands`
struct SignificandsOptions {
  std::string scene = "room";
  double detail = 1;
  std::string view;
  ViewWords look;
  std::string size = "256x256";
  int depth = 3;
  std::string config = "4w4c";  ///< what else the arithmetic is
  std::vector<std::string> set;
  bool quiet = false;  ///< no progress
};
int significands_command(const SignificandsOptions& options);

/// `raypool boxes` and `raypool triangles`
struct WidthsOptions {
  std::string scene = "room";
  double detail = 1;
  std::string view;
  ViewWords look;
  std::string size = kDefaultSize;
  uint32_t depth = 3;
  std::vector<uint32_t> bits;
  bool quiet = false;  ///< no progress
};
struct BoxesOptions : WidthsOptions {
  BoxesOptions() { bits = {16, 14, 12, 11, 10, 9, 8, 7, 6}; }
};
struct TrianglesOptions : WidthsOptions {
  TrianglesOptions() { bits = {53, 40, 32, 28, 26, 24}; }
};
/// Exit code 3 if a hit is another one.
int boxes_command(const BoxesOptions& options);
int triangles_command(const TrianglesOptions& options);

/// `raypool referee`
struct RefereeCommandOptions {
  uint64_t cases = 100'000;
  uint64_t seed = 1;
  std::string corpus;                ///< file; empty: cases are drawn
  std::string write;                 ///< file for the corpus, "-": standard output; empty: it is judged
  std::vector<std::string> answers;  ///< files
  std::string on_chip;               ///< engine that runs the whole chip to answer too; empty: none
  std::string config = "tiny";       ///< of that chip
  std::vector<std::string> set;
  bool smallest = false;  ///< the smallest case of each fault
  uint32_t threads = 0;   ///< 0: all cores
  bool quiet = false;     ///< no progress
};
void add_referee_options(CLI::App& app, RefereeCommandOptions& options);
/// `others`: contenders besides our own; may be empty.
int referee_command(const RefereeCommandOptions& options, const std::function<referee::Contenders()>& others = {});

/// `raypool fit`: the frame is that of `raypool sim`, with one sample of a pixel.
struct FitOptions {
  std::string scene = "room";
  double detail = 1;
  std::string view;
  ViewWords look;
  std::string size = kDefaultSize;
  int depth = 3;
  int units = 1;
  std::string config = "8w8c";  ///< what there is to be less of
  std::vector<std::string> set;
  std::string traverser;
  std::string shaders;        ///< the shader set that draws; empty: the built-in kernels
  std::string slower = "1%";  ///< cycles that the whole may take more
  std::string out;            ///< the configuration's file; empty: out/fit/<its name>.json beside the executable
  std::string json;           ///< file with what was found; empty: none
  bool quiet = false;         ///< no progress
  std::vector<std::string> command;
};
int fit_command(const FitOptions& options);

/// `raypool explore`
struct ExploreOptions {
  std::string scene = "room";
  double detail = 1;
  std::string view;
  ViewWords look;
  std::string size = "128x128";
  int depth = 3;
  std::string config = "best_8w8c";  ///< what the machines have where nothing varies
  std::vector<std::string> set;
  std::vector<std::string> vary;  ///< explore::set_axis()
  size_t machines = 10'000;       ///< at most
  uint64_t seed = 1;              ///< of their choice
  double deviations = 0.5;        ///< explore::search_front()
  size_t check = 0;               ///< machines at random that are simulated too
  std::string areas;              ///< file of an explore::AreaTable; empty: the project's
  std::string out;                ///< JSON file; empty: out/explore/explore.json beside the executable
  bool quiet = false;             ///< no progress
  std::vector<std::string> command;
};
int explore_command(const ExploreOptions& options);

}  // namespace raypool
