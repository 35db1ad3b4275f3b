// A glTF file as it lies on disk: its JSON text, in .glb with a binary chunk behind it, and the buffers that it names.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "scene/json_place.hpp"

namespace raypool {

class GltfFile {
 public:
  /// Text or binary, by the first bytes. Throws InputError.
  explicit GltfFile(const std::string& path);
  GltfFile(const GltfFile&) = delete;
  GltfFile& operator=(const GltfFile&) = delete;

  const std::string& path() const { return path_; }
  JsonPlace root() const { return {json_, path_}; }
  /// The bytes of a buffer at this place of the document: from a file beside this one, a data URI or the binary chunk.
  /// As many as its byteLength.
  const std::string& buffer(const JsonPlace& place, size_t index);
  /// The bytes of an image at this place: from a buffer view, a file beside this one or a data URI.
  std::string image(const JsonPlace& place);

 private:
  std::string read_binary(const std::string& bytes);
  std::string read_external(const std::string& uri, const JsonPlace& place, const std::string& what) const;

  std::string path_;
  JsonPlace::Json json_;
  bool has_chunk_ = false;
  std::string chunk_;
  std::map<size_t, std::string> buffers_;
};

}  // namespace raypool
