#include "numerics/watertight.hpp"

#include <gtest/gtest.h>

#include <cstdio>

namespace raypool::numerics {
namespace {

TEST(Seams, AMillionRaysAtEdgesAndVerticesFindNoGap) {
  const auto meshes = watertight_meshes();
  WatertightCounts sum;
  for (const WatertightMesh& mesh : meshes) {
    const WatertightCounts counts = aim_at_seams(mesh, 1'000'000 / meshes.size());
    std::printf("%-20s %8zu triangles %9lu rays %9lu at edges %9lu at vertices %6lu leaks\n", mesh.name.c_str(),
                mesh.scene.triangles.size(), counts.rays, counts.edges, counts.vertices, counts.leaks);
    EXPECT_EQ(counts.leaks, 0u) << mesh.name;
    EXPECT_GT(counts.on_seam, counts.rays / 64 / 2) << mesh.name << ": most rays miss the edges that they are aimed at";
    sum.rays += counts.rays;
    sum.leaks += counts.leaks;
  }
  std::printf("%lu rays, %lu leaks\n", sum.rays, sum.leaks);
  EXPECT_GE(sum.rays, 1'000'000u);
}

TEST(Seams, AMeshWithAGapLeaks) {
  WatertightMesh mesh = watertight_meshes().front();
  // Every triangle shrinks by a hundred thousandth and leaves gaps that only rays at edges find.
  Scene loose = mesh.scene;
  loose.vertices.clear();
  for (auto& triangle : loose.triangles) {
    Vec3d middle;
    for (const uint32_t index : triangle) middle = middle + mesh.scene.vertices[index].as<double>() * (1.0 / 3);
    for (uint32_t& index : triangle) {
      const Vec3d corner = mesh.scene.vertices[index].as<double>();
      loose.vertices.push_back((corner + (middle - corner) * 1e-5).as<float>());
      index = static_cast<uint32_t>(loose.vertices.size() - 1);
    }
  }
  // The aims stay those of the whole mesh.
  EXPECT_GT(aim_at_seams(mesh, loose, 10'000).leaks, 1000u);
}

}  // namespace
}  // namespace raypool::numerics
