#include <cstdint>
#include <cstring>
#include <unordered_map>

#include "bits.hpp"
#include "scene/scene_file.hpp"

namespace raypool {
namespace {

struct PlaceHash {
  size_t operator()(const Vec3& v) const {
    uint64_t hash = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const float value = v[axis] + 0.0f;  // -0 and 0 are one place
      uint32_t bits = 0;
      std::memcpy(&bits, &value, sizeof bits);
      hash = (hash ^ bits) * 0x9e3779b97f4a7c15u;
      hash ^= hash >> 32;
    }
    return hash;
  }
};

}  // namespace

void weld_vertices(Scene& scene) {
  std::unordered_map<Vec3, uint32_t, PlaceHash> known;
  std::vector<Vec3> vertices;
  for (auto& triangle : scene.triangles) {
    for (uint32_t& index : triangle) {
      const auto added = known.emplace(scene.vertices[index], size32(vertices));
      if (added.second) vertices.push_back(scene.vertices[index]);
      index = added.first->second;
    }
  }
  scene.vertices.swap(vertices);
}

}  // namespace raypool
