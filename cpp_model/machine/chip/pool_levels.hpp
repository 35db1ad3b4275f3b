// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// What a controller sees of the pools.
#pragma once

#include <cstdint>

#include "enum_array.hpp"
#include "machine/chip/kernel_policy.hpp"
#include "machine/compute/compute_unit.hpp"

namespace raypool {

struct PoolLevels {
  uint32_t rays = 0, shadow_rays = 0;  ///< of the ray pool, and among them
  /// Of the intersection pool; and those that no launch has reserved.
  EnumArray<ImportKind, uint32_t, kImportKinds> size{}, available{};

  /// What a secondary kernel would import: normal intersections of the kind of which there are more.
  ImportKind secondary_import() const {
    return available[ImportKind::Direct] > available[ImportKind::Normal] ? ImportKind::Direct : ImportKind::Normal;
  }
  /// What a policy sees of them, with so many rays that kernels may still export; the rest of it is for the caller.
  PolicyView view(uint32_t rays_to_come) const {
    PolicyView view;
    view.rays = rays;
    view.normal = available[secondary_import()];
    view.shadow = available[ImportKind::Shadow];
    view.rays_to_come = rays_to_come;
    for (const ImportKind kind : {ImportKind::Normal, ImportKind::Shadow, ImportKind::Direct})
      view.promised += size[kind] - available[kind];
    view.more_to_come = rays > 0 || rays_to_come > 0;
    return view;
  }
};

}  // namespace raypool
