// A highlight by the microfacets of Trowbridge and Reitz, as glTF defines it. Cosines are those with the normal, unless
// they are of Fresnel.
#pragma once

#include <algorithm>
#include <cmath>

#include "scene/vec.hpp"

namespace raypool::convergence {

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kDielectric = 0.04;  ///< reflectance of dielectrics at normal incidence

/// glTF's alpha. A mirror has a width too, so that lights are found in it.
inline double highlight_width(double roughness) { return std::max(roughness * roughness, 0.01); }

/// By Schlick; `straight` is reflected at cosine 1.
inline Vec3d fresnel(const Vec3d& straight, double cosine) {
  const double rest = std::pow(1 - std::clamp(cosine, 0.0, 1.0), 5);
  return straight * (1 - rest) + Vec3d{rest, rest, rest};
}

/// Per solid angle and projected area: D.
inline double microfacets(double cosine, double width) {
  const double square = width * width, root = cosine * cosine * (square - 1) + 1;
  return square / (kPi * root * root);
}

/// Their share that is seen from this cosine, by Smith.
inline double microfacets_seen(double cosine, double width) {
  const double square = width * width;
  return 2 * cosine / (cosine + std::sqrt(square + (1 - square) * cosine * cosine));
}

/// The share of light that the highlight of a material without metal sends to a viewer at this cosine, when light comes
/// evenly from everywhere.
double highlight_albedo(double cosine, double roughness);

}  // namespace raypool::convergence
