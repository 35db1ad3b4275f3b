// `raypool explore`: the machines that are fastest for their area, of thousands around one.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <set>
#include <sstream>

#include "chip/board.hpp"
#include "cli/engine.hpp"
#include "cli/exit_code.hpp"
#include "cli/folders.hpp"
#include "cli/frame.hpp"
#include "cli/image_size.hpp"
#include "cli/progress.hpp"
#include "cli/version.hpp"
#include "commands/commands.hpp"
#include "config/unused_fields.hpp"
#include "estimate/estimated_frame.hpp"
#include "explore/area_table.hpp"
#include "explore/front.hpp"
#include "explore/guess.hpp"
#include "explore/machines.hpp"
#include "files/input_file.hpp"
#include "files/json_text.hpp"
#include "files/output_files.hpp"
#include "sampled/processes.hpp"
#include "scene/native_renderer.hpp"
#include "scene/threads.hpp"

namespace raypool {
namespace {

namespace fs = std::filesystem;
using explore::Candidate;
using explore::Machine;
using Json = nlohmann::ordered_json;

constexpr double kImpossible = std::numeric_limits<double>::infinity();
// Pixels that an estimate has the flow of: a quarter of those of engine estimate.
constexpr uint32_t kPixels = 4096;
// Machines at random that are estimated first, to learn what guesses are off by. What guesses and estimates are
// expected to be off by before that is known.
constexpr size_t kLearned = 200;
constexpr double kGuessSpread = 0.3, kEstimateSpread = 0.1;

/// The frame, drawn natively: what does not depend on the machine.
class ExploredFrame {
 public:
  ExploredFrame(RunRecord record, const Scene& scene)
      : record_(std::move(record)),
        scene_(scene),
        image_(build_memory(ray_program(record_).program, scene)),
        tracer_(tracer_of(record_, scene, image_)),
        picture_(render_native(scene, image_, tracer_, native_options(record_), &whole_)) {}

  const RunRecord& record() const { return record_; }
  double rays() const { return static_cast<double>(whole_.rays()); }

  double guessed_cycles(const Machine& machine) {
    count_for(machine.configuration);
    if (!guesses_) guesses_.emplace(counts_.begin()->second, whole_);
    return guesses_->cycles(machine.configuration, machine.units, costs_of(machine.configuration));
  }
  /// Needs what guessed_cycles() has counted.
  double estimated_cycles(const Machine& machine) const {
    const auto& counts = counts_.at(kind_of(machine.configuration));
    return estimate::estimate_frame(machine.configuration, machine.units, counts).cycles.value;
  }
  /// Of engine model, whose picture must be that of native. Throws InputError when the machine cannot draw the frame.
  double simulated_cycles(const Machine& machine) const;

 private:
  using Kind = std::pair<uint32_t, TileOrder>;
  static Kind kind_of(const Configuration& machine) { return {machine.contents(), machine.chip.tile_order}; }

  void count_for(const Configuration& configuration) {
    const auto [place, is_new] = counts_.try_emplace(kind_of(configuration));
    if (!is_new) return;
    RunRecord record = record_;
    record.configuration = configuration;
    place->second =
        estimate::count_frame(configuration, scene_, image_, tracer_, native_options(record), whole_, kPixels);
  }
  const estimate::KernelTable& costs_of(const Configuration& configuration) {
    // Kernels are the same for many machines: by all of a unit that they depend on.
    Json unit = Json::parse(to_json(configuration));
    const bool culling = configuration.chip.culling;
    for (const char* field : {"name", "chip", "warps", "kernel_overlap", "instruction_cache", "data_cache"})
      unit.erase(field);
    const auto [place, is_new] = costs_.try_emplace(unit.dump() + (culling ? "culling" : ""));
    if (is_new) place->second = estimate::kernel_costs(configuration);
    return place->second;
  }

  RunRecord record_;
  const Scene& scene_;
  MemoryImage image_;
  Tracer tracer_;
  NativeStatistics whole_;
  FrameBuffer picture_;
  std::map<Kind, estimate::FrameCounts> counts_;
  std::map<std::string, estimate::KernelTable> costs_;
  std::optional<explore::Guesses> guesses_;
};

double ExploredFrame::simulated_cycles(const Machine& machine) const {
  RunRecord record = record_;
  record.configuration = machine.configuration;
  record.units = static_cast<int>(machine.units);
  check_fits(record, scene_);
  MemoryImage image = build_memory(ray_program(record).program, scene_);
  Surroundings around(scene_, image, record);
  ChipOptions frame = chip_options(record, scene_, image, around);
  const auto chip = make_chip_around(
      frame, make_unit({Engine::Model, record.configuration, "", false, record.units, 0}, image.memory));
  const uint64_t cycles = run_board(frame, *chip).cycles;
  if (!(around.frame == picture_))
    throw std::runtime_error(fmt::format("{} draws another picture than engine native", record.configuration.name));
  return static_cast<double>(cycles);
}

/// What came of the machines.
struct Explored {
  std::vector<Machine> machines;
  size_t left_out = 0;               // combinations that are of no machine
  std::string wrong;                 // with the first one
  std::vector<Candidate> estimated;  // of those numbers; their guesses are guesses
  std::vector<Candidate> simulated;  // their guesses are estimates
  std::vector<size_t> front, checked;
  size_t simulations = 0;  // for the front
  double guess_spread = 0, estimate_spread = 0;
  double seconds[3] = {};  // of guesses, estimates, simulations
};

size_t measured(const std::vector<Candidate>& candidates) {
  return static_cast<size_t>(std::count_if(candidates.begin(), candidates.end(),
                                           [](const Candidate& candidate) { return candidate.cycles.has_value(); }));
}

std::vector<explore::Axis> axes_of(const ExploreOptions& options) {
  std::vector<explore::Axis> axes = explore::usual_axes();
  for (const std::string& text : options.vary) explore::set_axis(axes, text);
  // Frame and areas are the same for all machines.
  for (const explore::Axis& axis : axes) {
    for (const char* fixed : {"arithmetic.", "chip.traverser", "chip.culling", "chip.hardware_traverser.box_bits"}) {
      if (axis.field.rfind(fixed, 0) == 0)
        throw InputError(fmt::format("--vary {}: explore has one value of it for all machines: use --set", axis.field));
    }
  }
  return axes;
}

class Explorer {
 public:
  Explorer(const ExploreOptions& options, ExploredFrame& frame)
      : options_(options),
        frame_(frame),
        area_file_(options.areas.empty() ? explore::area_table_path() : options.areas),
        areas_(read_text_file(area_file_, "table of areas"), area_file_),
        space_(options.config, options.set, axes_of(options)) {}

  Explored explore();

 private:
  using Measure = std::function<double(const Machine&)>;
  std::vector<double> in_parallel(const std::vector<size_t>& numbers, const std::string& what, const Measure& measure);
  std::vector<double> simulate(const std::vector<size_t>& numbers) {
    return in_parallel(numbers, "simulated", [&](const Machine& machine) {
      try {
        return frame_.simulated_cycles(machine);
      } catch (const InputError&) {
        return kImpossible;
      }
    });
  }
  void guess();
  void guess_new();
  void search(const std::vector<size_t>& first, double deviations);
  void estimate();
  void simulate_front();
  void check();

  const ExploreOptions& options_;
  ExploredFrame& frame_;
  std::string area_file_;
  explore::AreaTable areas_;
  explore::MachineSpace space_;
  Explored explored_;
  size_t done_ = 0;
  std::unique_ptr<Progress> progress_;
};

/// As many processes as cores, each with every so manyth machine.
std::vector<double> Explorer::in_parallel(const std::vector<size_t>& numbers, const std::string& what,
                                          const Measure& measure) {
  if (numbers.empty()) return {};
  const size_t cores = threads_or_all(), tasks = std::min(numbers.size(), cores);
  std::vector<double> found(numbers.size());
  const auto work = [&](size_t task) {
    std::string text;
    for (size_t i = task; i < numbers.size(); i += tasks)
      text += fmt::format("{} ", measure(space_.machines()[numbers[i]]));
    return text;
  };
  const std::vector<std::string> texts = sampled::in_processes(tasks, static_cast<uint32_t>(cores), work);
  for (size_t task = 0; task < tasks; ++task) {
    std::istringstream words(texts[task]);
    std::string word;
    for (size_t i = task; i < numbers.size(); i += tasks) {
      words >> word;
      found[i] = std::stod(word);
    }
  }
  done_ += numbers.size();
  progress_->show(fmt::format("  {} {}, {:.0f} s", done_, what, progress_->seconds()));
  return found;
}

/// All combinations, or half of the machines at random.
void Explorer::guess() {
  if (space_.combinations() <= options_.machines)
    space_.add_all();
  else
    space_.add_random((options_.machines + 1) / 2, options_.seed);
  guess_new();
}

void Explorer::guess_new() {
  for (size_t i = explored_.estimated.size(); i < space_.machines().size(); ++i) {
    const Machine& machine = space_.machines()[i];
    const double area = areas_.area_of(machine.configuration, machine.units);
    explored_.estimated.push_back({area, frame_.guessed_cycles(machine), machine.features, std::nullopt});
    if (progress_->due())
      progress_->show(fmt::format("  {} guessed, {:.0f} s", explored_.estimated.size(), progress_->seconds()));
  }
}

void Explorer::search(const std::vector<size_t>& first, double deviations) {
  explore::search_front(explored_.estimated, first, deviations, kGuessSpread, [&](const std::vector<size_t>& numbers) {
    return in_parallel(numbers, "estimated", [&](const Machine& machine) { return frame_.estimated_cycles(machine); });
  });
}

/// Of machines at random, and then of what is beside their front, until that has no better neighbours.
void Explorer::estimate() {
  std::vector<size_t> first(std::min(kLearned, space_.machines().size()));
  std::iota(first.begin(), first.end(), size_t{0});
  search(first, options_.deviations);
  while (space_.combinations() > options_.machines &&
         space_.add_neighbours(explore::measured_front(explored_.estimated), options_.machines) > 0) {
    guess_new();
    // These are guessed by what is known of their neighbours, and there are many of nearly the same speed.
    search({}, 0);
  }
  explored_.guess_spread = explore::correction_of(explored_.estimated, kGuessSpread).spread;
}

void Explorer::simulate_front() {
  for (const Candidate& candidate : explored_.estimated) {
    explored_.simulated.push_back(
        {candidate.area, candidate.cycles.value_or(kImpossible), candidate.features, std::nullopt});
  }
  explore::search_front(explored_.simulated, explore::measured_front(explored_.estimated), options_.deviations,
                        kEstimateSpread, [&](const std::vector<size_t>& numbers) { return simulate(numbers); });
  explored_.estimate_spread = explore::correction_of(explored_.simulated, kEstimateSpread).spread;
  explored_.front = explore::measured_front(explored_.simulated);
  explored_.simulations = measured(explored_.simulated);
}

/// Machines at random, whatever is guessed of them; the front stays as it is.
void Explorer::check() {
  for (size_t number = 0; number < std::min(options_.check, space_.machines().size()); ++number)
    explored_.checked.push_back(number);
  std::vector<size_t> open;
  for (const size_t number : explored_.checked)
    if (!explored_.simulated[number].cycles) open.push_back(number);
  const std::vector<double> cycles = simulate(open);
  for (size_t i = 0; i < open.size(); ++i) explored_.simulated[open[i]].cycles = cycles[i];
}

Explored Explorer::explore() {
  const auto timed = [&](auto step) {
    progress_ = std::make_unique<Progress>(options_.quiet);
    done_ = 0;
    (this->*step)();
    return progress_->seconds();
  };
  explored_.seconds[0] = timed(&Explorer::guess);
  explored_.seconds[1] = timed(&Explorer::estimate);
  explored_.seconds[2] = timed(&Explorer::simulate_front);
  timed(&Explorer::check);
  progress_.reset();
  explored_.machines = space_.machines();
  explored_.left_out = space_.left_out();
  explored_.wrong = space_.wrong();
  return std::move(explored_);
}

/// The fewest cycles on the front in at most this area; infinite: all of the front is larger.
double front_cycles(const Explored& explored, double area) {
  double cycles = kImpossible;
  for (const size_t number : explored.front)
    if (explored.simulated[number].area <= area) cycles = std::min(cycles, *explored.simulated[number].cycles);
  return cycles;
}

std::vector<std::string> words_of(const std::string& changes) {
  std::istringstream words(changes);
  return {std::istream_iterator<std::string>(words), {}};
}

/// The changes that all machines have: of fields with one value.
std::set<std::string> common_changes(const std::vector<Machine>& machines) {
  std::map<std::string, size_t> times;
  for (const Machine& machine : machines)
    for (const std::string& word : words_of(machine.changes)) ++times[word];
  std::set<std::string> common;
  for (const auto& [word, count] : times)
    if (count == machines.size()) common.insert(word);
  return common;
}

std::string machine_text(const Machine& machine, const std::set<std::string>& common) {
  std::string text = fmt::format("{} unit{}", machine.units, machine.units == 1 ? " " : "s");
  for (const std::string& word : words_of(machine.changes))
    if (common.count(word) == 0) text += " " + word;
  return text;
}

std::string check_text(const Explored& explored) {
  size_t beat = 0;
  double most = 0;
  for (const size_t number : explored.checked) {
    const Candidate& candidate = explored.simulated[number];
    const double front = front_cycles(explored, candidate.area);
    if (!(*candidate.cycles < front)) continue;
    ++beat;
    most = std::max(most, front / *candidate.cycles - 1);
  }
  return fmt::format(
      "check     {} of the machines at random, simulated: {} faster than the front has it for their area{}\n",
      explored.checked.size(), beat, beat == 0 ? "" : fmt::format(", by {:.1f}% at most", 100 * most));
}

std::string table_of(const Explored& explored, const ExploredFrame& frame) {
  const RunRecord& record = frame.record();
  std::string text =
      fmt::format("{}, {} triangles, {}x{}, depth {}: {} machines around {}\n", record.scene, record.triangles,
                  record.width, record.height, record.depth, explored.machines.size(), record.configuration.name);
  const std::set<std::string> common = common_changes(explored.machines);
  if (!common.empty()) text += fmt::format("all of them have {}\n", fmt::join(common, " "));
  text += fmt::format("{:>8} {:>8} {:>7}  {:>8}  {}\n", "mm2", "Mrays/s", "a mm2", "estimate", "machine");
  for (const size_t number : explored.front) {
    const Candidate& found = explored.simulated[number];
    const double speed = 1e3 * frame.rays() / *found.cycles;
    text += fmt::format("{:>8.3f} {:>8.1f} {:>7.1f}  {:>+7.1f}%  {}\n", found.area, speed, speed / found.area,
                        100 * (*found.cycles / found.guess - 1), machine_text(explored.machines[number], common));
  }
  text += fmt::format(
      "guessed   {} in {:.0f} s, {:.0f}% off; estimated {} in {:.0f} s, {:.0f}% off; simulated {} in {:.0f} s\n",
      explored.machines.size(), explored.seconds[0], 100 * explored.guess_spread, measured(explored.estimated),
      explored.seconds[1], 100 * explored.estimate_spread, explored.simulations, explored.seconds[2]);
  if (!explored.checked.empty()) text += check_text(explored);
  if (explored.left_out > 0) {
    text += fmt::format("left out  {} combinations, of which no machine can be; the first: {}\n", explored.left_out,
                        explored.wrong.substr(explored.wrong.find(": ") + 2));
  }
  return text;
}

std::string json_of(const Explored& explored, const ExploredFrame& frame) {
  const RunRecord& record = frame.record();
  Json json;
  json["raypool"] = kVersion;
  json["command"] = record.command;
  json["scene"] = {{"name", record.scene}, {"triangles", record.triangles}};
  json["size"] = {{"width", record.width}, {"height", record.height}};
  json["depth"] = record.depth;
  json["rays"] = frame.rays();
  json["config"] = record.configuration.source;
  json["set"] = record.configuration.set;
  json["machines"] = Json::array();
  std::vector<bool> on_front(explored.machines.size());
  for (const size_t number : explored.front) on_front[number] = true;
  for (size_t i = 0; i < explored.machines.size(); ++i) {
    const Candidate &estimated = explored.estimated[i], &simulated = explored.simulated[i];
    Json row = {{"units", explored.machines[i].units},
                {"changes", explored.machines[i].changes},
                {"mm2", estimated.area},
                {"guessed_cycles", std::round(estimated.guess)}};
    if (estimated.cycles) row["estimated_cycles"] = std::round(*estimated.cycles);
    if (simulated.cycles && *simulated.cycles != kImpossible) row["cycles"] = static_cast<uint64_t>(*simulated.cycles);
    row["front"] = static_cast<bool>(on_front[i]);
    json["machines"].push_back(std::move(row));
  }
  return to_text(json, 1) + "\n";
}

RunRecord record_of(const ExploreOptions& options, const Scene& scene) {
  const ImageSize size = parse_image_size(options.size);
  RunRecord record;
  record.command = options.command;
  record.configuration = load_configuration(options.config, options.set);
  refuse_unused_settings(record.configuration);
  if (record.configuration.chip.traverser != TraverserName::Hardware)
    throw InputError("explore knows areas of chips with their traverser inside: leave out chip.traverser=static");
  record.width = size.width;
  record.height = size.height;
  record.depth = options.depth;
  record.units = 1;
  record.scene = scene.name;
  record.triangles = scene.triangles.size();
  record.reflections = options.depth > 1 && scene.reflects();
  return record;
}

}  // namespace

int explore_command(const ExploreOptions& options) {
  check_depth_and_units(options.depth, 1);
  const Scene scene = load_scene_and_warn(options.scene, options.detail, options.view, options.look);
  const fs::path out = options.out.empty() ? results_folder() / "explore" / "explore.json" : fs::path(options.out);
  if (options.out.empty()) make_folder(out.parent_path());
  OutputFiles().begin(out);
  ExploredFrame frame(record_of(options, scene), scene);
  const Explored explored = Explorer(options, frame).explore();
  write_file(out, json_of(explored, frame));
  fmt::print("{}results   {}\n", table_of(explored, frame), fs::proximate(out).lexically_normal().string());
  return kDone;
}

}  // namespace raypool
