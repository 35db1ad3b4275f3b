// `raypool numerics`: what each arithmetic mode does to pictures and costs; the catalogue of extremes.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <set>

#include "cli/engine.hpp"
#include "cli/exit_code.hpp"
#include "cli/folders.hpp"
#include "cli/image_size.hpp"
#include "cli/output_folder.hpp"
#include "cli/progress.hpp"
#include "commands/commands.hpp"
#include "commands/shader_modes.hpp"
#include "isa/did_you_mean.hpp"
#include "numerics/cost.hpp"
#include "numerics/extreme_parts.hpp"
#include "numerics/extremes.hpp"
#include "numerics/trade_report.hpp"

namespace raypool {
namespace {

namespace fs = std::filesystem;
using namespace numerics;

constexpr const char* kChip = "chip";
constexpr uint64_t kSeamRays = 1'000'000;

std::vector<ArithmeticMode> chosen_modes(const std::string& name) {
  if (name == "all") return arithmetic_modes();
  std::vector<std::string> names = {"all"};
  for (const ArithmeticMode& mode : arithmetic_modes()) {
    if (mode.name == name) return {mode};
    names.push_back(mode.name);
  }
  throw InputError(fmt::format("there is no arithmetic mode '{}'{}", name,
                               did_you_mean(name, names, fmt::format("use {}", fmt::join(names, ", ")))));
}

UnitMaker unit_maker(Engine engine) {
  return [engine](const Configuration& configuration, Memory& memory) {
    EngineOptions options;
    options.engine = engine;
    options.configuration = configuration;
    options.inspect_until = kInspectAlways;
    return make_unit(options, memory);
  };
}

/// Whether the Verilated unit of a configuration has been built.
bool has_rtl(const Configuration& configuration) { return fs::exists(unit_library_path(configuration, false)); }

bool has_chips(const ExtremeMachine& machine) {
  const std::vector<Configuration> chips = machine.chips();
  return std::all_of(chips.begin(), chips.end(),
                     [](const Configuration& chip) { return fs::exists(chip_library_path(chip, false)); });
}

bool on_chips(const NumericsOptions& options) { return parse_boundary(options.boundary) == Boundary::Chip; }

struct NamedScene {
  std::string title;
  Scene scene;
};

std::vector<NamedScene> trade_scenes() {
  std::vector<NamedScene> scenes;
  scenes.push_back({"cornell", make_cornell()});
  scenes.push_back({"room at detail 0.1", make_room(0.1)});
  scenes.push_back({"cornell moved by 1 km", moved(make_cornell(), 1, {1000, 700, -900})});
  return scenes;
}

TradeResult measure_trade(const NumericsOptions& options, const ImageSize& size, Progress& progress) {
  const Configuration base = load_configuration(options.config, options.set);
  const std::vector<ArithmeticMode> modes = chosen_modes(options.mode);
  TradeResult result;
  result.configuration = base.name;
  for (NamedScene& named : trade_scenes()) {
    progress.show(fmt::format("  {}: the reference picture", named.title));
    TradeScene scene(named.title, std::move(named.scene), size.width, size.height, options.depth);
    scene.draw_reference([&](double share) {
      if (progress.due()) progress.show(fmt::format("  {}: the reference picture, {:.0f}%", named.title, 100 * share));
    });
    for (const ArithmeticMode& mode : modes) {
      if (progress.due()) progress.show(fmt::format("  {}: {}", named.title, mode.name));
      result.rows.push_back({named.title, mode, judge_frame(scene, record_frame(scene, mode.mode))});
    }
  }
  const Scene timed = make_cornell();
  for (const ArithmeticMode& mode : modes) {
    const Configuration configuration = mode.applied_to(base);
    TradeCost cost{
        mode, std::nullopt,
        read_gates(options.synthesis.empty() ? results_folder().parent_path() / "synth" : fs::path(options.synthesis),
                   mode.mode)};
    if (progress.due()) progress.show(fmt::format("  cost: {}", mode.name));
    cost.timing = time_mode(timed, options.depth, configuration, unit_maker(Engine::Model));
    result.costs.push_back(cost);
  }
  return result;
}

int trade_command(const NumericsOptions& options) {
  const ImageSize size = parse_image_size(options.size);
  OutputFolder out(options.out.empty() ? results_folder() / "numerics" : fs::path(options.out));
  Progress progress(options.quiet);
  const TradeResult trade = measure_trade(options, size, progress);

  const std::vector<WatertightMesh> meshes = watertight_meshes();
  std::vector<WatertightCounts> seams;
  for (const WatertightMesh& mesh : meshes) {
    if (progress.due()) progress.show(fmt::format("  rays at seams: {}", mesh.name));
    seams.push_back(aim_at_seams(mesh, kSeamRays / meshes.size()));
  }

  const std::vector<OffsetScene> scenes = offset_scenes();
  const std::vector<OffsetRule> rules = offset_rules();
  std::vector<std::vector<OffsetCounts>> offsets;
  for (const OffsetScene& scene : scenes) {
    if (progress.due()) progress.show(fmt::format("  offsets: {}", scene.name));
    offsets.push_back(study_offsets(scene.scene, rules, std::clamp(size.width, 16, 256)));
  }

  out.write("numerics.json", to_json(trade, meshes, seams, scenes, rules, offsets));
  const bool gates_known =
      std::all_of(trade.costs.begin(), trade.costs.end(), [](const TradeCost& c) { return c.gates; });
  out.publish();

  fmt::print("{}\nrays aimed at shared edges and vertices\n{}\n", trade_table(trade), seam_table(meshes, seams));
  fmt::print("offset of secondary rays, against the reference, ties apart\n{}\n", offset_table(scenes, rules, offsets));
  if (!gates_known)
    fmt::print("no gates where there is a -: make numerics GATES=1 synthesises the lanes of every mode first\n");
  fmt::print("results in {}: numerics.json\n", fs::proximate(out.path(".")).lexically_normal().string());
  const bool leak =
      std::any_of(seams.begin(), seams.end(), [](const WatertightCounts& counts) { return counts.leaks > 0; });
  return leak ? kOtherFailure : kDone;
}

/// What the letters mean, and the columns: a number each, as names are too wide.
void print_letters(const std::vector<ArithmeticMode>& modes, const std::vector<std::string>& engines) {
  fmt::print(
      "n engine native, f functional, m model, l RTL in lockstep with the model, {}X failed, b breaks with so few "
      "bits, "
      "- not Verilated\n",
      engines.back() == kChip ? "c the whole chip in lockstep, " : "");
  for (size_t i = 0; i < modes.size(); ++i) fmt::print("{}{} {}", i == 0 ? "modes " : ", ", i + 1, modes[i].name);
  fmt::print("\n{:<58}", "");
  for (size_t i = 0; i < modes.size(); ++i) fmt::print(" {:>{}}", i + 1, engines.size());
  fmt::print("\n");
}

/// Those that there are; `missing`: modes of which something is not Verilated.
std::vector<ExtremeMachine> machines_of(const NumericsOptions& options, const std::vector<ArithmeticMode>& modes,
                                        const Configuration& base, std::set<std::string>& missing) {
  std::vector<ExtremeMachine> machines;
  for (const ArithmeticMode& mode : modes) {
    machines.emplace_back("native", mode, base);
    machines.emplace_back("functional", mode, base, unit_maker(Engine::Functional));
    machines.emplace_back("model", mode, base, unit_maker(Engine::Model));
    if (has_rtl(mode.applied_to(base))) {
      machines.emplace_back("lockstep", mode, base, unit_maker(Engine::Lockstep));
    } else {
      missing.insert(mode.name);
    }
    if (!on_chips(options)) continue;
    machines.emplace_back(kChip, mode, base, chip_maker(Engine::Lockstep));
    if (has_chips(machines.back())) continue;
    machines.pop_back();
    missing.insert(mode.name);
  }
  return machines;
}

/// One letter an engine: its own passed, X failed, - not run.
int extremes_command(const NumericsOptions& options) {
  const Configuration base = load_configuration(options.config, options.set);
  const std::vector<ArithmeticMode> modes = chosen_modes(options.mode);
  std::set<std::string> missing;
  const std::vector<ExtremeMachine> machines = machines_of(options, modes, base, missing);
  Progress progress(options.quiet);
  std::string failures;
  uint64_t checks = 0, failed = 0, broken = 0, on_rtl = 0;
  std::vector<std::string> engines = {"native", "functional", "model", "lockstep"};
  if (on_chips(options)) engines.push_back(kChip);
  print_letters(modes, engines);
  std::string theme;
  for (const ExtremeCase& extreme : extreme_cases()) {
    if (extreme.theme != theme) {
      theme = extreme.theme;
      fmt::print("{}\n", theme);
    }
    std::map<std::pair<std::string, std::string>, char> letters;  // [mode, engine]
    for (const ExtremeMachine& machine : machines) {
      if (progress.due())
        progress.show(fmt::format("  {}: {}, {}", extreme.name, machine.mode().name, machine.engine()));
      const auto [holds, failure] = run_extreme(extreme, machine);
      ++checks;
      on_rtl += machine.engine() == "lockstep" || machine.engine() == kChip;
      failed += !failure.empty();
      broken += !holds && failure.empty();
      letters[{machine.mode().name, machine.engine()}] = holds ? machine.engine()[0] : failure.empty() ? 'b' : 'X';
      if (!failure.empty()) {
        failures += fmt::format("FAILED: {}: {} ({}), {}, {}: {}\n", extreme.theme, extreme.name, extreme.expected,
                                machine.mode().name, machine.engine(), failure);
      }
    }
    fmt::print("  {:<56}", extreme.name);
    for (const ArithmeticMode& mode : modes) {
      std::string cell;
      for (const std::string& engine : engines) {
        const auto found = letters.find({mode.name, engine});
        cell += found == letters.end() ? '-' : found->second;
      }
      fmt::print(" {}", cell);
    }
    fmt::print("\n");
    std::fflush(stdout);
  }
  fmt::print("{}{} cases, {} runs ({} on RTL in lockstep), {} break with few bits, {} failed\n", failures,
             extreme_cases().size(), checks, on_rtl, broken, failed);
  if (!missing.empty()) {
    fmt::print("without hardware: {} of {} modes; make extremes builds their units\n", missing.size(), modes.size());
  }
  return failed == 0 ? kDone : kOtherFailure;
}

/// Every case of the catalogue and its expected behaviour.
int list_extremes() {
  std::string theme;
  for (const ExtremeCase& extreme : extreme_cases()) {
    if (extreme.theme != theme) fmt::print("{}\n", theme = extreme.theme);
    fmt::print("  {:<56} {}\n", extreme.name, extreme.expected);
  }
  fmt::print("{} cases\n", extreme_cases().size());
  return 0;
}

/// A configuration file for each mode, named after it; of whole chips two.
int write_configurations(const NumericsOptions& options) {
  const Configuration base = load_configuration(options.config, options.set);
  OutputFolder folder(options.configurations);
  std::string names;
  for (const ArithmeticMode& mode : chosen_modes(options.mode)) {
    const Configuration unit = mode.applied_to(base);
    const ExtremeMachine chip(kChip, mode, base, chip_maker(Engine::Lockstep));
    for (Configuration configuration : on_chips(options) ? chip.chips() : std::vector{unit}) {
      if (on_chips(options) && !has_traverser(configuration.chip)) configuration.name += "_ports";
      const std::string name = configuration.name + ".json";
      folder.write(name, to_json(configuration) + "\n");
      names += folder.path(name).string() + "\n";
    }
  }
  folder.publish();
  fmt::print("{}", names);
  return 0;
}

}  // namespace

int numerics_command(const NumericsOptions& options) {
  if (options.shaders.empty() && !options.option_of_shaders.empty()) {
    throw InputError(
        fmt::format("numerics draws scenes of its own with the built-in kernels: leave {} out, or give --shaders too",
                    options.option_of_shaders));
  }
  if (!options.shaders.empty() && (options.extremes || options.catalogue || !options.configurations.empty()))
    throw InputError("--shaders draws a frame in each mode: leave --extremes, --catalogue and --configurations out");
  if (!options.configurations.empty()) return write_configurations(options);
  if (options.catalogue) return list_extremes();
  if (options.extremes) return extremes_command(options);
  return options.shaders.empty() ? trade_command(options) : shader_modes_command(options, chosen_modes(options.mode));
}

}  // namespace raypool
