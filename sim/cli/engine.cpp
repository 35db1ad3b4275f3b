#include "cli/engine.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <utility>
#include <vector>

#include "lockstep/rtl_loader.hpp"
#include "machine/functional_unit.hpp"
#include "machine/model.hpp"
#include "machine/multiprocessor.hpp"

namespace raypool {

Engine parse_engine(const std::string& name) {
  if (name == "native") return Engine::Native;
  if (name == "functional") return Engine::Functional;
  if (name == "model") return Engine::Model;
  if (name == "rtl") return Engine::Rtl;
  if (name == "lockstep") return Engine::Lockstep;
  throw InputError(fmt::format("there is no engine '{}': use native, functional, model, rtl or lockstep", name));
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
    throw InputError("the native engine has no compute unit: use functional, model, rtl or lockstep");
  if (options.engine == Engine::Functional) {
    std::vector<std::unique_ptr<ComputeUnit>> units;
    for (int i = 0; i < options.units; ++i) units.push_back(make_functional_unit(configuration, memory));
    return make_multiprocessor(std::move(units));
  }
  if (options.engine == Engine::Model) return make_model(configuration, memory, static_cast<uint32_t>(options.units)).device;

  const std::string library =
      options.unit_library.empty() ? unit_library_path(configuration, options.waves, options.units) : options.unit_library;
  if (!std::filesystem::exists(library)) {
    throw InputError(fmt::format("there is no Verilated unit '{}': build it with make unit CONFIG={}{}{}", library,
                                 configuration.name, options.units == 1 ? "" : fmt::format(" CUS={}", options.units),
                                 options.waves ? " WAVES=1" : ""));
  }
  std::unique_ptr<ComputeUnit> rtl = load_rtl_unit(library, configuration, options.units);
  if (options.engine == Engine::Rtl) return rtl;
  LockstepOptions lockstep;
  lockstep.name = name;
  lockstep.kernel_names = kernel_names;
  return make_lockstep_unit(configuration, std::move(rtl), memory, lockstep);
}

std::optional<LockstepCounts> lockstep_counts(ComputeUnit& device) {
  const auto* lockstep = dynamic_cast<const LockstepUnit*>(&device);
  return lockstep == nullptr ? std::nullopt : std::optional(lockstep->counts());
}

}  // namespace raypool
