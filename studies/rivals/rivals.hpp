// Other ways to intersect, in floats, each as in its paper, and Embree. Only the match uses them: no engine does.
#pragma once

#include <array>

#include "referee/contender.hpp"

namespace raypool::referee {

/// Where a ray meets a triangle; the limits are the caller's.
struct FloatMeeting {
  bool meets = false;
  float t = 0;
};
using Corners = std::array<Vec3, 3>;

/// Moeller and Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection" (1997), both sides: what is nearly parallel,
/// by the paper's 0.000001, is not met.
FloatMeeting moeller_trumbore(const RayQuery& ray, const Corners& corners);
/// Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection" (2013).
FloatMeeting woop(const RayQuery& ray, const Corners& corners);
/// Baldwin and Weber, "Fast Ray-Triangle Intersections by Coordinate Transformation" (2016), the transformation in
/// floats too.
FloatMeeting baldwin_weber(const RayQuery& ray, const Corners& corners);
/// The sides of a ray and of three edges by Pluecker coordinates (Amanatides and Choi, "Ray Tracing Triangular Meshes",
/// 1997; borders included), t from the plane.
FloatMeeting pluecker(const RayQuery& ray, const Corners& corners);

/// These, and Embree's two kinds of scenes.
Contenders rivals();

}  // namespace raypool::referee
