// Measures what the offset of secondary rays does, prints the table of docs/use/hits.md, and holds offset_share() to
// it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "scene/lost_shadows.hpp"
#include "scene/mesh_builder.hpp"
#include "scene/native_renderer.hpp"
#include "scene/reference_kernels.hpp"

namespace raypool {
namespace {

struct SurfacePoint {
  Vec3 point, normal;  // the normal towards the eye
  float reach;         // largest coordinate and t
  uint32_t triangle;
};

/// What the eye rays of a 256 x 256 picture hit, as the kernels compute it, where the light is in front of the surface.
std::vector<SurfacePoint> lit_side_points(const Scene& scene, const Traversal& traversal) {
  const auto arguments = camera_arguments(scene, 256, 256, 1);
  std::vector<SurfacePoint> points;
  for (uint32_t y = 0; y < 256; ++y) {
    for (uint32_t x = 0; x < 256; ++x) {
      NativeThread thread;
      thread.arguments = &arguments;
      thread.block = x | y << 16;
      reference::run(RayKernel::CastEye, thread);
      const RayQuery ray = to_query(thread.rays.at(0));
      Hit hit;
      if (!traversal.nearest(ray, hit)) continue;
      const Vec3 point = ray.origin + ray.direction * hit.t;
      const Vec3 normal = dot(hit.normal, ray.direction) > 0 ? hit.normal * -1.0f : hit.normal;
      if (dot(normal, scene.light.position - point) > 0)
        points.push_back({point, normal, largest_of(point) + hit.t, hit.triangle});
    }
  }
  return points;
}

TEST(Offset, LiesBetweenAcneAndDisplacedShadows) {
  SceneOptions options;
  options.detail = 0.25;
  const Scene scene = load_scene("room", options);
  const Traversal traversal(scene);
  const auto points = lit_side_points(scene, traversal);
  // Of reach, in roundings: halves of a last place of 24 bits.
  const float roundings[] = {0.125f, 0.5f, 1, 2, 4, 8, 32, 256, 2048};
  std::vector<std::vector<bool>> blocked;
  std::vector<size_t> own;  // blocked by the triangle that the ray starts from
  for (const float share : roundings) {
    std::vector<bool> results;
    size_t count = 0;
    for (const SurfacePoint& p : points) {
      const Vec3 origin = p.point + p.normal * (p.reach * share * 0x1p-24f);
      Hit hit;
      const bool found = traversal.nearest({origin, scene.light.position - origin, 1}, hit);
      results.push_back(found);
      count += found && hit.triangle == p.triangle;
    }
    blocked.push_back(results);
    own.push_back(count);
  }
  constexpr size_t kHalf = 4, kInUse = 5;
  auto changed = [&](size_t i) {
    size_t count = 0;
    for (size_t p = 0; p < points.size(); ++p) count += blocked[i][p] != blocked[kHalf][p];
    return count;
  };
  std::printf("%zu shadow rays\nroundings  own shadow  differ from %g\n", points.size(),
              static_cast<double>(roundings[kHalf]));
  for (size_t i = 0; i < own.size(); ++i)
    std::printf("%9g %11zu %14zu\n", static_cast<double>(roundings[i]), own[i], changed(i));
  ASSERT_EQ(roundings[kInUse] * 0x1p-24f, as_float(camera_arguments(scene, 256, 256, 1)[argument::kOffset]));
  EXPECT_GT(own[0], points.size() / 20) << "without an offset surfaces shadow themselves";
  EXPECT_LE(own[kHalf], points.size() / 10000) << "half of the offset is nearly enough";
  EXPECT_EQ(own[kInUse], 0u);
  EXPECT_LT(changed(kInUse), points.size() / 10000) << "and shadows stay where they are";
  EXPECT_GT(changed(8), 20 * (1 + changed(kInUse)));
}

/// A cube of 1 m and its shadow on a square ground.
Scene cube_on_ground(double size) {
  Scene scene;
  MeshBuilder mesh(scene, 1);
  mesh.add_material("all", {0.8f, 0.8f, 0.8f}, {0.3f, 0.3f, 0.3f});
  mesh.quad({-size, 0, size}, {size, 0, size}, {size, 0, -size}, {-size, 0, -size});
  mesh.box({0, 0, 0}, {1, 1, 1});
  scene.camera = {{3, 2.5f, 4}, {-2.5f, -2.2f, -3.5f}, {0, 1, 0}, 25};
  scene.light = {{-2, 4, 3}, {1, 1, 1}};
  return scene;
}

TEST(Offset, AGroundThatIsWiderChangesNoShadow) {
  NativeOptions options;
  options.width = options.height = 96;
  options.depth = 3;
  for (const TraverserName traverser : {TraverserName::Static, TraverserName::Hardware}) {
    ChipConfiguration chip;
    chip.traverser = traverser;
    const auto draw = [&](double size) {
      const Scene scene = cube_on_ground(size);
      const MemoryImage image = build_memory(ray_kernel_program(), scene);
      const Tracer tracer(scene, image.material_base, chip);
      NativeStatistics statistics;
      FrameBuffer frame = render_native(scene, image, tracer, options, &statistics);
      EXPECT_GT(statistics.ray_counts.blocked(), 500u) << "the cube has a shadow";
      return frame;
    };
    const FrameBuffer near = draw(10);
    // Reflections that leave a small ground meet a wider one: the light does not.
    for (const double size : {1e3, 1e5, 1e6}) EXPECT_GT(compare(near, draw(size)).psnr, 60) << size << " m";
  }
}

TEST(Offset, IsToldWhereItIsLargerThanWhatIsSeen) {
  Scene scene = cube_on_ground(1);
  const auto told = [&] { return lost_shadows(scene, Traversal(scene), camera_arguments(scene, 64, 64, 1)); };
  EXPECT_EQ(told(), "");
  // Ten thousand kilometres away, in a picture as large as the cube.
  scene.camera.eye = {0, 5e6f, 1e7f};
  scene.camera.direction = {0, -0.5f, -1};
  scene.camera.fov = 1e-5f;
  EXPECT_NE(told().find("100% of what is seen are triangles smaller than"), std::string::npos) << told();
  EXPECT_NE(told().find("up to 5.33, 1.12e+07 from the eye"), std::string::npos) << told();
}

}  // namespace
}  // namespace raypool
