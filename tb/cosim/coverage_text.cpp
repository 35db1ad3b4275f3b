#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "cosim/coverage.hpp"

namespace raypool {
namespace {

constexpr std::array<std::string_view, 8> kFaultNames = {"",
                                                         "illegal instruction",
                                                         "PC outside the program",
                                                         "stack overflow",
                                                         "stack underflow",
                                                         "misaligned address",
                                                         "address outside the memory",
                                                         "ray word outside"};

std::string quoted(const std::string& name) { return name.find(' ') == std::string::npos ? name : '"' + name + '"'; }

}  // namespace

size_t Coverage::Group::covered() const {
  size_t count = 0;
  for (const Item& item : items) count += item.count > 0 ? 1 : 0;
  return count;
}

std::vector<Coverage::Group> Coverage::groups() const {
  std::vector<Group> groups;
  const auto group = [&](std::string_view name) -> Group& {
    for (Group& each : groups)
      if (each.name == name) return each;
    return groups.emplace_back(Group{std::string(name), {}});
  };
  const auto table = [&](const char* name, const std::vector<uint64_t>& counts) {
    Group& rows = group(name);
    for (size_t row = 0; row < counts.size(); ++row)
      if (configuration_.has(kInstructions[row].needs))
        rows.items.push_back({std::string(kInstructions[row].mnemonic), counts[row]});
  };
  table("instructions", rows_);
  table("instructions with an empty mask", empty_);
  // A lane is on or off; some but not all takes two.
  if (lanes_ > 1) table("instructions with some lanes", partial_);
  Group& after = group("types one after the other in a warp");
  for (size_t a = 0; a < kUnits; ++a)
    for (size_t b = 0; b < kUnits; ++b) after.items.push_back({fmt::format("{}-{}", kUnitNames[a], kUnitNames[b]), after_[a][b]});
  if (configuration_.warps > 1) {
    Group& together = group("types in flight in one cycle");
    for (size_t a = 0; a < kUnits; ++a)
      for (size_t b = a; b < kUnits; ++b)
        together.items.push_back({fmt::format("{}+{}", kUnitNames[a], kUnitNames[b]), together_[a][b]});
  }
  Group& depths = group("PC stack entries");
  for (size_t depth = 1; depth < depths_.size(); ++depth) depths.items.push_back({std::to_string(depth), depths_[depth]});
  for (size_t event = 0; event < kEvents; ++event) {
    const auto one = static_cast<Event>(event);
    // What a configuration of one warp or one lane cannot do.
    if (lanes_ == 1 &&
        (one == Event::OneQuadword || one == Event::SeveralQuadwords || one == Event::QuadwordALane || one == Event::PartOfWarp))
      continue;
    if (configuration_.warps == 1 && one == Event::WarpsLeftOut) continue;
    const bool one_read = configuration_.data_cache_mshrs == 1 || configuration_.contents() == 1;
    if (one_read && one == Event::OneSet) continue;
    if (units_ > 1 && one == Event::ImportAhead) continue;  // which unit a package goes to is not seen from outside
    group(kEventTexts[event].group).items.push_back({std::string(kEventTexts[event].name), events_[event]});
  }
  Group& faults = group("faults");
  for (size_t code = 1; code < faults_.size(); ++code) faults.items.push_back({std::string(kFaultNames[code]), faults_[code]});
  return groups;
}

std::string to_string(const Coverage& coverage) {
  std::string text = "coverage (seen of what the configuration can show):\n";
  for (const Coverage::Group& group : coverage.groups()) {
    text += fmt::format("  {:<38} {:>3} of {:>3}", group.name, group.covered(), group.items.size());
    std::string missing;
    for (const Coverage::Item& item : group.items)
      if (item.count == 0) missing += (missing.empty() ? "" : ", ") + quoted(item.name);
    text += missing.empty() ? "\n" : "   NOT covered: " + missing + "\n";
  }
  return text;
}

std::string to_json(const Coverage& coverage, const std::string& configuration, uint64_t programs) {
  nlohmann::ordered_json json;
  json["configuration"] = configuration;
  json["programs"] = programs;
  for (const Coverage::Group& group : coverage.groups()) {
    nlohmann::ordered_json items;
    for (const Coverage::Item& item : group.items) items[item.name] = item.count;
    json["groups"][group.name] = {{"covered", group.covered()}, {"items", group.items.size()}, {"counts", items}};
  }
  return json.dump(2) + "\n";
}

}  // namespace raypool
