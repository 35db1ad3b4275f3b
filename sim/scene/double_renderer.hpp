// Engine `native` in double precision: the kernels' source, the camera and the hits with 53 bits, and no machine's
// arithmetic. What a picture of a machine is off by is its difference from this one.
#pragma once

#include <cstdint>

#include "scene/image.hpp"
#include "scene/native_renderer.hpp"
#include "scene/pixel_decisions.hpp"
#include "scene/scene.hpp"
#include "scene/traversal.hpp"

namespace raypool {

/// Of `options` size, depth, reflections and threads; `tracer`, of which it takes the tree, and `image` as for
/// render_native(). `decisions`, of the picture's size, are filled unless null. Throws InputError as render_native()
/// does.
FrameBuffer render_in_double(const Scene& scene, const MemoryImage& image, const Tracer& tracer,
                             const NativeOptions& options, NativeStatistics& statistics, PixelDecisions* decisions);

/// In place of offset_share(): thousands of times what double precision loses, as its hits have no bound of their
/// error.
inline constexpr double kDoubleOffsetShare = 0x1p-40;

}  // namespace raypool
