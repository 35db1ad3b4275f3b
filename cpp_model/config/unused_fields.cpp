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

constexpr std::string_view kModelled = "chip.modelled_traverser.";
constexpr const char* kOtherTraverser = "choose another traverser";

struct Rule {
  std::function<bool(const Configuration&)> unused;
  std::vector<std::string> paths;  ///< one that ends with a point stands for all behind it
  const char* reason;
  const char* remedy;
};

std::function<bool(const Configuration&)> traverser_is(TraverserName name) {
  return [name](const Configuration& c) { return c.chip.traverser == name; };
}

std::vector<std::string> modelled(std::initializer_list<std::string_view> keys) {
  std::vector<std::string> paths;
  for (const std::string_view key : keys) paths.push_back(fmt::format("{}{}", kModelled, key));
  return paths;
}

const std::vector<Rule>& rules() {
  static const std::vector<Rule> kRules = {
      {traverser_is(TraverserName::Static),
       {std::string(kModelled)},
       "chip.traverser is static, which has no machine inside",
       "choose another traverser, such as chip.traverser=modelled"},
      {[](const Configuration& c) { return c.chip.traverser != TraverserName::Static; },
       {"chip.static_traverser.stall_cycles"},
       "chip.traverser is not static",
       "choose chip.traverser=static"},
      {[](const Configuration& c) {
         return c.chip.traverser != TraverserName::Static && c.chip.policy != PolicyName::Fill;
       },
       {"chip.static_traverser.batch"},
       "chip.traverser is not static, and of the policies only fill looks at it",
       "choose chip.traverser=static, or chip.policy=fill"},
      {traverser_is(TraverserName::Lanes), modelled({"triangle_pipes"}),
       "chip.traverser is lanes, which has a triangle pipe in each lane", kOtherTraverser},
      {traverser_is(TraverserName::Lanes), modelled({"cache_latency"}),
       "chip.traverser is lanes, whose caches take two cycles", kOtherTraverser},
      {traverser_is(TraverserName::Hardware),
       modelled({"setup_latency", "box_latency", "triangle_latency", "finish_latency", "cache_latency"}),
       "chip.traverser is hardware, whose pipes and caches are as long as they are built", kOtherTraverser},
      {traverser_is(TraverserName::Hardware), modelled({"memory_banks", "memory_row_bytes", "memory_row_miss"}),
       "chip.traverser is hardware, around which the memory has no rows and banks", kOtherTraverser},
      {[](const Configuration& c) {
         return c.chip.traverser != TraverserName::Static && c.chip.modelled_traverser_nodes == NodeFormat::Exact;
       },
       modelled({"box_bits"}), "chip.modelled_traverser.nodes is exact, whose boxes are floats",
       "choose chip.modelled_traverser.nodes=compressed"},
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
