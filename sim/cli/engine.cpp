#include "cli/engine.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdio>
#include <filesystem>
#include <set>
#include <utility>
#include <vector>

#include "cli/folders.hpp"
#include "config/data_folder.hpp"
#include "isa/did_you_mean.hpp"
#include "lockstep/lockstep_chip.hpp"
#include "lockstep/rtl_loader.hpp"
#include "machine/chip/chip_model.hpp"
#include "machine/compute/functional_unit.hpp"
#include "machine/compute/model.hpp"

namespace raypool {

namespace fs = std::filesystem;

namespace {

// In the order of Engine.
const std::vector<std::string> kEngines = {"native", "estimate", "functional", "sampled", "model", "rtl", "lockstep"};

}  // namespace

Engine parse_engine(const std::string& name) {
  for (size_t i = 0; i < kEngines.size(); ++i)
    if (name == kEngines[i]) return static_cast<Engine>(i);
  throw InputError(
      fmt::format("there is no engine '{}'{}", name,
                  did_you_mean(name, kEngines, "use native, estimate, functional, sampled, model, rtl or lockstep")));
}

std::string engine_name(Engine engine) { return kEngines.at(static_cast<size_t>(engine)); }

Boundary parse_boundary(const std::string& name) {
  if (name == "unit") return Boundary::Unit;
  if (name == "chip") return Boundary::Chip;
  throw InputError(
      fmt::format("there is no boundary '{}'{}", name, did_you_mean(name, {"unit", "chip"}, "use unit or chip")));
}

namespace {

// Two configurations share a library exactly when their Verilog is the same.
std::string library_path(const Configuration& configuration, const std::vector<std::pair<std::string, int>>& parameters,
                         const std::string& what, const char* file) {
  uint32_t hash = hash_of("");
  for (const auto& [name, value] : parameters) hash = hash_of(fmt::format("{}={} ", name, value), hash);
  return units_folder() / fmt::format("{}w{}c-{:08x}{}", configuration.warps, configuration.lanes, hash, what) / file;
}

std::string several(int units) { return units == 1 ? "" : fmt::format("-{}cu", units); }

}  // namespace

std::string unit_library_path(const Configuration& configuration, bool waves, int units) {
  return library_path(configuration, verilog_parameters(configuration), several(units) + (waves ? "-waves" : ""),
                      "libraypool_unit.so");
}

std::string chip_library_path(const Configuration& configuration, bool waves, int units) {
  return library_path(configuration, chip_verilog_parameters(configuration, units),
                      several(units) + "-chip" + (waves ? "-waves" : ""), "libraypool_chip.so");
}

std::string newer_verilog(const std::string& library, const std::string& rtl) {
  std::error_code missing;
  const fs::file_time_type built = fs::last_write_time(library);
  for (const fs::directory_entry& file : fs::recursive_directory_iterator(rtl, missing)) {
    const fs::path extension = file.path().extension();
    if ((extension == ".v" || extension == ".vh") && file.last_write_time() > built) return file.path();
  }
  return "";
}

namespace {

/// One that is read from a file of a run has its name alone: that of a file in configs/, or of one for cosim.
std::string source_of(const Configuration& configuration) {
  if (!configuration.source.empty()) return configuration.source;
  const std::string cosim = fmt::format("configs/cosim/{}.json", configuration.name);
  const fs::path named = fs::path(data_folder()) / "configs" / (configuration.name + ".json");
  return !fs::exists(named) && fs::exists(fs::path(data_folder()) / cosim) ? cosim : configuration.name;
}

/// What a user types to have the unit: from a checkout make, of an installed program the program itself.
std::string build_command(const EngineOptions& options) {
  const Configuration& configuration = options.configuration;
  const std::string units = options.units == 1 ? "" : std::to_string(options.units);
  if (installed())
    return fmt::format("raypool unit {}{}{}{}", config_options(configuration), units.empty() ? "" : " --units " + units,
                       options.boundary == Boundary::Chip ? " --boundary chip" : "", options.waves ? " --waves" : "");
  const std::string set =
      configuration.set.empty() ? "" : fmt::format(" SET=\"{}\"", fmt::join(configuration.set, " "));
  return fmt::format("make unit CONFIG={}{}{}{}{}", source_of(configuration), set, units.empty() ? "" : " CUS=" + units,
                     options.boundary == Boundary::Chip ? " BOUNDARY=chip" : "", options.waves ? " WAVES=1" : "");
}

}  // namespace

std::string config_options(const Configuration& configuration) {
  std::string text = "--config " + source_of(configuration);
  if (!configuration.set.empty()) text += fmt::format(" --set \"{}\"", fmt::join(configuration.set, " "));
  return text;
}

std::string find_unit_library(const EngineOptions& options) {
  const Configuration& configuration = options.configuration;
  const bool chip = options.boundary == Boundary::Chip;
  const auto path = chip ? chip_library_path : unit_library_path;
  std::string library =
      options.unit_library.empty() ? path(configuration, options.waves, options.units) : options.unit_library;
  const std::string build = build_command(options);
  if (!fs::exists(library))
    throw InputError(
        fmt::format("there is no Verilated {} '{}': build it with {}", chip ? "chip" : "unit", library, build));

  static std::set<std::string> checked;
  if (options.unit_library.empty() && checked.insert(library).second) {
    const std::string newer = newer_verilog(library, fs::path(data_folder()) / "rtl");
    if (!newer.empty())
      fmt::print(stderr, "raypool: warning: '{}' was changed after '{}' was built: build it again with {}\n", newer,
                 library, build);
  }
  return library;
}

std::unique_ptr<ComputeUnit> make_unit(const EngineOptions& options, Memory& memory, const std::string& name,
                                       const std::map<uint32_t, std::string>& kernel_names) {
  const Configuration& configuration = options.configuration;
  if (options.engine == Engine::Native || options.engine == Engine::Estimate || options.engine == Engine::Sampled)
    throw InputError(
        "engines native, estimate and sampled are for frames only: use functional, model, rtl or lockstep");
  if (options.engine == Engine::Functional)
    return make_functional_units(configuration, memory, static_cast<uint32_t>(options.units));
  if (options.engine == Engine::Model)
    return make_model(configuration, memory, static_cast<uint32_t>(options.units)).device;

  std::unique_ptr<ComputeUnit> rtl = load_rtl_unit(find_unit_library(options), configuration, options.units);
  if (options.engine == Engine::Rtl) return rtl;
  LockstepOptions lockstep;
  lockstep.name = name;
  lockstep.answered_soon = false;  // the chip around it has a watch of its own
  lockstep.kernel_names = kernel_names;
  lockstep.inspect_until = options.waves ? kInspectAlways : options.inspect_until;
  return make_lockstep_unit(configuration, std::move(rtl), memory, lockstep);
}

std::unique_ptr<ChipDevice> make_verilog_chip(const EngineOptions& options, const Memory& memory) {
  const Configuration& configuration = options.configuration;
  if (options.engine == Engine::Rtl)
    return make_chip(ChipKind::Rtl, configuration, memory, options.units, find_unit_library(options));
  return make_chip(ChipKind::Lockstep, configuration, memory, options.units, find_unit_library(options), "chip",
                   options.waves ? kInspectAlways : options.inspect_until);
}

ChipMaker chip_maker(Engine engine) {
  return [engine](const Configuration& configuration, Memory& memory) {
    EngineOptions options;
    options.engine = engine;
    options.configuration = configuration;
    options.boundary = Boundary::Chip;
    if (has_verilog(engine)) return make_verilog_chip(options, memory);
    return make_chip_model(configuration, make_unit(options, memory));
  };
}

std::optional<ChipLockstepCounts> lockstep_counts(const ChipDevice& chip) {
  const auto* lockstep = dynamic_cast<const LockstepChip*>(&chip);
  return lockstep == nullptr ? std::nullopt : std::optional(lockstep->lockstep_counts());
}

std::optional<LockstepCounts> lockstep_counts(ComputeUnit& device) {
  const auto* lockstep = dynamic_cast<const LockstepUnit*>(&device);
  return lockstep == nullptr ? std::nullopt : std::optional(lockstep->counts());
}

}  // namespace raypool
