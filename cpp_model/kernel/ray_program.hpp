// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The ray kernels that a frame is drawn with: the built-in ones, or others that take their places.
#pragma once

#include "config/configuration.hpp"
#include "enum_array.hpp"
#include "isa/program.hpp"
#include "kernel/compiler.hpp"
#include "kernel/intermediate.hpp"
#include "kernel/kernels.hpp"
#include "kernel/target.hpp"
#include "machine/chip/ray_kernel.hpp"
#include "machine/common/packages.hpp"

namespace raypool {

using RayFunctions = EnumArray<RayKernel, kernel::Function, kRayKernels>;

struct RayProgram {
  Program program;         ///< with entries of kRayKernelNames
  RecordLayout layout;     ///< of the intersections that the kernels import; compact where the target is
  RayFunctions functions;  ///< what the program was compiled from, with words of whole intersections
  /// With the program's bits; from several threads of C++ at once too.
  NativeKernels native;
  int slots = 0;  ///< of spill memory that the kernels use, where their functions have one
  EnumArray<RayKernel, kernel::CompileCounts, kRayKernels> counts{};
};

/// The program of these kernels, which are recorded with whole intersections; natively they run from their intermediate
/// code. Throws InputError, with kernel and line, when one of them does not fit into registers, predicates or a
/// program.
RayProgram make_ray_program(RayFunctions functions, const KernelTarget& target);

/// Those of ray_kernels.hpp, which run natively as C++.
const RayProgram& built_in_ray_program(const KernelTarget& target = {});

/// Of a configuration's machines. Throws InputError when they have fewer words than the kernels need.
RecordLayout record_layout(const RayProgram& program, const Configuration& configuration);

}  // namespace raypool
