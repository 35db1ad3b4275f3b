// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// What the bindings of a shader set hold: where buffers and textures lie in the unit's memory, and the words of uniform
// blocks, which are known when the kernels are compiled. docs/use/shaders.md has the layouts.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace raypool::shader {

/// A line of the data cache.
inline constexpr uint32_t kLineBytes = 64;

/// Values of a thread that a kernel may keep in memory.
inline constexpr int kSpillSlots = 256;

/// Descriptor set and binding.
using Place = std::pair<uint32_t, uint32_t>;

/// Which shader has the record: its stage, and its number in it. Hit groups count as closest-hit shaders.
enum class RecordStage : uint8_t { RayGeneration, Miss, HitGroup, Callable };
using RecordPlace = std::pair<RecordStage, uint32_t>;

/// A word of a uniform block or of push constants: its bits, or the number of the kernel argument that has them.
struct Word {
  uint32_t bits = 0;
  std::optional<uint32_t> argument;
};

/// A storage buffer in the unit's memory.
struct Buffer {
  uint32_t address = 0;  ///< a multiple of 16
  uint32_t bytes = 0;
};

/// Consecutive texture records of kTextureBytes in the unit's memory: what a sampler, or an array of them, stands for.
struct Textures {
  uint32_t address = 0;  ///< of the first record, a multiple of 32
  uint32_t count = 0;
};

/// A texture record: address of the texels (a multiple of 64), width, height, wrap modes (words). Texel (x, y) is at
/// address + 8 (y width + x): red, green, blue, alpha as 16 bits each, linear, 65535 is 1.
inline constexpr uint32_t kTextureBytes = 16;
inline constexpr uint32_t kTextureWrapS = 1;       ///< bits 1:0 of the wrap word: a Wrap
inline constexpr uint32_t kTextureWrapTShift = 2;  ///< bits 3:2
inline constexpr uint32_t kTextureNearest = 16;    ///< bit 4: no bilinear filter
enum class Wrap : uint32_t { Repeat = 0, Clamp = 1, Mirror = 2 };

struct Resources {
  std::map<Place, Buffer> buffers;
  std::map<Place, std::vector<Word>> blocks;  ///< uniform blocks, by word of their layout
  std::map<Place, Textures> textures;
  std::set<Place> unseen;  ///< pictures of which nothing is kept
  std::vector<Word> push_constants;
  std::map<RecordPlace, std::vector<Word>> records;  ///< of shaders, by word of their layout
  /// Address of the first material record of 32 bytes, where each material is a geometry; none: all are geometry 0.
  std::optional<uint32_t> geometries;
  std::map<uint32_t, uint32_t> specialization;  ///< constant_id -> bits
  uint32_t width = 0, height = 0;               ///< of the picture, pixels
  /// Address of what kernels keep of their threads, behind all else; 0: nothing. Value n of thread t in unit u lies at
  /// spilled() + saved_stride() n + 4 (threads u + t): a unit runs no other thread t meanwhile.
  uint32_t saved = 0;
  uint32_t units = 1;    ///< of the machine
  uint32_t threads = 1;  ///< of a unit: warps x lanes, a power of two
  /// Of sets that wait for their rays: words that a path's record takes. Records lie at saved + path_bytes()
  /// (y path_pitch() + x); the values above come behind them. With several units a path goes on in any of them, and
  /// their data caches do not see each other's stores.
  uint32_t path_words = 0;
  /// How many closest-hit shaders of a path may wait for their rays at a time, where they wait for each other: 1 or
  /// more.
  uint32_t levels = 1;
  uint64_t path_bytes() const { return (uint64_t{4} * path_words + kLineBytes - 1) / kLineBytes * kLineBytes; }
  /// An odd number of eights, so that rows of a tile lie in different sets of the cache.
  uint64_t path_pitch() const { return 8 * ((uint64_t{width} + 7) / 8 | 1); }
  uint64_t paths_bytes() const { return path_bytes() * path_pitch() * height; }
  /// Where value 0 lies: saved, but for records of paths.
  uint32_t spilled() const { return static_cast<uint32_t>(saved + paths_bytes()); }
  /// Whole lines, so that no two units' values share one.
  uint64_t saved_stride() const { return (uint64_t{4} * units * threads + kLineBytes - 1) / kLineBytes * kLineBytes; }
};

}  // namespace raypool::shader
