#include "numerics/cost.hpp"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <vector>

#include "chip/chip.hpp"
#include "scene/native_renderer.hpp"

namespace raypool::numerics {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr int kTimedSize = 32;

/// The parameters on which the two ALUs' size depends, of those that the report names.
bool fits(const Json& parameters, const Configuration& configuration) {
  if (!parameters.is_object()) return false;
  for (const auto& [name, value] : verilog_parameters(configuration)) {
    const bool matters = name.find("CACHE") == std::string::npos && name != "STACK_DEPTH";
    if (!matters) continue;
    const auto found = parameters.find(name);
    if (found == parameters.end() || !found->is_number() || found->get<double>() != value) return false;
  }
  return true;
}

/// kGE of all blocks of a name, wherever they stand; the parts of a block are in the block already.
double block_kge(const Json& blocks, const std::string& name) {
  double sum = 0;
  for (const Json& row : blocks) {
    const std::string path = row.value("block", "");
    const std::string last = path.substr(path.rfind('/') == std::string::npos ? 0 : path.rfind('/') + 1);
    if (last == name) sum += row.value("logic_kge", 0.0);
  }
  return sum;
}

}  // namespace

std::optional<ModeTiming> time_mode(const Scene& scene, int depth, const Configuration& configuration, const UnitMaker& make) {
  const Program& program = ray_kernel_program(configuration.fma);
  MemoryImage image = build_memory(program, scene);
  const Tracer tracer(scene, image.material_base);
  SceneTracer scene_tracer(tracer);
  FrameBuffer frame(kTimedSize, kTimedSize);
  FrameBufferSink sink(frame);
  const std::unique_ptr<ComputeUnit> unit = make(configuration, image.memory);
  ChipOptions chip;
  chip.configuration = configuration;
  chip.device = unit.get();
  chip.memory = &image.memory;
  chip.program_length = static_cast<uint32_t>(program.code.size());
  for (size_t i = 0; i < kRayKernels; ++i) chip.entries[i] = program.entries.at(std::string(kRayKernelNames[i]));
  chip.arguments = camera_arguments(scene, kTimedSize, kTimedSize, configuration.contents());
  chip.width = chip.height = kTimedSize;
  chip.depth = depth;
  chip.tracer = &scene_tracer;
  chip.frame = &sink;
  const ChipResult result = run_chip(chip);
  if (!result.timed || result.rays() == 0) return std::nullopt;
  return ModeTiming{static_cast<double>(result.cycles) / static_cast<double>(result.rays()), result.mrays_per_s};
}

std::optional<ModeGates> read_gates(const fs::path& synthesis, const Configuration& configuration) {
  std::error_code error;
  std::vector<fs::path> reports;
  for (fs::directory_iterator entry(synthesis, error), end; !error && entry != end; entry.increment(error)) {
    if (fs::is_regular_file(entry->path() / "report.json")) reports.push_back(entry->path() / "report.json");
  }
  std::sort(reports.begin(), reports.end());
  for (const fs::path& path : reports) {
    std::ifstream file(path);
    const Json report = Json::parse(file, nullptr, false);
    if (!report.is_object() || !report.contains("blocks") || !report["blocks"].is_array()) continue;
    if (!fits(report.value("parameters", Json()), configuration)) continue;
    try {
      const ModeGates gates{block_kge(report["blocks"], "flt_alu"), block_kge(report["blocks"], "slw_alu")};
      if (gates.flt_kge > 0 && gates.slw_kge > 0) return gates;
    } catch (const Json::exception&) {
      continue;  // a row of another shape
    }
  }
  return std::nullopt;
}

}  // namespace raypool::numerics
