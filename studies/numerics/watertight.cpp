#include "numerics/watertight.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <set>

#include "scene/hits_check.hpp"
#include "scene/mesh_builder.hpp"
#include "scene/traversal.hpp"

namespace raypool::numerics {
namespace {

/// Only every so many rays are judged exactly: that is slow.
constexpr uint64_t kJudged = 64;
/// A hit this much beyond the aim, as a share of its distance, is one of something else.
constexpr double kBeyond = 1e-3;

/// The poles are points, not rings.
double cosine(double angle) {
  const double value = std::cos(angle);
  return std::fabs(value) < 1e-9 ? 0 : value;
}

Scene with_material() {
  Scene scene;
  scene.materials.push_back({"grey", {0.5f, 0.5f, 0.5f}, {}});
  return scene;
}

WatertightMesh ball(const std::string& name, const Vec3d& centre, const Vec3d& radii, int around) {
  WatertightMesh mesh{name, with_material(), {}};
  MeshBuilder builder(mesh.scene, 1);
  builder.surface(around, around / 2, true, false, [&](double s, double t) {
    const double a = 2 * M_PI * s, b = M_PI * (t - 0.5);
    return centre + Vec3d{radii.x * cosine(b) * std::cos(a), radii.y * std::sin(b), -radii.z * cosine(b) * std::sin(a)};
  });
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> share(-0.4, 0.4);
  mesh.origins.push_back(centre.as<float>());
  for (int i = 0; i < 7; ++i) {
    mesh.origins.push_back(
        (centre + Vec3d{radii.x * share(random), radii.y * share(random), radii.z * share(random)}).as<float>());
  }
  return mesh;
}

WatertightMesh star() {
  WatertightMesh mesh{"bumpy body", with_material(), {Vec3{0, 0, 0}}};
  MeshBuilder builder(mesh.scene, 1);
  builder.surface(96, 48, true, false, [](double s, double t) {
    const double a = 2 * M_PI * s, b = M_PI * (t - 0.5);
    const double r = 1 + 0.3 * std::sin(9 * a) * std::sin(7 * b) * cosine(b);
    return Vec3d{r * cosine(b) * std::cos(a), r * std::sin(b), -r * cosine(b) * std::sin(a)};
  });
  return mesh;
}

WatertightMesh terrain() {
  WatertightMesh mesh{"terrain from above", with_material(), {}};
  MeshBuilder builder(mesh.scene, 1);
  builder.surface(64, 64, false, false, [](double s, double t) {
    return Vec3d{200 * s - 100, 3 * std::sin(17 * s) * std::cos(13 * t), 200 * t - 100};
  });
  for (int i = 0; i < 4; ++i) mesh.origins.push_back({-30.3f + 20.1f * i, 150, 11.7f * i});
  return mesh;
}

/// `traversal` is of `cast_at`.
WatertightCounts aim(const WatertightMesh& mesh, const Scene& cast_at, const Traversal& traversal, uint64_t rays) {
  const Scene& scene = mesh.scene;
  const std::vector<SharedEdge> edges = shared_edges(scene);
  std::mt19937_64 random(11);
  WatertightCounts counts;
  for (uint64_t i = 0; i < rays; ++i) {
    const SharedEdge edge = edges[random() % edges.size()];
    const Vec3 origin = mesh.origins[random() % mesh.origins.size()];
    // A vertex, the middle, or anywhere between.
    const bool vertex = i % 4 == 0;
    const double share = vertex ? 0 : i % 4 == 1 ? 0.5 : std::uniform_real_distribution<double>(0, 1)(random);
    const RayQuery ray = ray_at(scene, origin, edge, share);
    ++(vertex ? counts.vertices : counts.edges);
    ++counts.rays;
    Hit hit;
    const bool found = traversal.nearest(ray, hit);
    bool leak = !found || !traversal.occluded({origin, ray.direction, 1.0f + static_cast<float>(kBeyond)});
    // On a closed body that is seen from inside there is nothing behind; on others a hit further off is a leak too.
    leak |= found && static_cast<double>(hit.t) > 1 + kBeyond;
    counts.leaks += leak;
    if (i % kJudged == 0 && found) counts.on_seam += std::fabs(exact_hit(cast_at, hit.triangle, ray).margin) < 1e-6;
  }
  return counts;
}

}  // namespace

std::vector<SharedEdge> shared_edges(const Scene& scene) {
  // Vertices of one place, as at the poles, are one.
  std::map<std::array<float, 3>, uint32_t> places;
  auto place = [&](uint32_t vertex) {
    const Vec3& v = scene.vertices[vertex];
    return places.insert({{v.x, v.y, v.z}, vertex}).first->second;
  };
  std::map<std::pair<uint32_t, uint32_t>, int> count;
  for (const auto& triangle : scene.triangles) {
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t a = place(triangle[k]), b = place(triangle[(k + 1) % 3]);
      ++count[{std::min(a, b), std::max(a, b)}];
    }
  }
  std::set<uint32_t> rim;
  for (const auto& [edge, triangles] : count) {
    if (triangles == 1) rim.insert({edge.first, edge.second});
  }
  std::vector<SharedEdge> edges;
  for (const auto& [edge, triangles] : count) {
    if (triangles == 2 && rim.count(edge.first) == 0 && rim.count(edge.second) == 0)
      edges.push_back({edge.first, edge.second});
  }
  return edges;
}

RayQuery ray_at(const Scene& scene, const Vec3& origin, const SharedEdge& edge, double share) {
  // In double, so that the float point is next to the edge.
  const Vec3d a = scene.vertices[edge.a].as<double>(), b = scene.vertices[edge.b].as<double>();
  return {origin, (a + (b - a) * share - origin.as<double>()).as<float>(), INFINITY};
}

std::vector<WatertightMesh> watertight_meshes() {
  return {ball("ball", {0, 0, 0}, {1, 1, 1}, 96), ball("ball at 1e5", {1e5, -2e5, 5e4}, {100, 100, 100}, 96),
          ball("needles 1000 to 1", {0.1, 0.2, 0.3}, {0.01, 10, 0.02}, 96), star(), terrain()};
}

WatertightCounts aim_at_seams(const WatertightMesh& mesh, uint64_t rays) {
  return aim_at_seams(mesh, mesh.scene, rays);
}

WatertightCounts aim_at_seams(const WatertightMesh& mesh, const Scene& cast_at, uint64_t rays) {
  return aim(mesh, cast_at, Traversal(cast_at), rays);
}

WatertightCounts aim_at_seams(const WatertightMesh& mesh, const TriangleTest& test, uint64_t rays) {
  Traversal traversal(mesh.scene);
  traversal.set_triangle_test(test);
  return aim(mesh, mesh.scene, traversal, rays);
}

}  // namespace raypool::numerics
