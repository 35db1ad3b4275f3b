// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The one table of the records that modules hand to each other, or to memory, as one vector; rtl/include/rp_records.vh
// is made from it.
#pragma once

#include <stdexcept>
#include <string_view>

namespace raypool {

struct RecordField {
  std::string_view name;
  int bits;
};

/// Fields from bit 0 up, without a gap.
struct Record {
  std::string_view name, meaning;
  const RecordField* fields;
  int count;

  /// The lowest bit of a field, or of no name how many bits the record has.
  constexpr int low(std::string_view field = {}) const {
    int bit = 0;
    for (int i = 0; i < count; ++i) {
      if (fields[i].name == field) return bit;
      bit += fields[i].bits;
    }
    if (!field.empty()) throw std::logic_error("a record has no field of this name");
    return bit;
  }
  constexpr int bits() const { return low(); }
};

namespace record {
inline constexpr RecordField kTestFields[] = {{"corners", 288},     {"number", 32},       {"origin", 96},
                                              {"padded_lower", 96}, {"padded_upper", 96}, {"inverse", 96},
                                              {"main_axis", 2},     {"shear", 64},        {"direction", 105}};
inline constexpr RecordField kTriangleFields[] = {{"corners", 288}, {"number", 32}, {"material", 32}};
inline constexpr RecordField kNodeFields[] = {{"grid", 96},  {"step", 24},  {"children", 8},
                                              {"lower", 96}, {"upper", 96}, {"references", 128}};
inline constexpr RecordField kRayFields[] = {{"origin", 96}, {"direction", 96}, {"limit", 32},  {"pixel", 32},
                                             {"color", 96},  {"depth", 8},      {"unused", 20}, {"met", 1},
                                             {"first", 1},   {"returns", 1},    {"shadow", 1}};

template <int N>
constexpr Record record(std::string_view name, std::string_view meaning, const RecordField (&fields)[N]) {
  return {name, meaning, fields, N};
}
inline constexpr Record kTest =
    record("test", "what a lane of the traverser gives a triangle pipe: a triangle, and its ray", kTestFields);
inline constexpr Record kTriangle = record("triangle", "a triangle in the traverser's memory", kTriangleFields);
inline constexpr Record kNode = record("node", "a node there, the low bits of its line", kNodeFields);
inline constexpr Record kRay =
    record("ray", "a ray, in beats of 128 bits; word by word machine/common/packages.hpp", kRayFields);

inline constexpr Record kAll[] = {kTest, kTriangle, kNode, kRay};
}  // namespace record

}  // namespace raypool
