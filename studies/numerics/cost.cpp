#include "numerics/cost.hpp"

#include <algorithm>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "bits.hpp"
#include "chip/board.hpp"
#include "scene/native_renderer.hpp"

namespace raypool::numerics {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr int kTimedSize = 32;

/// kGE of one lane from a report of the same parameters.
std::optional<double> lane_kge(const Json& report, const std::string& lane,
                               const std::map<std::string, int>& depends_on) {
  try {
    for (const auto& [name, value] : depends_on) {
      // As raypool prints them: texts.
      if (report.at("parameters").at(name) != std::to_string(value)) return std::nullopt;
    }
    return report.at("lanes").at(lane).at("kge").get<double>();
  } catch (const Json::exception&) {
    return std::nullopt;  // a report of another shape
  }
}

}  // namespace

std::optional<ModeTiming> time_mode(const Scene& scene, int depth, const Configuration& configuration,
                                    const UnitMaker& make) {
  const Program& program = ray_kernel_program(KernelTarget(configuration));
  MemoryImage image = build_memory(program, scene);
  const Tracer tracer(scene, image.material_base);
  SceneTracer scene_tracer(tracer);
  FrameBuffer frame(kTimedSize, kTimedSize);
  FrameBufferSink sink(frame);
  ChipOptions chip;
  chip.configuration = configuration;
  chip.configuration.chip.traverser = TraverserName::Static;
  chip.memory = &image.memory;
  chip.program_length = size32(program.code);
  for (size_t i = 0; i < kRayKernels; ++i) chip.entries[i] = program.entries.at(std::string(kRayKernelNames[i]));
  chip.layout = ray_record_layout(configuration);
  chip.arguments = camera_arguments(scene, kTimedSize, kTimedSize, configuration.contents(), configuration.significand);
  chip.width = chip.height = kTimedSize;
  chip.depth = depth;
  chip.tracer = &scene_tracer;
  chip.frame = &sink;
  const ChipResult result = run_board(chip, *make_chip_around(chip, make(configuration, image.memory)));
  if (!result.timed || result.rays() == 0) return std::nullopt;
  return ModeTiming{static_cast<double>(result.cycles) / result.rays(), result.mrays_per_s};
}

std::optional<ModeGates> read_gates(const fs::path& synthesis, const arith::Mode& mode) {
  std::error_code error;
  std::vector<std::pair<fs::file_time_type, fs::path>> reports;
  for (fs::directory_iterator entry(synthesis, error), end; !error && entry != end; entry.increment(error)) {
    const fs::path path = entry->path() / "report.json";
    if (fs::is_regular_file(path)) reports.push_back({fs::last_write_time(path), path});
  }
  std::sort(reports.rbegin(), reports.rend());
  const auto subnormals = to_underlying(mode.subnormals), slow_unit = to_underlying(mode.slow_unit);
  const auto significand = static_cast<int>(mode.significand);
  std::optional<double> flt, slw;
  for (const auto& [time, path] : reports) {
    std::ifstream file(path);
    const Json report = Json::parse(file, nullptr, false);
    if (!flt) {
      flt =
          lane_kge(report, "Flt lane", {{"SUBNORMALS", subnormals}, {"SIGNIFICAND", significand}, {"FMA", mode.fused}});
    }
    if (!slw) {
      slw = lane_kge(report, "Slw lane",
                     {{"SUBNORMALS", subnormals}, {"SIGNIFICAND", significand}, {"SLOW_UNIT", slow_unit}});
    }
  }
  if (!flt || !slw) return std::nullopt;
  return ModeGates{*flt, *slw};
}

}  // namespace raypool::numerics
