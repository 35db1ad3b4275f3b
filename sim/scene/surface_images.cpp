#include "scene/surface_images.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "bits.hpp"
#include "isa/input_error.hpp"
#include "scene/image_decoding.hpp"

namespace raypool {
namespace {

constexpr uint16_t kOne = 65535;
constexpr size_t kAlpha = 3;

bool is_opaque(const SurfaceImage& image) {
  for (size_t i = kAlpha; i < image.texels.size(); i += 4) {
    if (image.texels[i] != kOne) return false;
  }
  return true;
}

}  // namespace

void SurfaceImages::warn(const std::string& name, const std::string& reason) {
  // The message of the file's reader names it too.
  const std::string prefix = path_ + ": ";
  const std::string why = reason.compare(0, prefix.size(), prefix) == 0 ? reason.substr(prefix.size()) : reason;
  warnings_.push_back(
      fmt::format("{}: image '{}' is left out: {}; the colours beside it are used alone", path_, name, why));
}

const std::string* SurfaceImages::bytes(const std::string& name) {
  const auto known = bytes_.find(name);
  if (known != bytes_.end()) return known->second ? &*known->second : nullptr;
  std::optional<std::string> read;
  try {
    read = read_(name);
  } catch (const InputError& error) {
    warn(name, error.what());
  }
  const auto added = bytes_.emplace(name, std::move(read)).first;
  return added->second ? &*added->second : nullptr;
}

const SurfaceImage* SurfaceImages::decoded(const std::string& name, bool srgb) {
  const auto known = decoded_.find({name, srgb});
  if (known != decoded_.end()) return known->second ? &*known->second : nullptr;
  std::optional<SurfaceImage> image;
  if (const std::string* const file = bytes(name)) {
    std::string reason;
    image = decode_image(*file, srgb, reason);
    if (!image && decoded_.find({name, !srgb}) == decoded_.end()) warn(name, reason);
  }
  const auto added = decoded_.emplace(std::make_pair(name, srgb), std::move(image)).first;
  return added->second ? &*added->second : nullptr;
}

std::optional<uint32_t> SurfaceImages::find(const std::string& name, bool srgb) {
  const auto known = found_.find({name, srgb});
  if (known != found_.end()) return known->second;
  std::optional<uint32_t> result;
  if (const SurfaceImage* const image = decoded(name, srgb)) {
    surfaces_.images.push_back(*image);
    result = size32(surfaces_.images) - 1;
    decoded_.erase({name, srgb});  // the only copy is that of the surfaces
  }
  found_.emplace(std::make_pair(name, srgb), result);
  return result;
}

std::optional<uint32_t> SurfaceImages::combine(const std::array<ImageChannel, 4>& channels, bool srgb) {
  const auto key = std::make_pair(channels, srgb);
  const auto known = combined_.find(key);
  if (known != combined_.end()) return known->second;
  std::array<const SurfaceImage*, 4> sources{};
  std::array<size_t, 4> from{};
  SurfaceImage result;
  for (size_t i = 0; i < channels.size(); ++i) {
    if (channels[i].name.empty()) continue;
    sources[i] = decoded(channels[i].name, srgb && i != kAlpha);
    if (sources[i] == nullptr) continue;
    from[i] = !channels[i].alpha_or_red ? channels[i].channel : is_opaque(*sources[i]) ? 0 : kAlpha;
    if (result.width != 0) continue;
    result.width = sources[i]->width;
    result.height = sources[i]->height;
  }
  std::optional<uint32_t> index;
  if (result.width != 0) {
    result.texels.resize(size_t{4} * result.width * result.height, kOne);
    for (size_t i = 0; i < channels.size(); ++i) {
      if (sources[i] == nullptr) continue;
      const SurfaceImage& source = *sources[i];
      for (size_t y = 0; y < result.height; ++y) {
        const size_t row = y * source.height / result.height;
        for (size_t x = 0; x < result.width; ++x) {
          const size_t column = x * source.width / result.width;
          result.texels[4 * (y * result.width + x) + i] = source.texels[4 * (row * source.width + column) + from[i]];
        }
      }
    }
    surfaces_.images.push_back(std::move(result));
    index = size32(surfaces_.images) - 1;
  }
  combined_.emplace(key, index);
  return index;
}

}  // namespace raypool
