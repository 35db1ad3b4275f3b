// The ray kernels, compiled and native.
#include "kernel/kernels.hpp"

#include "kernel/ray_kernels.hpp"

namespace raypool {
namespace {

template <Subnormals kSubnormals, SlowUnit kSlowUnit>
void run_in_mode(RayKernel which, NativeThread& thread) {
  kernel::NativeKernel<kSubnormals, kSlowUnit> k(thread);
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

template <Subnormals kSubnormals>
void run_in_mode(RayKernel which, NativeThread& thread) {
  switch (thread.mode.slow_unit) {
    case SlowUnit::Exact:
      return run_in_mode<kSubnormals, SlowUnit::Exact>(which, thread);
    case SlowUnit::Newton2:
      return run_in_mode<kSubnormals, SlowUnit::Newton2>(which, thread);
    case SlowUnit::Newton1:
      return run_in_mode<kSubnormals, SlowUnit::Newton1>(which, thread);
    case SlowUnit::Newton0:
      return run_in_mode<kSubnormals, SlowUnit::Newton0>(which, thread);
  }
}

std::string name_of(RayKernel which) { return std::string(kRayKernelNames[static_cast<size_t>(which)]); }

}  // namespace

void run_native(RayKernel which, NativeThread& thread) {
  if (thread.mode.subnormals == Subnormals::Flush)
    run_in_mode<Subnormals::Flush>(which, thread);
  else
    run_in_mode<Subnormals::Ieee>(which, thread);
}

const Program& ray_kernel_program() {
  static const Program kProgram = [] {
    Program program;
    kernel::add_kernel(program, name_of(RayKernel::CastEye), [](auto& k) { kernel::cast_eye(k); });
    kernel::add_kernel(program, name_of(RayKernel::CastSecondary), [](auto& k) { kernel::cast_secondary(k); });
    kernel::add_kernel(program, name_of(RayKernel::CastSecondaryDirect), [](auto& k) { kernel::cast_secondary_direct(k); });
    kernel::add_kernel(program, name_of(RayKernel::Shade), [](auto& k) { kernel::shade(k); });
    return program;
  }();
  return kProgram;
}

}  // namespace raypool
