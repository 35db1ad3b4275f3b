#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "cosim/coverage.hpp"

namespace raypool {
namespace {

constexpr std::array<std::string_view, 9> kFaultNames = {"",
                                                         "illegal instruction",
                                                         "PC outside the program",
                                                         "stack overflow",
                                                         "stack underflow",
                                                         "misaligned address",
                                                         "address outside the memory",
                                                         "ray word outside",
                                                         "subnormal number"};

template <size_t kBits>
void bits(Coverage::Group& group, const char* what, const std::array<uint64_t, kBits>& counts, uint32_t first,
          size_t end = kBits) {
  for (size_t bit = first; bit < end; ++bit) group.items.push_back({fmt::format("bit {} {}", bit, what), counts[bit]});
}

std::string quoted(const std::string& name) { return name.find(' ') == std::string::npos ? name : '"' + name + '"'; }

/// The items that have not been seen, with commas.
std::string not_covered(const Coverage::Group& group) {
  std::string missing;
  for (const Coverage::Item& item : group.items)
    if (item.count == 0) missing += (missing.empty() ? "" : ", ") + quoted(item.name);
  return missing;
}

/// Of a machine's column in the table.
size_t width_of(const std::string& name) { return std::max(name.size() + 2, size_t{12}); }

nlohmann::ordered_json json_of(const NamedCoverage& machine) {
  nlohmann::ordered_json json;
  json["configuration"] = machine.name;
  json["programs"] = machine.programs;
  for (const Coverage::Group& group : machine.coverage->groups()) {
    nlohmann::ordered_json items;
    for (const Coverage::Item& item : group.items) items[item.name] = item.count;
    json["groups"][group.name] = {{"covered", group.covered()}, {"items", group.items.size()}, {"counts", items}};
  }
  return json;
}

}  // namespace

size_t Coverage::Group::covered() const {
  size_t count = 0;
  for (const Item& item : items) count += item.count > 0 ? 1 : 0;
  return count;
}

// What a configuration of one warp or one lane cannot do, or one without the feature.
bool Coverage::possible(Event one) const {
  const bool one_lane = one == Event::OneQuadword || one == Event::SeveralQuadwords || one == Event::QuadwordALane ||
                        one == Event::PartOfWarp;
  if (lanes_ == 1 && one_lane) return false;
  const bool two_warps = one == Event::WarpsLeftOut || one == Event::NewerRetires || one == Event::BothRetire ||
                         one == Event::OlderIsHigher || one == Event::FaultInNewer || one == Event::GroupsInARow ||
                         one == Event::PackageIntoSet;
  if (configuration_.warps == 1 && two_warps) return false;
  // The one predicate that there is besides p0 keeps short loops going, which are not left.
  if (configuration_.predicates == 2 && (one == Event::LoopLeft || one == Event::LoopLeftBack)) return false;
  const bool one_read = configuration_.data_cache_mshrs == 1 || configuration_.contents() == 1;
  if (one_read && (one == Event::OneSet || one == Event::TopBitOnTheWay || one == Event::UpperBitOnTheWay))
    return false;
  if (one >= Event::ElementsOverlap && one <= Event::FaultInTriple) return configuration_.triples;
  if (one >= Event::NewerRetires && one <= Event::FaultInNewer) return units_ == 1 && configuration_.kernel_overlap;
  if (one == Event::PackageIntoSet) return units_ == 1 && configuration_.wide_ray_memory && lanes_ > 4;
  if (one >= Event::GroupsInARow) return configuration_.slow_groups() > 1;
  return units_ == 1 || one != Event::ImportAhead;  // which unit a package goes to is not seen from outside
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
      if (configuration_.has(kInstructions[row]))
        rows.items.push_back({std::string(kInstructions[row].mnemonic), counts[row]});
  };
  table("instructions", rows_);
  table("instructions with an empty mask", empty_);
  // A lane is on or off; some but not all takes two.
  if (lanes_ > 1) table("instructions with some lanes", partial_);
  Group& after = group("types one after the other in a warp");
  for (size_t a = 0; a < kAluTypes; ++a)
    for (size_t b = 0; b < kAluTypes; ++b)
      after.items.push_back({fmt::format("{}-{}", kAluNames[a], kAluNames[b]), after_[a][b]});
  if (configuration_.warps > 1) {
    Group& together = group("types in flight in one cycle");
    for (size_t a = 0; a < kAluTypes; ++a)
      for (size_t b = a; b < kAluTypes; ++b)
        together.items.push_back({fmt::format("{}+{}", kAluNames[a], kAluNames[b]), together_[a][b]});
  }
  Group& depths = group("PC stack entries");
  for (size_t depth = 1; depth < depths_.size(); ++depth)
    depths.items.push_back({std::to_string(depth), depths_[depth]});
  for (size_t event = 0; event < kEvents; ++event) {
    const auto one = static_cast<Event>(event);
    if (!possible(one)) continue;
    group(kEventTexts[event].group).items.push_back({std::string(kEventTexts[event].name), events_[event]});
  }
  bits(group("upper address bits"), "of loads", load_bits_, kFirstUpperBit);
  bits(group("upper address bits"), "of stores", store_bits_, kFirstUpperBit);
  bits(group("upper PC bits"), "set", pc_bits_, kFirstUpperPcBit, configuration_.pc_bits);
  bits(group("upper PC bits"), "apart from a PC that has retired", pc_twins_, kFirstUpperPcBit, configuration_.pc_bits);
  Group& left = group("predicates that the kernel before left set");
  for (size_t number = 1; number < configuration_.predicates; ++number)
    left.items.push_back({fmt::format("p{}", number), left_set_[number]});
  Group& faults = group("faults");
  for (size_t code = 1; code <= last_fault(); ++code)
    faults.items.push_back({std::string(kFaultNames[code]), faults_[code]});
  if (configuration_.warps > 1) fault_pairs(group("faults in one cycle"));
  return groups;
}

size_t Coverage::last_fault() const {
  return to_underlying(configuration_.subnormals == Subnormals::None ? FaultCode::SubnormalNumber
                                                                     : FaultCode::RayWordOutside);
}

// The memory ALU's wins before the ray ALU's, that before any other, and of these the lower warp's.
void Coverage::fault_pairs(Group& group) const {
  constexpr size_t kMemory = 5, kRay = 7;
  const bool one_branch = configuration_.alu(AluType::Brh).count == 1;
  const auto of_stack = [](size_t code) { return code == 3 || code == 4; };
  for (size_t wins = 1; wins <= last_fault(); ++wins) {
    for (size_t other = 1; other <= last_fault(); ++other) {
      if (other >= kMemory && other <= kRay && (wins < kMemory || wins >= kRay || other != kRay)) continue;
      if (one_branch && of_stack(wins) && of_stack(other)) continue;
      const auto add = [&](size_t lower, const char* warp) {
        group.items.push_back({fmt::format("{} of {} warp before {}", kFaultNames[wins], warp, kFaultNames[other]),
                               fault_pairs_[wins][other][lower]});
      };
      add(1, "a lower");
      if (wins >= kMemory && wins <= kRay) add(0, "a higher");
    }
  }
}

std::string to_string(const Coverage& coverage) {
  std::string text = "coverage (seen of what the configuration can show):\n";
  for (const Coverage::Group& group : coverage.groups()) {
    text += fmt::format("  {:<38} {:>3} of {:>3}", group.name, group.covered(), group.items.size());
    const std::string missing = not_covered(group);
    text += missing.empty() ? "\n" : "   NOT covered: " + missing + "\n";
  }
  return text;
}

std::string to_string(const std::vector<NamedCoverage>& machines) {
  // Groups and items in the order in which the machines name them first; an item's count is that of all.
  std::vector<Coverage::Group> together;
  std::vector<std::vector<std::string>> cells;  // [group of `together`][machine]
  const auto place = [&](const std::string& name) {
    const auto found = std::find_if(together.begin(), together.end(),
                                    [&](const Coverage::Group& group) { return group.name == name; });
    if (found == together.end()) {
      together.push_back({name, {}});
      cells.emplace_back(machines.size(), "-");
      return together.size() - 1;
    }
    return static_cast<size_t>(found - together.begin());
  };
  const auto cell = [](const Coverage::Group& group) {
    return fmt::format("{}/{}", group.covered(), group.items.size());
  };
  for (size_t machine = 0; machine < machines.size(); ++machine) {
    for (const Coverage::Group& group : machines[machine].coverage->groups()) {
      const size_t number = place(group.name);
      cells[number][machine] = cell(group);
      std::vector<Coverage::Item>& all = together[number].items;
      for (const Coverage::Item& item : group.items) {
        const auto same =
            std::find_if(all.begin(), all.end(), [&](const Coverage::Item& other) { return other.name == item.name; });
        if (same == all.end())
          all.push_back(item);
        else
          same->count += item.count;
      }
    }
  }
  std::string text = fmt::format("{:<44}", "coverage (seen/what the machine can show):");
  for (const NamedCoverage& machine : machines) text += fmt::format("{:>{}}", machine.name, width_of(machine.name));
  text += fmt::format("{:>12}\n", "together");
  std::string missing;
  for (size_t number = 0; number < together.size(); ++number) {
    const Coverage::Group& group = together[number];
    text += fmt::format("  {:<42}", group.name);
    for (size_t machine = 0; machine < machines.size(); ++machine)
      text += fmt::format("{:>{}}", cells[number][machine], width_of(machines[machine].name));
    text += fmt::format("{:>12}\n", cell(group));
    const std::string names = not_covered(group);
    if (!names.empty()) missing += fmt::format("  {}: {}\n", group.name, names);
  }
  return text +
         (missing.empty() ? "every item has been seen on some machine\n" : "NOT covered on any machine:\n" + missing);
}

std::string to_json(const NamedCoverage& machine) { return json_of(machine).dump(2) + "\n"; }

std::string to_json(const std::vector<NamedCoverage>& machines) {
  nlohmann::ordered_json json;
  for (const NamedCoverage& machine : machines) json["machines"].push_back(json_of(machine));
  return json.dump(2) + "\n";
}

}  // namespace raypool
