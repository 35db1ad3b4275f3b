// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The kernels that a chip launches.
#pragma once

#include <cstdint>
#include <string_view>

#include "enum_array.hpp"

namespace raypool {

/// Kernels of the renderer; their names in Program::entries and reports are in kRayKernelNames.
enum class RayKernel : uint8_t {
  CastEye = 0,              ///< makes an eye ray for each pixel of a tile
  CastSecondary = 1,        ///< normal intersection -> reflection ray and shadow ray
  CastSecondaryDirect = 2,  ///< normal intersection -> shadow ray only
  Shade = 3,                ///< shadow intersection -> contribution to the frame buffer
};
inline constexpr int kRayKernels = 4;
inline constexpr EnumArray<RayKernel, std::string_view, kRayKernels> kRayKernelNames = {
    "cast_eye", "cast_secondary", "cast_secondary_direct", "shade"};

}  // namespace raypool
