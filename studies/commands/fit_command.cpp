// `raypool fit`: a machine with only what a frame requires.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <stdexcept>
#include <tuple>

#include "chip/board.hpp"
#include "cli/engine.hpp"
#include "cli/exit_code.hpp"
#include "cli/folders.hpp"
#include "cli/frame.hpp"
#include "cli/image_size.hpp"
#include "cli/progress.hpp"
#include "cli/shaders.hpp"
#include "cli/version.hpp"
#include "commands/commands.hpp"
#include "commands/special_values.hpp"
#include "config/data_folder.hpp"
#include "config/unused_fields.hpp"
#include "files/json_text.hpp"
#include "files/output_files.hpp"
#include "fit/fit.hpp"
#include "fit/needs.hpp"
#include "machine/compute/functional_unit.hpp"
#include "scene/subnormal_words.hpp"

namespace raypool {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double kMostSlower = 1000;  // percent

/// "1%" as a share.
double parse_slower(const std::string& text) {
  const size_t digits = text.size() - (!text.empty() && text.back() == '%' ? 1 : 0);
  double percent = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + digits, percent);
  if (error != std::errc() || end != text.data() + digits || !(percent >= 0 && percent <= kMostSlower))
    throw InputError(fmt::format("--slower is '{}': give the percentage of cycles, 0% to {}%", text, kMostSlower));
  return percent / 100;
}

/// The machine's, with what it was fitted to; no longer than names may be.
std::string fitted_name(const std::string& base, const std::string& scene) {
  const std::string end = "-fit-" + name_of_file(scene);
  return base.substr(0, kLongestName - std::min(kLongestName, end.size())) + end.substr(0, kLongestName);
}

/// What draws the frame: the built-in kernels, or a shader set, compiled once for each kind of machine.
class Programs {
 public:
  /// `set`: null for the built-in kernels.
  Programs(const Scene& scene, std::shared_ptr<const shader::ShaderSet> set) : scene_(scene), set_(std::move(set)) {}

  /// The record's memory; the record gets the set's kernels. Throws InputError when its machine lacks what they need.
  MemoryImage image(RunRecord& record) {
    if (!set_) return build_memory(ray_program(record).program, scene_);
    const Made& made = of(record);
    record.kernels = made.kernels;
    return made.image;
  }
  const RayProgram& program(RunRecord record) {
    if (set_) record.kernels = of(record).kernels;
    return ray_program(record);
  }

 private:
  struct Made {
    std::shared_ptr<const RayProgram> kernels;
    MemoryImage image;
  };
  /// By all of a machine that the kernels depend on.
  const Made& of(RunRecord& record) {
    const KernelTarget target(record.configuration);
    const std::tuple key = {target.fma, target.triples, target.culling, target.compact,
                            record.configuration.contents()};
    const auto found = made_.find(key);
    if (found != made_.end()) return found->second;
    MemoryImage image = build_shader_image(SimOptions().shader_source, *set_, scene_, record);
    return made_.emplace(key, Made{record.kernels, std::move(image)}).first->second;
  }

  const Scene& scene_;
  std::shared_ptr<const shader::ShaderSet> set_;
  std::map<std::tuple<bool, bool, bool, bool, uint32_t>, Made> made_;
};

/// One frame, drawn on one machine after another. Each picture must be that of the kernels as C++.
class FrameRuns {
 public:
  FrameRuns(const FitOptions& options, RunRecord record, const Scene& scene, Programs& programs)
      : options_(options), record_(std::move(record)), scene_(scene), programs_(programs), picture_(draw_natively()) {}

  /// Throws std::runtime_error when the picture is another one, and what run_board() throws.
  ChipResult draw(const Configuration& machine, const std::string& what);
  /// None when the machine stops with a fault.
  std::optional<uint64_t> cycles(const Configuration& machine, const std::string& what) {
    try {
      return draw(machine, what).cycles;
    } catch (const ChipFault&) {
      return std::nullopt;
    }
  }
  /// The infinities and NaNs that one compute unit of the machine meets, which are those of several.
  SpecialValues specials(const Configuration& machine);
  int runs() const { return runs_; }
  /// Of the deepest ray that was traced; an eye ray has 1.
  uint32_t depth_reached() const { return depth_reached_; }

 private:
  FrameBuffer draw_natively();
  ChipResult draw_on(std::unique_ptr<ComputeUnit> device, MemoryImage& image, const std::string& what);

  const FitOptions& options_;
  RunRecord record_;
  const Scene& scene_;
  Programs& programs_;
  std::atomic<uint32_t> depth_reached_{0};
  int runs_ = 0;
  FrameBuffer picture_;
};

FrameBuffer FrameRuns::draw_natively() {
  const MemoryImage image = programs_.image(record_);
  const Tracer tracer = tracer_of(record_, scene_, image);
  NativeOptions native = native_options(record_);
  native.trace = [&](const Ray& ray, Intersection& hit) {
    const uint32_t depth = ray[word::kFlags] & kDepthMask;
    uint32_t deepest = depth_reached_;
    while (depth > deepest && !depth_reached_.compare_exchange_weak(deepest, depth)) continue;
    return tracer.trace(ray, hit);
  };
  return render_native(scene_, image, tracer, native);
}

ChipResult FrameRuns::draw(const Configuration& machine, const std::string& what) {
  record_.configuration = machine;
  MemoryImage image = programs_.image(record_);
  return draw_on(make_unit({Engine::Model, machine, "", false, record_.units, 0}, image.memory), image, what);
}

SpecialValues FrameRuns::specials(const Configuration& machine) {
  record_.configuration = machine;
  MemoryImage image = programs_.image(record_);
  SpecialCensus census(arith::mode_of(machine));
  draw_on(make_counting_functional_unit(machine, image.memory, census), image, "its infinities and NaNs");
  return special_values(census, ray_program(record_).program);
}

ChipResult FrameRuns::draw_on(std::unique_ptr<ComputeUnit> device, MemoryImage& image, const std::string& what) {
  Surroundings around(scene_, image, record_);
  ChipOptions frame = chip_options(record_, scene_, image, around);
  const std::unique_ptr<ChipDevice> chip = make_chip_around(frame, std::move(device));
  ++runs_;
  Progress progress(options_.quiet);
  frame.progress = [&](const ChipProgress& done) {
    if (!progress.due()) return;
    progress.show(fmt::format("  frame {}, {}: {:.0f}% of the pixels, {:.0f} s", runs_, what, 100 * done.pixels_done,
                              progress.seconds()));
  };
  ChipResult result = run_board(frame, *chip);
  if (around.frame == picture_) return result;
  throw std::runtime_error(
      fmt::format("with {} the machine draws another picture than engine native: {} of {} pixels differ", what,
                  compare(around.frame, picture_).pixels, record_.width * record_.height));
}

/// As people read it: a list by its length.
std::string value_text(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (!value.is_array()) return value.dump();
  return value.empty() ? "-" : std::to_string(value.size());
}

std::string slower_text(uint64_t cycles, uint64_t base) {
  return fmt::format("{:+.2f}%", 100 * (static_cast<double>(cycles) / static_cast<double>(base) - 1));
}

/// Everything that the table and the JSON show.
struct Found {
  RunRecord record;
  fit::Fit fit;
  fit::Frame frame;        // drawn on the base
  ChipResult fitted;       // on what is left
  SpecialValues specials;  // on the base
  double slower = 0;
  uint32_t depth_reached = 0;
  int runs = 0;
};

std::string depth_text(const Found& found) {
  if (found.record.waits) return "the shaders' own";
  if (!found.record.reflections) return "no reflections";
  return fmt::format("rays reach {}", found.depth_reached);
}

std::string table_of(const Found& found) {
  const RunRecord& record = found.record;
  std::string text = fmt::format("{}, {} triangles, {}x{}, depth {} ({}){}: what it needs of {}, {} compute unit{}\n",
                                 record.scene, record.triangles, record.width, record.height, record.depth,
                                 depth_text(found), record.shaders.empty() ? "" : ", shaders " + record.shaders,
                                 found.fit.base.name, record.units, record.units == 1 ? "" : "s");
  std::vector<std::string> launched, never;
  for (size_t i = 0; i < kRayKernels; ++i) {
    const uint64_t threads = found.frame.drawn.kernels[i].threads;
    if (threads > 0) launched.push_back(fmt::format("{} ({} threads)", kRayKernelNames[i], threads));
    if (threads == 0) never.emplace_back(kRayKernelNames[i]);
  }
  text += fmt::format("kernels   {}{}{}\n", fmt::join(launched, ", "),
                      never.empty() ? "" : "; never launched: ", fmt::join(never, ", "));
  text += text_of(found.specials);
  text +=
      fmt::format("{:<26} {:>6} {:>6}  {:>12} {:>9}  {}\n", "left out", "from", "to", "cycles alone", "more", "why");
  for (const auto& [cut, from, cycles] : found.fit.changes) {
    text += fmt::format("{:<26} {:>6} {:>6}  {:>12} {:>9}  {}\n", cut.field, value_text(from), value_text(cut.value),
                        cycles ? std::to_string(*cycles) : "-",
                        cycles ? slower_text(*cycles, found.fit.base_cycles) : "-", cut.why);
  }
  if (found.fit.changes.empty()) text += "nothing: the frame needs all of it\n";
  text += fmt::format("{:<26} {:>6} {:>6}  {:>12} {:>9}  of {}; at most {:g}% more were allowed\n", "all of it", "", "",
                      found.fit.cycles, slower_text(found.fit.cycles, found.fit.base_cycles), found.fit.base_cycles,
                      100 * found.slower);
  text += fmt::format("simulated in {:.2f} s, before in {:.2f} s\n", found.fitted.wall_seconds,
                      found.frame.drawn.wall_seconds);
  return text + fmt::format("picture   in each of {} frames drawn that of {}, byte for byte\n", found.runs,
                            record.shaders.empty() ? "the kernels as C++" : "engine native");
}

std::string json_of(const Found& found, const std::string& file) {
  const RunRecord& record = found.record;
  Json json;
  json["raypool"] = kVersion;
  json["command"] = record.command;
  json["scene"] = {{"name", record.scene}, {"triangles", record.triangles}, {"materials", record.materials}};
  json["size"] = {{"width", record.width}, {"height", record.height}};
  if (!record.shaders.empty()) json["shaders"] = record.shaders;
  json["depth"] = record.depth;
  json["depth_reached"] = found.depth_reached;
  json["reflections"] = record.reflections;
  json["units"] = record.units;
  json["config"] = record.configuration.source;
  json["set"] = record.configuration.set;
  json["slower"] = found.slower;
  for (size_t i = 0; i < kRayKernels; ++i)
    json["threads"][std::string(kRayKernelNames[i])] = found.frame.drawn.kernels[i].threads;
  json["specials"] = json_of(found.specials);
  json["frames_drawn"] = found.runs;
  json["cycles"] = {{"base", found.fit.base_cycles}, {"most", found.fit.most_cycles}, {"fitted", found.fit.cycles}};
  json["simulation_seconds"] = {{"base", found.frame.drawn.wall_seconds}, {"fitted", found.fitted.wall_seconds}};
  json["changes"] = Json::array();
  for (const auto& [cut, from, cycles] : found.fit.changes) {
    json["changes"].push_back({{"field", cut.field},
                               {"from", from},
                               {"to", cut.value},
                               {"why", cut.why},
                               {"cycles", cycles ? Json(*cycles) : Json()}});
  }
  json["file"] = file;
  json["base"] = Json::parse(to_json(found.fit.base));
  json["fitted"] = Json::parse(to_json(found.fit.fitted));
  return to_text(json, 2) + "\n";
}

/// Before all the work.
void check_writable(const fs::path& path) { OutputFiles().begin(path); }

RunRecord record_of(const FitOptions& options, const Scene& scene, const shader::ShaderSet* shaders) {
  const ImageSize size = parse_image_size(options.size);
  std::vector<std::string> set = options.set;
  if (!options.traverser.empty()) set.push_back("chip.traverser=" + options.traverser);
  RunRecord record;
  if (shaders != nullptr) {
    add_settings_for(*shaders, options.units, set);
    record.shaders = options.shaders;
    record.waits = shaders->waits();
  }
  record.command = options.command;
  record.configuration = load_configuration(options.config, set);
  refuse_unused_settings(record.configuration);
  record.width = size.width;
  record.height = size.height;
  record.depth = options.depth;
  record.units = options.units;
  record.scene = scene.name;
  record.triangles = scene.triangles.size();
  record.materials = scene.materials.size();
  record.reflections = record.chip_depth() > 1 && (shaders != nullptr || scene.reflects());
  return record;
}

}  // namespace

int fit_command(const FitOptions& options) {
  const double slower = parse_slower(options.slower);
  check_depth_and_units(options.depth, options.units);
  std::shared_ptr<const shader::ShaderSet> shaders;
  if (!options.shaders.empty()) shaders = SimOptions().shader_source.load(options.shaders);
  const Scene scene =
      load_scene_and_warn(options.scene, options.detail, options.view, options.look, shaders != nullptr);
  Found found;
  found.slower = slower;
  found.record = record_of(options, scene, shaders.get());
  const Configuration& base = found.record.configuration;
  Programs programs(scene, shaders);
  if (shaders) {
    check_shaders(found.record);
    programs.image(found.record);
  }
  check_fits(found.record, scene);
  const std::string name = fitted_name(base.name, options.scene);
  const fs::path out = options.out.empty() ? results_folder() / "fit" / (name + ".json") : fs::path(options.out);
  if (options.out.empty()) make_folder(out.parent_path());
  check_writable(out);
  if (!options.json.empty()) check_writable(options.json);

  FrameRuns runs(options, found.record, scene, programs);
  found.frame.depth = found.record.chip_depth();
  found.frame.reflections = found.record.reflections;
  found.frame.materials = shaders ? 0 : scene.materials.size();
  found.frame.subnormal_words = !subnormal_word(scene, arguments_of(found.record, scene)).empty();
  found.frame.drawn = runs.draw(base, "the whole machine");
  found.frame.program = [&](const Configuration& machine) -> const RayProgram& {
    RunRecord record = found.record;
    record.configuration = machine;
    return programs.program(record);
  };
  found.specials = runs.specials(base);
  found.fit =
      fit::fit(base, found.frame.drawn.cycles, fit::parts_of(found.frame), slower,
               [&](const Configuration& machine, const std::string& what) { return runs.cycles(machine, what); });
  found.fit.fitted.name = name;
  // What is left is tried as it is left.
  const std::string text = fit::shortest_file(found.fit.fitted) + "\n";
  found.fitted = runs.draw(parse_configuration(text, out.string()), "all of it");
  if (found.fitted.cycles != found.fit.cycles)
    throw std::runtime_error(
        fmt::format("the fitted machine takes {} cycles, {} when it was found", found.fitted.cycles, found.fit.cycles));
  found.depth_reached = runs.depth_reached();
  found.runs = runs.runs();

  OutputFiles files;
  files.write(out, text);
  const std::string shown = options.out.empty() ? fs::proximate(out).lexically_normal().string() : options.out;
  if (!options.json.empty()) files.write(options.json, json_of(found, shown));
  files.publish();
  fmt::print("{}results   {}: {} sim --config {}{}\n", table_of(found), shown, program_command(), shown,
             options.shaders.empty() ? "" : " --shaders " + options.shaders);
  return kDone;
}

}  // namespace raypool
