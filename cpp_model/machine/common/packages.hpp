// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The two packages that travel between pools, compute units and traverser. Words are raw 32-bit patterns.
#pragma once

#include <array>
#include <cstdint>

#include "isa/isa.hpp"

namespace raypool {

inline constexpr int kRayWords = 12;                      ///< 48 bytes
inline constexpr int kIntersectionWords = kPackageWords;  ///< 84 bytes
inline constexpr int kBeatWords = 4;                      ///< 128 bits, one cycle of any pool or memory port
inline constexpr int kRayBeats = 3;
inline constexpr int kIntersectionBeats = 6;  ///< of a whole one: the last carries word 20 and zeros

/// Word numbers; a ray has words 0-11, an intersection is its ray followed by words 12-20.
namespace word {
inline constexpr int kOrigin = 0;        ///< x, y, z
inline constexpr int kDirection = 3;     ///< x, y, z, not normalised
inline constexpr int kLimit = 6;         ///< largest t: infinity, or 1 for a shadow ray
inline constexpr int kPixel = 7;         ///< x in bits 15:0, y in bits 31:16
inline constexpr int kColor = 8;         ///< red, green, blue: throughput (normal ray) or contribution (shadow ray)
inline constexpr int kFlags = 11;        ///< the flags below, depth in bits 7:0 (an eye ray has 1)
inline constexpr int kDistance = 12;     ///< t of the hit
inline constexpr int kBarycentric = 13;  ///< u, v
inline constexpr int kNormal = 15;       ///< unit geometric normal, as wound
inline constexpr int kMaterial = 18;     ///< byte address of the material record
inline constexpr int kTriangle = 19;     ///< triangle index
}  // namespace word

inline constexpr uint32_t kShadowFlag = 0x80000000u;
// With chip.miss_records, of rays that are no shadow rays; without it these bits are the kernels' own.
inline constexpr uint32_t kReturnsFlag = 0x40000000u;  ///< it comes back as a package even if it meets nothing
inline constexpr uint32_t kFirstFlag = 0x20000000u;    ///< any hit ends such a ray, and its package carries none
inline constexpr uint32_t kMetFlag = 0x10000000u;      ///< in the package of such a ray: it has met something
inline constexpr uint32_t kDepthMask = 0xffu;

using Ray = std::array<uint32_t, kRayWords>;
using Intersection = std::array<uint32_t, kIntersectionWords>;
using Beat = std::array<uint32_t, kBeatWords>;

inline bool is_shadow(const Ray& ray) { return (ray[word::kFlags] & kShadowFlag) != 0; }
/// Of a chip with miss_records.
inline bool returns(const Ray& ray) { return (ray[word::kFlags] & (kShadowFlag | kReturnsFlag)) == kReturnsFlag; }
/// A ray that returns, and any hit ends it.
inline bool returns_first(const Ray& ray) { return returns(ray) && (ray[word::kFlags] & kFirstFlag) != 0; }
/// The package of a ray that returns shows whether it has met something, whatever the ray had there.
inline void set_met(Intersection& package, bool met) {
  package[word::kFlags] = (package[word::kFlags] & ~kMetFlag) | (met ? kMetFlag : 0);
}

/// How an intersection travels, and lies in ray memory: whole, or as a compact record, which has the words that kernels
/// need.
struct RecordLayout {
  static constexpr uint8_t kAbsent = 255;
  uint32_t words = kIntersectionWords;  ///< of the record
  std::array<uint8_t, kIntersectionWords> place = {0,  1,  2,  3,  4,  5,  6,  7,  8,  9, 10,
                                                   11, 12, 13, 14, 15, 16, 17, 18, 19, 20};  ///< [word] in the record

  /// Of what is a record of so many words already.
  static RecordLayout in_order(uint32_t words) {
    RecordLayout layout;
    layout.words = words;
    for (uint32_t word = words; word < kIntersectionWords; ++word) layout.place[word] = kAbsent;
    return layout;
  }
};

/// Of each place of a record its word, or kNoWord where it has none: it is zero.
inline constexpr uint8_t kNoWord = 31;
inline std::array<uint8_t, kIntersectionWords> words_of(const RecordLayout& layout) {
  std::array<uint8_t, kIntersectionWords> words;
  words.fill(kNoWord);
  for (size_t word = 0; word < layout.place.size(); ++word)
    if (layout.place[word] != RecordLayout::kAbsent) words[layout.place[word]] = static_cast<uint8_t>(word);
  return words;
}

/// The record of an intersection, and zeros.
inline Intersection packed(const Intersection& intersection, const RecordLayout& layout) {
  Intersection record{};
  for (size_t word = 0; word < intersection.size(); ++word)
    if (layout.place[word] != RecordLayout::kAbsent) record[layout.place[word]] = intersection[word];
  return record;
}

/// Whether a ray's weight is zero in each channel: whatever it finds adds nothing to the picture.
inline bool is_black(const Ray& ray) {
  return ((ray[word::kColor] | ray[word::kColor + 1] | ray[word::kColor + 2]) & 0x7fffffffu) == 0;
}

/// Material record in memory: diffuse r, g, b, 0, reflectance r, g, b, 0 (floats).
inline constexpr int kMaterialBytes = 32;
inline constexpr int kMaterialDiffuse = 0;       ///< byte offset
inline constexpr int kMaterialReflectance = 16;  ///< byte offset

}  // namespace raypool
