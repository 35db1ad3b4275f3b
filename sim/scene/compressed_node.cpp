#include "scene/compressed_node.hpp"

#include <algorithm>
#include <cmath>

namespace raypool {
namespace {

constexpr int kGreatest = 255;  // of a plane's number
constexpr int kLeastExponent = -126;

float plane(const CompressedNode& node, int axis, int number) {
  return node.origin[axis] + static_cast<float>(number) * std::ldexp(1.0f, node.exponent[axis]);
}

/// False if the grid does not reach all planes: the sum in plane() is rounded.
bool compress_axis(const BvhNode& node, int axis, CompressedNode& result) {
  const double step = std::ldexp(1.0, result.exponent[axis]);
  for (int i = 0; i < result.children; ++i) {
    const float lower = node.bounds[0][axis][i], upper = node.bounds[1][axis][i];
    const auto steps = [&](float to) {
      return std::min<double>((static_cast<double>(to) - result.origin[axis]) / step, kGreatest);
    };
    int first = static_cast<int>(steps(lower)), last = static_cast<int>(std::ceil(steps(upper)));
    while (first > 0 && plane(result, axis, first) > lower) --first;
    while (last <= kGreatest && plane(result, axis, last) < upper) ++last;
    if (last > kGreatest) return false;
    result.planes[0][axis][i] = static_cast<uint8_t>(first);
    result.planes[1][axis][i] = static_cast<uint8_t>(last);
  }
  return true;
}

}  // namespace

CompressedNode compress(const BvhNode& node) {
  CompressedNode result{};
  std::copy_n(node.children, kBvhWidth, result.places.begin());
  while (result.children < kBvhWidth && node.children[result.children] != kNoChild) ++result.children;
  for (int axis = 0; axis < 3 && result.children > 0; ++axis) {
    const float* lower = node.bounds[0][axis];
    const float* upper = node.bounds[1][axis];
    result.origin[axis] = *std::min_element(lower, lower + result.children);
    const double extent = static_cast<double>(*std::max_element(upper, upper + result.children)) - result.origin[axis];
    int exponent = kLeastExponent;
    if (extent > 0) exponent = std::max(exponent, std::ilogb(extent / kGreatest));
    do {
      result.exponent[axis] = static_cast<int8_t>(exponent++);
    } while (!compress_axis(node, axis, result));
  }
  return result;
}

BvhNode decompress(const CompressedNode& node) {
  BvhNode result{};
  std::copy(node.places.begin(), node.places.end(), result.children);
  for (int axis = 0; axis < 3; ++axis) {
    for (int i = 0; i < kBvhWidth; ++i) {
      const bool there = i < node.children;
      result.bounds[0][axis][i] = there ? plane(node, axis, node.planes[0][axis][i]) : INFINITY;
      result.bounds[1][axis][i] = there ? plane(node, axis, node.planes[1][axis][i]) : -INFINITY;
    }
  }
  return result;
}

}  // namespace raypool
