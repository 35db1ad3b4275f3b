// The image files that materials name, each read and decoded once.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "scene/surfaces.hpp"

namespace raypool {

/// Where a channel of an image comes from.
struct ImageChannel {
  std::string name;           ///< of the image; empty: the channel is 1 everywhere
  size_t channel = 0;         ///< 0 .. 3: red, green, blue, alpha
  bool alpha_or_red = false;  ///< alpha where the image is not opaque all over, or else red

  bool operator<(const ImageChannel& other) const {
    return std::tie(name, channel, alpha_or_red) < std::tie(other.name, other.channel, other.alpha_or_red);
  }
};

class SurfaceImages {
 public:
  /// The bytes of the image of this name; throws InputError where there are none.
  using Read = std::function<std::string(const std::string& name)>;

  /// An image that cannot be read gets one of `warnings`, which begins with the file's `path`.
  SurfaceImages(std::string path, Surfaces& surfaces, std::vector<std::string>& warnings, Read read)
      : path_(std::move(path)), surfaces_(surfaces), warnings_(warnings), read_(std::move(read)) {}

  /// Its index in Surfaces::images; none: it cannot be read.
  std::optional<uint32_t> find(const std::string& name, bool srgb);
  /// One of channels of several, as large as the first of them. `srgb`: of red, green and blue. None when none of them
  /// can be read.
  std::optional<uint32_t> combine(const std::array<ImageChannel, 4>& channels, bool srgb);

 private:
  const std::string* bytes(const std::string& name);
  const SurfaceImage* decoded(const std::string& name, bool srgb);
  void warn(const std::string& name, const std::string& reason);

  std::string path_;
  Surfaces& surfaces_;
  std::vector<std::string>& warnings_;
  Read read_;
  std::map<std::string, std::optional<std::string>> bytes_;
  std::map<std::pair<std::string, bool>, std::optional<SurfaceImage>> decoded_;
  std::map<std::pair<std::string, bool>, std::optional<uint32_t>> found_;
  std::map<std::pair<std::array<ImageChannel, 4>, bool>, std::optional<uint32_t>> combined_;
};

}  // namespace raypool
