// The shader sets of shaders/, as pictures.
#include <gtest/gtest.h>

#include <optional>

#include "bits.hpp"
#include "kernel/function_runner.hpp"
#include "scene/native_renderer.hpp"
#include "scene/shader_file.hpp"
#include "scene/shader_memory.hpp"
#include "shader/shader_set.hpp"

namespace raypool {
namespace {

constexpr uint32_t kSize = 24;

struct Drawing {
  uint32_t depth = 3, samples = 1;
  bool fused = false;
};

NativeOptions options_of(const Drawing& drawing) {
  NativeOptions options;
  options.width = options.height = kSize;
  options.depth = drawing.depth;
  options.mode.fused = drawing.fused;
  return options;
}

FrameBuffer built_in(const Scene& scene, const Drawing& drawing) {
  const MemoryImage image = build_memory(ray_kernel_program(), scene);
  const Tracer tracer(scene, image.material_base);
  return render_native(scene, image, tracer, options_of(drawing));
}

FrameBuffer drawn_by(const std::string& set_name, const Scene& scene, const Drawing& drawing) {
  MemoryImage image = build_memory(ray_kernel_program(), scene);
  const Tracer tracer(scene, image.material_base);
  const auto set = load_shaders(set_name);
  NativeOptions options = options_of(drawing);
  ShaderFrame shader_frame;
  shader_frame.width = shader_frame.height = kSize;
  shader_frame.samples = drawing.samples;
  shader_frame.depth = drawing.depth;
  shader_frame.camera = camera_numbers(scene, kSize, kSize);
  shader_frame.offset = as_float(camera_arguments(scene, kSize, kSize, options.contents)[argument::kOffset]);
  const shader::Resources resources = build_shader_memory(image, scene, *set, shader_frame);
  KernelTarget target;
  target.fma = drawing.fused;
  const auto functions = set->record(resources, target, RecordLayout{});
  EnumArray<RayKernel, std::optional<kernel::FunctionRunner>, kRayKernels> runners;
  for (const RayKernel kernel :
       {RayKernel::CastEye, RayKernel::CastSecondary, RayKernel::CastSecondaryDirect, RayKernel::Shade})
    runners[kernel].emplace(functions[kernel]);
  options.kernel = [&](RayKernel kernel, NativeThread& thread) { runners[kernel]->run(thread); };
  FrameBuffer sum(kSize, kSize);
  for (uint32_t sample = 0; sample < drawing.samples; ++sample) {
    options.change_arguments = [&](std::array<uint32_t, kArguments>& arguments) {
      arguments[kSampleArgument] = sample;
    };
    sum.add(render_native(scene, image, tracer, options));
  }
  return sum;
}

double mean(const FrameBuffer& frame) {
  double sum = 0;
  for (uint32_t y = 0; y < kSize; ++y)
    for (uint32_t x = 0; x < kSize; ++x)
      for (uint32_t channel = 0; channel < 3; ++channel) sum += frame.linear(x, y, channel);
  return sum / (3 * kSize * kSize);
}

TEST(ShaderSets, WhittedDrawsThePictureOfTheBuiltInKernels) {
  const Scene scene = make_cornell();
  for (const bool fused : {false, true}) {
    for (const uint32_t depth : {1u, 4u}) {
      const Drawing drawing{depth, 1, fused};
      EXPECT_TRUE(drawn_by("whitted", scene, drawing) == built_in(scene, drawing)) << fused << " " << depth;
    }
  }
}

TEST(ShaderSets, SeveralSamplesAreAsBrightAsOne) {
  const Scene scene = make_cornell();
  for (const char* set : {"whitted", "preview", "ao", "debug", "path"}) {
    const double one = mean(drawn_by(set, scene, {3, 1, false})), four = mean(drawn_by(set, scene, {3, 4, false}));
    EXPECT_GT(one, 0.1) << set;
    EXPECT_NEAR(four, one, 0.2 * one) << set;
  }
}

TEST(ShaderSets, PreviewLeavesNothingBlack) {
  const FrameBuffer frame = drawn_by("preview", make_cornell(), {1, 1, false});
  for (uint32_t y = 0; y < kSize; ++y)
    for (uint32_t x = 0; x < kSize; ++x)
      EXPECT_GT(frame.linear(x, y, 0) + frame.linear(x, y, 1) + frame.linear(x, y, 2), 0) << x << " " << y;
}

/// What is above the floor in a scene with holes. It is white, and its texture, if it has one, is missing on the left.
struct Cover {
  AlphaMode mode = AlphaMode::Opaque;
  float alpha = 1;
  bool has_texture = false;
};

/// A floor that the camera sees straight from above, a lamp above the camera, and a cover between them. Without a cover
/// there is none.
Scene lit_from_above(const std::optional<Cover>& cover) {
  constexpr float kWide = 4, kHigh = 0.4f;
  Scene scene;
  Surfaces surfaces;
  const auto add = [&](float height, uint32_t material) {
    const auto first = static_cast<uint32_t>(scene.vertices.size());
    for (const auto& [x, z] : {std::pair(-kWide, kWide), {kWide, kWide}, {kWide, -kWide}, {-kWide, -kWide}}) {
      scene.vertices.push_back({x, height, z});
      surfaces.normals.push_back({0, 1, 0});
      surfaces.texcoords.push_back({x > 0 ? 1.0f : 0.0f, 0.5f});
    }
    scene.triangles.push_back({first, first + 1, first + 2});
    scene.triangles.push_back({first, first + 2, first + 3});
    scene.triangle_materials.insert(scene.triangle_materials.end(), 2, material);
  };
  add(0, 0);
  if (cover) add(kHigh, 1);
  scene.name = "lit from above";
  scene.materials = {{"floor", {0.5f, 0.5f, 0.5f}, {}}, {"cover", {1, 1, 1}, {}}};
  scene.camera = {{0, 0.35f, 0}, {0, -1, 0}, {0, 0, -1}, 110};
  surfaces.triangles = scene.triangles;
  surfaces.positions = scene.vertices;
  surfaces.materials.resize(2);
  surfaces.materials[0].base_color = {0.5f, 0.5f, 0.5f, 1};
  if (cover) {
    surfaces.materials[1].alpha_mode = cover->mode;
    surfaces.materials[1].base_color[3] = cover->alpha;
    if (cover->has_texture) surfaces.materials[1].base_color_texture = 0;
  }
  surfaces.images = {{2, 1, {65535, 65535, 65535, 0, 65535, 65535, 65535, 65535}}};
  surfaces.textures = {{0, shader::Wrap::Clamp, shader::Wrap::Clamp, true}};
  SurfaceLight lamp;
  lamp.position = {0, 3, 0};
  lamp.color = {9, 9, 9};
  surfaces.lights = {lamp};
  scene.surfaces = std::make_shared<const Surfaces>(std::move(surfaces));
  return scene;
}

double mean_of_columns(const FrameBuffer& frame, uint32_t from, uint32_t to) {
  double sum = 0;
  for (uint32_t y = 0; y < kSize; ++y)
    for (uint32_t x = from; x < to; ++x) sum += frame.linear(x, y, 0);
  return sum / (kSize * (to - from));
}

TEST(ShaderSets, PreviewsLampShinesThroughHoles) {
  const Drawing drawing{2, 1, false};
  const FrameBuffer free = drawn_by("preview", lit_from_above({}), drawing);
  const FrameBuffer covered = drawn_by("preview", lit_from_above(Cover{}), drawing);
  EXPECT_LT(mean(covered), 0.9 * mean(free));
  EXPECT_TRUE(drawn_by("preview", lit_from_above(Cover{AlphaMode::CutOut, 0}), drawing) == free);
  EXPECT_TRUE(drawn_by("preview", lit_from_above(Cover{AlphaMode::CutOut, 1}), drawing) == covered);
  const FrameBuffer half = drawn_by("preview", lit_from_above(Cover{AlphaMode::Blend, 0.5f}), drawing);
  EXPECT_NEAR(mean(half), (mean(free) + mean(covered)) / 2, 1e-4);
  // The shadow's edge runs across the picture.
  const FrameBuffer shaped = drawn_by("preview", lit_from_above(Cover{AlphaMode::CutOut, 1, true}), drawing);
  EXPECT_GT(mean(shaped), mean(covered));
  EXPECT_LT(mean(shaped), mean(free));
}

TEST(ShaderSets, PathsLampsShineThroughHoles) {
  // Light that only the floor has scattered: the cover lets it pass, or it ends there.
  const Drawing drawing{2, 64, false};
  const double free = mean(drawn_by("path", lit_from_above({}), drawing));
  EXPECT_GT(free, 0.05);
  EXPECT_LT(mean(drawn_by("path", lit_from_above(Cover{}), drawing)), 1e-3);
  EXPECT_NEAR(mean(drawn_by("path", lit_from_above(Cover{AlphaMode::CutOut, 0}), drawing)), free, 0.03 * free);
  EXPECT_NEAR(mean(drawn_by("path", lit_from_above(Cover{AlphaMode::Blend, 0.5f}), drawing)), free / 2, 0.03 * free);
  // The last surface of a path has no ray to spare.
  EXPECT_LT(mean(drawn_by("path", lit_from_above(Cover{AlphaMode::CutOut, 0}), {1, 4, false})), 1e-3);
}

TEST(ShaderSets, AHoleInATextureThrowsItsShape) {
  const Drawing drawing{2, 16, false};
  const FrameBuffer free = drawn_by("path", lit_from_above({}), drawing);
  const FrameBuffer shaped = drawn_by("path", lit_from_above(Cover{AlphaMode::CutOut, 1, true}), drawing);
  const double left = mean_of_columns(free, 0, kSize / 2);
  EXPECT_NEAR(mean_of_columns(shaped, 0, kSize / 2 - 1), left, 0.1 * left);
  EXPECT_LT(mean_of_columns(shaped, kSize / 2 + 1, kSize), 1e-3);
}

}  // namespace
}  // namespace raypool
