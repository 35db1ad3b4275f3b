// The picture in double precision, and what it is compared by.
#include "scene/double_renderer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "bits.hpp"
#include "isa/input_error.hpp"
#include "scene/double_traversal.hpp"
#include "scene/hard_rays.hpp"
#include "scene/hits_check.hpp"
#include "scene/unstable_pixels.hpp"

namespace raypool {
namespace {

// ---- Hits

TEST(DoubleTraversal, HitsWhat113BitsSayIsNearest) {
  int hits = 0;
  for (const uint32_t seed : {1u, 2u, 3u}) {
    const Scene scene = soup(seed, 60, seed == 2 ? 1e-3f : 100.0f, {seed == 3 ? 1e5f : 0.0f, 3, -7});
    const Bvh bvh = build_bvh(scene);
    const DoubleTraversal traversal(bvh);
    for (const RayQuery& ray : hard_rays(scene, 1000, seed)) {
      const DoubleHit hit = traversal.nearest(ray.origin.as<double>(), ray.direction.as<double>(), ray.limit);
      const bool found = hit.triangle != kNoTriangle;
      hits += found;
      EXPECT_EQ(traversal.occluder(ray.origin.as<double>(), ray.direction.as<double>(), ray.limit) != kNoTriangle,
                found);
      if (found) {
        const ExactHit exact = exact_hit(scene, hit.triangle, ray);
        EXPECT_TRUE(exact.passage == Passage::Inside || exact.passage == Passage::Border) << exact.margin;
        EXPECT_NEAR(hit.t, exact.t, 1e-9 * std::fabs(exact.t) + 1e-12);
      }
      for (uint32_t triangle = 0; triangle < scene.triangles.size(); ++triangle) {
        const ExactHit exact = exact_hit(scene, triangle, ray);
        if (exact.passage != Passage::Inside || exact.t <= 1e-9 || exact.t >= static_cast<double>(ray.limit)) continue;
        EXPECT_TRUE(found && hit.t <= exact.t * (1 + 1e-9)) << triangle << ' ' << hit.t << ' ' << exact.t;
      }
    }
  }
  EXPECT_GT(hits, 300);
}

TEST(DoubleTraversal, LetsNoRayThroughAClosedMesh) {
  const Vec3 corners[6] = {{1, 0.1f, 0}, {-1, 0.3f, 0.2f}, {0, 1, 0.1f}, {0.1f, -1, 0}, {0, 0.2f, 1}, {0.3f, 0, -1}};
  std::vector<std::array<Vec3, 3>> faces;
  for (const int x : {0, 1})
    for (const int y : {2, 3})
      for (const int z : {4, 5}) faces.push_back({corners[x], corners[y], corners[z]});
  const Scene scene = scene_of(faces);
  const Bvh bvh = build_bvh(scene);
  const DoubleTraversal traversal(bvh);
  const Vec3d centre{0.05, 0.04, 0.03};
  // To points of edges, the corners among them.
  for (const auto& face : faces)
    for (int k = 0; k < 3; ++k)
      for (int step = 0; step <= 64; ++step) {
        const Vec3d a = face[k].as<double>(), b = face[(k + 1) % 3].as<double>();
        const Vec3d direction = a + (b - a) * (step / 64.0) - centre;
        EXPECT_NE(traversal.nearest(centre, direction, INFINITY).triangle, kNoTriangle) << k << ' ' << step;
      }
}

// ---- Pictures

struct Drawing {
  explicit Drawing(Scene drawn, uint32_t size = 48, uint32_t depth = 3)
      : scene(std::move(drawn)), image(build_memory(ray_kernel_program(), scene)), tracer(scene, image.material_base) {
    options.width = options.height = size;
    options.depth = depth;
    options.reflections = scene.reflects();
  }
  FrameBuffer in_double(PixelDecisions* decisions = nullptr) {
    return render_in_double(scene, image, tracer, options, statistics, decisions);
  }

  Scene scene;
  MemoryImage image;
  Tracer tracer;
  NativeOptions options;
  NativeStatistics statistics;
};

TEST(DoublePicture, IsNearlyThatOfTheMachine) {
  Drawing drawing(make_cornell());
  NativeStatistics single;
  const FrameBuffer machine = render_native(drawing.scene, drawing.image, drawing.tracer, drawing.options, &single);
  const ImageDifference difference = compare(drawing.in_double(), machine);
  EXPECT_GT(difference.psnr, 45);
  EXPECT_LT(difference.visible, 48 * 48 / 20);
  EXPECT_EQ(drawing.statistics.ray_counts.eye.traced, single.ray_counts.eye.traced);
  EXPECT_NEAR(static_cast<double>(drawing.statistics.rays()), static_cast<double>(single.rays()), 20);
}

TEST(DoublePicture, IsTheSameOnAnyNumberOfThreads) {
  Drawing one(make_cornell()), three(make_cornell());
  three.options.threads = 3;
  PixelDecisions of_one(48, 48), of_three(48, 48);
  EXPECT_TRUE(one.in_double(&of_one) == three.in_double(&of_three));
  EXPECT_EQ(of_one.to_bytes(), of_three.to_bytes());
}

/// A floor that fills the picture, and a light above it.
Scene lit_floor() {
  Scene scene = scene_of({{{{-50, 0, -50}, {50, 0, 50}, {50, 0, -50}}}, {{{-50, 0, -50}, {-50, 0, 50}, {50, 0, 50}}}});
  scene.materials[0].kd = {0.7f, 0.5f, 0.3f};
  scene.camera.eye = {0.3f, 5, 0.2f};
  scene.camera.direction = {0, -1, 0};
  scene.camera.up = {0, 0, -1};
  scene.light = {{1, 3, 2}, {1, 0.5f, 1}};
  return scene;
}

TEST(DoublePicture, OfAFloorHasTheCosinesOfItsPoints) {
  Drawing drawing(lit_floor(), 16, 1);
  const FrameBuffer frame = drawing.in_double();
  const CameraNumbers camera = camera_numbers(drawing.scene, 16, 16);
  double largest_of_machine = 0;
  const FrameBuffer machine = render_native(drawing.scene, drawing.image, drawing.tracer, drawing.options);
  for (uint32_t y = 0; y < 16; ++y) {
    for (uint32_t x = 0; x < 16; ++x) {
      const auto along = [&](int axis) {
        return camera[argument::kCorner + axis] + x * camera[argument::kStepX + axis] +
               y * camera[argument::kStepY + axis];
      };
      const double t = -static_cast<double>(drawing.scene.camera.eye.y) / along(1);
      const Vec3d eye = drawing.scene.camera.eye.as<double>(), light = drawing.scene.light.position.as<double>();
      const Vec3d to_light = light - Vec3d{eye.x + t * along(0), 0, eye.z + t * along(2)};
      const double red = static_cast<double>(0.7f) * to_light.y / length(to_light);
      // A contribution is rounded to single precision, and to 32 binary places.
      EXPECT_NEAR(frame.linear(x, y, 0), red, 0x1p-24 * red + 0x1p-32) << x << ' ' << y;
      largest_of_machine = std::max(largest_of_machine, std::fabs(machine.linear(x, y, 0) - red));
    }
  }
  EXPECT_GT(largest_of_machine, 0x1p-24) << "the machine rounds more often";
}

// ---- What is left beside a picture

TEST(PixelDecisions, AreReadAsTheyWereWritten) {
  PixelDecisions decisions(3, 2), other(3, 2);
  decisions.hit(1, 7);
  decisions.shadow(1, true);
  decisions.miss(2 | 1 << 16);
  const std::string bytes = decisions.to_bytes();
  const PixelDecisions read = PixelDecisions::from_bytes(bytes, "file");
  EXPECT_EQ(read.to_bytes(), bytes);
  other.hit(1, 7);
  other.shadow(1, false);
  EXPECT_EQ(read.cause(other, 0), PixelCause::Colour);
  EXPECT_EQ(read.cause(other, 1), PixelCause::Shadow);
  EXPECT_EQ(read.cause(other, 5), PixelCause::Hit);
  EXPECT_THROW(PixelDecisions::from_bytes(bytes.substr(0, bytes.size() - 1), "file"), InputError);
  EXPECT_THROW(PixelDecisions::from_bytes(bytes.substr(0, 10), "file"), InputError);
  EXPECT_THROW(PixelDecisions::from_bytes("", "file"), InputError);
  EXPECT_THROW(PixelDecisions::from_bytes("x" + bytes, "file"), InputError);
}

TEST(PixelDecisions, KnowTheOrderOfHits) {
  PixelDecisions one(1, 1), other(1, 1);
  one.hit(0, 1);
  one.miss(0);
  other.miss(0);
  other.hit(0, 1);
  EXPECT_EQ(one.cause(other, 0), PixelCause::Hit);
}

TEST(UnstablePixels, AreThoseThatChangeWhenLastBitsOfTheCameraMove) {
  Drawing drawing(lit_floor(), 16, 1);
  const auto arguments = camera_arguments(drawing.scene, 16, 16, 64);
  std::vector<int> moved(argument::kCount);
  for (int number = 1; number <= 8; ++number) {
    auto changed = arguments, again = arguments;
    move_last_bits(changed, number);
    move_last_bits(again, number);
    EXPECT_EQ(changed, again);
    for (int i = 0; i < argument::kCount; ++i) {
      const float before = as_float(arguments[i]), after = as_float(changed[i]);
      moved[i] += changed[i] != arguments[i];
      EXPECT_TRUE(after == before || after == std::nextafter(before, after)) << i;
    }
  }
  for (int i = 0; i < argument::kCount; ++i) EXPECT_EQ(moved[i] > 0, i < argument::kLight) << i;

  const FrameBuffer frame = render_native(drawing.scene, drawing.image, drawing.tracer, drawing.options);
  UnstablePixels unstable(frame);
  unstable.add(frame);
  EXPECT_EQ(unstable.pixels, 0u);
  FrameBuffer other = frame;
  other.add(FrameContribution{3 | 5 << 16, {as_bits(0.5f), 0, 0}});
  unstable.add(other);
  unstable.add(other);
  EXPECT_EQ(unstable.frames, 3u);
  EXPECT_EQ(unstable.pixels, 1u);
}

}  // namespace
}  // namespace raypool
