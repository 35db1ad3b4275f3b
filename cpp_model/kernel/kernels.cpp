// The ray kernels, compiled and native.
#include "kernel/kernels.hpp"

#include "kernel/ray_kernels.hpp"

namespace raypool {
namespace {

template <Subnormals kSubnormals, SlowUnit kSlowUnit, bool kFused>
void run_in_mode(RayKernel which, NativeThread& thread) {
  kernel::NativeKernel<kSubnormals, kSlowUnit, kFused> k(thread);
  switch (which) {
    case RayKernel::CastEye:
      return kernel::cast_eye(k);
    case RayKernel::CastSecondary:
      return kernel::cast_secondary(k);
    case RayKernel::CastSecondaryDirect:
      return kernel::cast_secondary_direct(k);
    case RayKernel::Shade:
      return kernel::shade(k);
  }
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

}  // namespace

void run_native(RayKernel which, NativeThread& thread) {
  if (thread.mode.subnormals == Subnormals::Flush)
    thread.mode.fused ? run_in_mode<Subnormals::Flush, true>(which, thread)
                      : run_in_mode<Subnormals::Flush, false>(which, thread);
  else
    thread.mode.fused ? run_in_mode<Subnormals::Ieee, true>(which, thread)
                      : run_in_mode<Subnormals::Ieee, false>(which, thread);
}

const Program& ray_kernel_program(const KernelTarget& target) {
  return program_for(target, [](const KernelTarget& each) {
    Program program;
    const auto add = [&](RayKernel which, const auto& body) {
      kernel::add_kernel(program, name_of(which), body, each);
    };
    add(RayKernel::CastEye, [](auto& k) { kernel::cast_eye(k); });
    add(RayKernel::CastSecondary, [](auto& k) { kernel::cast_secondary(k); });
    add(RayKernel::CastSecondaryDirect, [](auto& k) { kernel::cast_secondary_direct(k); });
    add(RayKernel::Shade, [](auto& k) { kernel::shade(k); });
    return program;
  });
}

}  // namespace raypool
