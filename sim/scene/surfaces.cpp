#include "scene/surfaces.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <unordered_map>

#include "bits.hpp"
#include "scene/scene.hpp"

namespace raypool {
namespace {

/// A vertex with the normal of its triangle, which may have others.
struct FlatVertex {
  uint32_t vertex;
  Vec3 normal;
  bool operator==(const FlatVertex& other) const { return vertex == other.vertex && normal == other.normal; }
};
struct FlatVertexHash {
  size_t operator()(const FlatVertex& flat) const {
    uint64_t hash = flat.vertex;
    for (int axis = 0; axis < 3; ++axis) {
      hash = (hash ^ as_bits(flat.normal[axis] + 0.0f)) * 0x9e3779b97f4a7c15u;
      hash ^= hash >> 32;
    }
    return hash;
  }
};

/// Zero where there is none.
Vec3 unit(const Vec3& vector) {
  const Vec3d exact = vector.as<double>();
  const double size = length(exact);
  return size > 0 && std::isfinite(size) ? (exact * (1 / size)).as<float>() : Vec3{};
}

Vec3 normal_of(const Surfaces& surfaces, const std::array<uint32_t, 3>& triangle) {
  const Vec3d a = surfaces.positions[triangle[0]].as<double>(), b = surfaces.positions[triangle[1]].as<double>(),
              c = surfaces.positions[triangle[2]].as<double>();
  const Vec3d normal = cross(b - a, c - a);
  const double size = length(normal);
  return size > 0 ? (normal * (1 / size)).as<float>() : Vec3{0, 0, 1};  // of a line no ray hits it
}

template <typename T>
void pick(std::vector<T>& values, const std::vector<uint32_t>& from) {
  if (values.empty()) return;
  std::vector<T> picked;
  picked.reserve(from.size());
  for (const uint32_t vertex : from) picked.push_back(values[vertex]);
  values.swap(picked);
}

}  // namespace

uint32_t Surfaces::add_texture(const SurfaceTexture& texture) {
  const auto found = std::find(textures.begin(), textures.end(), texture);
  if (found != textures.end()) return static_cast<uint32_t>(found - textures.begin());
  textures.push_back(texture);
  return size32(textures) - 1;
}

void finish(Surfaces& surfaces) {
  constexpr uint32_t kNone = ~uint32_t{0};
  const Vec3 zero;
  surfaces.normals.resize(surfaces.positions.size());
  for (Vec3& normal : surfaces.normals) normal = unit(normal);
  std::vector<uint32_t> smooth(surfaces.positions.size(), kNone);
  std::unordered_map<FlatVertex, uint32_t, FlatVertexHash> flat;
  std::vector<uint32_t> from;  // [new vertex]
  std::vector<Vec3> normals;
  std::vector<std::array<uint32_t, 3>> triangles;
  triangles.reserve(surfaces.triangles.size());
  for (std::array<uint32_t, 3> triangle : surfaces.triangles) {
    const Vec3 own = normal_of(surfaces, triangle);
    for (uint32_t& vertex : triangle) {
      const bool is_flat = surfaces.normals[vertex] == zero;
      const auto next = size32(from);
      uint32_t& known = is_flat ? flat.emplace(FlatVertex{vertex, own}, kNone).first->second : smooth[vertex];
      if (known == kNone) {
        known = next;
        from.push_back(vertex);
        normals.push_back(is_flat ? own : surfaces.normals[vertex]);
      }
      vertex = known;
    }
    triangles.push_back(triangle);
  }
  surfaces.triangles.swap(triangles);
  surfaces.normals.swap(normals);
  pick(surfaces.positions, from);
  pick(surfaces.texcoords, from);
  pick(surfaces.colors, from);
}

Surfaces surfaces_of(const Scene& scene) {
  Surfaces surfaces;
  surfaces.triangles = scene.triangles;
  surfaces.positions = scene.vertices;
  for (const Material& material : scene.materials)
    surfaces.materials.push_back(surface_material(material.kd, material.ks));
  finish(surfaces);
  return surfaces;
}

SurfaceMaterial surface_material(const Vec3& kd, const Vec3& ks) {
  SurfaceMaterial material;
  const Vec3 base = kd + ks;
  for (int i = 0; i < 3; ++i) material.base_color[static_cast<size_t>(i)] = std::min(base[i], 1.0f);
  const float sum = base.x + base.y + base.z, mirror = ks.x + ks.y + ks.z;
  if (mirror > 0) {
    material.metallic = mirror / sum;
    material.roughness = 0;
  }
  return material;
}

double srgb_to_linear(double value) {
  return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

}  // namespace raypool
