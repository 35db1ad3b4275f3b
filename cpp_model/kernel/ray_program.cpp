#include "kernel/ray_program.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "isa/input_error.hpp"
#include "kernel/compiler.hpp"
#include "kernel/function_runner.hpp"
#include "kernel/ray_kernels.hpp"
#include "kernel/record_layout.hpp"

namespace raypool {
namespace {

std::string name_of(size_t number) { return std::string(kRayKernelNames[number]); }

void compile_all(RayProgram& made, const KernelTarget& target) {
  if (target.compact) made.layout = kernel::compact_layout({made.functions.begin(), made.functions.end()});
  for (size_t i = 0; i < kRayKernels; ++i) {
    kernel::Function function = made.functions[i];
    function.name = name_of(i);
    kernel::place_words(function, made.layout);
    // Of a compact record ray memory has but these words.
    if (target.compact) function.slice_words = static_cast<int>(made.layout.words);
    made.counts[i] = kernel::compile(std::move(function), made.program, target);
    made.slots = std::max(made.slots, made.counts[i].slots);
  }
}

RayProgram make_built_in(const KernelTarget& target) {
  RayProgram made;
  const auto record = [&](RayKernel which, const auto& body) {
    made.functions[which] = kernel::record_kernel(std::string(kRayKernelNames[which]), body, target);
  };
  record(RayKernel::CastEye, [](auto& k) { kernel::cast_eye(k); });
  record(RayKernel::CastSecondary, [&](auto& k) { kernel::cast_secondary(k, target.compact); });
  record(RayKernel::CastSecondaryDirect, [](auto& k) { kernel::cast_secondary_direct(k); });
  record(RayKernel::Shade, [](auto& k) { kernel::shade(k); });
  compile_all(made, target);
  made.native = run_native;
  return made;
}

}  // namespace

RayProgram make_ray_program(RayFunctions functions, const KernelTarget& target) {
  RayProgram made;
  made.functions = std::move(functions);
  compile_all(made, target);
  std::vector<kernel::FunctionRunner> runners;
  for (const kernel::Function& function : made.functions) runners.emplace_back(function);
  made.native = {
      kernel::FunctionRunner::kMostThreads,
      [all = std::make_shared<const std::vector<kernel::FunctionRunner>>(std::move(runners))](
          RayKernel which, NativeThread* threads, size_t count) { (*all)[to_underlying(which)].run(threads, count); }};
  return made;
}

const RayProgram& built_in_ray_program(const KernelTarget& target) { return program_for(target, make_built_in); }

const Program& ray_kernel_program(const KernelTarget& target) { return built_in_ray_program(target).program; }

RecordLayout record_layout(const RayProgram& program, const Configuration& configuration) {
  RecordLayout layout = program.layout;
  if (layout.words > configuration.intersection_words) {
    throw InputError(fmt::format(
        "configuration {}: intersection_words is {}, but the ray kernels need {} words of an "
        "intersection; it must lie in {} .. {}",
        configuration.name, configuration.intersection_words, layout.words, layout.words, kIntersectionWords));
  }
  layout.words = configuration.intersection_words;
  return layout;
}

RecordLayout ray_record_layout(const Configuration& configuration) {
  return record_layout(built_in_ray_program(KernelTarget(configuration)), configuration);
}

}  // namespace raypool
