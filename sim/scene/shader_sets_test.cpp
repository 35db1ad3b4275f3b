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

}  // namespace
}  // namespace raypool
