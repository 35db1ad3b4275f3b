// The hardware configuration: one JSON file (configs/*.json) that the models, the Verilated
// build, the chip and synthesis all read.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "isa/input_error.hpp"
#include "isa/isa.hpp"

namespace raypool {

enum class Subnormals : uint8_t { Ieee = 0, Flush = 1 };
enum class SlowUnit : uint8_t { Exact = 0, Newton2 = 1, Newton1 = 2, Newton0 = 3 };

struct AluConfiguration {
  int count = 1;    ///< instances
  int latency = 1;  ///< cycles between new tasks; not used by mem and ray
  int depth = 1;    ///< pipeline stages; not used by mem and ray
};

/// One instance of each type, a task each cycle, as deep as the type's table row says.
inline constexpr std::array<AluConfiguration, kAluTypes> default_alus() {
  std::array<AluConfiguration, kAluTypes> alus{};
  for (size_t type = 0; type < kAluTypes; ++type) alus[type].depth = kAluTable[type].depth;
  return alus;
}

struct Configuration {
  std::string name = "8w8c";
  std::string source;  ///< what load_configuration was given; empty: nothing
  int warps = 8;
  int lanes = 8;  ///< of an ALU, and threads in a warp
  int stack_depth = 8;
  std::array<AluConfiguration, kAluTypes> alus = default_alus();
  int instruction_cache_bytes = 4096;
  int data_cache_bytes = 8192;
  int data_cache_mshrs = 4;
  Subnormals subnormals = Subnormals::Ieee;
  SlowUnit slow_unit = SlowUnit::Exact;
  bool fma = false;  ///< fused multiply-add: the instruction ffma, used by kernels; flt then has 5 stages at least

  /// Whether instructions that need the feature are legal.
  bool has(Feature feature) const { return feature == Feature::Base || fma; }
  int contents() const { return warps * lanes; }
  const AluConfiguration& alu(AluType type) const { return alus[static_cast<size_t>(type)]; }
};

/// Reads a file; `name_or_path` is a path or the name of a file in the configs folder ("8w8c"). A name of the form
/// NwMc that has no file gets the defaults with N warps and M lanes. Throws InputError naming file, key, value and
/// allowed range; unknown keys are refused.
Configuration load_configuration(const std::string& name_or_path);

/// Whether its name alone says what it is: a file of the project, or NwMc.
bool is_built_in(const Configuration& configuration);

/// A configuration from the text of a configuration file; `where` names the source in messages.
Configuration parse_configuration(const std::string& json, const std::string& where);

/// Least pipeline depth of a type in this configuration: what its function needs at speed. 0: the type has neither
/// latency nor depth to choose. flt and slw have it as their default.
int least_depth(const Configuration& configuration, AluType type);

/// Throws InputError when a value is out of its range; `where` names the source in the message.
void check_configuration(const Configuration& configuration, const std::string& where);

std::string to_json(const Configuration& configuration);

/// Parameters of rtl/compute_unit.v, in the order of docs/architecture.md: {"WARPS", 8}, ...
std::vector<std::pair<std::string, int>> verilog_parameters(const Configuration& configuration);

}  // namespace raypool
