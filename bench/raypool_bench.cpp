// `make bench`: how fast the engines run on this machine. Draws one fixed frame with each, best of three, and sets the Verilated
// unit's rate beside that of the best open GPU RTL at 4 warps x 4 lanes on this class of machine. Needs the Verilated units of
// 4w4c and 8w8c.
#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "cli/commands.hpp"

namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

constexpr double kReferenceCycles = 90e3;               ///< a second, 4 warps x 4 lanes
constexpr double kReferenceThreadInstructions = 150e3;  ///< a second
constexpr int kRepetitions = 3;

Json draw(const char* config, const char* engine) {
  const fs::path folder = fs::temp_directory_path() / fmt::format("raypool_bench.{}", getpid());
  raypool::SimOptions options;
  options.scene = "cornell";
  options.size = "128x128";
  options.depth = 5;
  options.config = config;
  options.engine = engine;
  options.out = folder;
  options.quiet = true;
  Json best;
  for (int i = 0; i < kRepetitions; ++i) {
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
  fmt::print("{:<7} {:<11} {:>9.3f} {:>16.1f}", config, engine, seconds, rays / seconds / 1e3);
  const double thread_instructions = report.value("thread_instructions", 0.0) / seconds;
  const double cycles = report["cycles"].is_null() ? 0 : report["cycles"].get<double>() / seconds;
  cycles > 0 ? fmt::print(" {:>18.1f}", cycles / 1e3) : fmt::print(" {:>18}", "-");
  thread_instructions > 0 ? fmt::print(" {:>30.1f}\n", thread_instructions / 1e3) : fmt::print(" {:>30}\n", "-");
  std::fflush(stdout);
}

}  // namespace

int main() {
  try {
    fmt::print("cornell, 128x128, depth 5, the whole chip; best of {}. native uses every core, the others one.\n", kRepetitions);
    fmt::print("config  engine        seconds  thousand rays/s  thousand cycles/s  thousand thread instructions/s\n");
    Json small;
    for (const char* config : {"4w4c", "8w8c"}) {
      for (const char* engine : {"rtl", "lockstep", "functional", "native"}) {
        const Json report = draw(config, engine);
        print_row(config, engine, report);
        if (std::string(config) == "4w4c" && std::string(engine) == "rtl") small = report["simulated_per_second"];
      }
    }
    const double cycles = small["cycles"];
    const double thread_instructions = small["thread_instructions"];
    fmt::print("best open GPU RTL, 4 warps x 4 lanes: {:.0f} thousand cycles/s, {:.0f} thousand thread instructions/s\n",
               kReferenceCycles / 1e3, kReferenceThreadInstructions / 1e3);
    fmt::print("raypool 4w4c rtl against it: {:.1f} times the cycles, {:.1f} times the thread instructions\n",
               cycles / kReferenceCycles, thread_instructions / kReferenceThreadInstructions);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "raypool_bench: %s\n", error.what());
    return 1;
  }
}
