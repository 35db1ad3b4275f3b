// What rays have come to in each pixel of a picture, as a digest: two pictures of a frame can be asked where a ray has
// hit something else, and where only a shadow or the colour differs.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "kernel/kernels.hpp"
#include "scene/picture_file.hpp"

namespace raypool {

/// Why a pixel is not the same in two pictures: an eye ray or a reflection hits another triangle, or only one of them
/// hits; else a shadow ray is free in one and not in the other; else numbers are rounded otherwise.
enum class PixelCause : uint8_t { Hit, Shadow, Colour };
inline constexpr size_t kPixelCauses = 3;
inline constexpr const char* kPixelCauseNames[kPixelCauses] = {"hit", "shadow", "colour"};

class PixelDecisions {
 public:
  PixelDecisions() = default;
  PixelDecisions(uint32_t width, uint32_t height) : width_(width), height_(height), pixels_(size_t{width} * height) {}

  uint32_t width() const { return width_; }
  uint32_t height() const { return height_; }

  /// What a ray of pixel x | y << 16 has come to, in the order in which the pixel's are traced. From several threads,
  /// of different pixels.
  void hit(uint32_t pixel, uint32_t triangle) { mix(at(pixel).hits, triangle + 1); }
  void miss(uint32_t pixel) { mix(at(pixel).hits, 0); }
  void shadow(uint32_t pixel, bool free) { mix(at(pixel).shadows, free); }

  /// Of a pixel in which the pictures differ.
  PixelCause cause(const PixelDecisions& other, size_t number) const {
    const Pixel &a = pixels_[number], &b = other.pixels_[number];
    return a.hits != b.hits ? PixelCause::Hit : a.shadows != b.shadows ? PixelCause::Shadow : PixelCause::Colour;
  }

  std::string to_bytes() const;
  /// Throws InputError, which begins with `where`.
  static PixelDecisions from_bytes(const std::string& bytes, const std::string& where);

 private:
  struct Pixel {
    uint64_t hits = 0, shadows = 0;
  };

  Pixel& at(uint32_t pixel) { return pixels_[size_t{pixel >> 16} * width_ + (pixel & 0xffff)]; }
  // FNV-1a, a word at a time.
  static void mix(uint64_t& digest, uint64_t word) {
    digest = (digest ^ (word + 1)) * 0x100000001b3 + 0x9e3779b97f4a7c15;
  }

  uint32_t width_ = 0, height_ = 0;
  std::vector<Pixel> pixels_;
};

/// How engine `native` asks what a ray meets: NativeOptions::trace.
using TraceRay = std::function<bool(const Ray&, Intersection&)>;
/// The same answers as `trace`, recorded in `decisions`.
TraceRay told(TraceRay trace, PixelDecisions& decisions);

/// A picture with what its rays have come to.
struct DecidedPicture {
  Picture picture;
  PixelDecisions decisions;
};
/// Of each pixel: why it differs, or nothing where it does not. All of both must be of the same size.
std::vector<std::optional<PixelCause>> causes_of(const DecidedPicture& a, const DecidedPicture& b);
/// Pixels by cause.
std::array<uint64_t, kPixelCauses> count_causes(const std::vector<std::optional<PixelCause>>& causes);

}  // namespace raypool
