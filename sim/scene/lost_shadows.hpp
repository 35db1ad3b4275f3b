// Pictures of what is smaller than the offset of secondary rays: single precision has not the bits for its shadows.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "isa/isa.hpp"
#include "scene/scene.hpp"
#include "scene/traversal.hpp"

namespace raypool {

/// A sentence when of what the eye rays of such a frame hit (a grid of them is tried) one in a hundred or more is a
/// triangle that is smaller than the offset of secondary rays there; else empty. `arguments` are the kernels'.
std::string lost_shadows(const Scene& scene, const Traversal& traversal,
                         const std::array<uint32_t, kArguments>& arguments);

}  // namespace raypool
