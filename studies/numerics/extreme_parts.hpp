// What the themes of the catalogue have in common: small scenes, frames of a single ray, and checks of a drawing.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "numerics/extremes.hpp"
#include "scene/scene.hpp"
#include "scene/vec.hpp"

namespace raypool::numerics {

inline constexpr float kInf = std::numeric_limits<float>::infinity();
inline constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

using TriangleCorners = std::array<Vec3, 3>;

/// Grey triangles that mirror half, in this order; camera at the origin looks along -z, the light stands at the camera.
Scene scene_of_triangles(const std::vector<TriangleCorners>& triangles);
/// A square of two triangles in the plane z, from -half to half.
std::vector<TriangleCorners> square(float half, float z);
/// A closed cube from `lower` to `upper`, 12 triangles, normals inwards.
std::vector<TriangleCorners> cube(float lower, float upper);

/// A picture of 1 x 1 pixel with exactly this eye ray, zeros' signs included.
ExtremeFrame ray_frame(Scene scene, const Vec3& origin, const Vec3& direction);
/// The eye ray of a drawing of one pixel.
const TracedRay& eye_ray(const Drawing& drawing);

/// Every vertex, the eye and the light, times `scale` plus `offset`, in double precision, rounded to float.
Scene moved(const Scene& scene, double scale, const Vec3d& offset);

bool is_lit(const FrameBuffer& frame, int x, int y);
/// Pixels with light.
uint64_t lit_pixels(const FrameBuffer& frame);

// Each throws ExtremeFailure.
/// No contribution has a NaN.
void require_no_nan(const Drawing& drawing);
/// Every traced ray found what exact arithmetic finds, or something equal to it at single precision.
void require_right_hits(const Drawing& drawing, const Scene& scene);
/// Nothing was hit, and the picture is black.
void require_nothing(const Drawing& drawing);
/// check_scene() refuses the scene with a sentence that names `word`.
void require_refused(const Scene& scene, const std::string& word);

}  // namespace raypool::numerics
