// What the commands that draw do; drawing_commands.cpp parses the command line into these options. Each throws
// InputError on input that cannot be used and returns the exit code otherwise.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "chip/sampling.hpp"
#include "cli/scene_loading.hpp"
#include "machine/common/memory.hpp"
#include "machine/compute/compute_unit.hpp"
#include "scene/shader_file.hpp"
#include "scene/shader_memory.hpp"
#include "shader/shader_set.hpp"

namespace raypool {

/// The frames of a picture have numbers of so many bits.
inline constexpr int kMostSamples = 65535;

/// What `--shaders` names becomes a set, and the set's bindings memory. Empty: the program draws with no shaders.
struct ShaderSource {
  std::function<std::shared_ptr<const shader::ShaderSet>(const std::string& folder)> load;
  std::function<shader::Resources(MemoryImage&, const Scene&, const shader::ShaderSet&, const ShaderFrame&)> memory;
};

/// `raypool sim`
struct SimOptions {
  std::string scene = "room";  ///< built-in name or path of a scene file
  std::string config = "8w8c";
  std::vector<std::string> set;  ///< fields of the configuration to change, "warps=4"
  std::string engine = "model";
  std::string boundary;  ///< unit or chip: what is Verilog, of engines rtl and lockstep; empty: unit
  std::string hits;      ///< own or embree: whose hits engine native takes; empty: own
  /// single or double, of engine native: numbers of the machine's arithmetic, or of double precision; then
  /// decisions.bin is left too. Empty: single, and it is not.
  std::string precision;
  int unstable = 0;  ///< of engine native: frames with the camera's last bits moved; 0: none
  std::string size = kDefaultSize;
  std::string view;          ///< JSON file with camera and light; empty: the scene's own
  ViewWords look;            ///< changes of it
  std::string out;           ///< folder; empty: out/<what was run> beside the executable
  std::string traverser;     ///< chip.traverser; empty: as the configuration says
  std::string unit_library;  ///< Verilated unit; empty: unit_library_path()
  int depth = 3;
  int units = 1;
  std::string shaders;   ///< the shader set that draws, as ShaderSource::load takes it; empty: the built-in kernels
  int samples = 1;       ///< with `shaders`: frames whose contributions add up, 1 .. kMostSamples
  uint32_t threads = 0;  ///< of engines native, estimate and sampled; 0: as many as the machine has cores
  /// Of engine sampled: "2%" of the cycles, half of their interval, or "10s" for the whole command; one or none.
  std::string error, within;
  bool choose_engine = false;  ///< `error` or `within` decides between estimate, sampled and model, not `engine`
  uint64_t seed = 0;           ///< of engine sampled; 0: as 1
  double detail = 1;           ///< of a built-in scene, 0.01 .. 16
  bool waves = false;
  std::string trace;                    ///< window of cycles (trace::parse_window()); empty: no trace
  bool modules = false;                 ///< print the modules of the chip, and draw nothing
  std::optional<uint64_t> cycle_limit;  ///< of engines model, rtl and lockstep
  uint64_t inspect_until = 0;  ///< cycle of a difference that a look inside the RTL is to show more of; 0: no look
  bool json = false;           ///< the report on standard output, instead of the table
  bool quiet = false;          ///< no progress, no table
  std::vector<std::string> command;  ///< the command line, for the report
  /// Puts something around the device, which works on that memory; empty: nothing. No option of the command line.
  std::function<std::unique_ptr<ComputeUnit>(std::unique_ptr<ComputeUnit>, const Memory&)> wrap = {};
  ShaderSource shader_source = {load_shaders, build_shader_memory};
  const EstimatingEngines* estimating = nullptr;  ///< engines sampled and estimate; null: there are none
};
int sim_command(const SimOptions& options);

/// `raypool config`
struct ConfigOptions {
  std::string config = "8w8c";
  std::vector<std::string> set;  ///< fields of the configuration to change, "warps=4"
  bool verilog_parameters = false;
  bool chip = false;  ///< `verilog_parameters` are those of the whole chip
  bool json = false;
  bool in_use = false;        ///< refuses a field of `set` that a frame does not look at
  bool unit_library = false;  ///< path of the Verilated unit
  int units = 1;              ///< of which `unit_library` and `chip` have so many
};
int config_command(const ConfigOptions& options);

/// `raypool unit`: does not return when the build has begun; its exit code is the program's.
struct UnitOptions {
  std::string config = "8w8c";
  std::vector<std::string> set;  ///< fields of the configuration to change, "warps=4"
  int units = 1;
  std::string boundary = "unit";  ///< unit or chip: what becomes Verilated
  bool waves = false;
};
int unit_command(const UnitOptions& options);

}  // namespace raypool
