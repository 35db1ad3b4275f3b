#include "config/unused_fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <string_view>

#include "config/settings.hpp"
#include "files/json_text.hpp"

namespace raypool {
namespace {

using Json = nlohmann::ordered_json;

struct Rule {
  std::function<bool(const Configuration&)> unused;
  std::vector<std::string> paths;  ///< one that ends with a point stands for all behind it
  const char* reason;
  const char* remedy;
};

bool is_static(const Configuration& c) { return c.chip.traverser == TraverserName::Static; }
bool is_hardware(const Configuration& c) { return c.chip.traverser == TraverserName::Hardware; }

const std::vector<Rule>& rules() {
  static const std::vector<Rule> kRules = {
      {is_static,
       {"chip.hardware_traverser."},
       "chip.traverser is static, which has no machine inside",
       "choose chip.traverser=hardware"},
      {is_hardware,
       {"chip.static_traverser.stall_cycles"},
       "chip.traverser is not static",
       "choose chip.traverser=static"},
      {[](const Configuration& c) { return is_hardware(c) && c.chip.policy != PolicyName::Fill; },
       {"chip.static_traverser.batch"},
       "chip.traverser is not static, and of the policies only fill looks at it",
       "choose chip.traverser=static, or chip.policy=fill"},
      {[](const Configuration& c) { return c.chip.memory_row_miss == 0; },
       {"chip.memory.banks", "chip.memory.row_bytes"},
       "chip.memory.row_miss is 0, and a line takes the same time whatever row is open",
       "choose chip.memory.row_miss"},
      {[](const Configuration& c) { return c.chip.policy == PolicyName::Fill; },
       {"chip.thresholds."},
       "chip.policy is fill, which has no thresholds",
       "choose chip.policy=thesis"},
      {[](const Configuration& c) { return c.wide_ray_memory && c.lanes <= 4; },
       {"wide_ray_memory"},
       "the machine has at most four lanes, which ray memory moves in one cycle anyway",
       "choose more lanes"},
  };
  return kRules;
}

bool matches(const std::string& pattern, const std::string& path) {
  return pattern.back() == '.' ? path.compare(0, pattern.size(), pattern) == 0 : path == pattern;
}

// "a", "a and b", "a and 3 more"
std::string listed(const std::vector<std::string>& paths) {
  if (paths.size() == 1) return paths[0];
  return paths.size() == 2 ? fmt::format("{} and {}", paths[0], paths[1])
                           : fmt::format("{} and {} more", paths[0], paths.size() - 1);
}

/// Those of `paths`, with the reason of the first.
std::string sentence(const Configuration& configuration, const std::vector<std::string>& paths) {
  std::vector<std::string> found;
  const UnusedField* first = nullptr;
  const std::vector<UnusedField> unused = unused_fields(configuration);
  for (const UnusedField& field : unused) {
    if (std::find(paths.begin(), paths.end(), field.path) == paths.end()) continue;
    if (first == nullptr) first = &field;
    if (field.reason == first->reason) found.push_back(field.path);
  }
  if (first == nullptr) return "";
  return fmt::format("{} {} not looked at: {}; {}, or leave {} out", listed(found), found.size() == 1 ? "is" : "are",
                     first->reason, first->remedy, found.size() == 1 ? "it" : "them");
}

}  // namespace

std::vector<UnusedField> unused_fields(const Configuration& configuration) {
  std::vector<UnusedField> unused;
  for (const ConfigurationField& field : fields()) {
    for (const Rule& rule : rules()) {
      const bool named = std::any_of(rule.paths.begin(), rule.paths.end(),
                                     [&](const std::string& pattern) { return matches(pattern, field.path); });
      if (!named || !rule.unused(configuration)) continue;
      unused.push_back({field.path, rule.reason, rule.remedy});
      break;
    }
  }
  return unused;
}

void refuse_unused_settings(const Configuration& configuration) {
  const std::string said = sentence(configuration, paths_set(configuration.set));
  if (!said.empty()) throw InputError(said);
}

void refuse_settings_of_frames(const Configuration& configuration) {
  std::vector<std::string> found;
  for (const std::string& path : paths_set(configuration.set))
    if (matches("chip.", path) && !matches("chip.memory.", path)) found.push_back(path);
  if (found.empty()) return;
  throw InputError(
      fmt::format("{} {} not looked at: a compute program has no pools, controller and traverser around its unit; "
                  "leave {} out",
                  listed(found), found.size() == 1 ? "is" : "are", found.size() == 1 ? "it" : "them"));
}

std::string unused_in_file(const Configuration& configuration) {
  const Json whole = Json::parse(to_json(configuration)), without = Json::parse(to_json(Configuration()));
  const std::vector<std::string> set = paths_set(configuration.set);
  std::vector<std::string> paths;
  for (const UnusedField& field : unused_fields(configuration)) {
    if (std::find(set.begin(), set.end(), field.path) == set.end() &&
        whole.at(pointer_to(field.path)) != without.at(pointer_to(field.path)))
      paths.push_back(field.path);
  }
  const std::string said = sentence(configuration, paths);
  return said.empty() ? "" : fmt::format("configuration {}: {}", configuration.name, said);
}

}  // namespace raypool
