// What a few rays see of a scene, for choosing a view and a light: surfaces are shaded as the kernels shade them, flat
// and from either side. Nothing here depends on the machine: no thread, no clock.
#pragma once

#include <optional>
#include <vector>

#include "scene/scene.hpp"
#include "scene/traversal.hpp"

namespace raypool {

/// A point of a surface that a ray meets.
struct Sample {
  Vec3d point;
  Vec3d normal;         ///< of unit length, on the side that the ray comes from
  double distance = 0;  ///< from the ray's origin
  bool front = false;   ///< the ray meets the side from which the corners turn left
  uint32_t triangle = 0;
};

/// A light, as seen at samples. Those of a material that no light brightens (Kd about 0) do not count.
struct Lit {
  double light = 0;  ///< sum of the cosines
  double dark = 0;   ///< share of the samples that are drawn black: in shadow, or turned away; 0 .. 1
};

/// The 26 directions to a cube's corners, edges and sides, of unit length.
const std::vector<Vec3d>& all_around();

class SceneProbe {
 public:
  /// `scene` must outlive it.
  explicit SceneProbe(const Scene& scene);

  const Scene& scene() const { return scene_; }
  const Bounds& bounds() const { return bounds_; }  ///< of all triangles
  double diagonal() const { return diagonal_; }     ///< of the bounds; never zero

  /// `towards` is of unit length.
  std::optional<Sample> hit(const Vec3d& from, const Vec3d& towards) const;
  /// What the pixels of a picture of columns x rows see, row by row; pixels that see nothing have none.
  std::vector<std::optional<Sample>> picture(const Camera& camera, int columns, int rows) const;
  Lit lit(const std::vector<Sample>& samples, const Vec3& light) const;
  /// Share of the directions on one side of a surface, `normal`'s, in which nothing is in the way. 0 .. 1
  double open_share(const Vec3d& point, const Vec3d& normal) const;

 private:
  const Scene& scene_;
  Bounds bounds_;
  double diagonal_;
  Traversal traversal_;
};

/// Half the height of a picture at distance 1. Rounded to float, which hides that libraries' tangents differ.
double half_height(float fov);

}  // namespace raypool
