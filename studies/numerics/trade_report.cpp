#include "numerics/trade_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace raypool::numerics {
namespace {

using Json = nlohmann::ordered_json;

std::string number(const std::optional<double>& value, const char* format) {
  return value ? fmt::format(fmt::runtime(format), *value) : "-";
}

std::string decibels(double value) { return std::isfinite(value) ? fmt::format("{:.1f}", value) : "equal"; }

std::string share(uint64_t part, uint64_t whole) {
  return fmt::format("{:.2f}%", 100 * static_cast<double>(part) / whole);
}

Json to_json(const TradeResult& result) {
  Json json;
  json["configuration"] = result.configuration;
  for (const TradeRow& row : result.rows) {
    const Quality& q = row.quality;
    json["quality"].push_back({{"scene", row.scene},
                               {"mode", row.mode.name},
                               {"pixels", q.pixels},
                               {"ties", q.ties},
                               {"wrong_triangles", q.wrong_triangles},
                               {"holes", q.holes},
                               {"wrong_shadows", q.wrong_shadows},
                               {"nan_pixels", q.nan_pixels},
                               {"same_paths", q.same_paths},
                               {"psnr_db", q.psnr},
                               {"psnr_same_paths_db", q.psnr_same_paths},
                               {"off_by_one", q.off_by_one},
                               {"off_by_more", q.off_by_more}});
  }
  for (const TradeCost& cost : result.costs) {
    Json entry = {{"mode", cost.mode.name},
                  {"cycles_per_ray", nullptr},
                  {"mrays_per_second", nullptr},
                  {"flt_lane_kge", nullptr},
                  {"slw_lane_kge", nullptr}};
    if (cost.timing)
      entry["cycles_per_ray"] = cost.timing->cycles_per_ray, entry["mrays_per_second"] = cost.timing->mrays_per_s;
    if (cost.gates) entry["flt_lane_kge"] = cost.gates->flt_kge, entry["slw_lane_kge"] = cost.gates->slw_kge;
    json["cost"].push_back(entry);
  }
  return json;
}

}  // namespace

std::string trade_table(const TradeResult& result) {
  std::string text;
  std::string scene;
  for (const TradeRow& row : result.rows) {
    const Quality& q = row.quality;
    if (row.scene != scene) {
      scene = row.scene;
      text +=
          fmt::format("{}, {} pixels\n{:<22} {:>5} {:>9} {:>5} {:>7} {:>4} {:>7} {:>8} {:>8} {:>7}\n", scene, q.pixels,
                      "  mode", "wrong", "holes", "wrong", "NaN", "ties", "PSNR", "of equal", "off by 1", "by 2+");
      text += fmt::format("{:<22} {:>5} {:>9} {:>5} {:>7} {:>4} {:>7} {:>8}\n", "", "hits", "", "shad.", "pixels", "",
                          "dB", "paths");
    }
    text += fmt::format("  {:<20} {:>5} {:>9} {:>5} {:>7} {:>4} {:>7} {:>8} {:>8} {:>7}\n", row.mode.name,
                        q.wrong_triangles, q.holes, q.wrong_shadows, q.nan_pixels, q.ties, decibels(q.psnr),
                        decibels(q.psnr_same_paths), share(q.off_by_one, q.pixels), share(q.off_by_more, q.pixels));
  }
  text += fmt::format("cost on {}; kGE of one lane\n{:<22} {:>10} {:>8} {:>8} {:>8} {:>8}\n", result.configuration,
                      "  mode", "cycles/ray", "Mrays/s", "Flt kGE", "Slw kGE", "sum");
  for (const TradeCost& cost : result.costs) {
    std::optional<double> cycles, rate, flt, slw, sum;
    if (cost.timing) cycles = cost.timing->cycles_per_ray, rate = cost.timing->mrays_per_s;
    if (cost.gates) flt = cost.gates->flt_kge, slw = cost.gates->slw_kge, sum = cost.gates->total();
    text += fmt::format("  {:<20} {:>10} {:>8} {:>8} {:>8} {:>8}\n", cost.mode.name, number(cycles, "{:.2f}"),
                        number(rate, "{:.2f}"), number(flt, "{:.1f}"), number(slw, "{:.1f}"), number(sum, "{:.1f}"));
  }
  return text;
}

std::string offset_table(const std::vector<OffsetScene>& scenes, const std::vector<OffsetRule>& rules,
                         const std::vector<std::vector<OffsetCounts>>& counts) {
  std::string text = fmt::format("{:<18} {:<18} {:>8} {:>6} {:>6} {:>6} {:>10}\n", "scene", "offset", "shadows", "acne",
                                 "moved", "leaks", "self hits");
  for (size_t s = 0; s < scenes.size(); ++s) {
    for (size_t r = 0; r < rules.size(); ++r) {
      const OffsetCounts& c = counts[s][r];
      text += fmt::format("{:<18} {:<18} {:>8} {:>6} {:>6} {:>6} {:>10}\n", r == 0 ? scenes[s].name : "", rules[r].name,
                          c.shadow_rays, c.acne, c.moved, c.leaks, c.self_hits);
    }
  }
  const OffsetInstructions instructions = offset_instructions();
  return text + fmt::format("instructions for the origin: fixed {}, in use {}, integer {}\n", instructions.fixed,
                            instructions.in_use, instructions.integer);
}

std::string seam_table(const std::vector<WatertightMesh>& meshes, const std::vector<WatertightCounts>& counts) {
  std::string text = fmt::format("{:<20} {:>9} {:>9} {:>9} {:>9} {:>6}\n", "mesh", "triangles", "at edges", "vertices",
                                 "rays", "leaks");
  WatertightCounts sum;
  for (size_t i = 0; i < meshes.size(); ++i) {
    text += fmt::format("{:<20} {:>9} {:>9} {:>9} {:>9} {:>6}\n", meshes[i].name, meshes[i].scene.triangles.size(),
                        counts[i].edges, counts[i].vertices, counts[i].rays, counts[i].leaks);
    sum.rays += counts[i].rays;
    sum.leaks += counts[i].leaks;
  }
  return text + fmt::format("{} rays, {} leaks\n", sum.rays, sum.leaks);
}

std::string to_json(const TradeResult& result, const std::vector<WatertightMesh>& meshes,
                    const std::vector<WatertightCounts>& seams, const std::vector<OffsetScene>& scenes,
                    const std::vector<OffsetRule>& rules, const std::vector<std::vector<OffsetCounts>>& offsets) {
  Json json = to_json(result);
  for (size_t i = 0; i < meshes.size(); ++i) {
    json["seams"].push_back({{"mesh", meshes[i].name}, {"rays", seams[i].rays}, {"leaks", seams[i].leaks}});
  }
  for (size_t s = 0; s < scenes.size(); ++s) {
    for (size_t r = 0; r < rules.size(); ++r) {
      const OffsetCounts& c = offsets[s][r];
      json["offsets"].push_back({{"scene", scenes[s].name},
                                 {"offset", rules[r].name},
                                 {"shadow_rays", c.shadow_rays},
                                 {"acne", c.acne},
                                 {"moved", c.moved},
                                 {"leaks", c.leaks},
                                 {"reflections", c.reflections},
                                 {"self_hits", c.self_hits}});
    }
  }
  return json.dump(2) + "\n";
}

}  // namespace raypool::numerics
