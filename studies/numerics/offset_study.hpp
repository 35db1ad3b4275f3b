// By how much the origin of a secondary ray should leave its surface: rules compared
// on near, far, small and large scenes.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace raypool::numerics {

/// What a rule works with, all in single precision as the kernel has it.
struct OffsetInput {
  Vec3 origin, direction;  ///< of the ray that hit
  float t;
  Vec3 normal;     ///< unit length, on the side from which the ray came
  float diagonal;  ///< of the scene's bounding box
  float share;     ///< the kernels' argument kOffset
};
struct OffsetRule {
  std::string name;
  std::function<Vec3(const OffsetInput&)> origin;
  bool hardware = false;  ///< the hits are those of the chip's traverser, not those of `static`
};
/// None; a fixed distance; shares of the scene's diagonal; the machine's rule (camera_arguments()), with the hits of
/// each traverser; and the integer offset along the normal (Waechter and Binder, "A Fast and Robust Method for Avoiding
/// Self-Intersection", Ray Tracing Gems, 2019, chapter 6).
std::vector<OffsetRule> offset_rules();

struct OffsetScene {
  std::string name;
  Scene scene;
};
/// Near: built-in scenes as they are. Small and large: cornell at 1e-6 and 1e6. Far: cornell moved by 100 m and by 10
/// km. Wide: a cube and a ball on a ground that is up to 10^6 times as wide, level, and tilted by odd angles.
std::vector<OffsetScene> offset_scenes();

/// Shadow and reflection rays of the primary hits of a picture, against the reference, ties apart.
struct OffsetCounts {
  uint64_t shadow_rays = 0;  ///< from points that face the light
  uint64_t acne =
      0;  ///< blocked by the triangle that the ray starts from, or one in its plane, where the reference sees the light
  uint64_t moved = 0;        ///< blocked by another triangle, where the reference sees the light
  uint64_t leaks = 0;        ///< free, where the reference is in shadow
  uint64_t reflections = 0;  ///< reflection rays, of which
  uint64_t self_hits = 0;    ///< hit it
  uint64_t wrong() const { return acne + moved + leaks + self_hits; }
};
/// A picture of size x size pixels, every rule in turn; the result has the order of `rules`.
std::vector<OffsetCounts> study_offsets(const Scene& scene, const std::vector<OffsetRule>& rules, int size);

/// Instructions of the machine that a distance given by the host, the rule in use and the integer offset take, for the
/// three coordinates.
struct OffsetInstructions {
  int fixed = 0, in_use = 0, integer = 0;
};
OffsetInstructions offset_instructions();

}  // namespace raypool::numerics
