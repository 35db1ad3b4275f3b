// Rays aimed at the edges and vertices that the triangles of a mesh share, of which none may pass between them.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "scene/narrow_triangles.hpp"
#include "scene/scene.hpp"

namespace raypool::numerics {

struct WatertightMesh {
  std::string name;
  Scene scene;                ///< closed, or a sheet with all edges but the rim shared
  std::vector<Vec3> origins;  ///< from which every point of the mesh is in sight, and rays are cast
};
/// Balls near and far, a ball squeezed to needles of 1000 to 1, a bumpy star-shaped body, a terrain seen from above.
std::vector<WatertightMesh> watertight_meshes();

/// An edge that triangles of a mesh share, by the numbers of two vertices.
struct SharedEdge {
  uint32_t a, b;
};
/// Edges of two triangles, without an end on a rim: a ray at the rim may pass beside the mesh.
std::vector<SharedEdge> shared_edges(const Scene& scene);
/// From an origin to a point of an edge, this share of it from a to b: next to it, as the direction is rounded.
RayQuery ray_at(const Scene& scene, const Vec3& origin, const SharedEdge& edge, double share);

struct WatertightCounts {
  uint64_t rays = 0;
  uint64_t edges = 0, vertices = 0;  ///< aimed at
  uint64_t on_seam = 0;  ///< of every 64th ray: passes an edge nearer than 1e-6 of the triangle, by exact arithmetic
  uint64_t leaks = 0;    ///< that hit nothing, or only something beyond the aim by more than 1e-3 of its distance
};
/// Casts `rays` rays at the mesh, as nearest-hit and as shadow rays, reproducibly.
WatertightCounts aim_at_seams(const WatertightMesh& mesh, uint64_t rays);
/// The same rays, cast at another scene.
WatertightCounts aim_at_seams(const WatertightMesh& mesh, const Scene& cast_at, uint64_t rays);
/// The same rays, with triangles tested so.
WatertightCounts aim_at_seams(const WatertightMesh& mesh, const TriangleTest& test, uint64_t rays);

}  // namespace raypool::numerics
