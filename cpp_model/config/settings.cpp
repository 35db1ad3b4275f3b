#include "config/settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <sstream>

#include "isa/did_you_mean.hpp"

namespace raypool {

using Json = nlohmann::ordered_json;

namespace {

constexpr const char* kName = "name";

struct Assignment {
  std::string path, value;
};

/// Of a path that may lack sections at its beginning, and of a section that stands for its fields.
size_t distance_of_path(std::string_view given, std::string_view path) {
  size_t least = SIZE_MAX, missing = 0;
  for (size_t begin = 0; begin != std::string_view::npos; begin = path.find('.', begin)) {
    if (begin != 0) ++begin;
    for (size_t end = path.find('.', begin);; end = path.find('.', end + 1)) {
      least = std::min(least, missing + spelling_distance(given, path.substr(begin, end - begin)));
      if (end == std::string_view::npos) break;
    }
    missing = 1;
  }
  return least;
}

/// As the Verilog names its parameters: DATA_CACHE_BYTES.
std::string verilog_name(std::string path) {
  for (char& letter : path)
    letter = letter == '.' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(letter)));
  return path;
}

/// Those with the least distance; the one that has this name in the Verilog.
std::vector<std::string> nearest_fields(std::string_view given) {
  std::vector<std::string> paths = {kName}, nearest;
  for (const ConfigurationField& field : fields()) paths.push_back(field.path);
  for (const std::string& path : paths)
    if (verilog_name(path) == given) return {path};
  size_t least = SIZE_MAX;
  for (const std::string& path : paths) {
    const size_t distance = distance_of_path(given, path);
    if (distance > least || !is_misspelling(given, distance)) continue;
    if (distance < least) nearest.clear();
    least = distance;
    nearest.push_back(path);
  }
  return nearest;
}

[[noreturn]] void refuse_unknown(const std::string& path) {
  throw InputError(fmt::format("--set: there is no field '{}'{}", path,
                               did_you_mean(nearest_fields(path), "raypool config prints all")));
}

std::vector<Assignment> assignments(const std::vector<std::string>& texts) {
  std::vector<Assignment> all;
  for (const std::string& text : texts) {
    std::istringstream words(text);
    for (std::string word; words >> word;) {
      const size_t sign = word.find('=');
      if (sign == std::string::npos)
        throw InputError(fmt::format("--set {}: write FIELD=VALUE, such as data_cache.bytes=4096", word));
      all.push_back({word.substr(0, sign), word.substr(sign + 1)});
    }
  }
  return all;
}

std::string with_blanks(std::string text) {
  std::replace(text.begin(), text.end(), ',', ' ');
  return text;
}

Json parse_value(const ConfigurationField& field, const std::string& text) {
  int number = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, number);
  switch (field.range.form) {
    case Range::Form::Integer:
    case Range::Form::PowerOfTwo:
      if (!text.empty() && error == std::errc() && rest == end) return number;
      break;
    case Range::Form::OnOff:
      if (text == "true" || text == "false") return text == "true";
      break;
    case Range::Form::Name: {
      const std::vector<std::string_view> names = names_of(field.range);
      if (std::find(names.begin(), names.end(), text) != names.end()) return text;
      const std::vector<std::string> nearest = nearest_names(text, {names.begin(), names.end()});
      if (nearest.empty()) break;
      throw InputError(fmt::format("--set {}={}{}", field.path, text,
                                   did_you_mean(nearest, fmt::format("it must be {}", text_of(field.range)))));
    }
    case Range::Form::Instructions: {  // imul,sar; nothing: none. Reading the file checks their names
      Json list = Json::array();
      std::istringstream names(text);
      for (std::string name; std::getline(names, name, ',');) list.push_back(name);
      return list;
    }
  }
  if (text.find(',') != std::string::npos && text.find('=') != std::string::npos) {
    throw InputError(fmt::format("--set {}={}: put blanks between fields, not commas: \"{}={}\"", field.path, text,
                                 field.path, with_blanks(text)));
  }
  throw InputError(fmt::format("--set {}={}: {} must be {}", field.path, text, field.path, text_of(field.range)));
}

}  // namespace

Json::json_pointer pointer_to(std::string path) {
  std::replace(path.begin(), path.end(), '.', '/');
  return Json::json_pointer("/" + path);
}

std::vector<ConfigurationField> fields() {
  std::vector<ConfigurationField> all;
  for (const Parameter& parameter : parameter::kAll) all.push_back({path_of(parameter), parameter.range});
  for (const AluType alu : kEveryAluType) {
    for (const AluParameter& parameter : parameter::kOfAlu) {
      if (!applies(parameter, alu)) continue;
      Range range = range_of(parameter, alu);
      if (alu_info(alu).timed_by_events()) range.greatest = range.least;
      all.push_back({fmt::format("alus.{}.{}", alu_info(alu).name, parameter.key), range});
    }
  }
  for (const Parameter& parameter : parameter::kOfChip) all.push_back({path_of(parameter), parameter.range});
  return all;
}

void set_fields(Json& json, const std::vector<std::string>& texts) {
  const std::vector<ConfigurationField> all = fields();
  for (const Assignment& assignment : assignments(texts)) {
    if (assignment.path == kName) {
      json[kName] = assignment.value;
      continue;
    }
    const auto field = std::find_if(all.begin(), all.end(),
                                    [&](const ConfigurationField& each) { return each.path == assignment.path; });
    if (field == all.end()) refuse_unknown(assignment.path);
    json[pointer_to(field->path)] = parse_value(*field, assignment.value);
  }
}

std::vector<std::string> paths_set(const std::vector<std::string>& texts) {
  const std::vector<Assignment> given = assignments(texts);
  std::vector<std::string> paths;
  const auto add = [&](const std::string& path) {
    if (std::any_of(given.begin(), given.end(), [&](const Assignment& each) { return each.path == path; }))
      paths.push_back(path);
  };
  add(kName);
  for (const ConfigurationField& field : fields()) add(field.path);
  return paths;
}

std::string value_text(const Json& configuration, const std::string& path) {
  const Json& value = configuration.at(pointer_to(path));
  if (value.is_array()) return fmt::format("{}", fmt::join(value.get<std::vector<std::string>>(), "_"));
  return value.is_string() ? value.get<std::string>() : value.dump();
}

}  // namespace raypool
