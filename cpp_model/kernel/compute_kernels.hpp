// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Kernels that use memory only, for `raypool run`. Any number of blocks and threads may be
// launched, all blocks with the same number.
#pragma once

#include "enum_array.hpp"
#include "isa/program.hpp"
#include "kernel/kernels.hpp"

namespace raypool {

enum class ComputeKernel : uint8_t {
  Saxpy = 0,   ///< y[i] = a * x[i] + y[i] for i = 0 .. n-1
  Matmul = 1,  ///< c = a * b, matrices of n x n floats by rows; sums run over k = 0 .. n-1 in this order, from 0
};
inline constexpr EnumArray<ComputeKernel, std::string_view, 2> kComputeKernelNames = {"saxpy", "matmul"};

/// Argument words. Addresses are of bytes, multiples of 4.
namespace saxpy_argument {
inline constexpr int kN = 0;  ///< integer
inline constexpr int kA = 1;  ///< float
inline constexpr int kX = 2;  ///< address of n floats
inline constexpr int kY = 3;  ///< address of n floats
}  // namespace saxpy_argument
namespace matmul_argument {
inline constexpr int kN = 0;  ///< integer
inline constexpr int kA = 1;  ///< address of n * n floats
inline constexpr int kB = 2;
inline constexpr int kC = 3;
}  // namespace matmul_argument

/// Both kernels in one program, for such machines. Block words of
/// the launches must be 0 .. blocks-1.
const Program& compute_kernel_program(const KernelTarget& target = {});

/// One thread of a kernel as C++.
void run_native(ComputeKernel which, NativeThread& thread);

}  // namespace raypool
