#include "scene/native_renderer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "bits.hpp"
#include "scene/embree_scene.hpp"
#include "scene/mesh_builder.hpp"
#include "scene/reference_kernels.hpp"

namespace raypool {
namespace {

using reference::read3;

struct Rendered {
  FrameBuffer frame;
  NativeStatistics statistics;
};

Rendered render(const Scene& scene, NativeOptions options, TraverserName traverser = TraverserName::Static) {
  options.kernel = reference::run;
  const MemoryImage image = build_memory({}, scene);
  ChipConfiguration chip;
  chip.traverser = traverser;
  const Tracer tracer(scene, image.material_base, chip);
  NativeStatistics statistics;
  FrameBuffer frame = render_native(scene, image, tracer, options, &statistics);
  return {std::move(frame), statistics};
}

NativeOptions size(int width, int height, int depth) {
  NativeOptions options;
  options.width = width;
  options.height = height;
  options.depth = depth;
  return options;
}

// Where two surfaces meet, or a ray grazes one, either answer may be right; nowhere else.
TEST(NativeRenderer, DrawsWithEmbreesHitsWhatItDrawsWithOurs) {
  const Scene scene = make_room(0.05);
  const MemoryImage image = build_memory({}, scene);
  const Tracer tracer(scene, image.material_base);
  const EmbreeTracer embree(scene, tracer);
  NativeOptions options = size(96, 72, 3);
  const FrameBuffer ours = render(scene, options).frame;
  uint64_t asked = 0;
  options.trace = [&](const Ray& ray, Intersection& hit) {
    ++asked;
    return embree.trace(ray, hit);
  };
  const Rendered theirs = render(scene, options);
  EXPECT_EQ(asked, theirs.statistics.rays());
  const std::vector<uint8_t> a = to_rgb8(ours), b = to_rgb8(theirs.frame);
  int differ = 0;
  for (size_t i = 0; i < a.size(); ++i) differ += std::abs(a[i] - b[i]) > 2;
  EXPECT_LT(differ, 20);
}

TEST(MemoryImage, HoldsProgramAndAlignedMaterials) {
  const Scene scene = make_room(0.02);
  Program program;
  for (uint64_t i = 0; i < 11; ++i) program.code.push_back(i << 32 | (100 + i));
  const MemoryImage image = build_memory(program, scene);
  EXPECT_EQ(image.material_base, 128u);
  EXPECT_EQ(image.memory.size() % 64, 0u);
  EXPECT_EQ(image.memory.size(), 128u + 36 * 32);
  EXPECT_EQ(image.memory.load(8 * 10), 110u);
  EXPECT_EQ(image.memory.load(8 * 10 + 4), 10u);
  for (uint32_t i = 0; i < 36; ++i) {
    const uint32_t record = 128 + 32 * i;
    EXPECT_EQ(reference::load3(image.memory, record), scene.materials[i].kd);
    EXPECT_EQ(image.memory.load(record + 12), 0u);
    EXPECT_EQ(reference::load3(image.memory, record + 16), scene.materials[i].ks);
    EXPECT_EQ(image.memory.load(record + 28), 0u);
  }
}

TEST(CameraArguments, SpanTheFieldOfView) {
  Scene scene = make_cornell(0.05);
  scene.camera = {{1, 2, 3}, {0, 0, -5}, {0, 1, 0}, 90};
  const auto a = camera_arguments(scene, 200, 100, 32);
  auto direction = [&](float x, float y) {
    return read3(a, argument::kCorner) + read3(a, argument::kStepX) * x + read3(a, argument::kStepY) * y;
  };
  EXPECT_EQ(read3(a, argument::kEye), (Vec3{1, 2, 3}));
  // The outer edges of the picture lie at 45 degrees up and down; x to the right, y downwards.
  const Vec3 top_left = direction(-0.5f, -0.5f), bottom_right = direction(199.5f, 99.5f);
  EXPECT_NEAR(top_left.x / -top_left.z, -2, 1e-5);
  EXPECT_NEAR(top_left.y / -top_left.z, 1, 1e-5);
  EXPECT_NEAR(bottom_right.x / -bottom_right.z, 2, 1e-5);
  EXPECT_NEAR(bottom_right.y / -bottom_right.z, -1, 1e-5);
  EXPECT_EQ(a[argument::kTileWidthLog2], 3u);
  EXPECT_EQ(a[argument::kTileMask], 7u);
  EXPECT_EQ(a[argument::kWidth], 200u);
  EXPECT_EQ(a[argument::kHeight], 100u);
  // The middle of the first pixel is the furthest from the middle of the picture, which is at 1.
  const float longest = std::sqrt(1 + 1.99f * 1.99f + 0.99f * 0.99f);
  EXPECT_FLOAT_EQ(as_float(a[argument::kOffset]), 0x1p-22f * longest);
  const auto few = camera_arguments(scene, 200, 100, 32, 11);
  EXPECT_FLOAT_EQ(as_float(few[argument::kOffset]), (0x1p-10f + 0x1p-23f) * longest);
  scene.camera.fov = 40;
  EXPECT_EQ(as_float(camera_arguments(scene, 200, 100, 32)[argument::kOffset]), 0x1p-21f);
  EXPECT_THROW(camera_arguments(scene, 0, 10, 64), InputError);
  EXPECT_THROW(camera_arguments(scene, 10, 65536, 64), InputError);
}

TEST(NativeRenderer, PictureDoesNotDependOnThreadsOrTiles) {
  const Scene scene = make_cornell(0.2);
  NativeOptions options = size(61, 43, 4);
  const Rendered one = render(scene, options);
  for (int threads : {2, 5}) {
    for (int contents : {1, 32, 1024}) {
      options.threads = threads;
      options.contents = contents;
      const Rendered other = render(scene, options);
      EXPECT_TRUE(other.frame == one.frame) << threads << " threads, " << contents << " contents";
      EXPECT_EQ(other.statistics.rays(), one.statistics.rays());
    }
  }
}

class NativeParts : public testing::TestWithParam<TraverserName> {};
INSTANTIATE_TEST_SUITE_P(Traversers, NativeParts, testing::Values(TraverserName::Static, TraverserName::Hardware));

TEST_P(NativeParts, AreDrawnAndReportedWithWhatEachTakes) {
  const bool hardware = GetParam() == TraverserName::Hardware;
  NativeOptions options = size(40, 32, 3);
  const Rendered whole = render(make_cornell(), options, GetParam());  // in tiles of 8x8
  std::vector<NativeWork> work;
  // Bands of four rows, the lowest first, in parts of three.
  for (uint32_t band = 0; band < 40; ++band) {
    if (band % 3 == 0) options.parts.emplace_back();
    options.parts.back().push_back({band % 5 * 8, 28 - band / 5 * 4, 32});
  }
  options.work = &work;
  const Rendered parts = render(make_cornell(), options, GetParam());
  EXPECT_TRUE(parts.frame == whole.frame);
  EXPECT_EQ(parts.statistics.contributions, whole.statistics.contributions);
  ASSERT_EQ(work.size(), 14u);
  NativeWork sum;
  for (const NativeWork& part : work) {
    for (size_t i = 0; i < kRayKernels; ++i) sum.kernel_threads[i] += part.kernel_threads[i];
    sum.rays += part.rays;
    EXPECT_GT(part.nodes, part.rays) << "the root is not all";
    EXPECT_GT(part.triangles, 0u);
    EXPECT_GT(part.places, 1u);
    EXPECT_EQ(part.tile_ends.size(), options.parts[&part - work.data()].size());
    EXPECT_TRUE(std::is_sorted(part.tile_ends.begin(), part.tile_ends.end()));
    EXPECT_EQ(part.tile_ends.back(), part.chip_places.size());
    EXPECT_EQ(part.chip_places.size(), hardware ? part.places : 0) << "in the chip's tree";
    EXPECT_LT(part.places, (part.nodes + part.triangles) / 5) << "neighbours visit the same";
  }
  for (size_t i = 0; i < kRayKernels; ++i) EXPECT_EQ(sum.kernel_threads[i], whole.statistics.kernel_threads[i]);
  EXPECT_EQ(sum.rays, whole.statistics.rays());

  options.threads = 3;
  std::vector<NativeWork> again;
  options.work = &again;
  render(make_cornell(), options, GetParam());
  for (size_t i = 0; i < work.size(); ++i) {
    EXPECT_EQ(again[i].nodes, work[i].nodes);
    EXPECT_EQ(again[i].places, work[i].places);
  }
}

TEST(NativeRenderer, CountsRaysByKindAndDepth) {
  // All materials reflect and the room is closed: every normal ray up to the depth is traced, one more is dropped.
  const Scene scene = make_room(0.02);
  const uint64_t pixels = 40 * 30;
  for (int depth : {1, 2, 4}) {
    const NativeStatistics s = render(scene, size(40, 30, depth)).statistics;
    EXPECT_EQ(s.ray_counts.eye.traced, pixels);
    EXPECT_EQ(s.ray_counts.reflection.traced, pixels * static_cast<uint64_t>(depth - 1));
    EXPECT_EQ(s.dropped_rays, depth == 1 ? 0 : pixels);
    EXPECT_EQ(s.ray_counts.missed(), 0u);
    EXPECT_GT(s.ray_counts.shadow.traced, pixels / 2);
    EXPECT_EQ(s.contributions, s.ray_counts.shadow.traced - s.ray_counts.blocked());
    const auto direct = to_underlying(RayKernel::CastSecondaryDirect),
               reflecting = to_underlying(RayKernel::CastSecondary);
    EXPECT_EQ(s.kernel_threads[direct], depth == 1 ? pixels : 0);
    EXPECT_EQ(s.kernel_threads[reflecting], depth == 1 ? 0 : pixels * static_cast<uint64_t>(depth));
  }
}

TEST(NativeRenderer, ColoursAreLambertTimesLight) {
  // One large floor seen from above: pixel = Kd * colour * cosine.
  Scene scene;
  MeshBuilder mesh(scene, 1);
  mesh.add_material("floor", {0.25f, 0.5f, 1}, {});
  mesh.quad({-50, 0, 50}, {50, 0, 50}, {50, 0, -50}, {-50, 0, -50});
  scene.camera = {{0, 10, 0}, {0, -1, 0}, {0, 0, -1}, 60};
  scene.light = {{3, 4, 0}, {1, 1, 0.5f}};
  const Rendered result = render(scene, size(1, 1, 1));
  // The offset raises the point towards the light a little.
  EXPECT_NEAR(result.frame.linear(0, 0, 0), 0.25 * 0.8, 1e-3);
  EXPECT_NEAR(result.frame.linear(0, 0, 1), 0.5 * 0.8, 1e-3);
  EXPECT_NEAR(result.frame.linear(0, 0, 2), 0.5 * 0.8, 1e-3);
}

TEST(NativeRenderer, OffsetKeepsSurfacesFreeOfTheirOwnShadow) {
  // Nothing but a ball in a room's light: no point of it that faces the light may be in shadow.
  Scene scene;
  MeshBuilder mesh(scene, 1);
  mesh.add_material("ball", {1, 1, 1}, {});
  mesh.sphere({200, 100, -300}, 2, 200);
  const View view = automatic_view(scene);
  scene.camera = view.camera;
  scene.light = view.light;
  const NativeStatistics s = render(scene, size(160, 160, 1)).statistics;
  EXPECT_GT(s.ray_counts.shadow.traced, 4000u);
  EXPECT_LT(static_cast<double>(s.ray_counts.blocked()), 0.002 * s.ray_counts.shadow.traced);
}

TEST(NativeRenderer, KernelsDrawWhatTheirFormulasSay) {
  const Scene scene = make_room(0.02);
  const MemoryImage image = build_memory(ray_kernel_program(), scene);
  const Tracer tracer(scene, image.material_base);
  for (int depth : {1, 3}) {
    NativeOptions options = size(64, 48, depth);
    NativeStatistics statistics;
    const FrameBuffer kernels = render_native(scene, image, tracer, options, &statistics);
    const FrameBuffer formulas = render(scene, options).frame;
    // Rounding differs, and with it a few hits at the edge of something.
    EXPECT_GT(compare(kernels, formulas).psnr, 30) << "depth " << depth;
    EXPECT_EQ(statistics.ray_counts.eye.traced, 64u * 48);
    EXPECT_EQ(statistics.ray_counts.reflection.traced, 64u * 48 * static_cast<uint64_t>(depth - 1));
    EXPECT_EQ(statistics.ray_counts.shadow.traced, 64u * 48 * static_cast<uint64_t>(depth)) << "one for each hit";
  }
}

TEST(NativeRenderer, WithoutReflectingMaterialsReflectionsChangeNothing) {
  Scene scene = make_cornell(0.2);
  EXPECT_TRUE(scene.reflects());
  for (Material& material : scene.materials) material.ks = {};
  EXPECT_FALSE(scene.reflects());
  scene.materials.push_back({"mirror that no triangle has", {}, {1, 1, 1}});
  EXPECT_FALSE(scene.reflects());

  const MemoryImage image = build_memory(ray_kernel_program(), scene);
  const Tracer tracer(scene, image.material_base);
  NativeOptions options = size(48, 32, 4);
  NativeStatistics with, without;
  const FrameBuffer frame = render_native(scene, image, tracer, options, &with);
  options.reflections = false;
  EXPECT_TRUE(render_native(scene, image, tracer, options, &without) == frame);
  const RayCounts &cast = with.ray_counts, &left = without.ray_counts;
  EXPECT_EQ(cast.reflection.traced, 3u * 48 * 32);
  EXPECT_EQ(cast.reflection.weightless, cast.reflection.traced);
  EXPECT_EQ(left.reflection.traced, 0u);
  EXPECT_EQ(left.eye.traced, 48u * 32);
  EXPECT_EQ(left.shadow.traced, 48u * 32);
  EXPECT_EQ(without.dropped_rays, 0u);
  // What adds to the picture is the same.
  EXPECT_EQ(left.shadow.traced - left.shadow.futile, cast.shadow.traced - cast.shadow.futile);
}

TEST(NativeRenderer, RefusesOptionsOutOfRange) {
  const Scene scene = make_cornell(0.05);
  EXPECT_THROW(render(scene, size(10, 10, 0)), InputError);
  EXPECT_THROW(render(scene, size(10, 10, 255)), InputError);
  NativeOptions options = size(10, 10, 1);
  options.contents = 48;
  EXPECT_THROW(render(scene, options), InputError);
  options.contents = 64;
  options.threads = 0;
  EXPECT_THROW(render(scene, options), InputError);
}

TEST(NativeRenderer, ErrorOfAKernelReachesTheCaller) {
  const Scene scene = make_cornell(0.05);
  const MemoryImage image = build_memory({}, scene);
  const Tracer tracer(scene, image.material_base);
  NativeOptions options = size(64, 64, 1);
  options.threads = 2;
  options.kernel = [](RayKernel, NativeThread&) { throw std::runtime_error("kernel"); };
  EXPECT_THROW(render_native(scene, image, tracer, options), std::runtime_error);
}

}  // namespace
}  // namespace raypool
