#include "cosim/machines.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <utility>

#include "config/data_folder.hpp"
#include "config/parameter_table.hpp"

namespace raypool {
namespace {

namespace fs = std::filesystem;

// Caches that a program of usual length does not fit into, so that lines are replaced.
constexpr uint32_t kSmallCache = 1024;

const Configuration kDefault;

bool narrow(const Machine& machine, Subnormals subnormals) {
  const Configuration& c = machine.configuration;
  return c.significand < kDefault.significand && c.subnormals == subnormals;
}

template <SlowUnit unit>
bool divides(const Machine& machine) {
  return machine.configuration.slow_unit == unit;
}

template <AluType type>
bool several(const Machine& machine) {
  return machine.configuration.alu(type).count > 1;
}

template <auto Configuration::*member>
bool fewer(const Machine& machine) {
  return machine.configuration.*member < kDefault.*member;
}

bool leaves_out(const Machine& machine) {
  const auto& alus = machine.configuration.alus;
  return std::any_of(std::begin(kEveryAluType), std::end(kEveryAluType),
                     [&](AluType type) { return alus[type].without != 0; });
}

}  // namespace

const std::vector<MachineFeature>& machine_features() {
  static const std::vector<MachineFeature> kFeatures = {
      {"several warps", [](const Machine& m) { return m.configuration.warps > 1; }},
      {"several lanes", [](const Machine& m) { return m.configuration.lanes > 1; }},
      {"several units", [](const Machine& m) { return m.units > 1; }},
      {"triples", [](const Machine& m) { return m.configuration.triples; }},
      {"fused triples", [](const Machine& m) { return m.configuration.triples && m.configuration.fma; }},
      {"kernel overlap", [](const Machine& m) { return m.configuration.kernel_overlap; }},
      {"wide ray memory",
       [](const Machine& m) { return m.configuration.wide_ray_memory && m.configuration.lanes > 4; }},
      {"slow lanes", [](const Machine& m) { return m.configuration.slow_groups() > 1; }},
      {"sharing", [](const Machine& m) { return m.configuration.sharing; }},
      {"short intersections", fewer<&Configuration::intersection_words>},
      {"fused multiply-add", [](const Machine& m) { return m.configuration.fma; }},
      {"whole significands", [](const Machine& m) { return m.configuration.significand == kDefault.significand; }},
      {"narrow significands with subnormals ieee", [](const Machine& m) { return narrow(m, Subnormals::Ieee); }},
      {"narrow significands with subnormals flush", [](const Machine& m) { return narrow(m, Subnormals::Flush); }},
      {"narrow significands with subnormals none", [](const Machine& m) { return narrow(m, Subnormals::None); }},
      {"slow unit exact", divides<SlowUnit::Exact>},
      {"slow unit newton2", divides<SlowUnit::Newton2>},
      {"slow unit newton1", divides<SlowUnit::Newton1>},
      {"slow unit newton0", divides<SlowUnit::Newton0>},
      {"few registers", fewer<&Configuration::registers>},
      {"few predicates", fewer<&Configuration::predicates>},
      {"few arguments", fewer<&Configuration::arguments>},
      {"short PCs", fewer<&Configuration::pc_bits>},
      {"short counters", fewer<&Configuration::counter_bits>},
      {"small instruction cache",
       [](const Machine& m) { return m.configuration.instruction_cache_bytes <= kSmallCache; }},
      {"small data cache", [](const Machine& m) { return m.configuration.data_cache_bytes <= kSmallCache; }},
      {"several instances of tid", several<AluType::Tid>},
      {"several instances of brh", several<AluType::Brh>},
      {"several instances of int", several<AluType::Int>},
      {"several instances of flt", several<AluType::Flt>},
      {"several instances of slw", several<AluType::Slw>},
      {"instructions left out", leaves_out},
  };
  return kFeatures;
}

std::vector<std::string> features_lacking(const std::vector<Machine>& machines) {
  std::vector<std::string> lacking;
  for (const MachineFeature& feature : machine_features())
    if (std::none_of(machines.begin(), machines.end(), feature.has)) lacking.emplace_back(feature.name);
  return lacking;
}

std::vector<std::string> values_lacking(const std::vector<Machine>& machines) {
  std::vector<std::string> lacking;
  for (const Factor& factor : covering_factors()) {
    if (factor.of_alu) continue;
    std::vector<int> values;
    for (const int value : factor.values) {
      const auto has = [&](const Machine& machine) { return factor.get(machine) == value; };
      if (std::none_of(machines.begin(), machines.end(), has)) values.push_back(value);
    }
    if (!values.empty()) lacking.push_back(fmt::format("{} {}", factor.name, fmt::join(values, ", ")));
  }
  return lacking;
}

std::vector<Machine> cosim_machines() {
  // What one lacks another one has, and the other way round: triples and none, one unit and four, ...
  static constexpr std::pair<const char*, int> kFilesAndUnits[] = {
      {"2w2c_small.json", 1}, {"2w8c_features.json", 1}, {"2w1c_units.json", 4}, {"4w2c_few.json", 1}};
  const fs::path folder = fs::path("configs") / "cosim";
  std::vector<Machine> machines;
  for (const auto& [file, units] : kFilesAndUnits) {
    // In a checkout the short path, which commands for a user name, is the same file.
    std::error_code none;
    const fs::path shipped = fs::path(data_folder()) / folder / file;
    const bool here = fs::equivalent(folder / file, shipped, none);
    machines.push_back({load_configuration(here ? folder / file : shipped), units});
  }
  return machines;
}

std::string name_of(const Machine& machine) {
  const std::string& name = machine.configuration.name;
  return machine.units == 1 ? name : fmt::format("{} x {}", machine.units, name);
}

}  // namespace raypool
