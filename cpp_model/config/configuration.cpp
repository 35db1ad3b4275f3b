// Reads, checks and writes configurations.
#include "config/configuration.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <regex>
#include <set>

#include "config/data_folder.hpp"
#include "config/parameter_table.hpp"
#include "config/settings.hpp"
#include "files/input_file.hpp"
#include "files/json_text.hpp"
#include "isa/did_you_mean.hpp"

namespace raypool {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::string_view kChip = "chip";  // the object of a file

constexpr uint32_t kLeastFusedDepth = 5;  // of flt: additions and multiplications go through the fused unit
constexpr EnumArray<SlowUnit, uint32_t, 4> kLeastSlowDepths = {11, 11, 8, 6};  // of slw: Newton steps have stages

/// Of a parameter a negative value is here what it was in the file.
void check_range(const std::string& where, const std::string& key, int value, const Range& range) {
  if (!range.has(value))
    throw InputError(fmt::format("{}: {} is {}; it must be {}", where, key, value, text_of(range)));
}

/// One JSON object of a file: hands out its values and refuses keys that are never asked for.
class Section {
 public:
  Section(const Json& json, std::string where, std::string prefix)
      : json_(json), where_(std::move(where)), prefix_(std::move(prefix)) {
    if (json_.is_object()) return;
    const std::string what = prefix_.empty() ? "the file" : prefix_.substr(0, prefix_.size() - 1);
    throw InputError(fmt::format("{}: {} must be an object in braces, not {}", where_, what, json_.dump()));
  }

  std::optional<int> integer(std::string_view key) {
    const Json* found = find(key);
    if (found == nullptr) return std::nullopt;
    // Beyond int the range check would see a wrapped value.
    if (!found->is_number_integer() || found->get<double>() < -2147483648.0 || found->get<double>() > 2147483647.0) {
      throw InputError(
          fmt::format("{}: {}{} is {}; it must be an integer without quotes", where_, prefix_, key, found->dump()));
    }
    return found->get<int>();
  }
  /// The value of a parameter, if it is there.
  void read(const Parameter& parameter, Configuration& configuration) {
    int value = parameter.get(configuration);
    switch (parameter.range.form) {
      case Range::Form::Integer:
      case Range::Form::PowerOfTwo:
        value = integer(parameter.key).value_or(value);
        break;
      case Range::Form::Name:
        choice(parameter, value);
        break;
      case Range::Form::OnOff:
        boolean(parameter, value);
        break;
      case Range::Form::Instructions:
        throw std::logic_error("only an ALU type lacks instructions");
    }
    parameter.set(configuration, value);
  }
  /// The value of a parameter of the ALU type, if it is there.
  void read(const AluParameter& parameter, AluType type, Configuration& configuration) {
    uint32_t& value = configuration.alus[type].*parameter.value;
    if (parameter.range.form == Range::Form::Instructions)
      instructions(parameter.key, range_of(parameter, type), value);
    else
      value = integer(parameter.key).value_or(value);
  }
  void text(std::string_view key, std::string& value) {
    const Json* found = find(key);
    if (found == nullptr) return;
    if (!found->is_string())
      throw InputError(fmt::format("{}: {}{} is {}; it must be a text in quotes", where_, prefix_, key, found->dump()));
    value = found->get<std::string>();
  }
  std::optional<Section> section(std::string_view key) {
    const Json* found = find(key);
    if (found == nullptr) return std::nullopt;
    return Section(*found, where_, fmt::format("{}{}.", prefix_, key));
  }
  /// To be called when all known keys have been asked for.
  void refuse_others() const {
    for (const auto& item : json_.items()) {
      if (std::find(known_.begin(), known_.end(), item.key()) != known_.end()) continue;
      if (prefix_.empty() && item.key() == "cores")
        throw InputError(fmt::format("{}: 'cores' is called 'lanes': rename the key", where_));
      const std::string advice = fmt::format("known here: {}", fmt::join(known_, ", "));
      throw InputError(
          fmt::format("{}: unknown key {}{}{}", where_, prefix_, item.key(), did_you_mean(item.key(), known_, advice)));
    }
  }

 private:
  void boolean(const Parameter& parameter, int& value) {
    const Json* found = find(parameter.key);
    if (found == nullptr) return;
    if (!found->is_boolean()) refuse(parameter, *found);
    value = found->get<bool>() ? 1 : 0;
  }
  void instructions(std::string_view key, const Range& range, uint32_t& value) {
    const Json* found = find(key);
    if (found == nullptr) return;
    const auto refuse = [&](const Json& what, const std::string& end) {
      throw InputError(fmt::format("{}: {}{} has {}{}", where_, prefix_, key, what.dump(), end));
    };
    if (!found->is_array()) refuse(*found, fmt::format("; it must be {}", text_of(range)));
    value = 0;
    for (const Json& each : *found) {
      const auto operation = each.is_string() ? operation_named(range, each.get<std::string>()) : std::nullopt;
      if (!operation) refuse(each, must_be(range, each));
      value |= 1u << *operation;
    }
  }
  void choice(const Parameter& parameter, int& value) {
    const Json* found = find(parameter.key);
    if (found == nullptr) return;
    const auto names = names_of(parameter.range);
    const auto name = std::find(names.begin(), names.end(), found->is_string() ? found->get<std::string>() : "");
    if (name == names.end()) refuse(parameter, *found);
    value = static_cast<int>(name - names.begin());
  }
  [[noreturn]] void refuse(const Parameter& parameter, const Json& found) const {
    throw InputError(
        fmt::format("{}: {} is {}{}", where_, path_of(parameter), found.dump(), must_be(parameter.range, found)));
  }
  /// The end of a refusal; of names it asks for the nearest.
  static std::string must_be(const Range& range, const Json& found) {
    const std::string advice = fmt::format("it must be {}", text_of(range));
    const bool named = range.form == Range::Form::Name || range.form == Range::Form::Instructions;
    if (!named || !found.is_string()) return "; " + advice;
    const std::vector<std::string_view> names = names_of(range);
    return did_you_mean(found.get<std::string>(), {names.begin(), names.end()}, advice);
  }
  const Json* find(std::string_view key) {
    known_.emplace_back(key);
    const auto found = json_.find(key);
    return found == json_.end() ? nullptr : &*found;
  }

  const Json& json_;
  std::string where_;
  std::string prefix_;
  std::vector<std::string> known_;
};

template <size_t count>
void read_section(Section& section, const Parameter (&rows)[count], std::string_view name,
                  Configuration& configuration) {
  for (const Parameter& parameter : rows)
    if (parameter.section == name) section.read(parameter, configuration);
}

/// Fields of the chip that are not set follow those that are: as many pixels are held as fit into the intersection
/// pool.
void read_chip(Section& chip, Configuration& configuration) {
  for (const std::string_view name : chip_sections()) {
    if (name == kChip) continue;
    auto part = chip.section(name.substr(kChip.size() + 1));
    if (!part) continue;
    read_section(*part, parameter::kOfChip, name, configuration);
    part->refuse_others();
  }
  configuration.chip.held_limit = configuration.chip.intersection_pool_size;
  read_section(chip, parameter::kOfChip, kChip, configuration);
  chip.refuse_others();
}

Configuration from_json(const Json& json, const std::string& where, const std::string& name) {
  Configuration configuration;
  configuration.name = name;
  Section root(json, where, "");
  root.text("name", configuration.name);
  read_section(root, parameter::kAll, "", configuration);
  // Before the ALUs, as the depth that is not given follows the arithmetic.
  for (const std::string_view name_of_section : sections()) {
    auto section = root.section(name_of_section);
    if (!section) continue;
    read_section(*section, parameter::kAll, name_of_section, configuration);
    section->refuse_others();
  }
  for (const AluType type : {AluType::Flt, AluType::Slw})
    configuration.alus[type].depth = least_depth(configuration, type);
  if (auto alus = root.section("alus")) {
    for (const AluType type : kEveryAluType) {
      auto alu = alus->section(kAluNames[type]);
      if (!alu) continue;
      for (const AluParameter& parameter : parameter::kOfAlu)
        if (applies(parameter, type)) alu->read(parameter, type, configuration);
      alu->refuse_others();
    }
    alus->refuse_others();
  }
  if (auto chip = root.section(kChip)) read_chip(*chip, configuration);
  std::string schema;  // which editors follow
  root.text("$schema", schema);
  root.refuse_others();
  check_configuration(configuration, where);
  return configuration;
}

/// What a configuration is made of.
struct Source {
  Json json;
  std::string where, name;  ///< that messages show; its name unless it gives another
};

Configuration made_of(const Source& source) { return from_json(source.json, source.where, source.name); }

Source source_of(const fs::path& path) {
  return {parse_json(read_text_file(path.string(), "configuration"), path.string()), path.string(),
          name_of_file(path.string())};
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

/// Those of the files in them, each once.
std::vector<std::string> configuration_names() {
  std::set<std::string> names;
  std::error_code none;
  for (const fs::path& folder : configuration_folders())
    for (const auto& entry : fs::directory_iterator(folder, none))
      if (entry.path().extension() == ".json") names.insert(entry.path().stem());
  return {names.begin(), names.end()};
}

/// N warps and M lanes, if that is what the name says, of the defaults (NwMc) or of a file in one of the folders
/// (best_NwMc: of best.json).
std::optional<Source> warps_and_lanes(const std::string& name, const std::vector<fs::path>& folders) {
  static const std::regex kWarpsAndLanes("(?:([A-Za-z][A-Za-z0-9]*)_)?([0-9]{1,4})w([0-9]{1,4})c");
  std::smatch match;
  if (!std::regex_match(name, match, kWarpsAndLanes)) return std::nullopt;
  Source source{Json::object(), name, name};
  if (match[1].matched) {
    const auto file = [&](const fs::path& folder) { return folder / (match[1].str() + ".json"); };
    const auto folder = std::find_if(folders.begin(), folders.end(),
                                     [&](const fs::path& each) { return fs::is_regular_file(file(each)); });
    if (folder == folders.end()) return std::nullopt;
    source = source_of(file(*folder));
    source.json["name"] = name;
  }
  source.json["warps"] = std::stoi(match[2]);
  source.json["lanes"] = std::stoi(match[3]);
  return source;
}

/// What everyone understands by a name: the project's own file, NwMc, or such a file's.
std::optional<Configuration> built_in(const std::string& name) {
  const fs::path path = shipped_folder() / (name + ".json");
  if (fs::is_regular_file(path)) return made_of(source_of(path));
  const std::optional<Source> source = warps_and_lanes(name, {shipped_folder()});
  return source ? std::optional(made_of(*source)) : std::nullopt;
}

/// Other hardware must not go by a name that has a meaning: reports and folders would pass for the other's.
void check_name(const Configuration& configuration, const std::string& where) {
  if (!built_in(configuration.name) || is_built_in(configuration)) return;
  throw InputError(
      fmt::format("{}: the name '{}' stands for other hardware (raypool config {}): give this one another \"name\"",
                  where, configuration.name, configuration.name));
}

Source find_source(const std::string& name_or_path) {
  // A FIFO or device too, but a folder may bear the name of a configuration.
  std::error_code none;
  const fs::file_status status = fs::status(name_or_path, none);
  if (fs::exists(status) && !fs::is_directory(status)) return source_of(name_or_path);
  const bool is_name = !name_or_path.empty() && name_or_path.find('/') == std::string::npos;
  if (is_name) {
    for (const fs::path& folder : configuration_folders()) {
      const fs::path path = folder / (name_or_path + ".json");
      if (fs::is_regular_file(path, none)) return source_of(path);
    }
    if (const std::optional<Source> source = warps_and_lanes(name_or_path, configuration_folders())) return *source;
  }
  throw InputError(fmt::format(
      "no configuration '{}'{}", name_or_path,
      did_you_mean(name_or_path, is_name ? configuration_names() : std::vector<std::string>(),
                   "give the path of a JSON file, the name of a file in configs/, NwMc for N warps of M lanes, or "
                   "best_NwMc")));
}

/// "8w8c+alus.flt.count-2": the name of a machine of which fields have been set, unless they had these values.
std::string name_with(const Configuration& base, const Configuration& changed, const std::vector<std::string>& set) {
  const Json before = Json::parse(to_json(base)), after = Json::parse(to_json(changed));
  std::string name = base.name;
  int changes = 0;
  for (const std::string& path : paths_set(set)) {
    const std::string value = value_text(after, path);
    if (value == value_text(before, path)) continue;
    name += fmt::format("+{}-{}", path, value);
    ++changes;
  }
  if (name.size() <= kLongestName) return name;
  const std::string end = fmt::format("+{}_changes", changes);
  return base.name.substr(0, kLongestName - end.size()) + end;
}

Configuration changed(const Source& source, const Configuration& base, const std::vector<std::string>& set) {
  Source other = source;
  other.where += fmt::format(" with --set {}", fmt::join(set, " "));
  set_fields(other.json, set);
  Configuration configuration = made_of(other);
  const std::vector<std::string> paths = paths_set(set);
  if (std::find(paths.begin(), paths.end(), "name") == paths.end())
    configuration.name = name_with(base, configuration, set);
  check_name(configuration, other.where);
  return configuration;
}

}  // namespace

std::string name_of_file(const std::string& path) {
  static const std::regex kOther("[^A-Za-z0-9_.+-]");
  return std::regex_replace(fs::path(path).stem().string(), kOther, "_").substr(0, kLongestName);
}

Configuration load_configuration(const std::string& name_or_path, const std::vector<std::string>& set) {
  const Source source = find_source(name_or_path);
  Configuration configuration = made_of(source);
  check_name(configuration, source.where);
  if (!set.empty()) configuration = changed(source, configuration, set);
  configuration.source = name_or_path;
  configuration.set = set;
  return configuration;
}

bool is_built_in(const Configuration& configuration) {
  std::optional<Configuration> meant = built_in(configuration.name);
  if (!meant) return false;
  meant->name = configuration.name;
  return to_json(*meant) == to_json(configuration);
}

Configuration parse_configuration(const std::string& json, const std::string& where) {
  return from_json(parse_json(json, where), where, Configuration().name);
}

uint32_t least_depth(const Configuration& configuration, AluType type) {
  if (type == AluType::Flt && configuration.fma) return kLeastFusedDepth;
  if (type == AluType::Slw) return kLeastSlowDepths[configuration.slow_unit];
  return alu_info(type).depth;
}

uint32_t tile_width_log2(uint32_t contents) {
  uint32_t log2 = 0;
  while ((1u << log2) < contents) ++log2;
  return (log2 + 1) / 2;
}

namespace {

/// What of the parameters of the traverser its modules check, in sentences.
void check_hardware_traverser(const ChipConfiguration& chip, const std::string& where) {
  const auto refuse = [&where](const char* key, const auto& value, const std::string& must) {
    throw InputError(fmt::format("{}: chip.hardware_traverser.{} is {}; it must be {}", where, key, value, must));
  };
  constexpr uint32_t kMostSlots = 256, kMostMshrsOfABank = 32;
  constexpr uint32_t kLine = 64;
  const uint32_t lanes = chip.hardware_traverser_lanes, rays = chip.hardware_traverser_rays;
  if (rays % lanes != 0 || rays / lanes > kMostSlots) {
    refuse("rays", rays,
           fmt::format("a multiple of lanes, which is {}, and at most {} for each of them", lanes, kMostSlots));
  }
  if (chip.hardware_traverser_triangle_pipes > lanes) {
    refuse("triangle_pipes", chip.hardware_traverser_triangle_pipes, fmt::format("at most {}, which is lanes", lanes));
  }
  const uint32_t banks = chip.hardware_traverser_cache_banks;
  const auto check_cache = [&](const std::string& cache, uint32_t bytes, uint32_t ways, uint32_t mshrs) {
    if (bytes < 2 * ways * banks * kLine) {
      refuse((cache + "_bytes").c_str(), bytes,
             fmt::format("at least {}: two sets of {} ways of {} bytes in each of {} banks", 2 * ways * banks * kLine,
                         ways, kLine, banks));
    }
    if (mshrs % banks != 0 || mshrs > kMostMshrsOfABank * banks) {
      refuse(
          (cache + "_mshrs").c_str(), mshrs,
          fmt::format("a multiple of cache_banks, which is {}, and at most {} in each bank", banks, kMostMshrsOfABank));
    }
  };
  check_cache("node_cache", chip.hardware_traverser_node_cache_bytes, chip.hardware_traverser_node_cache_ways,
              chip.hardware_traverser_node_cache_mshrs);
  check_cache("triangle_cache", chip.hardware_traverser_triangle_cache_bytes,
              chip.hardware_traverser_triangle_cache_ways, chip.hardware_traverser_triangle_cache_mshrs);
}

/// A row of an eye tile is held at once, and what is held must find room in the intersection pool.
void check_chip(const Configuration& configuration, const std::string& where) {
  for (const Parameter& parameter : parameter::kOfChip)
    check_range(where, path_of(parameter), parameter.get(configuration), parameter.range);
  const uint32_t width = 1u << tile_width_log2(configuration.contents());
  const ChipConfiguration& chip = configuration.chip;
  if (chip.intersection_pool_size < width) {
    throw InputError(
        fmt::format("{}: chip.intersection_pool.size is {}; with {} contents it must be at least {}, the "
                    "width of a tile",
                    where, chip.intersection_pool_size, configuration.contents(), width));
  }
  if (chip.held_limit < width || chip.held_limit > chip.intersection_pool_size) {
    throw InputError(
        fmt::format("{}: chip.held_limit is {}; it must be from {}, the width of a tile of {} contents, to "
                    "{}, which is chip.intersection_pool.size",
                    where, chip.held_limit, width, configuration.contents(), chip.intersection_pool_size));
  }
  if (chip.miss_records && chip.culling) {
    throw InputError(
        fmt::format("{}: chip.miss_records and chip.culling are both true, but culling drops rays that would have to "
                    "return: set one of them to false",
                    where));
  }
  if (chip.traverser == TraverserName::Hardware) check_hardware_traverser(chip, where);
}

}  // namespace

void check_configuration(const Configuration& configuration, const std::string& where) {
  static const std::regex kName(kNamePattern);
  if (!std::regex_match(configuration.name, kName)) {
    throw InputError(fmt::format("{}: name is '{}'; it must have 1 to 64 characters out of letters, digits and _ . + -",
                                 where, configuration.name));
  }
  for (const Parameter& parameter : parameter::kAll)
    check_range(where, path_of(parameter), parameter.get(configuration), parameter.range);
  for (const AluType type : kEveryAluType) {
    const AluConfiguration& alu = configuration.alus[type];
    const std::string prefix = fmt::format("alus.{}.", kAluNames[type]);
    if (alu_info(type).timed_by_events()) {
      if (alu.count == 1) continue;
      throw InputError(fmt::format("{}: {}count is {}; it must be 1, because this unit owns the {}", where, prefix,
                                   alu.count, type == AluType::Mem ? "data cache" : "ray memory"));
    }
    for (const AluParameter& parameter : parameter::kOfAlu) {
      if (!applies(parameter, type)) continue;
      check_range(where, prefix + std::string(parameter.key), alu.*parameter.value,
                  range_of(parameter, type, configuration));
    }
  }
  check_chip(configuration, where);
}

namespace {

template <size_t count>
void put(Json& object, const Parameter (&rows)[count], std::string_view section, const Configuration& configuration) {
  for (const Parameter& parameter : rows)
    if (parameter.section == section)
      object[std::string(parameter.key)] = json_of(parameter, parameter.get(configuration));
}

}  // namespace

std::string to_json(const Configuration& configuration) {
  Json json;
  json["name"] = configuration.name;
  put(json, parameter::kAll, "", configuration);
  for (const AluType type : kEveryAluType) {
    Json& entry = json["alus"][std::string(kAluNames[type])];
    for (const AluParameter& parameter : parameter::kOfAlu)
      if (applies(parameter, type))
        entry[std::string(parameter.key)] =
            json_of(range_of(parameter, type), configuration.alus[type].*parameter.value);
  }
  for (const std::string_view section : sections())
    put(json[std::string(section)], parameter::kAll, section, configuration);
  Json& chip = json[std::string(kChip)];
  for (const std::string_view section : chip_sections()) {
    Json& object = section == kChip ? chip : chip[std::string(section.substr(kChip.size() + 1))];
    put(object, parameter::kOfChip, section, configuration);
  }
  return json.dump(2);
}

std::vector<std::pair<std::string, int>> verilog_parameters(const Configuration& configuration) {
  std::vector<std::pair<std::string, int>> parameters;
  const auto add = [&](bool in_section) {
    for (const Parameter& parameter : parameter::kAll)
      if (parameter.section.empty() != in_section)
        parameters.emplace_back(verilog_name(parameter), parameter.get(configuration));
  };
  add(false);
  for (const AluParameter& parameter : parameter::kOfAlu) {
    for (const AluType type : kEveryAluType) {
      if (alu_info(type).timed_by_events() || !applies(parameter, type)) continue;
      parameters.emplace_back(verilog_name(type, parameter), configuration.alus[type].*parameter.value);
    }
  }
  add(true);
  return parameters;
}

namespace {

/// Whether rtl/chip/rp_chip.v has it by its own name: which kernels there are is its host's business, and the traverser
/// is hardware_traverser_parameters().
bool is_of_chip_verilog(const Parameter& parameter) {
  static constexpr std::string_view kNot[] = {"traverser",    "reflections",      "static_traverser_stall_cycles",
                                              "memory_banks", "memory_row_bytes", "memory_row_miss"};
  return parameter.section != "chip.hardware_traverser" &&
         std::find(std::begin(kNot), std::end(kNot), parameter.name) == std::end(kNot);
}

/// Of rtl/traverser/rp_traverser.v in rtl/chip/rp_chip.v. A chip that has it outside has its sizes as they are by
/// default, so that its Verilog does not depend on them.
std::vector<std::pair<std::string, int>> hardware_traverser_parameters(const ChipConfiguration& chip) {
  constexpr uint32_t kLine = 64;
  const bool inside = chip.traverser == TraverserName::Hardware;
  const ChipConfiguration sizes = inside ? chip : ChipConfiguration();
  const uint32_t lanes = sizes.hardware_traverser_lanes;
  std::vector<std::pair<std::string, int>> parameters = {{"TRAVERSER", inside ? 1 : 0}};
  for (const auto& [name, value] : std::initializer_list<std::pair<const char*, uint32_t>>{
           {"LANES", lanes},
           {"SLOTS", sizes.hardware_traverser_rays / lanes},
           {"ENTRIES", sizes.hardware_traverser_stack_entries},
           {"BITS", sizes.hardware_traverser_box_bits},
           {"TRIANGLE_PIPES", sizes.hardware_traverser_triangle_pipes},
           {"BANKS", sizes.hardware_traverser_cache_banks},
           {"NODE_LINES", sizes.hardware_traverser_node_cache_bytes / kLine},
           {"NODE_WAYS", sizes.hardware_traverser_node_cache_ways},
           {"NODE_MSHRS", sizes.hardware_traverser_node_cache_mshrs},
           {"TRIANGLE_LINES", sizes.hardware_traverser_triangle_cache_bytes / kLine},
           {"TRIANGLE_WAYS", sizes.hardware_traverser_triangle_cache_ways},
           {"TRIANGLE_MSHRS", sizes.hardware_traverser_triangle_cache_mshrs}})
    parameters.emplace_back(std::string("TRAVERSER_") + name, static_cast<int>(value));
  return parameters;
}

}  // namespace

std::vector<std::pair<std::string, int>> chip_verilog_parameters(const Configuration& configuration, int units) {
  std::vector<std::pair<std::string, int>> parameters = {{"UNITS", units}};
  for (auto& of_unit : verilog_parameters(configuration)) parameters.push_back(std::move(of_unit));
  for (const Parameter& parameter : parameter::kOfChip)
    if (is_of_chip_verilog(parameter)) parameters.emplace_back(verilog_name(parameter), parameter.get(configuration));
  parameters.emplace_back("TRAVERSER_QUEUE", static_cast<int>(tree_requests(configuration.chip)));
  for (auto& of_traverser : hardware_traverser_parameters(configuration.chip))
    parameters.push_back(std::move(of_traverser));
  return parameters;
}

}  // namespace raypool
