#include "scene/pixel_decisions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "isa/input_error.hpp"

namespace raypool {
namespace {

constexpr const char* kBegins = "raypool decisions 1\n";

void append(std::string& bytes, uint64_t value) {
  for (int i = 0; i < 8; ++i) bytes += static_cast<char>(value >> (8 * i) & 0xff);
}
uint64_t number_at(const std::string& bytes, size_t place) {
  uint64_t value = 0;
  for (size_t i = 0; i < 8; ++i) value |= uint64_t{static_cast<uint8_t>(bytes[place + i])} << (8 * i);
  return value;
}

}  // namespace

std::string PixelDecisions::to_bytes() const {
  std::string bytes = kBegins;
  append(bytes, width_ | uint64_t{height_} << 32);
  for (const Pixel& pixel : pixels_) {
    append(bytes, pixel.hits);
    append(bytes, pixel.shadows);
  }
  return bytes;
}

PixelDecisions PixelDecisions::from_bytes(const std::string& bytes, const std::string& where) {
  const std::string begins = kBegins;
  if (bytes.compare(0, begins.size(), begins) != 0 || bytes.size() < begins.size() + 8)
    throw InputError(fmt::format("{}: not what a frame's rays have come to: draw it again", where));
  const uint64_t size = number_at(bytes, begins.size());
  const auto width = static_cast<uint32_t>(size), height = static_cast<uint32_t>(size >> 32);
  const size_t first = begins.size() + 8;
  if (width > 65535 || height > 65535 || bytes.size() != first + 16 * size_t{width} * height)
    throw InputError(fmt::format("{}: it is cut off, or not of {}x{} pixels: draw it again", where, width, height));
  PixelDecisions decisions(width, height);
  for (size_t i = 0; i < decisions.pixels_.size(); ++i)
    decisions.pixels_[i] = {number_at(bytes, first + 16 * i), number_at(bytes, first + 16 * i + 8)};
  return decisions;
}

TraceRay told(TraceRay trace, PixelDecisions& decisions) {
  return [trace = std::move(trace), &decisions](const Ray& ray, Intersection& intersection) {
    const bool goes_on = trace(ray, intersection);
    const uint32_t pixel = ray[word::kPixel];
    if ((ray[word::kFlags] & kShadowFlag) != 0) {
      decisions.shadow(pixel, goes_on);
    } else if (goes_on) {
      decisions.hit(pixel, intersection[word::kTriangle]);
    } else {
      decisions.miss(pixel);
    }
    return goes_on;
  };
}

std::vector<std::optional<PixelCause>> causes_of(const DecidedPicture& a, const DecidedPicture& b) {
  const std::vector<uint8_t>&first = a.picture.rgb, &second = b.picture.rgb;
  std::vector<std::optional<PixelCause>> causes(first.size() / 3);
  for (size_t pixel = 0; pixel < causes.size(); ++pixel) {
    if (!std::equal(&first[3 * pixel], &first[3 * pixel] + 3, &second[3 * pixel]))
      causes[pixel] = a.decisions.cause(b.decisions, pixel);
  }
  return causes;
}

std::array<uint64_t, kPixelCauses> count_causes(const std::vector<std::optional<PixelCause>>& causes) {
  std::array<uint64_t, kPixelCauses> count{};
  for (const std::optional<PixelCause>& cause : causes) {
    if (cause) ++count[static_cast<size_t>(*cause)];
  }
  return count;
}

}  // namespace raypool
