// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Engine `estimate`: cycles of a frame from what the native renderer counts of it, without simulating the machine.
#pragma once

#include <cstdint>

#include "chip/estimates.hpp"
#include "config/configuration.hpp"
#include "estimate/unit_flow.hpp"
#include "estimate/workload.hpp"
#include "scene/native_renderer.hpp"
#include "scene/scene.hpp"
#include "scene/traversal.hpp"

namespace raypool::estimate {

/// As Estimates::error(), of every frame of such a machine.
double error_of(const Configuration& configuration);

/// What is known of a frame before there is a machine.
struct FrameCounts {
  Workload work;     ///< without reads of caches
  RayVisits visits;  ///< of a traverser in hardware
  double rays = 0;   ///< of the whole frame
};

/// Pixels whose flow engine `estimate` has, in runs of neighbouring tiles.
inline constexpr uint32_t kFlowPixels = 16384;

/// From drawing tiles of about so many pixels of a frame that render_native() has drawn with these options, whose
/// counts are `whole`. They hold for all machines with the configuration's contents, tile order, traverser and what it
/// tests boxes with.
FrameCounts count_frame(const Configuration& configuration, const Scene& scene, const MemoryImage& image,
                        const Tracer& tracer, const NativeOptions& native, const NativeStatistics& whole,
                        uint32_t pixels = kFlowPixels);

/// Of each kernel, as it is compiled for the machine.
KernelTable kernel_costs(const Configuration& configuration);

/// Deterministic.
Estimates estimate_frame(const Configuration& configuration, uint32_t units, const FrameCounts& counts);

}  // namespace raypool::estimate
