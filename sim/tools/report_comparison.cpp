#include "tools/report_comparison.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <sstream>
#include <utility>

#include "config/configuration.hpp"
#include "config/unused_fields.hpp"
#include "files/input_file.hpp"
#include "files/json_text.hpp"
#include "scene/picture_file.hpp"
#include "tools/picture_comparison.hpp"

namespace raypool {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// What a report has of the run itself; all other numbers are its results.
constexpr std::array kSetUp = {"raypool", "engine", "boundary", "hits",  "precision",   "shaders",      "scene",
                               "view",    "size",   "depth",    "units", "reflections", "configuration"};
// Neither: the same things in other words, and what this computer did.
constexpr std::array kLeftOut = {
    "command", "config", "traverser", "lockstep", "wall_seconds", "simulation_seconds", "simulated_per_second"};

template <size_t count>
bool is_in(const std::array<const char*, count>& list, const std::string& key) {
  return std::find(list.begin(), list.end(), key) != list.end();
}

/// The values of an object with their paths: "alus.flt.utilisation". An array is one value.
void append_leaves(const Json& json, const std::string& path, std::vector<std::pair<std::string, Json>>& leaves) {
  if (!json.is_object()) {
    leaves.emplace_back(path, json);
    return;
  }
  for (const auto& item : json.items())
    append_leaves(item.value(), path.empty() ? item.key() : path + "." + item.key(), leaves);
}

/// Reports of versions with fewer parameters have the defaults of those; of versions with others, what they have.
Json whole_configuration(const Json& json, const std::string& where) {
  try {
    return Json::parse(to_json(parse_configuration(to_text(json, -1), where)));
  } catch (const InputError&) {
    return json;
  }
}

/// The leaves of the members `wanted` of a report.
template <typename Wanted>
std::vector<std::pair<std::string, Json>> leaves_of(const Report& report, Wanted wanted) {
  std::vector<std::pair<std::string, Json>> leaves;
  for (const auto& item : report.json.items()) {
    if (!wanted(item.key())) continue;
    append_leaves(item.key() == "configuration" ? whole_configuration(item.value(), report.path) : item.value(),
                  item.key(), leaves);
  }
  return leaves;
}

/// Of both reports, null where one has none: those of `a` in their order, then what `b` alone has.
template <typename Wanted>
Json side_by_side(const Report& a, const Report& b, Wanted wanted) {
  const auto of_a = leaves_of(a, wanted), of_b = leaves_of(b, wanted);
  const std::map<std::string, Json> in_a(of_a.begin(), of_a.end()), in_b(of_b.begin(), of_b.end());
  Json rows = Json::array();
  for (const auto& [path, value] : of_a) {
    const auto found = in_b.find(path);
    rows.push_back({{"field", path}, {"a", value}, {"b", found == in_b.end() ? Json() : found->second}});
  }
  for (const auto& [path, value] : of_b)
    if (in_a.count(path) == 0) rows.push_back({{"field", path}, {"a", nullptr}, {"b", value}});
  return rows;
}

/// Fields that the machine of the report does not look at, each with the reason.
std::map<std::string, std::string> unused_of(const Report& report) {
  std::map<std::string, std::string> reasons;
  try {
    const Json whole = whole_configuration(report.json["configuration"], report.path);
    for (const UnusedField& field : unused_fields(parse_configuration(to_text(whole, -1), report.path)))
      reasons["configuration." + field.path] = field.reason;
  } catch (const InputError&) {
    return {};  // of a version with other parameters
  }
  return reasons;
}

Json set_up(const Report& a, const Report& b) {
  const std::map<std::string, std::string> of_a = unused_of(a), of_b = unused_of(b);
  Json rows = Json::array();
  for (Json& row : side_by_side(a, b, [](const std::string& key) { return is_in(kSetUp, key); })) {
    if (row["a"] == row["b"]) continue;
    const auto found = of_a.find(row["field"]);
    if (found != of_a.end() && of_b.count(row["field"]) != 0) row["not_looked_at"] = found->second;
    rows.push_back(row);
  }
  return rows;
}

Json results(const Report& a, const Report& b) {
  Json rows = Json::array();
  const auto wanted = [](const std::string& key) { return !is_in(kSetUp, key) && !is_in(kLeftOut, key); };
  for (Json& row : side_by_side(a, b, wanted)) {
    const auto figure = [](const Json& value) { return value.is_number() || value.is_null(); };
    if (!figure(row["a"]) || !figure(row["b"])) continue;
    row["change"] = nullptr;
    if (row["a"].is_number() && row["b"].is_number()) {
      const auto before = row["a"].get<double>(), after = row["b"].get<double>();
      if (before != 0) row["change"] = after / before - 1;
    }
    rows.push_back(row);
  }
  return rows;
}

Json read_json(const std::string& path, const std::string& what) {
  return parse_json(read_text_file(path, what), path);
}

bool is_synthesis(const Json& json) {
  const auto number = [&](const char* object, const char* key) {
    return json.contains(object) && json[object].is_object() && json[object].contains(key) &&
           json[object][key].is_number();
  };
  return json.is_object() && json.contains("parameters") && json["parameters"].is_object() &&
         number("area", "total_kge") && number("forty_nm", "total_mm2");
}

struct SynthesisReport {
  std::string path;
  Json json;
};

/// Newest first.
std::vector<SynthesisReport> synthesis_in(const fs::path& folder) {
  std::vector<std::pair<fs::file_time_type, std::string>> paths;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const fs::path path = entry->path() / "report.json";
    std::error_code none;
    if (fs::is_regular_file(path, none)) paths.emplace_back(fs::last_write_time(path, none), path.string());
  }
  std::sort(paths.rbegin(), paths.rend());
  std::vector<SynthesisReport> reports;
  for (const auto& [time, path] : paths) {
    try {
      const Json json = read_json(path, "synthesis report");
      if (is_synthesis(json)) reports.push_back({path, json});
    } catch (const InputError&) {
      continue;  // one that is just being written, or something else
    }
  }
  return reports;
}

std::vector<SynthesisReport> all_synthesis(const std::vector<std::string>& places) {
  std::vector<SynthesisReport> reports;
  for (const std::string& place : places) {
    std::error_code none;
    if (!fs::is_regular_file(place, none)) {
      const std::vector<SynthesisReport> found = synthesis_in(place);
      reports.insert(reports.end(), found.begin(), found.end());
      continue;
    }
    const Json json = read_json(place, "synthesis report");
    if (!is_synthesis(json))
      throw InputError(fmt::format("{}: not a report of make synth: it has no area and parameters", place));
    reports.push_back({place, json});
  }
  return reports;
}

/// The area of the units, from the first report of the same Verilog; null if there is none.
Json area(const Report& report, const std::vector<SynthesisReport>& synthesis) {
  Json parameters = Json::object();
  try {
    const Json configuration = whole_configuration(report.json["configuration"], report.path);
    for (const auto& [name, value] : verilog_parameters(parse_configuration(to_text(configuration, -1), report.path)))
      parameters[name] = std::to_string(value);  // as synthesis writes them: texts
  } catch (const InputError&) {
    return nullptr;  // of a version with other parameters
  }
  const int units = report.json["units"].get<int>();
  for (const SynthesisReport& each : synthesis) {
    const Json& found = each.json["parameters"];
    if (found.size() != parameters.size()) continue;
    const bool same = std::all_of(parameters.items().begin(), parameters.items().end(), [&](const auto& item) {
      return found.contains(item.key()) && found[item.key()] == item.value();
    });
    if (!same) continue;
    const double mm2 = units * each.json["forty_nm"]["total_mm2"].get<double>();
    Json row = {{"report", each.path},
                {"memories", each.json.value("memories", Json())},
                {"mm2", mm2},
                {"kge", units * each.json["area"]["total_kge"].get<double>()},
                {"mrays_per_second_mm2", nullptr}};
    const Json rate = report.json.value("mrays_per_second", Json());
    if (rate.is_number() && mm2 > 0) row["mrays_per_second_mm2"] = rate.get<double>() / mm2;
    return row;
  }
  return nullptr;
}

/// What make runs to know the area of a report's units, from the options that the run was given; null where they say
/// nothing, as in reports that another program has written.
Json synthesis_command(const Report& report) {
  const auto words = report.json.find("command");
  if (words == report.json.end() || !words->is_array() || words->empty()) return nullptr;
  std::string config = "8w8c";
  std::vector<std::string> set;
  for (size_t i = 0; i < words->size(); ++i) {
    if (!(*words)[i].is_string()) return nullptr;
    std::string option = (*words)[i].get<std::string>(), value;
    if (option != "-c" && option.rfind("--config", 0) != 0 && option.rfind("--set", 0) != 0) continue;
    if (const size_t equals = option.find('='); equals != std::string::npos) {
      value = option.substr(equals + 1);
      option.resize(equals);
    } else if (i + 1 < words->size() && (*words)[i + 1].is_string()) {
      value = (*words)[++i].get<std::string>();
    }
    if (option == "--config" || option == "-c") config = value;
    if (option != "--set") continue;
    // What is around the units is not part of their area.
    std::istringstream fields(value);
    for (std::string field; fields >> field;)
      if (field.rfind("chip.", 0) != 0 && field.rfind("name=", 0) != 0) set.push_back(field);
  }
  const std::string fields = set.empty() ? "" : fmt::format(" SET=\"{}\"", fmt::join(set, " "));
  return fmt::format("make synth CONFIG={}{}", config, fields);
}

}  // namespace

Report load_report(const std::string& path) {
  if (path.empty())
    throw InputError(
        "compare takes two reports of raypool sim, or the folders that they are in: raypool compare A B, or make "
        "compare A=FOLDER B=FOLDER");
  std::error_code none;
  Report report{fs::is_directory(path, none) ? (fs::path(path) / "report.json").string() : path, {}};
  report.json = read_json(report.path, "report");
  const auto require = [&](const char* key, bool (Json::*is_right)() const noexcept) {
    if (report.json.is_object() && report.json.contains(key) && (report.json[key].*is_right)()) return;
    throw InputError(fmt::format("{}: not a report of raypool sim: it has no '{}' as those have", report.path, key));
  };
  for (const char* key : {"raypool", "engine"}) require(key, &Json::is_string);
  for (const char* key : {"configuration", "scene", "size"}) require(key, &Json::is_object);
  for (const char* key : {"units", "rays"}) require(key, &Json::is_number_integer);
  return report;
}

/// How far the figures of an estimate may be off, as a share of the cycles; null: they are exact.
Json estimate_of(const Report& report) {
  for (const char* estimates : {"estimated", "sampled"})
    if (report.json.contains(estimates)) return report.json[estimates]["error"];
  return nullptr;
}

Json compare_reports(const Report& a, const Report& b, const std::vector<std::string>& synthesis,
                     const std::string& map) {
  const std::vector<SynthesisReport> known = all_synthesis(synthesis);
  return {{"a", a.path},
          {"b", b.path},
          {"set_up", set_up(a, b)},
          {"results", results(a, b)},
          {"estimates", {{"a", estimate_of(a)}, {"b", estimate_of(b)}}},
          {"picture", compare_pictures(a, b, map)},
          {"criterion", {{"off_by", kOffByMore}, {"most_off", kMostOff}}},
          {"area", {{"a", area(a, known)}, {"b", area(b, known)}}},
          {"synthesis", {{"a", synthesis_command(a)}, {"b", synthesis_command(b)}}}};
}

}  // namespace raypool
