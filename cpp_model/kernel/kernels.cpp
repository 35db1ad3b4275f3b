// The ray kernels, compiled and native.
#include "kernel/kernels.hpp"

#include <fmt/format.h>

#include "kernel/ray_kernels.hpp"
#include "kernel/record_layout.hpp"

namespace raypool {
namespace {

template <Subnormals kSubnormals, SlowUnit kSlowUnit, bool kFused, bool kNarrow>
void run_in_mode(RayKernel which, NativeThread& thread) {
  kernel::NativeKernel<kSubnormals, kSlowUnit, kFused, kNarrow> k(thread);
  kernel::run_kernel(which, k);
}

template <Subnormals kSubnormals, SlowUnit kSlowUnit, bool kFused>
void run_in_mode(RayKernel which, NativeThread& thread) {
  thread.mode.narrow() ? run_in_mode<kSubnormals, kSlowUnit, kFused, true>(which, thread)
                       : run_in_mode<kSubnormals, kSlowUnit, kFused, false>(which, thread);
}

template <Subnormals kSubnormals, bool kFused>
void run_in_mode(RayKernel which, NativeThread& thread) {
  switch (thread.mode.slow_unit) {
    case SlowUnit::Exact:
      return run_in_mode<kSubnormals, SlowUnit::Exact, kFused>(which, thread);
    case SlowUnit::Newton2:
      return run_in_mode<kSubnormals, SlowUnit::Newton2, kFused>(which, thread);
    case SlowUnit::Newton1:
      return run_in_mode<kSubnormals, SlowUnit::Newton1, kFused>(which, thread);
    case SlowUnit::Newton0:
      return run_in_mode<kSubnormals, SlowUnit::Newton0, kFused>(which, thread);
  }
}

std::string name_of(RayKernel which) { return std::string(kRayKernelNames[which]); }

/// `compact`: what they import lacks the words that none of them needs.
template <typename Visit>
void for_each_kernel(bool compact, const Visit& visit) {
  visit(RayKernel::CastEye, [](auto& k) { kernel::cast_eye(k); });
  visit(RayKernel::CastSecondary, [&](auto& k) { kernel::cast_secondary(k, compact); });
  visit(RayKernel::CastSecondaryDirect, [](auto& k) { kernel::cast_secondary_direct(k); });
  visit(RayKernel::Shade, [](auto& k) { kernel::shade(k); });
}

struct Compiled {
  Program program;
  RecordLayout layout;  // of what the kernels import
};

Compiled compile_all(const KernelTarget& target) {
  Compiled all;
  if (target.compact) {
    std::vector<kernel::Function> kernels;
    for_each_kernel(true, [&](RayKernel which, const auto& body) {
      kernels.push_back(kernel::record_kernel(name_of(which), body, target));
    });
    all.layout = kernel::compact_layout(kernels);
  }
  for_each_kernel(target.compact, [&](RayKernel which, const auto& body) {
    kernel::add_kernel(all.program, name_of(which), body, target, all.layout);
  });
  return all;
}

const Compiled& compiled(const KernelTarget& target) { return program_for(target, compile_all); }

}  // namespace

void run_native(RayKernel which, NativeThread& thread) {
  if (thread.mode.subnormals != Subnormals::Ieee)
    thread.mode.fused ? run_in_mode<Subnormals::Flush, true>(which, thread)
                      : run_in_mode<Subnormals::Flush, false>(which, thread);
  else
    thread.mode.fused ? run_in_mode<Subnormals::Ieee, true>(which, thread)
                      : run_in_mode<Subnormals::Ieee, false>(which, thread);
}

std::vector<RayKernel> kernels_of(const ChipConfiguration& chip, int depth, bool reflections) {
  const RayKernel secondary = secondary_kernel(depth, reflections);
  std::vector<RayKernel> kernels = {RayKernel::CastEye, secondary};
  // With culling a hit of the last depth, or on what does not reflect, casts no reflection.
  if (chip.culling && secondary != RayKernel::CastSecondaryDirect) kernels.push_back(RayKernel::CastSecondaryDirect);
  if (chip.shading == Shading::Kernel) kernels.push_back(RayKernel::Shade);
  return kernels;
}

const Program& ray_kernel_program(const KernelTarget& target) { return compiled(target).program; }

RecordLayout ray_record_layout(const Configuration& configuration) {
  RecordLayout layout = compiled(KernelTarget(configuration)).layout;
  if (layout.words > configuration.intersection_words) {
    throw InputError(fmt::format(
        "configuration {}: intersection_words is {}, but the ray kernels need {} words of an "
        "intersection; it must lie in {} .. {}",
        configuration.name, configuration.intersection_words, layout.words, layout.words, kIntersectionWords));
  }
  layout.words = configuration.intersection_words;
  return layout;
}

}  // namespace raypool
