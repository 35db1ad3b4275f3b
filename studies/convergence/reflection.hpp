// How a surface of a metallic-roughness material scatters light, in double precision: a matt part and a highlight, as
// docs/studies/convergence.md defines them. Written from the definition, and shares nothing with shaders/path.
#pragma once

#include <random>

#include "scene/vec.hpp"

namespace raypool::convergence {

using Random = std::mt19937_64;
/// In 0 .. 1, without 1.
double uniform(Random& random);

Vec3d times(const Vec3d& a, const Vec3d& b);
double largest_channel(const Vec3d& color);

/// A normal and two tangents, all of unit length.
struct Frame {
  explicit Frame(const Vec3d& axis);
  Vec3d out_of(double x, double y, double z) const { return tangent * x + bitangent * y + normal * z; }

  Vec3d normal, tangent, bitangent;
};

/// What a surface reflects to a viewer. Directions have unit length and lead away from the surface.
class Reflection {
 public:
  struct Surface {
    Vec3d face, normal;  ///< of the triangle and the shading normal, on the viewer's side
    Vec3d color;         ///< base colour
    double metallic = 0, roughness = 1;
  };
  Reflection(const Surface& surface, const Vec3d& viewer);

  /// Radiance to the viewer per radiance from there and solid angle: the BRDF times the cosine.
  Vec3d value(const Vec3d& direction) const;
  /// Per solid angle, of sample() giving this direction.
  double density(const Vec3d& direction) const;
  Vec3d sample(Random& random) const;

 private:
  bool is_lit_from(const Vec3d& direction) const;

  Surface surface_;
  Frame frame_;
  Vec3d viewer_;
  double width_, cosine_;
  Vec3d straight_, matt_;
  double highlight_;  // probability of sampling it
};

}  // namespace raypool::convergence
