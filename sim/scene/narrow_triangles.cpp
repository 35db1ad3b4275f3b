#include "scene/narrow_triangles.hpp"

#include <cmath>

#include "bits.hpp"
#include "machine/triangle_edges.hpp"
#include "scene/simd4.hpp"

namespace raypool {
namespace {

#include "scene/triangle_test.hpp"

constexpr float kSmallestFloat = 0x1p-149f;

}  // namespace

/// As the ray sees them.
struct TriangleTest::Corners {
  float x[3], y[3];

  Corners(const PreparedRay& ray, const TriangleBlock& block, unsigned lane) {
    for (int corner = 0; corner < 3; ++corner) {
      const auto from_origin = [&](int axis) { return block.vertices[corner][axis][lane] - ray.origin[axis]; };
      const float z = from_origin(ray.kz);
      x[corner] = from_origin(ray.kx) - ray.shear_x * z;
      y[corner] = from_origin(ray.ky) - ray.shear_y * z;
    }
  }
};

double TriangleTest::dot(const double (&a)[3], const double (&b)[3]) const {
  const double first = narrow_.add(narrow_.multiply(a[0], b[0]), narrow_.multiply(a[1], b[1]));
  return narrow_.add(first, narrow_.multiply(a[2], b[2]));
}

double TriangleTest::plane_t(const PreparedRay& ray, const TriangleBlock& block, unsigned lane) const {
  double corners[3][3], normal[3];
  for (int corner = 0; corner < 3; ++corner) {
    for (int axis = 0; axis < 3; ++axis) {
      corners[corner][axis] =
          narrow_.subtract(static_cast<double>(block.vertices[corner][axis][lane]), ray.origin[axis]);
    }
  }
  for (int axis = 0; axis < 3; ++axis) {
    const int i = (axis + 1) % 3, j = (axis + 2) % 3;
    const auto side = [&](int corner, int k) {
      if (time_ == TriangleTime::Floats) return narrow_.subtract(corners[corner][k], corners[0][k]);
      const float from = block.vertices[0][k][lane], to = block.vertices[corner][k][lane];
      return narrow_.subtract(static_cast<double>(to), static_cast<double>(from));
    };
    normal[axis] = narrow_.subtract(narrow_.multiply(side(1, i), side(2, j)), narrow_.multiply(side(1, j), side(2, i)));
  }
  return narrow_.divide(dot(normal, corners[0]), dot(normal, ray.direction));
}

bool TriangleTest::accept(const PreparedRay& ray, const TriangleBlock& block, unsigned lane, const Corners& corners,
                          Candidate& best) const {
  const auto& [x, y] = corners;
  double weights[3];  // u, v, w
  bool zero = time_ != TriangleTime::Floats;
  for (int k = 0; k < 3; ++k) {
    const int a = (k + 2) % 3, b = (k + 1) % 3;
    const float weight = x[a] * y[b] - y[a] * x[b];
    zero |= weight == 0;
    weights[k] = weight;
  }
  for (int k = 0; zero && k < 3; ++k) {
    const int a = (k + 2) % 3, b = (k + 1) % 3;
    weights[k] = narrow_.difference(x[a], y[b], y[a], x[b]);
  }
  const double determinant = narrow_.add(narrow_.add(weights[0], weights[1]), weights[2]);
  double products[3];
  int in_front = 0;
  for (int corner = 0; corner < 3; ++corner) {
    const double z = narrow_.subtract(static_cast<double>(block.vertices[corner][ray.kz][lane]), ray.origin[ray.kz]);
    products[corner] = narrow_.multiply(weights[corner], z);
    in_front += z * ray.direction[ray.kz] > 0;
  }
  const double sum = narrow_.add(narrow_.add(products[0], products[1]), products[2]);
  const double terms = narrow_.add(narrow_.add(std::fabs(products[0]), std::fabs(products[1])), std::fabs(products[2]));
  const double inverse_z = narrow_.divide(1, ray.direction[ray.kz]);
  const bool cancelled = std::fabs(sum) < kCancelled * terms;
  double t = time_ == TriangleTime::Plane || cancelled ? plane_t(ray, block, lane)
                                                       : narrow_.multiply(narrow_.divide(sum, determinant), inverse_z);
  if (time_ == TriangleTime::Plane && in_front == 3 && !(t > 0)) t = kSmallestFloat;
  if (time_ == TriangleTime::Plane && in_front == 0) return false;
  if (!take_if_nearer(ray, block, lane, static_cast<float>(t), best)) return false;
  best.u = narrow_.divide(weights[1], determinant);
  best.v = narrow_.divide(weights[2], determinant);
  return true;
}

bool TriangleTest::operator()(const PreparedRay& ray, const TriangleBlock& block, Candidate& best) const {
  bool found = false;
  for (unsigned lane = 0; lane < block.count; ++lane) {
    const Corners corners(ray, block, lane);
    if (TriangleEdges(corners.x, corners.y).inside()) found |= accept(ray, block, lane, corners, best);
  }
  return found;
}

}  // namespace raypool
