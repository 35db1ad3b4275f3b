#include "scene/narrow_triangles.hpp"

#include <cmath>

#include "bits.hpp"
#include "machine/traverser/triangle_pipe.hpp"
#include "scene/simd4.hpp"

namespace raypool {
namespace {

#include "scene/triangle_test.hpp"

Triangle triangle_of(const TriangleBlock& block, unsigned lane) {
  Triangle triangle{{}, block.triangles[lane]};
  for (int corner = 0; corner < 3; ++corner) {
    for (int axis = 0; axis < 3; ++axis) triangle.corners[corner][axis] = block.vertices[corner][axis][lane];
  }
  return triangle;
}

/// t of the plane, from distances to the origin alone.
double plane_t(const NarrowFloat& narrow, const PreparedRay& ray, const Triangle& triangle) {
  double corners[3][3], sides[2][3];
  for (int axis = 0; axis < 3; ++axis) {
    for (int corner = 0; corner < 3; ++corner) {
      corners[corner][axis] = narrow.subtract(triangle(corner, axis), ray.origin[axis]);
    }
    for (int i = 0; i < 2; ++i) sides[i][axis] = narrow.subtract(corners[i + 1][axis], corners[0][axis]);
  }
  return plane_time(narrow, ray, corners[0], sides);
}

}  // namespace

double TriangleTest::interpolated_t(const PreparedRay& ray, const Triangle& triangle, const double (&weights)[3],
                                    double determinant) const {
  double products[3];
  for (int corner = 0; corner < 3; ++corner) {
    const double z = narrow_.subtract(triangle(corner, ray.kz), ray.origin[ray.kz]);
    products[corner] = narrow_.multiply(weights[corner], z);
  }
  const double sum = narrow_.add(narrow_.add(products[0], products[1]), products[2]);
  const double terms = narrow_.add(narrow_.add(std::fabs(products[0]), std::fabs(products[1])), std::fabs(products[2]));
  if (std::fabs(sum) < kCancelled * terms) {
    return time_ == TriangleTime::Floats ? plane_t(narrow_, ray, triangle) : plane_time(narrow_, ray, triangle);
  }
  const double inverse_z = narrow_.divide(1, ray.direction[ray.kz]);
  return narrow_.multiply(narrow_.divide(sum, determinant), inverse_z);
}

bool TriangleTest::accept(const PreparedRay& ray, const TriangleBlock& block, unsigned lane, Candidate& best) const {
  const Triangle triangle = triangle_of(block, lane);
  const TriangleView view(ray, triangle);
  if (!TriangleEdges(view.x, view.y).inside()) return false;
  const float(&x)[3] = view.x, (&y)[3] = view.y;
  double weights[3];  // u, v, w
  bool small = time_ != TriangleTime::Floats;
  for (int k = 0; k < 3; ++k) {
    const int a = (k + 2) % 3, b = (k + 1) % 3;
    const float weight = x[a] * y[b] - y[a] * x[b];
    small |= std::fabs(weight) < kLeastWeight;
    weights[k] = weight;
  }
  for (int k = 0; small && k < 3; ++k) {
    const int a = (k + 2) % 3, b = (k + 1) % 3;
    weights[k] = narrow_.difference(x[a], y[b], y[a], x[b]);
  }
  const double determinant = narrow_.add(narrow_.add(weights[0], weights[1]), weights[2]);
  float t = 0;
  if (time_ == TriangleTime::Plane) {
    if (!meets_triangle(narrow_, ray, triangle, t)) return false;
  } else {
    t = static_cast<float>(interpolated_t(ray, triangle, weights, determinant));
    if (!move_into_own_box(ray, triangle, t)) return false;
  }
  if (!take(ray, block, lane, t, best)) return false;
  best.u = narrow_.divide(weights[1], determinant);
  best.v = narrow_.divide(weights[2], determinant);
  return true;
}

bool TriangleTest::operator()(const PreparedRay& ray, const TriangleBlock& block, Candidate& best) const {
  bool found = false;
  for (unsigned lane = 0; lane < block.count; ++lane) found |= accept(ray, block, lane, best);
  return found;
}

}  // namespace raypool
