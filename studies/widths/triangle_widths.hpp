// What triangle tests of fewer bits (scene/narrow_triangles.hpp) do to the rays of a frame, to its picture, to hard
// rays, to seams and to the catalogue of hard cases.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "scene/image.hpp"
#include "scene/intersection_bench.hpp"
#include "scene/narrow_triangles.hpp"
#include "scene/scene.hpp"

namespace raypool::numerics {

/// Answers beside those of the engines' test, and beside exact arithmetic.
struct TriangleAnswers {
  uint64_t rays = 0;
  uint64_t other = 0;    ///< another triangle, or hit instead of miss, or the other way round
  uint64_t wrong = 0;    ///< of these: it is not a tie in exact arithmetic, and the engines' answer is right
  uint64_t right = 0;    ///< of these: it is not a tie in exact arithmetic, and the engines' answer is wrong
  uint64_t other_t = 0;  ///< the same triangle at another t
  double largest = 0;    ///< difference of t, in units of its last place
  uint64_t hits = 0;     ///< of the same triangle, by rays that ask what they hit
  uint64_t exact = 0;    ///< of the hits: t is the exact t of the triangle's plane, rounded to a float
  double error = 0;      ///< of the hits: sum of errors of t in units of its last place, of each at most kMostError
  uint64_t far_off = 0;  ///< of the hits: the error is kMostError or more
};
inline constexpr double kMostError = 16;
/// Of the distance, some 50 away, of a slanted triangle with corners that are floats of up to 1e9, multiples of 64.
inline constexpr double kLargeError = 8;

struct TriangleWidthRow {
  TriangleTime time = TriangleTime::Floats;
  uint32_t bits = 0;  ///< 0: the engines' test
  TriangleAnswers frame, soups;
  ImageDifference picture;  ///< from that of the engines
  uint64_t leaks = 0;       ///< of rays at seams
  uint64_t sides = 0;       ///< points on the wrong side of a large triangle, or off by more than kLargeError
  uint64_t broken = 0;      ///< hard cases that do not do what is defined
};
struct TriangleWidths {
  uint64_t seam_rays = 0, large = 0, cases = 0;
  std::vector<TriangleWidthRow> rows;
};

struct TriangleWidthOptions {
  uint32_t width = 320, height = 320, depth = 3;
  std::vector<TriangleTime> times = {TriangleTime::Floats, TriangleTime::Products, TriangleTime::Plane};
  std::vector<uint32_t> bits = {53, 40, 32, 28, 26, 24};
  uint64_t seam_rays = 100'000;                      ///< in all meshes together
  std::function<void(const std::string&)> progress;  ///< what is done now; may be empty
};

/// A row for the engines' test, then one for each definition and width. Throws InputError as rays_of_frame() does.
TriangleWidths try_triangle_widths(const Scene& scene, const TriangleWidthOptions& options);
std::string triangle_width_table(const TriangleWidths& tried);

}  // namespace raypool::numerics
