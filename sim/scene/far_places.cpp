#include "scene/far_places.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "scene/subject.hpp"

namespace raypool {
namespace {

constexpr double kCentreSteps = 8;  // to a diagonal at most, of which centres are multiples: short numbers
constexpr double kLostShape = 0.1;  // of a triangle's longest edge: by less than this its corners may be off
constexpr int kDoubleDigits = 17;   // in which any two doubles differ

double largest(const Vec3d& v) { return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)}); }

/// Between this number and the next one of single precision.
double spacing(double value) {
  const auto single = static_cast<float>(std::fabs(value));
  return static_cast<double>(std::nextafter(single, INFINITY)) - static_cast<double>(single);
}

double in_file(double centre, float place) {
  const double exact = centre + static_cast<double>(place);
  for (int digits = 1; digits < kDoubleDigits; ++digits) {
    const double shorter = std::strtod(fmt::format("{:.{}g}", exact, digits).c_str(), nullptr);
    if (static_cast<float>(shorter - centre) == place) return shorter;
  }
  return exact;
}

}  // namespace

Vec3d FilePlaces::centre(const std::vector<uint32_t>& corners) const {
  Box box;
  for (const uint32_t corner : corners) box.add(places_[corner]);
  const double diagonal = length(box.extent()), far = std::max(largest(box.lower), largest(box.upper));
  // What is beyond the largest coordinate is refused where it is.
  if (!(diagonal > 0 && far > kFarDiagonals * diagonal && far <= static_cast<double>(kLargestCoordinate))) return {};
  const double step = std::exp2(std::floor(std::log2(diagonal / kCentreSteps)));
  Vec3d centre = box.centre();
  for (int axis = 0; axis < 3; ++axis) centre[axis] = std::round(centre[axis] / step) * step;
  return centre;
}

void FilePlaces::put_into(Scene& scene, const Vec3d& centre) const {
  scene.centre = centre;
  scene.vertices.clear();
  scene.vertices.reserve(places_.size());
  for (const Vec3d& place : places_) scene.vertices.push_back(from_file(centre, place));
}

void FilePlaces::tell_lost_detail(Scene& scene, const std::string& path, bool single) const {
  size_t lost = 0;
  double most = 0;
  for (const auto& triangle : scene.triangles) {
    double size = 0, off = 0;
    for (size_t i = 0; i < 3; ++i) {
      const Vec3d &place = places_[triangle[i]], &next = places_[triangle[(i + 1) % 3]];
      size = std::max(size, length(next - place));
      off = std::max(off, largest(place - scene.centre - scene.vertices[triangle[i]].as<double>()));
      if (single) off = std::max(off, spacing(largest(place)) / 2);
    }
    if (!(size > 0 && off > kLostShape * size)) continue;
    ++lost;
    most = std::max(most, off);
  }
  if (lost == 0) return;
  scene.warnings.push_back(fmt::format(
      "{}: single precision moves corners by up to {:.2g} in the file's units, which {} of {} triangles are too small "
      "for: {}",
      path, most, lost, scene.triangles.size(),
      single ? "export the file with coordinates in double precision, or near its origin"
             : "leave out what is far away from them"));
}

Vec3 from_file(const Vec3d& centre, const Vec3d& place) { return (place - centre).as<float>(); }

Vec3d in_file(const Vec3d& centre, const Vec3& place) {
  if (centre == Vec3d{}) return place.as<double>();
  return {in_file(centre.x, place.x), in_file(centre.y, place.y), in_file(centre.z, place.z)};
}

std::array<std::string, 3> texts_in_file(const Vec3d& centre, const Vec3& place) {
  const auto text = [](auto number) { return fmt::format("{}", number); };
  if (centre == Vec3d{}) return {text(place.x), text(place.y), text(place.z)};
  const Vec3d there = in_file(centre, place);
  return {text(there.x), text(there.y), text(there.z)};
}

}  // namespace raypool
