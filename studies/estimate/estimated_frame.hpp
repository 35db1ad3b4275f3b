// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Engine `estimate`: cycles of a frame from what the native renderer counts of it, without simulating the machine.
#pragma once

#include <cstdint>

#include "chip/estimates.hpp"
#include "config/configuration.hpp"
#include "scene/native_renderer.hpp"
#include "scene/scene.hpp"
#include "scene/traversal.hpp"

namespace raypool::estimate {

/// As Estimates::error(), of every frame of such a machine.
double error_of(const Configuration& configuration);

/// Of a frame that render_native() has drawn with these options, whose counts are `whole`. Deterministic.
Estimates estimate_frame(const Configuration& configuration, uint32_t units, const Scene& scene,
                         const MemoryImage& image, const Tracer& tracer, const NativeOptions& native,
                         const NativeStatistics& whole);

}  // namespace raypool::estimate
