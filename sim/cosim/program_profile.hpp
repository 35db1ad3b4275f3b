// The mixes of random programs.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "enum_array.hpp"
#include "isa/did_you_mean.hpp"
#include "isa/input_error.hpp"
#include "isa/isa.hpp"

namespace raypool {

/// Weights are relative; 0: never.
struct ProgramProfile {
  std::string_view name;
  uint32_t plain, arithmetic, pairs, memory, ray, loop, jump, call, far, early_exit;  ///< kinds of statements
  EnumArray<AluType, uint32_t, 7> types;  ///< of plain instructions: tid, brh, -, int, flt, slw, -
  uint32_t guarded_percent;               ///< plain instructions with a guard
  uint32_t length_percent;                ///< of the length asked for
  uint32_t most_kernels;

  /// A type that the mixes do not list comes as often as flt.
  uint32_t weight(size_t type) const { return type < types.size() ? types[type] : types[AluType::Flt]; }
};

/// The mix with pairs of weighted operands (arith/test_operands.hpp) in memory.
inline constexpr std::string_view kOperandMix = "operands";
/// The mix with warps that end in faults, several of them at about the same time.
inline constexpr std::string_view kFaultMix = "faults";

// clang-format off
inline constexpr ProgramProfile kProgramProfiles[] = {
  //  name        plain ari prs mem ray loop jump call far exit   tid brh  -  int flt slw -   guarded length kernels
  {"mixed",         11,   1,  0,  4,  3,  1,   1,   1,  0,  0,    {1,  4,  0,  4,  3,  1, 0},   33,    100,   3},
  {"memory",         4,   0,  0, 14,  0,  1,   1,   0,  0,  0,    {1,  2,  0,  4,  1,  0, 0},   33,     80,   3},
  {"rays",           4,   0,  0,  2, 12,  1,   1,   0,  0,  0,    {1,  2,  0,  3,  2,  1, 0},   33,     90,   5},
  {"control",        5,   0,  0,  1,  1,  5,   5,   5,  0,  1,    {1,  6,  0,  3,  1,  0, 0},   40,     70,   2},
  {"code",           8,   0,  0,  1,  0,  1,   2,   3,  2,  0,    {1,  2,  0,  3,  2,  1, 0},   25,    120,   2},
  {"hazards",       30,   1,  0,  2,  1,  1,   0,   0,  0,  0,    {2,  3,  0,  3,  3,  3, 0},   15,    100,   1},
  {"launches",       6,   0,  0,  2,  3,  0,   1,   1,  0,  1,    {2,  2,  0,  2,  2,  1, 0},   33,     15,   8},
  {"arithmetic",     4, 16,  0,  1,  0,  1,   0,   0,  0,  0,    {1,  3,  0,  4,  9,  9, 0},   10,    120,   1},
  {"predicates",    12,   0,  0,  2,  1,  2,   3,   1,  0,  1,    {1, 12,  0,  3,  1,  0, 0},   80,     80,   2},
  {kFaultMix,        1,   0,  0,  0,  0,  0,   0,   0,  0,  0,    {4,  0,  0,  3,  3,  1, 0},    0,    100,   1},
  {kOperandMix,      1,   0,  4,  0,  0,  0,   0,   0,  0,  0,    {1,  3,  0,  3,  7,  9, 0},    5,     20,   2},
};
// clang-format on

/// Throws InputError when there is none of that name.
inline const ProgramProfile& profile_named(std::string_view name) {
  for (const ProgramProfile& profile : kProgramProfiles)
    if (profile.name == name) return profile;
  std::vector<std::string> names;
  std::string all;
  for (const ProgramProfile& profile : kProgramProfiles) {
    names.emplace_back(profile.name);
    all += (all.empty() ? "" : ", ") + names.back();
  }
  throw InputError("there is no mix '" + std::string(name) + "' of random programs" +
                   did_you_mean(name, names, "take one of " + all));
}

}  // namespace raypool
