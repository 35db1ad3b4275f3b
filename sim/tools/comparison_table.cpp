// What `raypool compare` prints for people.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <string_view>

#include "files/json_text.hpp"
#include "scene/picture_file.hpp"
#include "tools/report_comparison.hpp"

namespace raypool {
namespace {

using Json = nlohmann::ordered_json;

// Rows that are always there, and those that are when they differ; a path that begins so.
constexpr std::array kAlways = {"cycles", "rays", "mrays_per_second", "frames_per_second"};
constexpr std::array kWhenDifferent = {"mrays_per_second_thesis",
                                       "time_utilisation",
                                       "resource_utilisation",
                                       "ceilings.lowest",
                                       "ceilings.reached",
                                       "warp_cycles.",
                                       "kernels.",
                                       "alus.",
                                       "caches.",
                                       "pools.",
                                       "memory.",
                                       "traverser_batches.",
                                       "traversal."};

constexpr size_t kLongestValue = 30;  // characters of a column

std::string text_of(const Json& value) {
  if (value.is_null()) return "-";
  const std::string text = value.is_string() ? value.get<std::string>() : to_text(value, -1);
  return text.size() > kLongestValue ? text.substr(0, kLongestValue - 3) + "..." : text;
}

bool ends_with(const std::string& text, std::string_view end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

bool is_share(const std::string& field) {
  return ends_with(field, "utilisation") || ends_with(field, "hit_rate") || ends_with(field, "reached");
}

std::string figure(const std::string& field, const Json& value) {
  if (value.is_null()) return "-";
  if (is_share(field)) return fmt::format("{:.1f}%", 100 * value.get<double>());
  return value.is_number_float() ? fmt::format("{:.2f}", value.get<double>()) : text_of(value);
}

/// In per cent; of a share in its points.
std::string change(const Json& row) {
  if (!row["a"].is_number() || !row["b"].is_number()) return "";
  if (row["a"] == row["b"]) return "same";
  if (is_share(row["field"]))
    return fmt::format("{:+.1f} points", 100 * (row["b"].get<double>() - row["a"].get<double>()));
  return row["change"].is_null() ? "" : fmt::format("{:+.1f}%", 100 * row["change"].get<double>());
}

bool shown(const Json& row) {
  const std::string field = row["field"];
  if (std::find(kAlways.begin(), kAlways.end(), field) != kAlways.end()) return true;
  if (field.rfind("alus.", 0) == 0 && is_share(field)) return true;
  if (row["a"] == row["b"]) return false;
  return std::any_of(kWhenDifferent.begin(), kWhenDifferent.end(),
                     [&](const char* begin) { return field.rfind(begin, 0) == 0; });
}

template <typename... Arguments>
void line(std::string& text, fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  fmt::format_to(std::back_inserter(text), format, std::forward<Arguments>(arguments)...);
  text += '\n';
}

void estimates_line(std::string& text, const Json& estimates) {
  if (estimates["a"].is_null() && estimates["b"].is_null()) return;
  const auto error = [](const Json& share) {
    return share.is_null() ? "exact" : fmt::format("+-{:.1f}%", 100 * share.get<double>());
  };
  line(text, "estimates A {}, B {} (of the cycles): a smaller change decides nothing, engine model does",
       error(estimates["a"]), error(estimates["b"]));
}

void picture_line(std::string& text, const Json& picture) {
  if (!picture["compared"].get<bool>()) {
    line(text, "picture   not compared: {}", picture["reason"].get<std::string>());
  } else if (picture["differ"] == 0) {
    line(text, "picture   the same, {} pixels", picture["pixels"].get<uint64_t>());
  } else {
    line(text,
         "picture   {} of {} pixels differ, {:.3f}% of the picture by {} or more; largest difference {} of 255, "
         "mean {:.3g}",
         picture["differ"].get<uint64_t>(), picture["pixels"].get<uint64_t>(),
         100 * picture["off_by_more"].get<double>(), kOffByMore, picture["largest_difference"].get<int>(),
         picture["mean_difference"].get<double>());
    if (!picture.contains("causes")) return;
    const auto pixels = [&](const char* cause) { return picture["causes"][cause].get<uint64_t>(); };
    line(text,
         "          of these a ray hits otherwise in {}, else a shadow falls otherwise in {}, else the colour is "
         "rounded otherwise in {}",
         pixels("hit"), pixels("shadow"), pixels("colour"));
  }
}

/// `commands`: what finds the area of each side; null where that is not known either.
void area_lines(std::string& text, const Json& area, const Json& commands) {
  for (const char* side : {"a", "b"}) {
    const Json& found = area[side];
    if (found.is_null()) {
      const Json& command = commands[side];
      line(text, "area {}    not known; `{}` finds it", side == std::string("a") ? "A" : "B",
           command.is_null() ? "make synth CONFIG=..." : command.get<std::string>());
      continue;
    }
    const Json& rate = found["mrays_per_second_mm2"];
    line(text, "area {}    {:.3f} mm2 (40 nm), {:.0f} kGE{}, from {}", side == std::string("a") ? "A" : "B",
         found["mm2"].get<double>(), found["kge"].get<double>(),
         rate.is_null() ? "" : fmt::format(", {:.1f} Mrays/s a mm2", rate.get<double>()),
         found["report"].get<std::string>());
  }
}

}  // namespace

std::string comparison_table(const Json& comparison) {
  std::string text;
  line(text, "A         {}", comparison["a"].get<std::string>());
  line(text, "B         {}", comparison["b"].get<std::string>());
  if (comparison["set_up"].empty()) {
    line(text, "set-up    the same");
  } else {
    line(text, "set-up    {:<38} {:>30} {:>30}", "", "A", "B");
    for (const Json& row : comparison["set_up"]) {
      line(text, "  {:<46} {:>30} {:>30}", row["field"].get<std::string>(), text_of(row["a"]), text_of(row["b"]));
      if (row.contains("not_looked_at"))
        line(text, "    not looked at by either: {}", row["not_looked_at"].get<std::string>());
    }
  }
  line(text, "results   {:<38} {:>14} {:>14} {:>14}", "", "A", "B", "change");
  size_t same = 0, others = 0;
  for (const Json& row : comparison["results"]) {
    if (shown(row)) {
      const std::string field = row["field"];
      line(text, "  {:<46} {:>14} {:>14} {:>14}", field, figure(field, row["a"]), figure(field, row["b"]), change(row));
    } else {
      ++(row["a"] == row["b"] ? same : others);
    }
  }
  line(text, "  and {} figures that are the same, {} others that differ: --json has them", same, others);
  estimates_line(text, comparison["estimates"]);
  picture_line(text, comparison["picture"]);
  area_lines(text, comparison["area"], comparison["synthesis"]);
  return text;
}

}  // namespace raypool
