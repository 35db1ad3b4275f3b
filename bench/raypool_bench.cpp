// `make bench`: how fast the engines run on this machine. Draws one fixed frame with each, best of three, and sets the
// Verilated unit's rate beside that of the best open GPU RTL at 4 warps x 4 lanes on this class of machine. Then the
// units alone: what the chip gave the unit in every cycle of that frame is recorded, and model and RTL are clocked
// through it in turn. Needs the Verilated units of 4w4c, 8w8c and 16w16c; --loops none.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "cli/commands.hpp"
#include "cli/engine.hpp"
#include "loops.hpp"
#include "port_recording.hpp"

namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

constexpr double kReferenceCycles = 90e3;               ///< a second, 4 warps x 4 lanes
constexpr double kReferenceThreadInstructions = 150e3;  ///< a second
constexpr double kReferenceModel = 0.42e6;              ///< thread instructions a second of its cycle model

struct BenchOptions {
  std::vector<std::string> configurations{"4w4c", "8w8c", "16w16c"};  ///< the units alone
  std::vector<std::string> engines{"rtl", "model"};                   ///< of the units alone
  int repetitions = 3;
};

raypool::SimOptions frame_options(const std::string& config, const char* engine, const fs::path& folder) {
  raypool::SimOptions options;
  options.scene = "cornell";
  options.size = "128x128";
  options.depth = 5;
  options.config = config;
  options.engine = engine;
  options.out = folder;
  options.quiet = true;
  return options;
}

/// `shaders`: the set that draws; empty: the built-in kernels.
Json draw(const BenchOptions& bench, const char* config, const char* engine, const std::string& shaders = "") {
  const fs::path folder = fs::temp_directory_path() / fmt::format("raypool_bench.{}", getpid());
  raypool::SimOptions options = frame_options(config, engine, folder);
  if (!shaders.empty()) options.shaders = shaders, options.samples = 4;
  Json best;
  for (int i = 0; i < bench.repetitions; ++i) {
    raypool::sim_command(options);
    const Json report = Json::parse(std::ifstream(folder / "report.json"));
    if (best.is_null() || report["simulation_seconds"] < best["simulation_seconds"]) best = report;
  }
  fs::remove_all(folder);
  return best;
}

void print_row(const char* config, const char* engine, const Json& report) {
  const double seconds = report["simulation_seconds"];
  const double rays = report["rays"];
  fmt::print("{:<7} {:<11} {:>9.3f} {:>9.1f}", config, engine, seconds, rays / seconds / 1e3);
  const double thread_instructions = report.value("thread_instructions", 0.0) / seconds;
  const double cycles = report["cycles"].is_null() ? 0 : report["cycles"].get<double>() / seconds;
  cycles > 0 ? fmt::print(" {:>10.1f}", cycles / 1e3) : fmt::print(" {:>10}", "-");
  thread_instructions > 0 ? fmt::print(" {:>30.1f}\n", thread_instructions / 1e3) : fmt::print(" {:>30}\n", "-");
  std::fflush(stdout);
}

// A unit alone on the frame's recorded ports, in each engine in turn.
void compare_units(const BenchOptions& bench, const std::string& config) {
  using raypool::ComputeUnit;
  const fs::path folder = fs::temp_directory_path() / fmt::format("raypool_bench.{}", getpid());
  raypool::bench::PortRecording recording;
  raypool::SimOptions options = frame_options(config, "model", folder);
  options.wrap = [&recording](std::unique_ptr<ComputeUnit> device, const raypool::Memory& memory) {
    return raypool::bench::record_ports(std::move(device), memory, recording);
  };
  raypool::sim_command(options);
  fs::remove_all(folder);

  std::vector<double> best(bench.engines.size(), std::numeric_limits<double>::infinity());
  std::set<uint64_t> instructions;
  for (int i = 0; i < bench.repetitions; ++i) {
    for (size_t engine = 0; engine < bench.engines.size(); ++engine) {
      const raypool::EngineOptions what{
          raypool::parse_engine(bench.engines[engine]), raypool::load_configuration(config), "", false, 1, 0};
      const std::unique_ptr<ComputeUnit> unit = raypool::make_unit(what, recording.memory);
      const auto begin = std::chrono::steady_clock::now();
      raypool::bench::replay(*unit, recording);
      best[engine] =
          std::min(best[engine], std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
      instructions.insert(unit->counter(raypool::counter::kThreadInstructions));
    }
  }
  if (instructions.size() != 1) throw std::runtime_error("the engines executed different numbers of instructions");
  const auto cycles = static_cast<double>(recording.cycles), threads = static_cast<double>(*instructions.begin());
  const auto at = [&](const std::string& engine) {
    const auto place = std::find(bench.engines.begin(), bench.engines.end(), engine);
    return place == bench.engines.end() ? 0.0 : best[place - bench.engines.begin()];
  };
  for (size_t engine = 0; engine < bench.engines.size(); ++engine)
    fmt::print("{:<7} {:<11} {:>9.3f} {:>9} {:>10.1f} {:>30.1f}\n", config, bench.engines[engine], best[engine], "-",
               cycles / best[engine] / 1e3, threads / best[engine] / 1e3);
  if (at("rtl") > 0 && at("model") > 0)
    fmt::print(
        "{} model against rtl, the unit alone: {:.1f} times the cycles; model against the best open GPU's cycle model: "
        "{:.0f} "
        "times the thread instructions\n",
        config, at("rtl") / at("model"), threads / at("model") / kReferenceModel);
}

void compare_engines(const BenchOptions& bench) {
  fmt::print("cornell, 128x128, depth 5, the whole chip; best of {}. native uses every core, the others one.\n",
             bench.repetitions);
  fmt::print("The last three are shader sets, with four samples a pixel.\n");
  fmt::print("config  engine        seconds   krays/s  kcycles/s  thousand thread instructions/s\n");
  Json small;
  for (const char* config : {"4w4c", "8w8c"}) {
    for (const char* engine : {"rtl", "lockstep", "model", "functional", "native"}) {
      const Json report = draw(bench, config, engine);
      print_row(config, engine, report);
      if (std::string(config) == "4w4c" && std::string(engine) == "rtl") small = report["simulated_per_second"];
    }
  }
  const double cycles = small["cycles"];
  const double thread_instructions = small["thread_instructions"];
  for (const char* set : {"whitted", "preview", "path"}) print_row(set, "native", draw(bench, "8w8c", "native", set));
  fmt::print("best open GPU RTL, 4 warps x 4 lanes: {:.0f} kcycles/s, {:.0f} thousand thread instructions/s\n",
             kReferenceCycles / 1e3, kReferenceThreadInstructions / 1e3);
  fmt::print("raypool 4w4c rtl against it: {:.1f} times the cycles, {:.1f} times the thread instructions\n\n",
             cycles / kReferenceCycles, thread_instructions / kReferenceThreadInstructions);
}

}  // namespace

int main(int argc, char** argv) {
  BenchOptions bench;
  bool alone = false, loops = false;
  CLI::App app("How fast the engines run on this machine.");
  app.add_flag("--alone", alone, "only the units alone, without the chip");
  app.add_flag("--loops", loops, "only a frame on the model of the chip, in the bare loop and in SystemC");
  app.add_option("--config", bench.configurations, "of the units alone, or of --loops")->capture_default_str();
  app.add_option("--engine", bench.engines, "of the units alone: rtl, model, lockstep")->capture_default_str();
  app.add_option("--repetitions", bench.repetitions, "of which the best counts; of --loops the median")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  CLI11_PARSE(app, argc, argv);
  try {
    if (loops) {
      for (const std::string& config : bench.configurations) raypool::bench::compare_loops(config, bench.repetitions);
      return 0;
    }
    if (!alone) compare_engines(bench);
    fmt::print("the same frame, the unit alone on its recorded ports; best of {}, in turn\n", bench.repetitions);
    for (const std::string& config : bench.configurations) compare_units(bench, config);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "raypool_bench: %s\n", error.what());
    return 1;
  }
}
