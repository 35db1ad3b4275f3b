#include "cli/engine.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <utility>
#include <vector>

#include "lockstep/rtl_loader.hpp"
#include "machine/functional_unit.hpp"
#include "machine/multiprocessor.hpp"

namespace raypool {

Engine parse_engine(const std::string& name) {
  if (name == "native") return Engine::Native;
  if (name == "functional") return Engine::Functional;
  if (name == "rtl") return Engine::Rtl;
  if (name == "lockstep") return Engine::Lockstep;
  throw InputError(fmt::format("there is no engine '{}': use native, functional, rtl or lockstep", name));
}

std::string unit_library_path(const Configuration& configuration, bool waves, int units) {
  // FNV-1a over all parameters: two configurations share a unit exactly when their Verilog is the same.
  uint32_t hash = 2166136261u;
  for (const auto& [name, value] : verilog_parameters(configuration)) {
    for (const char c : fmt::format("{}={} ", name, value)) hash = (hash ^ static_cast<uint8_t>(c)) * 16777619u;
  }
  const std::filesystem::path executable = std::filesystem::read_symlink("/proc/self/exe");
  const std::string several = units == 1 ? "" : fmt::format("-{}cu", units);
  const std::string key =
      fmt::format("{}w{}c-{:08x}{}{}", configuration.warps, configuration.cores, hash, several, waves ? "-waves" : "");
  return executable.parent_path() / "units" / key / "libraypool_unit.so";
}

std::unique_ptr<ComputeUnit> make_unit(const EngineOptions& options, Memory& memory, const std::string& name,
                                       const std::map<uint32_t, std::string>& kernel_names) {
  const Configuration& configuration = options.configuration;
  if (options.engine == Engine::Native)
    throw InputError("the native engine has no compute unit: use functional, rtl or lockstep");
  std::vector<std::unique_ptr<ComputeUnit>> units;
  if (options.engine == Engine::Functional) {
    for (int i = 0; i < options.units; ++i) units.push_back(make_functional_unit(configuration, memory));
    return make_multiprocessor(std::move(units));
  }

  const int in_library = options.engine == Engine::Rtl ? options.units : 1;
  const std::string library =
      options.unit_library.empty() ? unit_library_path(configuration, options.waves, in_library) : options.unit_library;
  if (!std::filesystem::exists(library)) {
    throw InputError(fmt::format("there is no Verilated unit '{}': build it with make unit CONFIG={}{}{}", library,
                                 configuration.name, in_library == 1 ? "" : fmt::format(" CUS={}", in_library),
                                 options.waves ? " WAVES=1" : ""));
  }
  if (options.engine == Engine::Rtl) return load_rtl_unit(library, configuration, in_library);
  for (int i = 0; i < options.units; ++i) {
    LockstepOptions lockstep;
    lockstep.name = options.units == 1 ? name : fmt::format("{} {}", name, i);
    lockstep.kernel_names = kernel_names;
    units.push_back(make_lockstep_unit(configuration, load_rtl_unit(library, configuration), memory, lockstep));
  }
  return make_multiprocessor(std::move(units));
}

std::optional<LockstepCounts> lockstep_counts(ComputeUnit& device) {
  if (const auto* lockstep = dynamic_cast<const LockstepUnit*>(&device)) return lockstep->counts();
  std::optional<LockstepCounts> sum;
  if (auto* several = dynamic_cast<Multiprocessor*>(&device)) {
    for (uint32_t u = 0; u < several->units(); ++u) {
      const std::optional<LockstepCounts> counts = lockstep_counts(several->unit(u));
      if (!counts) continue;
      if (!sum) sum.emplace();
      *sum += *counts;
    }
  }
  return sum;
}

}  // namespace raypool
