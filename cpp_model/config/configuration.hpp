// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The configuration: one machine, from one JSON file (configs/*.json) that the models, the Verilated build, the chip
// and synthesis all read.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "config/parameters.hpp"
#include "enum_array.hpp"
#include "isa/input_error.hpp"
#include "isa/isa.hpp"

namespace raypool {

struct AluConfiguration {
#define RAYPOOL_ROW(name, value, ...) uint32_t name = value;
  RAYPOOL_ALU_PARAMETERS(RAYPOOL_ROW)
#undef RAYPOOL_ROW
};

/// The chip around the unit; its defaults are the thesis' chip, but for the traverser.
struct ChipConfiguration {
#define RAYPOOL_CHIP(name, type, value, ...) type name = value;
#define RAYPOOL_PART(part, name, type, value, ...) type part##_##name = value;
  RAYPOOL_CHIP_PARAMETERS(RAYPOOL_CHIP, RAYPOOL_PART)
#undef RAYPOOL_CHIP
#undef RAYPOOL_PART
};

/// One instance of each type, a task each cycle, as deep as in the type's table row.
inline constexpr EnumArray<AluType, AluConfiguration, kAluTypes> default_alus() {
  EnumArray<AluType, AluConfiguration, kAluTypes> alus{};
  for (const AluType type : kEveryAluType) alus[type].depth = kAluTable[type].depth;
  return alus;
}

/// What the name of a configuration looks like, as a regular expression.
inline constexpr const char* kNamePattern = "[A-Za-z0-9_.+-]{1,64}";
inline constexpr size_t kLongestName = 64;
/// The name of a file without its folder and ending, with _ for what a configuration's name may not have.
std::string name_of_file(const std::string& path);

/// log2 of an eye tile's width for `contents` threads (a power of two): tiles are square or twice as wide as high.
uint32_t tile_width_log2(uint32_t contents);

/// Requests of the traverser that may wait at the memory port: the lines that its caches may have on their way.
constexpr uint32_t tree_requests(const ChipConfiguration& chip) {
  return chip.hardware_traverser_node_cache_mshrs + chip.hardware_traverser_triangle_cache_mshrs;
}

struct Configuration {
  std::string name = "8w8c";
  std::string source;            ///< what load_configuration was given; empty: nothing
  std::vector<std::string> set;  ///< likewise
  EnumArray<AluType, AluConfiguration, kAluTypes> alus = default_alus();  ///< latency and depth: not of mem and ray
#define RAYPOOL_UNIT(name, type, value, ...) type name = value;
#define RAYPOOL_PART(part, name, type, value, ...) type part##_##name = value;
  RAYPOOL_PARAMETERS(RAYPOOL_UNIT, RAYPOOL_PART, RAYPOOL_UNIT)
#undef RAYPOOL_UNIT
#undef RAYPOOL_PART
  ChipConfiguration chip;

  /// Whether the instruction is legal.
  bool has(const InstructionInfo& info) const {
    switch (info.needs) {
      case Feature::Optional:
        return (alus[info.alu()].without >> info.operation() & 1) == 0;
      case Feature::FusedMultiplyAdd:
        return fma;
      case Feature::Triples:
        return triples;
      case Feature::FusedTriples:
        return fma && triples;
      case Feature::Sharing:
        return sharing;
      default:
        return true;
    }
  }
  uint32_t contents() const { return warps * lanes; }
  /// Cycles in which an rld or rst has the port of its set: of four lanes each, or of all.
  uint32_t ray_access_cycles() const { return wide_ray_memory || lanes <= 4 ? 1 : lanes / 4; }
  /// Of 128 bits, for an intersection.
  uint32_t intersection_beats() const { return (intersection_words + 3) / 4; }
  const AluConfiguration& alu(AluType type) const { return alus[type]; }
  /// Groups of lanes that a task of slw is executed in, a cycle behind each other: 1 .. 32.
  uint32_t slow_groups() const { return slow_lanes < lanes ? lanes / slow_lanes : 1; }
  /// What alu() gives for a group of lanes, for a whole task.
  AluConfiguration task_of(AluType type) const {
    AluConfiguration task = alus[type];
    if (type != AluType::Slw) return task;
    task.latency = std::max(task.latency, slow_groups());
    task.depth += slow_groups() - 1;
    return task;
  }
};

/// Reads a file; `name_or_path` is a path or the name of a file in the configs folder ("8w8c"). A name of the form
/// NwMc that has no file gets the defaults with N warps and M lanes. Throws InputError naming file, key, value and
/// allowed range; unknown keys are refused.
/// `set`: fields to change, "data_cache.bytes=4096" (config/settings.hpp); the configuration's name then shows them,
/// unless they set it.
Configuration load_configuration(const std::string& name_or_path, const std::vector<std::string>& set = {});

/// Whether its name alone defines it: a file of the project, or NwMc.
bool is_built_in(const Configuration& configuration);

/// A configuration from the text of a configuration file; `where` names the source in messages.
Configuration parse_configuration(const std::string& json, const std::string& where);

/// Least pipeline depth of a type in this configuration: what its function needs at speed. 0: the type has neither
/// latency nor depth to choose. flt and slw have it as their default.
uint32_t least_depth(const Configuration& configuration, AluType type);

/// Throws InputError when a value is out of its range; `where` names the source in the message.
void check_configuration(const Configuration& configuration, const std::string& where);

std::string to_json(const Configuration& configuration);

/// Parameters of rtl/compute/rp_compute_unit.v in their order: {"WARPS", 8}, ...
std::vector<std::pair<std::string, int>> verilog_parameters(const Configuration& configuration);
/// Of rtl/chip/rp_chip.v with so many units: UNITS, those of its units, and those of the chip,
/// rtl/include/rp_chip_parameters.vh.
std::vector<std::pair<std::string, int>> chip_verilog_parameters(const Configuration& configuration, int units);

}  // namespace raypool
