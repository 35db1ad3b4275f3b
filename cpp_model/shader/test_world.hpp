// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// For tests: content for everything that a shader declares, and rays and hits that come to it.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "bits.hpp"
#include "kernel/kernels.hpp"
#include "machine/chip/ray_kernel.hpp"
#include "random.hpp"
#include "shader/module.hpp"
#include "shader/resources.hpp"

namespace raypool::shader {

inline constexpr uint32_t kWidth = 16, kHeight = 8, kDepth = 6;
inline constexpr uint32_t kElements = 16;  // of arrays without a size, of textures and of material records
inline constexpr uint32_t kMemoryBytes = 1 << 16;
// Behind it what kernels spill.
inline constexpr uint32_t kWithSpilled = kMemoryBytes + kLineBytes * kSpillSlots;
inline constexpr uint32_t kTexelSide = 4;
inline constexpr uint32_t kFirstArgument = 24;  // that a uniform word may be: four floats, then four integers

/// A multiple of 1/8 from -4 to 4.
inline uint32_t some_float(Random& random) { return as_bits((static_cast<float>(random() % 65) - 32.0f) / 8.0f); }

inline float share(Random& random) { return static_cast<float>(random() % 4096) / 4096.0f; }

/// A folder that goes when this does.
class Scratch {
 public:
  Scratch() : path_(std::filesystem::path(testing::TempDir()) / fmt::format("raypool-shaders-{}", ::getpid())) {
    std::filesystem::create_directories(path_);
  }
  ~Scratch() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Scratch(const Scratch&) = delete;
  std::string write(const std::string& name, const std::string& text) const {
    std::string path = (path_ / name).string();
    std::ofstream(path) << text;
    return path;
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Memory, blocks and buffers with content for everything that a shader declares: floats where it has floats, small
/// integers where it has integers, so that they are indices of something.
class World {
 public:
  explicit World(Random& random) : memory(kWithSpilled), random_(random) {
    resources.width = kWidth;
    resources.height = kHeight;
    resources.saved = kMemoryBytes;
    for (uint32_t i = 0; i < 4; ++i) {
      arguments[kFirstArgument + i] = some_float(random);
      arguments[kFirstArgument + 4 + i] = random() % 4;
    }
    arguments[argument::kTileWidthLog2] = 3;
    arguments[argument::kTileMask] = 7;
    arguments[argument::kSample] = 3;
    // Textures, and material records with the address of something in their fourth word.
    textures_ = take(kElements * kTextureBytes);
    for (uint32_t i = 0; i < kElements; ++i) {
      const uint32_t texels = take(8 * kTexelSide * kTexelSide);
      for (uint32_t n = 0; n < 2 * kTexelSide * kTexelSide; ++n) memory.store(texels + 4 * n, random());
      const uint32_t record = textures_ + i * kTextureBytes;
      memory.store(record, texels);
      memory.store(record + 4, 1 + random() % kTexelSide);
      memory.store(record + 8, 1 + random() % kTexelSide);
      memory.store(record + 12, random() % 3 | (random() % 3) << 2 | (random() % 2) << 4);
    }
    records_ = take(kElements * kMaterialBytes);
    for (uint32_t i = 0; i < kElements; ++i) {
      const uint32_t material = take(64), record = records_ + i * kMaterialBytes;
      for (uint32_t n = 0; n < 16; ++n) memory.store(material + 4 * n, n < 12 ? some_float(random) : random() % 4);
      for (uint32_t n = 0; n < 8; ++n) memory.store(record + 4 * n, some_float(random));
      memory.store(record + 12, material);
      memory.store(record + 28, 0);
    }
  }

  /// What the shader declares, and no shader before it.
  void add(const Module& module, bool counted = false) {
    for (const auto& [id, variable] : module.variables()) {
      const Decorations& decorations = module.decorations(id);
      const Place place = {decorations.set.value_or(0), decorations.binding.value_or(0)};
      const uint32_t type = module.type(variable.type).element;
      switch (variable.storage) {
        case spv::StorageClass::PushConstant:
          resources.push_constants = words(module, type, counted);
          break;
        case spv::StorageClass::ShaderRecordBufferKHR:
          resources.records[{record_stage(module.stage()), module.number()}] = words(module, type, counted);
          break;
        case spv::StorageClass::Uniform:
          if (resources.blocks.count(place) == 0) resources.blocks[place] = words(module, type, counted);
          break;
        case spv::StorageClass::StorageBuffer: {
          if (resources.buffers.count(place) != 0) break;
          const std::vector<Word> content = words(module, type, counted);
          const uint32_t address = take(4 * size32(content));
          for (uint32_t i = 0; i < content.size(); ++i) {
            const Word& word = content[i];
            memory.store(address + 4 * i, word.argument ? arguments[*word.argument] : word.bits);
          }
          resources.buffers[place] = {address, 4 * size32(content)};
          break;
        }
        case spv::StorageClass::UniformConstant:
          resources.textures[place] = {textures_, kElements};
          break;
        default:
          break;
      }
    }
  }

  /// A ray, or an intersection, that may come to a lane. Lanes have different pixels.
  Intersection input(uint32_t lane) {
    Intersection words{};
    for (int i = 0; i < 3; ++i) {
      words.at(static_cast<size_t>(word::kOrigin + i)) = some_float(random_);
      words.at(static_cast<size_t>(word::kDirection + i)) = some_float(random_);
    }
    words[word::kLimit] = as_bits(random_() % 2 != 0 ? 1.0f : std::numeric_limits<float>::infinity());
    words[word::kPixel] = (8 * (random_() % (kWidth / 8)) + lane) | (random_() % kHeight) << 16;
    const uint32_t kind = static_cast<uint32_t>(random_() % 4);
    for (size_t i = word::kColor; i < word::kColor + 3; ++i)
      words.at(i) = kind == 0   ? some_float(random_)
                    : kind == 1 ? random_()
                    : kind == 2 ? random_() % 8
                                : as_bits(share(random_));
    words[word::kFlags] = (1 + random_() % kDepth) | (random_() & 0xffff) << 8;
    put_hit(words, random_);
    return words;
  }

  /// Where a ray has met the scene.
  void put_hit(Intersection& words, Random& random) const {
    const auto put = [&](int number, float value) { words.at(static_cast<size_t>(number)) = as_bits(value); };
    for (int i = 0; i < 3; ++i) put(word::kBarycentric + i, 0.5f * share(random));
    put(word::kDistance, 8.0f * share(random));
    float normal[3] = {share(random) - 0.5f, share(random) - 0.5f, 0.25f + share(random)};
    const float length = std::sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    for (int i = 0; i < 3; ++i) put(word::kNormal + i, normal[i] / length);
    words[word::kMaterial] = records_ + static_cast<uint32_t>(random() % kElements) * kMaterialBytes;
    words[word::kTriangle] = random() % kElements;
  }

  Memory memory;
  Resources resources;
  std::array<uint32_t, kArguments> arguments{};

 private:
  uint32_t take(uint32_t bytes) {
    const uint32_t address = next_;
    next_ += (bytes + 63) / 64 * 64;
    EXPECT_LE(next_, kMemoryBytes);
    return address;
  }

  /// The content of a block, by word.
  std::vector<Word> words(const Module& module, uint32_t type, bool counted) {
    std::vector<Word> content;
    visit(module, type, 0, 0, false, [&](uint32_t byte, const Type& scalar) {
      if (byte / 4 >= content.size()) content.resize(byte / 4 + 1);
      Word& word = content[byte / 4];
      const bool is_float = scalar.kind == TypeKind::Float;
      word.bits = is_float ? some_float(random_) : random_() % 8;
      if (random_() % 8 == 0) word.argument = kFirstArgument + random_() % 4 + (is_float ? 0 : 4);
    });
    if (counted)
      for (uint32_t i = 0; i < content.size(); ++i) content[i] = {as_bits(static_cast<float>(i)), std::nullopt};
    return content;
  }

  template <typename Visit>
  static void visit(const Module& module, uint32_t type, uint32_t byte, uint32_t matrix_stride, bool row_major,
                    const Visit& leaf) {
    const Type& its = module.type(type);
    const uint32_t count = its.kind == TypeKind::RuntimeArray ? kElements : its.count;
    switch (its.kind) {
      case TypeKind::Struct:
        for (uint32_t m = 0; m < its.members.size(); ++m) {
          const MemberLayout& layout = module.layout(type, m);
          visit(module, its.members[m], byte + layout.offset, layout.matrix_stride, layout.row_major, leaf);
        }
        return;
      case TypeKind::Array:
      case TypeKind::RuntimeArray:
        for (uint32_t i = 0; i < count; ++i)
          visit(module, its.element, byte + i * its.stride, matrix_stride, row_major, leaf);
        return;
      case TypeKind::Matrix:
        for (uint32_t c = 0; c < count; ++c) {
          for (uint32_t r = 0; r < module.type(its.element).count; ++r)
            leaf(byte + (row_major ? r * matrix_stride + 4 * c : c * matrix_stride + 4 * r),
                 module.type(module.type(its.element).element));
        }
        return;
      case TypeKind::Vector:
        for (uint32_t i = 0; i < count; ++i) leaf(byte + 4 * i, module.type(its.element));
        return;
      case TypeKind::Pointer:
        return;  // nothing that could be followed
      default:
        leaf(byte, its);
        if (module.is_wide(type)) leaf(byte + 4, its);
    }
  }

  Random& random_;
  uint32_t next_ = 256, textures_ = 0, records_ = 0;
};

}  // namespace raypool::shader
