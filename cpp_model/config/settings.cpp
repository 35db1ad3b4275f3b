#include "config/settings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <numeric>
#include <sstream>

namespace raypool {

using Json = nlohmann::ordered_json;

namespace {

constexpr const char* kName = "name";
constexpr size_t kNearest = 3;  // fields that a sentence names

struct Assignment {
  std::string path, value;
};

/// How many letters must be changed, added or taken away to make `b` of `a`.
size_t distance(std::string_view a, std::string_view b) {
  std::vector<size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), size_t{0});
  for (size_t i = 0; i < a.size(); ++i) {
    size_t corner = row[0]++;
    for (size_t j = 0; j < b.size(); ++j)
      corner = std::exchange(row[j + 1], std::min({corner + (a[i] != b[j]), row[j] + 1, row[j + 1] + 1}));
  }
  return row[b.size()];
}

/// Of a path that may lack its beginning.
size_t distance_of_path(const std::string& given, const std::string& path) {
  size_t least = distance(given, path);
  for (size_t dot = path.find('.'); dot != std::string::npos; dot = path.find('.', dot + 1))
    least = std::min(least, 1 + distance(given, std::string_view(path).substr(dot + 1)));
  // Of a group all fields are near.
  return path.compare(0, given.size() + 1, given + ".") == 0 ? 0 : least;
}

[[noreturn]] void refuse_unknown(const std::string& path) {
  std::vector<std::string> names = {kName};
  for (const ConfigurationField& field : fields()) names.push_back(field.path);
  std::stable_sort(names.begin(), names.end(), [&](const std::string& a, const std::string& b) {
    return distance_of_path(path, a) < distance_of_path(path, b);
  });
  names.resize(kNearest);
  throw InputError(fmt::format("--set: there is no field '{}'; near to it are {}; raypool config prints all", path,
                               fmt::join(names, ", ")));
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
      break;
    }
    case Range::Form::Instructions: {  // imul,sar; nothing: none. Reading the file checks their names
      Json list = Json::array();
      std::istringstream names(text);
      for (std::string name; std::getline(names, name, ',');) list.push_back(name);
      return list;
    }
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
