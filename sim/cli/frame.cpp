#include "cli/frame.hpp"

#include <fmt/format.h>

#include <array>
#include <iterator>

#include "bits.hpp"
#include "isa/assembler.hpp"
#include "kernel/kernel_report.hpp"
#include "kernel/kernels.hpp"
#include "scene/subnormal_words.hpp"
#include "scene/threads.hpp"

namespace raypool {

std::array<uint32_t, kArguments> arguments_of(const RunRecord& record, const Scene& scene) {
  return camera_arguments(scene, record.width, record.height, record.configuration.contents(),
                          record.configuration.significand);
}

const RayProgram& ray_program(const RunRecord& record) {
  return record.kernels ? *record.kernels : built_in_ray_program(KernelTarget(record.configuration));
}

void check_depth_and_units(int depth, int units) {
  if (depth < 1 || depth > kLargestDepth)
    throw InputError(fmt::format("depth is {}; it must be from 1 to {}", depth, kLargestDepth));
  if (units != 1 && units != 2 && units != 4)
    throw InputError(fmt::format("compute units are {}; they must be 1, 2 or 4", units));
}

void check_fits(const RunRecord& record, const Scene& scene) {
  const ChipConfiguration& chip = record.configuration.chip;
  if (record.reflections && !chip.reflections && !record.kernels) {
    throw InputError(fmt::format(
        "{}: material '{}' reflects, and depth {} casts reflections, but {} has no kernel for them (chip.reflections): "
        "draw with --depth 1, or fit a configuration to this scene with raypool fit",
        scene.name, scene.reflecting()->name, record.depth, record.configuration.name));
  }
  if (record.configuration.subnormals == Subnormals::None) {
    const std::string found = subnormal_word(scene, arguments_of(record, scene));
    if (!found.empty()) {
      throw InputError(fmt::format(
          "{}: {}, a subnormal number, of which {} has none (arithmetic.subnormals): make it zero, draw with --set "
          "arithmetic.subnormals=ieee, or fit a configuration to this scene with raypool fit",
          scene.name, found, record.configuration.name));
    }
  }
  record_layout(ray_program(record), record.configuration);
  const Program& program = ray_program(record).program;
  for (const RayKernel kernel : kernels_of(chip, record.chip_depth(), record.reflections))
    check_instructions(program, std::string(kRayKernelNames[kernel]), record.configuration);
}

std::string describe(const ChipFault& fault, const RunRecord& record) {
  if (fault.fault.code != FaultCode::SubnormalNumber) return fault.what();
  const Program& program = ray_program(record).program;
  return fmt::format(
      "a subnormal number arose in kernel {} at '{}', and {} has none (arithmetic.subnormals): draw with --set "
      "arithmetic.subnormals=ieee, or fit a configuration to this frame with raypool fit ({})",
      kernel_at(program, fault.fault.pc),
      fault.fault.pc < program.code.size() ? disassemble(program.code[fault.fault.pc]) : "", record.configuration.name,
      fault.what());
}

Surroundings::Surroundings(const Scene& scene, const MemoryImage& image, const RunRecord& record)
    : tracer(scene, image.material_base, record.configuration.chip),
      scene_tracer(tracer),
      frame(record.width, record.height),
      sink(frame) {
  const ChipConfiguration& chip = record.configuration.chip;
  if (has_traverser(chip) && record.engine != "functional")
    tree = make_tree_image(scene, tracer.traversal().bvh(), chip, image.material_base);
}

ChipOptions chip_options(const RunRecord& record, const Scene& scene, MemoryImage& image, Surroundings& around) {
  const Program& program = ray_program(record).program;
  ChipOptions chip;
  chip.configuration = record.configuration;
  chip.memory = &image.memory;
  chip.program_length = size32(program.code);
  for (size_t i = 0; i < kRayKernels; ++i) chip.entries[i] = program.entries.at(std::string(kRayKernelNames[i]));
  chip.layout = record_layout(ray_program(record), record.configuration);
  chip.shaders = record.kernels != nullptr;
  chip.arguments = arguments_of(record, scene);
  chip.width = record.width;
  chip.height = record.height;
  chip.depth = record.chip_depth();
  chip.reflections = record.reflections;
  chip.tracer = &around.scene_tracer;
  chip.tree = around.tree ? &*around.tree : nullptr;
  chip.frame = &around.sink;
  return chip;
}

Tracer tracer_of(const RunRecord& record, const Scene& scene, const MemoryImage& image) {
  Tracer tracer(scene, image.material_base);
  tracer.take_hits_of(record.configuration.chip);
  return tracer;
}

NativeOptions native_options(const RunRecord& record) {
  NativeOptions native;
  native.width = record.width;
  native.height = record.height;
  native.depth = record.chip_depth();
  native.reflections = record.reflections;
  native.contents = record.configuration.contents();
  native.threads = threads_or_all();
  native.mode = arith::mode_of(record.configuration);
  native.culling = record.configuration.chip.culling;
  if (record.kernels) native.kernel = record.kernels->native;
  return native;
}

std::map<uint32_t, std::string> kernel_names(const Program& program) {
  std::map<uint32_t, std::string> names;
  for (const auto& [name, entry] : program.entries) names[entry] = name;
  return names;
}

std::string kernel_at(const Program& program, uint32_t pc) {
  const auto names = kernel_names(program);
  const auto behind = names.upper_bound(pc);
  return behind == names.begin() ? "of no name" : std::prev(behind)->second;
}

}  // namespace raypool
