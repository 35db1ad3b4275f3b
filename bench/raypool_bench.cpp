// `make bench`: how fast the engines run on this machine. Draws one fixed frame with each, best of three, and sets the Verilated
// unit's rate beside that of the best open GPU RTL at 4 warps x 4 lanes on this class of machine. Then the units alone: what
// the chip gave the unit in every cycle of that frame is recorded, and model and RTL are clocked through it in turn. Needs the
// Verilated units of 4w4c, 8w8c and 16w16c.
#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "cli/commands.hpp"
#include "cli/engine.hpp"
#include "port_recording.hpp"

namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

constexpr double kReferenceCycles = 90e3;               ///< a second, 4 warps x 4 lanes
constexpr double kReferenceThreadInstructions = 150e3;  ///< a second
constexpr double kReferenceModel = 0.42e6;              ///< thread instructions a second of its cycle model
constexpr int kRepetitions = 3;

raypool::SimOptions frame_options(const char* config, const char* engine, const fs::path& folder) {
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

Json draw(const char* config, const char* engine) {
  const fs::path folder = fs::temp_directory_path() / fmt::format("raypool_bench.{}", getpid());
  const raypool::SimOptions options = frame_options(config, engine, folder);
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

// The units alone on the frame's recorded ports.
void compare_units(const char* config) {
  using raypool::ComputeUnit;
  const fs::path folder = fs::temp_directory_path() / fmt::format("raypool_bench.{}", getpid());
  raypool::bench::PortRecording recording;
  raypool::SimOptions options = frame_options(config, "model", folder);
  options.wrap = [&recording](std::unique_ptr<ComputeUnit> device, const raypool::Memory& memory) {
    return raypool::bench::record_ports(std::move(device), memory, recording);
  };
  raypool::sim_command(options);
  fs::remove_all(folder);

  std::array<double, 2> best{};
  std::array<uint64_t, 2> instructions{};
  for (int i = 0; i < kRepetitions; ++i) {
    for (size_t engine = 0; engine < 2; ++engine) {
      const raypool::EngineOptions what{engine == 0 ? raypool::Engine::Rtl : raypool::Engine::Model,
                                        raypool::load_configuration(config), "", false, 1};
      const std::unique_ptr<ComputeUnit> unit = raypool::make_unit(what, recording.memory);
      const auto begin = std::chrono::steady_clock::now();
      raypool::bench::replay(*unit, recording);
      const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
      if (i == 0 || seconds < best[engine]) best[engine] = seconds;
      instructions[engine] = unit->counter(raypool::counter::kThreadInstructions);
    }
  }
  if (instructions[0] != instructions[1]) throw std::runtime_error("RTL and model executed different numbers of instructions");
  const auto cycles = static_cast<double>(recording.cycles), threads = static_cast<double>(instructions[0]);
  for (size_t engine = 0; engine < 2; ++engine) {
    fmt::print("{:<7} {:<11} {:>9.3f} {:>16} {:>18.1f} {:>30.1f}\n", config, engine == 0 ? "rtl" : "model", best[engine], "-",
               cycles / best[engine] / 1e3, threads / best[engine] / 1e3);
  }
  fmt::print(
      "{} model against rtl, the unit alone: {:.1f} times the cycles; model against the best open GPU's cycle model: {:.0f} "
      "times the thread instructions\n",
      config, best[0] / best[1], threads / best[1] / kReferenceModel);
}

}  // namespace

int main() {
  try {
    fmt::print("cornell, 128x128, depth 5, the whole chip; best of {}. native uses every core, the others one.\n", kRepetitions);
    fmt::print("config  engine        seconds  thousand rays/s  thousand cycles/s  thousand thread instructions/s\n");
    Json small;
    for (const char* config : {"4w4c", "8w8c"}) {
      for (const char* engine : {"rtl", "lockstep", "model", "functional", "native"}) {
        const Json report = draw(config, engine);
        print_row(config, engine, report);
        if (std::string(config) == "4w4c" && std::string(engine) == "rtl") small = report["simulated_per_second"];
      }
    }
    fmt::print("\nthe same frame, the unit alone on its recorded ports; best of {}, in turn\n", kRepetitions);
    for (const char* config : {"4w4c", "8w8c", "16w16c"}) compare_units(config);
    const double cycles = small["cycles"];
    const double thread_instructions = small["thread_instructions"];
    fmt::print("\nbest open GPU RTL, 4 warps x 4 lanes: {:.0f} thousand cycles/s, {:.0f} thousand thread instructions/s\n",
               kReferenceCycles / 1e3, kReferenceThreadInstructions / 1e3);
    fmt::print("raypool 4w4c rtl against it: {:.1f} times the cycles, {:.1f} times the thread instructions\n",
               cycles / kReferenceCycles, thread_instructions / kReferenceThreadInstructions);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "raypool_bench: %s\n", error.what());
    return 1;
  }
}
