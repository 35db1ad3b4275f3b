#include "fit/fit.hpp"

#include <fmt/format.h>

#include <map>

#include "config/settings.hpp"
#include "files/json_text.hpp"

namespace raypool::fit {
namespace {

using Json = nlohmann::ordered_json;

/// Measures no machine twice.
class Measurements {
 public:
  explicit Measurements(const Measure& measure) : measure_(measure) {}
  std::optional<uint64_t> of(const Configuration& configuration, const std::string& what) {
    const std::string key = to_json(configuration);
    const auto found = done_.find(key);
    return found != done_.end() ? found->second : done_.emplace(key, measure_(configuration, what)).first->second;
  }
  void know(const Configuration& configuration, uint64_t cycles) { done_.emplace(to_json(configuration), cycles); }

 private:
  const Measure& measure_;
  std::map<std::string, std::optional<uint64_t>> done_;
};

std::string name_of(const Cut& cut) {
  return cut.value.is_array() ? cut.field : fmt::format("{} {}", cut.field, cut.value.dump());
}

/// The text of a file, with each list, which holds nothing but names, in one line.
std::string with_short_lists(const std::string& text) {
  std::string result;
  bool in_list = false;
  for (const char letter : text) {
    if (letter == '[' || letter == ']') in_list = letter == '[';
    if (in_list && (letter == '\n' || letter == ' ')) continue;
    result += letter;
    if (in_list && letter == ',') result += ' ';
  }
  return result;
}

/// Without the field, and without the objects that held nothing else.
void erase(Json& json, Json::json_pointer place) {
  do {
    const std::string key = place.back();
    place.pop_back();
    json[place].erase(key);
  } while (!place.empty() && json[place].empty());
}

/// Whether a file is of the machine with this JSON.
bool is_that_of(const Json& file, const std::string& machine) {
  try {
    return to_json(parse_configuration(file.dump(), "a part of it")) == machine;
  } catch (const InputError&) {
    return false;  // a field that is left has a value that it may have only beside the one that is not
  }
}

}  // namespace

Configuration with(const Configuration& configuration, const Cut& cut) {
  Json json = Json::parse(to_json(configuration));
  json[pointer_to(cut.field)] = cut.value;
  return parse_configuration(json.dump(), fmt::format("configuration {} with {}", configuration.name, name_of(cut)));
}

Fit fit(const Configuration& base, uint64_t base_cycles, const std::vector<Part>& parts, double slower,
        const Measure& measure) {
  Measurements measurements(measure);
  measurements.know(base, base_cycles);
  Fit fit;
  fit.base = fit.fitted = base;
  fit.base_cycles = fit.cycles = base_cycles;
  fit.most_cycles = base_cycles + static_cast<uint64_t>(static_cast<double>(base_cycles) * slower);
  for (const Part& part : parts) {
    for (const Cut& cut : part(fit.fitted)) {
      const Configuration tried = with(fit.fitted, cut);
      const std::optional<uint64_t> cycles = measurements.of(tried, name_of(cut));
      if (!cycles || *cycles > fit.most_cycles) continue;
      const std::optional<uint64_t> alone = measurements.of(with(base, cut), name_of(cut) + " alone");
      if (alone && *alone > fit.most_cycles) continue;
      fit.changes.push_back({cut, Json::parse(to_json(base)).at(pointer_to(cut.field)), alone});
      fit.fitted = tried;
      fit.cycles = *cycles;
      break;
    }
  }
  return fit;
}

std::string shortest_file(const Configuration& configuration) {
  const std::string whole = to_json(configuration);
  Json json = Json::parse(whole);
  // A field's default may depend on other fields, so each is tried.
  for (const ConfigurationField& field : fields()) {
    Json less = json;
    erase(less, pointer_to(field.path));
    if (is_that_of(less, whole)) json = less;
  }
  return with_short_lists(to_text(json, 2));
}

}  // namespace raypool::fit
