// The engines by name, and where their Verilated units lie.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "config/configuration.hpp"
#include "machine/compute_unit.hpp"
#include "machine/memory.hpp"

namespace raypool {

enum class Engine : uint8_t { Native, Functional, Rtl, Lockstep };

/// Throws InputError naming the engines.
Engine parse_engine(const std::string& name);

/// <folder of the executable>/units/<name from the Verilog parameters>/libraypool_unit.so, where scripts/unit.sh builds it; with
/// `waves` the one that can write waveforms.
std::string unit_library_path(const Configuration& configuration, bool waves);

/// What it takes to make a compute unit.
struct EngineOptions {
  Engine engine = Engine::Functional;  ///< not Native, which has no unit
  Configuration configuration;
  std::string unit_library;  ///< empty: unit_library_path(configuration, waves)
  bool waves = false;        ///< a waveform will be asked for
};

/// A unit for the program and data in `memory`, which must outlive it. `name` and `kernel_names` (entry PC -> name) are for the
/// reports of a lockstep. Throws InputError when the Verilated unit is missing or does not fit.
std::unique_ptr<ComputeUnit> make_unit(const EngineOptions& options, Memory& memory, const std::string& name = "unit",
                                       const std::map<uint32_t, std::string>& kernel_names = {});

}  // namespace raypool
