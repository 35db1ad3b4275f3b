// The engines by name, and where their Verilated units lie.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "chip/board.hpp"
#include "config/configuration.hpp"
#include "lockstep/lockstep_chip.hpp"
#include "lockstep/lockstep_unit.hpp"
#include "machine/chip/chip_device.hpp"
#include "machine/common/memory.hpp"
#include "machine/compute/compute_unit.hpp"

namespace raypool {

/// Native, Estimate: no machine, the kernels as C++. Functional: the units without time. Model, Sampled: the C++ model.
/// Rtl: the Verilated Verilog. Lockstep: both, compared in every cycle.
enum class Engine : uint8_t { Native, Estimate, Functional, Sampled, Model, Rtl, Lockstep };
/// What of the chip is Verilog, of engines rtl and lockstep: its units, with the model of the chip around them, or all.
enum class Boundary : uint8_t { Unit, Chip };

constexpr bool has_verilog(Engine engine) { return engine == Engine::Rtl || engine == Engine::Lockstep; }

/// Throw InputError naming those there are.
Engine parse_engine(const std::string& name);
Boundary parse_boundary(const std::string& name);
/// What parse_engine() takes.
std::string engine_name(Engine engine);

/// units_folder()/<name from the Verilog parameters>/libraypool_unit.so, where `raypool unit` builds it; with
/// `waves` the one that can write waveforms. Of a multiprocessor of `units` units.
std::string unit_library_path(const Configuration& configuration, bool waves, int units = 1);

/// The same of the whole chip: libraypool_chip.so.
std::string chip_library_path(const Configuration& configuration, bool waves, int units = 1);

/// "--config 8w8c", and "--set ..." if fields of it were set: what names this configuration to a command.
std::string config_options(const Configuration& configuration);

/// What it takes to make a compute unit, or a multiprocessor.
struct EngineOptions {
  Engine engine = Engine::Functional;  ///< one with a unit
  Configuration configuration;
  std::string unit_library;  ///< empty: unit_library_path()
  bool waves = false;        ///< a waveform will be asked for
  int units = 1;             ///< compute units of the device: 1, 2 or 4
  /// Of a lockstep, LockstepOptions::inspect_until. With `waves` it always looks inside: a waveform takes more time
  /// than that, and is not written twice.
  uint64_t inspect_until = 0;
  Boundary boundary = Boundary::Unit;
};

/// The Verilated device that they name. Throws InputError when it is missing; reports on stderr, once, if the Verilog
/// is newer.
std::string find_unit_library(const EngineOptions& options);

/// A Verilog file in the folder `rtl` that was changed after `library`; empty if there is none, or no such folder.
std::string newer_verilog(const std::string& library, const std::string& rtl);

/// A device for the program and data in `memory`, which must outlive it: for rtl the Verilated
/// multiprocessor, for functional and model a Multiprocessor over as many units, for lockstep both. `name`
/// and `kernel_names` (entry PC -> name) are for the reports of a lockstep. Throws InputError when the
/// Verilated device is missing or does not fit.
std::unique_ptr<ComputeUnit> make_unit(const EngineOptions& options, Memory& memory, const std::string& name = "unit",
                                       const std::map<uint32_t, std::string>& kernel_names = {});

/// rtl/chip/rp_chip.v whole, of engine rtl or lockstep; else as make_unit().
std::unique_ptr<ChipDevice> make_verilog_chip(const EngineOptions& options, const Memory& memory);

/// Whole chips of an engine, of one unit each: rtl and lockstep all of it in Verilog, model none of it. Throws as
/// make_verilog_chip() does.
ChipMaker chip_maker(Engine engine);

/// What the device has compared; none unless it is a lockstep.
std::optional<LockstepCounts> lockstep_counts(ComputeUnit& device);
std::optional<ChipLockstepCounts> lockstep_counts(const ChipDevice& chip);

}  // namespace raypool
