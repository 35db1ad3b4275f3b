#include "scene/lost_shadows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bits.hpp"
#include "kernel/kernels.hpp"

namespace raypool {
namespace {

constexpr uint32_t kGrid = 24;  // rays along each side

/// The largest extent of the triangle along an axis.
float extent(const Scene& scene, uint32_t triangle) {
  const Vec3 a = scene.corner(triangle, 0), b = scene.corner(triangle, 1), c = scene.corner(triangle, 2);
  return std::max({largest_of(b - a), largest_of(c - a), largest_of(c - b)});
}

}  // namespace

std::string lost_shadows(const Scene& scene, const Traversal& traversal,
                         const std::array<uint32_t, kArguments>& arguments) {
  const auto get = [&](int number) { return as_float(arguments[static_cast<size_t>(number)]); };
  const auto vector = [&](int first) { return Vec3{get(first), get(first + 1), get(first + 2)}; };
  uint32_t hits = 0, lost = 0;
  float largest = 0, way = 0;
  for (uint32_t i = 0; i < kGrid * kGrid; ++i) {
    const auto step = [](uint32_t at, uint32_t pixels) {
      return static_cast<float>((2 * at + 1) * pixels / (2 * kGrid));
    };
    const Vec3 direction = vector(argument::kCorner) +
                           vector(argument::kStepX) * step(i % kGrid, arguments[argument::kWidth]) +
                           vector(argument::kStepY) * step(i / kGrid, arguments[argument::kHeight]);
    const Vec3 eye = vector(argument::kEye);
    Hit hit;
    if (!traversal.nearest({eye, direction, INFINITY}, hit)) continue;
    ++hits;
    const float offset = (largest_of(eye + direction * hit.t) + hit.t) * get(argument::kOffset);
    if (offset <= extent(scene, hit.triangle)) continue;
    ++lost;
    if (offset > largest) largest = offset, way = hit.t * length(direction);
  }
  if (100 * lost < std::max(hits, 1u)) return "";
  return fmt::format(
      "{}: {:.0f}% of what is seen are triangles smaller than the distance at which shadow and reflection rays must "
      "begin off their surfaces here, in single precision (up to {:.3g}, {:.3g} from the eye): their shadows are not "
      "to "
      "be relied on; put the eye nearer, or the scene nearer to the origin",
      scene.name, 100.0 * lost / hits, largest, way);
}

}  // namespace raypool
