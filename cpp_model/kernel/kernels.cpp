// The ray kernels as C++.
#include "kernel/kernels.hpp"

#include "kernel/ray_kernels.hpp"

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

}  // namespace raypool
