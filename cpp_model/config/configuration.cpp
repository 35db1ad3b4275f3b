// Reads, checks and writes configurations.
#include "config/configuration.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <regex>

#include "config/data_folder.hpp"
#include "config/schema.hpp"
#include "files/input_file.hpp"
#include "files/json_text.hpp"
#include "isa/reference.hpp"

namespace raypool {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::array<std::string_view, 2> kSubnormalNames = {"ieee", "flush"};
constexpr std::array<std::string_view, 4> kSlowUnitNames = {"exact", "newton2", "newton1", "newton0"};

// What may stand under the keys of a file that hold integers: the checks and the schema are made from these rows.
struct Range {
  const char* key;
  int Configuration::*value;
  int least, greatest;
  bool power_of_two;
  const char* meaning;
};
constexpr std::array<Range, 6> kRanges = {{
    {"warps", &Configuration::warps, 1, 32, true, "warps of a compute unit"},
    {"lanes", &Configuration::lanes, 1, 32, true, "lanes of an ALU, and threads in a warp"},
    {"stack_depth", &Configuration::stack_depth, 2, 32, false, "entries of a warp's PC stack"},
    {"instruction_cache.bytes", &Configuration::instruction_cache_bytes, 512, 65536, true, "size"},
    {"data_cache.bytes", &Configuration::data_cache_bytes, 512, 65536, true, "size"},
    {"data_cache.mshrs", &Configuration::data_cache_mshrs, 1, 16, false, "miss-status holding registers"},
}};
struct AluRange {
  const char* key;
  int AluConfiguration::*value;
  int least, greatest;
  const char* meaning;
};
constexpr std::array<AluRange, 3> kAluRanges = {{
    {"count", &AluConfiguration::count, 1, 4, "instances"},
    {"latency", &AluConfiguration::latency, 1, 16, "cycles between new tasks"},
    {"depth", &AluConfiguration::depth, 0, 32, "pipeline stages"},  // at least least_depth()
}};
constexpr const char* kNamePattern = "[A-Za-z0-9_.+-]{1,64}";
constexpr size_t kLongestName = 64;

constexpr int kLeastFusedDepth = 5;  // of flt, whose additions and multiplications go through the fused unit
constexpr std::array<int, 4> kLeastSlowDepths = {11, 11, 8, 6};  // of slw, by SlowUnit: each Newton step has its stages
bool is_fixed(size_t type) { return kAluTable[type].timed_by_events(); }

bool is_power_of_two(int value) { return value > 0 && (value & (value - 1)) == 0; }

void check_range(const std::string& where, const std::string& key, int value, int least, int greatest,
                 bool power_of_two = false) {
  if (value >= least && value <= greatest && (!power_of_two || is_power_of_two(value))) return;
  throw InputError(fmt::format("{}: {} is {}; it must be {} from {} to {}", where, key, value,
                               power_of_two ? "a power of two" : "an integer", least, greatest));
}

template <typename Names>
std::string join(const Names& names) {
  std::string text;
  for (const auto& name : names) text += (text.empty() ? "" : ", ") + std::string(name);
  return text;
}

/// One JSON object of a file: hands out its values and refuses keys that nobody asked for.
class Section {
 public:
  Section(const Json& json, std::string where, std::string prefix)
      : json_(json), where_(std::move(where)), prefix_(std::move(prefix)) {
    if (json_.is_object()) return;
    const std::string what = prefix_.empty() ? "the file" : prefix_.substr(0, prefix_.size() - 1);
    throw InputError(fmt::format("{}: {} must be an object in braces, not {}", where_, what, json_.dump()));
  }

  void integer(const char* key, int& value) {
    const Json* found = find(key);
    if (found == nullptr) return;
    // Beyond int the range check would see a wrapped value.
    if (!found->is_number_integer() || found->get<double>() < -2147483648.0 || found->get<double>() > 2147483647.0) {
      throw InputError(
          fmt::format("{}: {}{} is {}; it must be an integer without quotes", where_, prefix_, key, found->dump()));
    }
    value = found->get<int>();
  }
  void boolean(const char* key, bool& value) {
    const Json* found = find(key);
    if (found == nullptr) return;
    if (!found->is_boolean()) {
      throw InputError(fmt::format("{}: {}{} is {}; it must be true or false", where_, prefix_, key, found->dump()));
    }
    value = found->get<bool>();
  }
  void text(const char* key, std::string& value) {
    const Json* found = find(key);
    if (found == nullptr) return;
    if (!found->is_string())
      throw InputError(fmt::format("{}: {}{} is {}; it must be a text in quotes", where_, prefix_, key, found->dump()));
    value = found->get<std::string>();
  }
  template <typename Enum, typename Names>
  void choice(const char* key, const Names& names, Enum& value) {
    const Json* found = find(key);
    if (found == nullptr) return;
    for (size_t i = 0; i < names.size(); ++i) {
      if (found->is_string() && found->get<std::string>() == names[i]) {
        value = static_cast<Enum>(i);
        return;
      }
    }
    throw InputError(
        fmt::format("{}: {}{} is {}; it must be one of {}", where_, prefix_, key, found->dump(), join(names)));
  }
  std::optional<Section> section(const char* key) {
    const Json* found = find(key);
    if (found == nullptr) return std::nullopt;
    return Section(*found, where_, prefix_ + key + ".");
  }
  /// To be called when all known keys have been asked for.
  void refuse_others() const {
    for (const auto& item : json_.items()) {
      if (std::find(known_.begin(), known_.end(), item.key()) != known_.end()) continue;
      if (prefix_.empty() && item.key() == "cores")
        throw InputError(fmt::format("{}: 'cores' is called 'lanes': rename the key", where_));
      throw InputError(fmt::format("{}: unknown key {}{}; known here: {}", where_, prefix_, item.key(), join(known_)));
    }
  }

 private:
  const Json* find(const char* key) {
    known_.emplace_back(key);
    const auto found = json_.find(key);
    return found == json_.end() ? nullptr : &*found;
  }

  const Json& json_;
  std::string where_;
  std::string prefix_;
  std::vector<std::string> known_;
};

Configuration from_json(const Json& json, const std::string& where, const std::string& name) {
  Configuration configuration;
  configuration.name = name;
  Section root(json, where, "");
  root.text("name", configuration.name);
  root.integer("warps", configuration.warps);
  root.integer("lanes", configuration.lanes);
  root.integer("stack_depth", configuration.stack_depth);
  // First, as the depth that is not given follows it.
  if (auto arithmetic = root.section("arithmetic")) {
    arithmetic->choice("subnormals", kSubnormalNames, configuration.subnormals);
    arithmetic->choice("slow_unit", kSlowUnitNames, configuration.slow_unit);
    arithmetic->boolean("fma", configuration.fma);
    arithmetic->refuse_others();
  }
  for (const AluType type : {AluType::Flt, AluType::Slw})
    configuration.alus[static_cast<size_t>(type)].depth = least_depth(configuration, type);
  if (auto alus = root.section("alus")) {
    for (size_t type = 0; type < kAluTypes; ++type) {
      auto alu = alus->section(std::string(kAluNames[type]).c_str());
      if (!alu) continue;
      alu->integer("count", configuration.alus[type].count);
      if (!is_fixed(type)) {
        alu->integer("latency", configuration.alus[type].latency);
        alu->integer("depth", configuration.alus[type].depth);
      }
      alu->refuse_others();
    }
    alus->refuse_others();
  }
  if (auto cache = root.section("instruction_cache")) {
    cache->integer("bytes", configuration.instruction_cache_bytes);
    cache->refuse_others();
  }
  if (auto cache = root.section("data_cache")) {
    cache->integer("bytes", configuration.data_cache_bytes);
    cache->integer("mshrs", configuration.data_cache_mshrs);
    cache->refuse_others();
  }
  std::string schema;  // which editors follow
  root.text("$schema", schema);
  root.refuse_others();
  check_configuration(configuration, where);
  return configuration;
}

Configuration parse(const std::string& text, const std::string& where, const std::string& name) {
  return from_json(parse_json(text, where), where, name);
}

/// The name of a file without its folder and ending, with _ for what a configuration's name may not have.
std::string name_of_file(const fs::path& path) {
  static const std::regex kOther("[^A-Za-z0-9_.+-]");
  return std::regex_replace(path.stem().string(), kOther, "_").substr(0, kLongestName);
}

Configuration read_configuration(const fs::path& path) {
  return parse(read_file(path.string(), "configuration"), path.string(), name_of_file(path));
}

/// Where the project's own lie.
fs::path shipped_folder() { return fs::path(data_folder()) / "configs"; }

/// Folders in which a name is looked up, first match wins.
std::vector<fs::path> configuration_folders() {
  std::vector<fs::path> folders;
  if (const char* folder = std::getenv("RAYPOOL_CONFIGS"); folder != nullptr && *folder != '\0')
    folders.emplace_back(folder);
  folders.emplace_back("configs");
  folders.push_back(shipped_folder());
  return folders;
}

/// The defaults with N warps and M lanes, if that is what the name says.
std::optional<Configuration> warps_and_lanes(const std::string& name) {
  static const std::regex kWarpsAndLanes("([0-9]{1,4})w([0-9]{1,4})c");
  std::smatch match;
  if (!std::regex_match(name, match, kWarpsAndLanes)) return std::nullopt;
  Configuration configuration;
  configuration.name = name;
  configuration.warps = std::stoi(match[1]);
  configuration.lanes = std::stoi(match[2]);
  check_configuration(configuration, name);
  return configuration;
}

/// What everyone understands by a name: the project's own file, or NwMc.
std::optional<Configuration> built_in(const std::string& name) {
  const fs::path path = shipped_folder() / (name + ".json");
  if (fs::is_regular_file(path)) return read_configuration(path);
  return warps_and_lanes(name);
}

/// A file of other hardware must not go by a name that has a meaning: reports and folders would pass for the other's.
Configuration read_user_file(const fs::path& path) {
  Configuration configuration = read_configuration(path);
  if (built_in(configuration.name) && !is_built_in(configuration)) {
    throw InputError(
        fmt::format("{}: the name '{}' stands for other hardware (raypool config {}): give this one another \"name\"",
                    path.string(), configuration.name, configuration.name));
  }
  return configuration;
}

Configuration load(const std::string& name_or_path) {
  // A FIFO or device too, but a folder may bear the name of a configuration.
  std::error_code none;
  const fs::file_status status = fs::status(name_or_path, none);
  if (fs::exists(status) && !fs::is_directory(status)) return read_user_file(name_or_path);
  const bool is_name = !name_or_path.empty() && name_or_path.find('/') == std::string::npos;
  if (is_name) {
    for (const fs::path& folder : configuration_folders()) {
      const fs::path path = folder / (name_or_path + ".json");
      if (fs::is_regular_file(path, none)) return read_user_file(path);
    }
    if (const std::optional<Configuration> configuration = warps_and_lanes(name_or_path)) return *configuration;
  }
  throw InputError(
      fmt::format("no configuration '{}': give the path of a JSON file, the name of a file in configs/, or NwMc for N "
                  "warps of M lanes",
                  name_or_path));
}

}  // namespace

Configuration load_configuration(const std::string& name_or_path) {
  Configuration configuration = load(name_or_path);
  configuration.source = name_or_path;
  return configuration;
}

bool is_built_in(const Configuration& configuration) {
  const std::optional<Configuration> meant = built_in(configuration.name);
  return meant && verilog_parameters(*meant) == verilog_parameters(configuration);
}

Configuration parse_configuration(const std::string& json, const std::string& where) {
  return parse(json, where, Configuration().name);
}

int least_depth(const Configuration& configuration, AluType type) {
  if (type == AluType::Flt && configuration.fma) return kLeastFusedDepth;
  if (type == AluType::Slw) return kLeastSlowDepths.at(static_cast<size_t>(configuration.slow_unit));
  return alu_info(type).depth;
}

namespace {

int least_of(const AluRange& range, const Configuration& configuration, AluType type) {
  return range.value == &AluConfiguration::depth ? least_depth(configuration, type) : range.least;
}

Json schema_of(const Range& range) {
  Json schema = {{"description", range.meaning}, {"type", "integer"}};
  if (range.power_of_two) {
    for (int value = range.least; value <= range.greatest; value *= 2) schema["enum"].push_back(value);
  } else {
    schema["minimum"] = range.least;
    schema["maximum"] = range.greatest;
  }
  schema["default"] = Configuration().*range.value;
  return schema;
}

Json object_schema(const char* description) {
  return {{"description", description},
          {"type", "object"},
          {"additionalProperties", false},
          {"properties", Json::object()}};
}

Json alu_schema(AluType type) {
  Json schema = object_schema("an ALU type");
  if (is_fixed(static_cast<size_t>(type))) {
    schema["properties"]["count"] = {{"const", 1}};
    return schema;
  }
  Configuration shallowest;  // what other modes ask for is said by depth_rule
  shallowest.slow_unit = SlowUnit::Newton0;
  for (const AluRange& range : kAluRanges) {
    Json& entry = schema["properties"][range.key];
    entry = {{"description", range.meaning}, {"type", "integer"}};
    entry["minimum"] = least_of(range, shallowest, type);
    entry["maximum"] = range.greatest;
  }
  return schema;
}

/// If arithmetic.`key` is `value`, then the depth of `type` is that configuration's; with
/// `otherwise` also where the key is missing.
Json depth_rule(const char* key, const Json& value, const Configuration& configuration, AluType type, bool otherwise) {
  const std::string name(kAluNames[static_cast<size_t>(type)]);
  Json rule;
  rule["if"]["properties"]["arithmetic"]["properties"][key]["const"] = value;
  if (!otherwise) {
    rule["if"]["required"] = {"arithmetic"};
    rule["if"]["properties"]["arithmetic"]["required"] = {key};
  }
  rule["then"]["properties"]["alus"]["properties"][name]["properties"]["depth"]["minimum"] =
      least_depth(configuration, type);
  return rule;
}

}  // namespace

std::string configuration_schema() {
  Json schema =
      object_schema("hardware that raypool builds, simulates and synthesises; what is left out has its default");
  Json& keys = schema["properties"];
  keys["$schema"] = {{"type", "string"}};
  keys["name"] = {{"description", "as reports name it (default: that of the file)"},
                  {"type", "string"},
                  {"pattern", fmt::format("^{}$", kNamePattern)}};
  for (const Range& range : kRanges) {
    const std::string key = range.key;
    const size_t dot = key.find('.');
    if (dot == std::string::npos) {
      keys[key] = schema_of(range);
      continue;
    }
    Json& section = keys[key.substr(0, dot)];
    if (section.is_null()) section = object_schema("a cache");
    section["properties"][key.substr(dot + 1)] = schema_of(range);
  }
  keys["alus"] = object_schema("ALU types");
  for (size_t type = 0; type < kAluTypes; ++type)
    keys["alus"]["properties"][std::string(kAluNames[type])] = alu_schema(static_cast<AluType>(type));
  Json& arithmetic = keys["arithmetic"] = object_schema("what docs/numerics.md compares");
  arithmetic["properties"]["subnormals"] = {{"enum", kSubnormalNames}, {"default", kSubnormalNames[0]}};
  arithmetic["properties"]["slow_unit"] = {{"enum", kSlowUnitNames}, {"default", kSlowUnitNames[0]}};
  arithmetic["properties"]["fma"] = {
      {"description", "fused multiply-add: the instruction ffma"}, {"type", "boolean"}, {"default", false}};

  Configuration variant;
  for (size_t i = 0; i < kSlowUnitNames.size(); ++i) {
    variant.slow_unit = static_cast<SlowUnit>(i);
    schema["allOf"].push_back(depth_rule("slow_unit", kSlowUnitNames[i], variant, AluType::Slw, i == 0));
  }
  variant.fma = true;
  schema["allOf"].push_back(depth_rule("fma", true, variant, AluType::Flt, false));
  const Json head = {{"$schema", "http://json-schema.org/draft-07/schema#"}, {"title", "raypool configuration"}};
  Json whole = head;
  whole.update(schema);
  return whole.dump(2) + "\n";
}

void check_configuration(const Configuration& configuration, const std::string& where) {
  static const std::regex kName(kNamePattern);
  if (!std::regex_match(configuration.name, kName)) {
    throw InputError(fmt::format("{}: name is '{}'; it must have 1 to 64 characters out of letters, digits and _ . + -",
                                 where, configuration.name));
  }
  for (const Range& range : kRanges)
    check_range(where, range.key, configuration.*range.value, range.least, range.greatest, range.power_of_two);
  for (size_t type = 0; type < kAluTypes; ++type) {
    const AluConfiguration& alu = configuration.alus[type];
    const std::string prefix = "alus." + std::string(kAluNames[type]) + ".";
    if (is_fixed(type)) {
      if (alu.count == 1) continue;
      throw InputError(fmt::format("{}: {}count is {}; it must be 1, because this unit owns the {}", where, prefix,
                                   alu.count,
                                   static_cast<AluType>(type) == AluType::Mem ? "data cache" : "ray memory"));
    }
    for (const AluRange& range : kAluRanges) {
      check_range(where, prefix + range.key, alu.*range.value,
                  least_of(range, configuration, static_cast<AluType>(type)), range.greatest);
    }
  }
  if (static_cast<size_t>(configuration.subnormals) >= kSubnormalNames.size()) {
    throw InputError(fmt::format("{}: arithmetic.subnormals must be one of {}", where, join(kSubnormalNames)));
  }
  if (static_cast<size_t>(configuration.slow_unit) >= kSlowUnitNames.size()) {
    throw InputError(fmt::format("{}: arithmetic.slow_unit must be one of {}", where, join(kSlowUnitNames)));
  }
}

std::string to_json(const Configuration& configuration) {
  Json json;
  json["name"] = configuration.name;
  json["warps"] = configuration.warps;
  json["lanes"] = configuration.lanes;
  json["stack_depth"] = configuration.stack_depth;
  for (size_t type = 0; type < kAluTypes; ++type) {
    const AluConfiguration& alu = configuration.alus[type];
    Json& entry = json["alus"][std::string(kAluNames[type])];
    entry["count"] = alu.count;
    if (is_fixed(type)) continue;
    entry["latency"] = alu.latency;
    entry["depth"] = alu.depth;
  }
  json["instruction_cache"]["bytes"] = configuration.instruction_cache_bytes;
  json["data_cache"] = {{"bytes", configuration.data_cache_bytes}, {"mshrs", configuration.data_cache_mshrs}};
  json["arithmetic"] = {{"subnormals", kSubnormalNames[static_cast<size_t>(configuration.subnormals)]},
                        {"slow_unit", kSlowUnitNames[static_cast<size_t>(configuration.slow_unit)]},
                        {"fma", configuration.fma}};
  return json.dump(2);
}

std::vector<std::pair<std::string, int>> verilog_parameters(const Configuration& configuration) {
  std::vector<std::pair<std::string, int>> parameters = {
      {"WARPS", configuration.warps}, {"LANES", configuration.lanes}, {"STACK_DEPTH", configuration.stack_depth}};
  struct Column {
    const char* suffix;
    int AluConfiguration::*value;
  };
  for (const Column& column :
       {Column{"_COUNT", &AluConfiguration::count}, Column{"_LATENCY", &AluConfiguration::latency},
        Column{"_DEPTH", &AluConfiguration::depth}}) {
    for (size_t type = 0; type < kAluTypes; ++type) {
      if (is_fixed(type)) continue;
      parameters.emplace_back(verilog_name(static_cast<AluType>(type)) + column.suffix,
                              configuration.alus[type].*column.value);
    }
  }
  parameters.emplace_back("ICACHE_BYTES", configuration.instruction_cache_bytes);
  parameters.emplace_back("DCACHE_BYTES", configuration.data_cache_bytes);
  parameters.emplace_back("DCACHE_MSHRS", configuration.data_cache_mshrs);
  parameters.emplace_back("SUBNORMALS", static_cast<int>(configuration.subnormals));
  parameters.emplace_back("SLOW_UNIT", static_cast<int>(configuration.slow_unit));
  parameters.emplace_back("FMA", configuration.fma ? 1 : 0);
  return parameters;
}

}  // namespace raypool
