#include "kernel/compute_kernels.hpp"

#include "kernel/kernel.hpp"

namespace raypool {
namespace {

template <typename K>
void saxpy(K& k) {
  using Int = typename K::Int;
  using Float = typename K::Float;
  const Int n = k.int_argument(saxpy_argument::kN);
  const Int step = k.threads() * k.blocks();
  const Float a = k.float_argument(saxpy_argument::kA);
  Int i = k.block() * k.threads() + k.thread();
  k.while_([&] { return i < n; },
           [&] {
             const Int offset = i << 2;
             const Int y = k.int_argument(saxpy_argument::kY) + offset;
             k.store(y, 0, multiply_add(a, k.load_float(k.int_argument(saxpy_argument::kX) + offset), k.load_float(y)));
             i += step;
           });
}

template <typename K>
void matmul(K& k) {
  using Int = typename K::Int;
  using Float = typename K::Float;
  // A block takes every blocks-th row, a thread every threads-th column of it.
  const Int n = k.int_argument(matmul_argument::kN);
  const Int row_bytes = n << 2;
  Int row = k.block();
  k.while_([&] { return row < n; },
           [&] {
             const Int row_offset = row * row_bytes;
             Int column = k.thread();
             k.while_([&] { return column < n; },
                      [&] {
                        Int a = k.int_argument(matmul_argument::kA) + row_offset;
                        Int b = k.int_argument(matmul_argument::kB) + (column << 2);
                        const Int a_end = a + row_bytes;
                        Float sum = 0.0f;
                        k.while_([&] { return a != a_end; },
                                 [&] {
                                   sum = multiply_add(k.load_float(a), k.load_float(b), sum);
                                   a += 4;
                                   b += row_bytes;
                                 });
                        k.store(k.int_argument(matmul_argument::kC) + row_offset + (column << 2), 0, sum);
                        column += k.threads();
                      });
             row += k.blocks();
           });
}

template <Subnormals kSubnormals, bool kFused, bool kNarrow>
void run_in_mode(ComputeKernel which, NativeThread& thread) {
  kernel::NativeKernel<kSubnormals, SlowUnit::Exact, kFused, kNarrow> k(thread);
  if (which == ComputeKernel::Saxpy)
    saxpy(k);
  else
    matmul(k);
}

template <Subnormals kSubnormals, bool kFused>
void run_in_mode(ComputeKernel which, NativeThread& thread) {
  thread.mode.narrow() ? run_in_mode<kSubnormals, kFused, true>(which, thread)
                       : run_in_mode<kSubnormals, kFused, false>(which, thread);
}

}  // namespace

void run_native(ComputeKernel which, NativeThread& thread) {
  // Neither kernel uses the slow unit.
  if (thread.mode.subnormals != Subnormals::Ieee)
    thread.mode.fused ? run_in_mode<Subnormals::Flush, true>(which, thread)
                      : run_in_mode<Subnormals::Flush, false>(which, thread);
  else
    thread.mode.fused ? run_in_mode<Subnormals::Ieee, true>(which, thread)
                      : run_in_mode<Subnormals::Ieee, false>(which, thread);
}

const Program& compute_kernel_program(const KernelTarget& target) {
  return program_for(target, [](const KernelTarget& each) {
    Program program;
    kernel::add_kernel(
        program, std::string(kComputeKernelNames[0]), [](auto& k) { saxpy(k); }, each);
    kernel::add_kernel(
        program, std::string(kComputeKernelNames[1]), [](auto& k) { matmul(k); }, each);
    return program;
  });
}

}  // namespace raypool
