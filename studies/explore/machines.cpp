#include "explore/machines.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <random>
#include <stdexcept>
#include <utility>

#include "bits.hpp"
#include "config/limits.hpp"
#include "config/settings.hpp"

namespace raypool::explore {
namespace {

constexpr const char* kUnits = "units";
// Combinations that are drawn for each that is wanted, as some are of no machine.
constexpr size_t kDraws = 20;

}  // namespace

const std::vector<Axis>& usual_axes() {
  static const std::vector<Axis> axes = {
      {"warps", {"4", "8", "16"}},
      {"lanes", {"4", "8"}},
      {"alus.int.count", {"1", "2"}},
      {"alus.flt.count", {"1", "2"}},
      {"slow_lanes", {"1", "4", "32"}},
      {"triples", {"false", "true"}},
      {"kernel_overlap", {"false", "true"}},
      {"wide_ray_memory", {"false", "true"}},
      {"intersection_words", {"16", "21"}},
      {"instruction_cache.bytes", {"2048", "4096"}},
      {"data_cache.bytes", {"2048", "4096", "8192"}},
      {"chip.policy", {"thesis", "fill"}},
      {"chip.shading", {"kernel", "traverser"}},
      {"chip.ray_pool.size", {"256", "512", "1024"}},
      {"chip.intersection_pool.size", {"256", "512", "1024"}},
      {"chip.hardware_traverser.rays", {"64", "128", "192", "256"}},
      {"chip.hardware_traverser.lanes", {"2", "4", "8"}},
      {"chip.hardware_traverser.triangle_pipes", {"1", "2", "3", "4", "6"}},
      {"chip.hardware_traverser.node_cache_bytes", {"16384", "32768", "65536", "131072"}},
      {"chip.hardware_traverser.triangle_cache_bytes", {"16384", "32768", "65536", "131072"}},
      {kUnits, {"1", "2", "4"}},
  };
  return axes;
}

void set_axis(std::vector<Axis>& axes, const std::string& text) {
  const size_t equals = text.find('=');
  if (equals == 0 || equals == text.npos || equals + 1 == text.size())
    throw InputError(fmt::format("--vary is '{}': give a field and its values, warps=4,8,16", text));
  Axis axis{text.substr(0, equals), {}};
  for (size_t begin = equals + 1; begin <= text.size();) {
    const size_t end = std::min(text.find(',', begin), text.size());
    axis.values.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  if (axis.field == kUnits) {
    for (const std::string& value : axis.values)
      if (value != "1" && value != "2" && value != "4")
        throw InputError(fmt::format("--vary units: '{}' units; a chip has 1, 2 or 4", value));
  }
  const auto there = std::find_if(axes.begin(), axes.end(), [&](const Axis& a) { return a.field == axis.field; });
  if (there == axes.end())
    axes.push_back(axis);
  else
    *there = axis;
}

MachineSpace::MachineSpace(std::string base, std::vector<std::string> set, std::vector<Axis> axes)
    : base_(std::move(base)),
      set_(std::move(set)),
      axes_(std::move(axes)),
      usual_(nlohmann::ordered_json::parse(to_json(load_configuration(base_, set_)))) {
  for (const Axis& axis : axes_) {
    if (axis.field == kUnits || usual_.contains(pointer_to(axis.field))) continue;
    std::vector<std::string> unknown = set_;
    unknown.push_back(axis.field + "=" + axis.values.front());
    load_configuration(base_, unknown);
    throw std::logic_error("a field that is set and not there: " + axis.field);
  }
}

uint64_t MachineSpace::combinations() const {
  uint64_t product = 1;
  for (const Axis& axis : axes_) product = product > UINT32_MAX ? product : product * axis.values.size();
  return product;
}

Machine MachineSpace::machine_of(const Choice& choice) const {
  Machine machine;
  std::vector<std::string> set = set_, changes;
  uint32_t before = 0;  // values of the axes before this one
  for (size_t i = 0; i < axes_.size(); ++i) {
    machine.features.push_back(before + choice[i]);
    before += size32(axes_[i].values);
    const std::string& value = axes_[i].values[choice[i]];
    if (axes_[i].field == kUnits) {
      machine.units = static_cast<uint32_t>(std::stoul(value));
      continue;
    }
    set.push_back(axes_[i].field + "=" + value);
    if (value_text(usual_, axes_[i].field) != value) changes.push_back(set.back());
  }
  machine.configuration = load_configuration(base_, set);
  machine.changes = fmt::format("{}", fmt::join(changes, " "));
  return machine;
}

void MachineSpace::add(const Choice& choice) {
  if (!known_.insert(choice).second) return;
  try {
    machines_.push_back(machine_of(choice));
    choices_.push_back(choice);
  } catch (const InputError& error) {
    if (left_out_++ == 0) wrong_ = error.what();
  }
}

void MachineSpace::refuse_none() const {
  if (machines_.empty()) throw InputError(wrong_);
}

void MachineSpace::add_all() {
  for (uint64_t number = 0; number < combinations(); ++number) {
    Choice choice(axes_.size());
    uint64_t left = number;
    for (size_t i = axes_.size(); i-- > 0; left /= axes_[i].values.size())
      choice[i] = static_cast<uint32_t>(left % axes_[i].values.size());
    add(choice);
  }
  refuse_none();
}

void MachineSpace::add_random(size_t count, uint64_t seed) {
  std::mt19937_64 random(seed);
  for (size_t i = 0; i < kDraws * count && machines_.size() < count; ++i) {
    Choice choice;
    for (const Axis& axis : axes_) choice.push_back(static_cast<uint32_t>(random() % axis.values.size()));
    add(choice);
  }
  refuse_none();
}

size_t MachineSpace::add_neighbours(const std::vector<size_t>& numbers, size_t most) {
  const size_t before = machines_.size();
  for (const size_t number : numbers) {
    for (size_t i = 0; i < axes_.size(); ++i) {
      Choice choice = choices_[number];
      for (choice[i] = 0; choice[i] < axes_[i].values.size() && machines_.size() < most; ++choice[i]) add(choice);
    }
  }
  return machines_.size() - before;
}

}  // namespace raypool::explore
