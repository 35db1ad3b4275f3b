// For tests of glTF files: documents with one buffer, and what they are loaded as.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bits.hpp"
#include "scene/file_fixture.hpp"
#include "scene/scene_file.hpp"

namespace raypool {

using Json = nlohmann::ordered_json;

inline std::string base64(const std::string& bytes) {
  constexpr const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t bits = 0;
    for (size_t k = 0; k < 3; ++k) bits = bits << 8 | (i + k < bytes.size() ? static_cast<uint8_t>(bytes[i + k]) : 0);
    for (size_t k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : kDigits[bits >> (18 - 6 * k) & 63];
  }
  return text;
}

inline std::string glb(const Json& json, std::string binary) {
  std::string text = json.dump(), bytes = "glTF";
  text.resize((text.size() + 3) / 4 * 4, ' ');
  binary.resize((binary.size() + 3) / 4 * 4, '\0');
  append(bytes, uint32_t{2});
  append(bytes, static_cast<uint32_t>(12 + 8 + text.size() + 8 + binary.size()));
  append(bytes, size32(text));
  bytes += "JSON" + text;
  append(bytes, size32(binary));
  return bytes + std::string("BIN\0", 4) + binary;
}

/// A document with one buffer, which arrays are added to.
struct GltfText {
  Json json = {{"asset", {{"version", "2.0"}}}, {"scene", 0}};
  std::string bytes;

  size_t add_accessor(size_t count, int component, const char* type, size_t begin) {
    json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", begin}, {"byteLength", bytes.size() - begin}});
    json["accessors"].push_back({{"bufferView", json["bufferViews"].size() - 1},
                                 {"componentType", component},
                                 {"count", count},
                                 {"type", type}});
    return json["accessors"].size() - 1;
  }
  size_t add_positions(const std::vector<Vec3>& positions) {
    const size_t begin = bytes.size();
    for (const Vec3& p : positions) {
      for (int axis = 0; axis < 3; ++axis) append(bytes, p[axis]);
    }
    return add_accessor(positions.size(), 5126, "VEC3", begin);
  }
  template <typename Index>
  size_t add_indices(const std::vector<Index>& indices) {
    const size_t begin = bytes.size();
    for (const Index index : indices) append(bytes, index);
    return add_accessor(indices.size(), sizeof(Index) == 1 ? 5121 : sizeof(Index) == 2 ? 5123 : 5125, "SCALAR", begin);
  }
  /// Nodes are the roots of the scene unless it has been given.
  std::string text() {
    Json whole = finished();
    whole["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64(bytes);
    return whole.dump();
  }
  Json finished() const {
    Json whole = json;
    if (!whole.contains("scenes")) {
      for (size_t i = 0; i < whole["nodes"].size(); ++i) whole["scenes"][0]["nodes"].push_back(i);
    }
    if (!whole.contains("buffers")) whole["buffers"] = {{{"byteLength", bytes.size()}}};
    return whole;
  }
};

inline const std::vector<Vec3> kCorners = {{0, 0, 0}, {2, 0, 0}, {0, 1, 0}};

/// One triangle in one node.
inline GltfText gltf_triangle() {
  GltfText document;
  const size_t positions = document.add_positions(kCorners), indices = document.add_indices<uint16_t>({0, 1, 2});
  document.json["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", positions}}}, {"indices", indices}}}}}};
  document.json["nodes"] = {{{"mesh", 0}}};
  return document;
}

class GltfFixture : public FileFixture {
 protected:
  SceneFile load(GltfText document, const std::string& camera = "") const {
    return load_gltf(write("a.gltf", document.text()), camera);
  }
  Scene scene(const GltfText& document) const { return load(document).scene; }
  void expect_refusal_of(const std::string& bytes, const std::string& part, const std::string& camera = "") const {
    const std::string path = write("a.gltf", bytes), message = refusal([&] { load_gltf(path, camera); });
    EXPECT_EQ(message.rfind("a.gltf: ", 0), 0u) << message;
    EXPECT_NE(message.find(part), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
  void expect_refusal(GltfText document, const std::string& part) const { expect_refusal_of(document.text(), part); }
};

inline void expect_near(const Vec3& a, const Vec3& b) {
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(a[axis], b[axis], 1e-6) << "axis " << axis;
}

}  // namespace raypool
