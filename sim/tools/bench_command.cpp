// `raypool bench`: our intersection beside Embree's.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "cli/exit_code.hpp"
#include "cli/image_size.hpp"
#include "cli/progress.hpp"
#include "cli/scene_loading.hpp"
#include "scene/intersection_bench.hpp"
#include "scene/threads.hpp"
#include "tools/commands.hpp"

namespace raypool {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const Rate& rate, double unit) {
  return {{"median", rate.median / unit}, {"quartiles", {rate.lower / unit, rate.upper / unit}}};
}

Json to_json(const BenchRow& row) {
  return {{"rays", row.kind},
          {"count", row.rays},
          {"threads", row.threads},
          {"ours", {{"hits", row.our_hits}, {"mrays_per_second", to_json(row.ours, 1e6)}}},
          {"embree", {{"hits", row.embree_hits}, {"mrays_per_second", to_json(row.embree, 1e6)}}},
          {"ratio", to_json(row.ratio, 1)}};
}

/// "3.21 (3.18 .. 3.25)"
std::string text(const Rate& rate, double unit) {
  return fmt::format("{:.2f} ({:.2f} .. {:.2f})", rate.median / unit, rate.lower / unit, rate.upper / unit);
}

}  // namespace

int bench_command(const BenchCommandOptions& options) {
  const ImageSize size = parse_image_size(options.size);
  const Scene scene = load_scene_and_warn(options.scene, options.detail, options.view, options.look);
  const Tracer tracer(scene);
  Progress progress(options.quiet || options.json);
  const std::vector<BenchRays> rays = rays_of_frame(scene, tracer, static_cast<uint32_t>(size.width),
                                                    static_cast<uint32_t>(size.height), options.depth);
  IntersectionBenchOptions bench;
  bench.threads = threads_or_all(options.threads);
  bench.repetitions = options.repetitions;
  bench.processor_time = options.processor_time;
  bench.progress = [&](double share) {
    if (progress.due()) progress.show(fmt::format("  {:.0f}% of the measurements", 100 * share));
  };
  const std::vector<BenchRow> rows = bench_intersection(scene, tracer.traversal(), rays, bench);
  const char* time = options.processor_time ? "processor" : "wall";
  const char* instructions = walks().back().instructions;

  if (options.json) {
    Json json{{"scene", scene.name},    {"triangles", scene.triangles.size()},
              {"width", size.width},    {"height", size.height},
              {"depth", options.depth}, {"repetitions", options.repetitions},
              {"time", time},           {"instructions", instructions},
              {"rows", Json::array()}};
    for (const BenchRow& row : rows) json["rows"].push_back(to_json(row));
    fmt::print("{}\n", json.dump(2));
    return kDone;
  }
  fmt::print("{}, {} triangles, the rays of {}x{} at depth {}; {} instructions; Mrays/s of {} time,\n", scene.name,
             scene.triangles.size(), size.width, size.height, options.depth, instructions, time);
  fmt::print("median of {} turns (quartiles); Embree: robust, rtcIntersect1 and rtcOccluded1\n", options.repetitions);
  fmt::print("{:<10} {:>9} {:>7} {:>9} {:>9} {:>24} {:>24} {:>22}\n", "rays", "count", "threads", "our hits",
             "Embree's", "ours", "Embree", "ratio");
  for (const BenchRow& row : rows)
    fmt::print("{:<10} {:>9} {:>7} {:>9} {:>9} {:>24} {:>24} {:>22}\n", row.kind, row.rays, row.threads, row.our_hits,
               row.embree_hits, text(row.ours, 1e6), text(row.embree, 1e6), text(row.ratio, 1));
  return kDone;
}

}  // namespace raypool
