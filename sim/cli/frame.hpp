// A frame as engines draw it: what each of them needs beside the scene and the record of the run.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "chip/chip.hpp"
#include "cli/report.hpp"
#include "scene/image.hpp"
#include "scene/native_renderer.hpp"
#include "scene/scene.hpp"
#include "scene/traversal.hpp"

namespace raypool {

/// The kernels that draw the frame.
const RayProgram& ray_program(const RunRecord& record);

/// Throws InputError unless there are 1 .. kLargestDepth, and 1, 2 or 4.
void check_depth_and_units(int depth, int units);

/// A machine that was fitted to other scenes may lack what this one needs: throws InputError then, with what, for what,
/// and what to do.
void check_fits(const RunRecord& record, const Scene& scene);

/// The sentence of a fault in this frame; of a subnormal number with kernel, instruction, and what to do.
std::string describe(const ChipFault& fault, const RunRecord& record);

/// The words of the kernels' arguments.
std::array<uint32_t, kArguments> arguments_of(const RunRecord& record, const Scene& scene);

/// What the chip draws with, for as long as a frame lasts.
struct Surroundings {
  Surroundings(const Scene& scene, const MemoryImage& image, const RunRecord& record);
  const Tracer tracer;
  SceneTracer scene_tracer;
  FrameBuffer frame;
  FrameBufferSink sink;
  std::optional<TreeImage> tree;  // of a traverser in hardware
};

/// What a chip draws the frame of the record with.
ChipOptions chip_options(const RunRecord& record, const Scene& scene, MemoryImage& image, Surroundings& around);

/// What finds hits where there is no chip: as that of the record does.
Tracer tracer_of(const RunRecord& record, const Scene& scene, const MemoryImage& image);

/// The same frame without a chip, on all cores.
NativeOptions native_options(const RunRecord& record);

/// Entry PC -> name.
std::map<uint32_t, std::string> kernel_names(const Program& program);
/// The kernel that has the instruction at this PC.
std::string kernel_at(const Program& program, uint32_t pc);

}  // namespace raypool
