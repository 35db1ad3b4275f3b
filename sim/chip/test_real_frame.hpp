// For tests: the Cornell box, or another scene, drawn with the real kernels, on a device that the test chooses.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "chip/chip.hpp"
#include "scene/image.hpp"
#include "scene/native_renderer.hpp"
#include "scene/scene.hpp"
#include "scene/traversal.hpp"

namespace raypool::test {

struct RealFrame {
  const Scene scene;
  const Program& program;
  MemoryImage image = build_memory(program, scene);
  const Tracer tracer{scene, image.material_base};
  SceneTracer scene_tracer{tracer};
  FrameBuffer frame;
  FrameBufferSink sink{frame};
  std::unique_ptr<ComputeUnit> device;
  ChipOptions options;

  RealFrame(uint32_t warps, uint32_t lanes, uint32_t width, uint32_t height, uint32_t depth,
            Scene drawn = make_cornell(), bool culling = false)
      : scene(std::move(drawn)), program(ray_kernel_program({false, false, culling})), frame(width, height) {
    options.configuration.chip.culling = culling;
    options.configuration.warps = warps;
    options.configuration.lanes = lanes;
    options.memory = &image.memory;
    options.program_length = size32(program.code);
    for (size_t i = 0; i < kRayKernels; ++i) options.entries[i] = program.entries.at(std::string(kRayKernelNames[i]));
    options.arguments = camera_arguments(scene, width, height, options.configuration.contents());
    options.width = width;
    options.height = height;
    options.depth = depth;
    options.tracer = &scene_tracer;
    options.frame = &sink;
  }
  RealFrame(const RealFrame&) = delete;
  RealFrame& operator=(const RealFrame&) = delete;

  void set_device(std::unique_ptr<ComputeUnit> made) {
    device = std::move(made);
    options.device = device.get();
  }
};

}  // namespace raypool::test
