// For tests: the Cornell box, or another scene, drawn with the real kernels or others, on a device that the test
// chooses, with the static traverser unless a test changes that.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "chip/board.hpp"
#include "kernel/ray_program.hpp"
#include "scene/image.hpp"
#include "scene/native_renderer.hpp"
#include "scene/scene.hpp"
#include "scene/traversal.hpp"

namespace raypool::test {

struct RealFrame {
  const Configuration configuration;
  const Scene scene;
  const Program& program;
  MemoryImage image = build_memory(program, scene);
  const Tracer tracer{scene, image.material_base, configuration.chip};
  SceneTracer scene_tracer{tracer};
  FrameBuffer frame;
  FrameBufferSink sink{frame};
  ChipOptions options;

  RealFrame(uint32_t warps, uint32_t lanes, uint32_t width, uint32_t height, uint32_t depth,
            Scene drawn = make_cornell(), bool culling = false, uint32_t intersection_words = kIntersectionWords)
      : RealFrame(machine(warps, lanes, intersection_words, culling), width, height, depth, std::move(drawn)) {}
  RealFrame(const Configuration& on, uint32_t width, uint32_t height, uint32_t depth, Scene drawn)
      : RealFrame(on, built_in_ray_program(KernelTarget(on)), width, height, depth, std::move(drawn)) {}
  /// `kernels` must outlive it.
  RealFrame(const Configuration& on, const RayProgram& kernels, uint32_t width, uint32_t height, uint32_t depth,
            Scene drawn)
      : configuration(on), scene(std::move(drawn)), program(kernels.program), frame(width, height) {
    options.configuration = configuration;
    options.layout = record_layout(kernels, configuration);
    options.memory = &image.memory;
    options.program_length = size32(program.code);
    for (size_t i = 0; i < kRayKernels; ++i) options.entries[i] = program.entries.at(std::string(kRayKernelNames[i]));
    options.arguments =
        camera_arguments(scene, width, height, options.configuration.contents(), options.configuration.significand);
    options.width = width;
    options.height = height;
    options.depth = depth;
    options.tracer = &scene_tracer;
    options.frame = &sink;
  }
  RealFrame(const RealFrame&) = delete;
  RealFrame& operator=(const RealFrame&) = delete;

  ChipResult draw(std::unique_ptr<ComputeUnit> device) {
    return run_board(options, *make_chip_around(options, std::move(device)));
  }

 private:
  static Configuration machine(uint32_t warps, uint32_t lanes, uint32_t intersection_words, bool culling) {
    Configuration configuration;
    configuration.chip.traverser = TraverserName::Static;
    configuration.chip.culling = culling;
    configuration.warps = warps;
    configuration.lanes = lanes;
    configuration.intersection_words = intersection_words;
    return configuration;
  }
};

}  // namespace raypool::test
