// A ball in surroundings that shine evenly: whatever it is made of, it vanishes before them if it keeps all light.
#pragma once

#include <cstdint>

#include "scene/scene.hpp"

namespace raypool::convergence {

/// A ball of flat faces of this material, seen from within a box that has radiance 1 and reflects nothing. Shadow rays
/// go to the box, or no ray but by chance.
enum class Finds : uint8_t { ByShadowRays, ByChance };
Scene furnace(const SurfaceMaterial& ball, Finds finds);

}  // namespace raypool::convergence
