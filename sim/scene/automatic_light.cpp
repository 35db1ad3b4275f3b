#include "scene/automatic_light.hpp"

#include <algorithm>
#include <cmath>

namespace raypool {
namespace {

constexpr double kMostDark = 0.06;  // of what is seen
constexpr int kCoarse = 4;          // every fourth sample, where many places are tried
constexpr size_t kEnough = 400;     // samples that see something

/// Of a picture of 16 : 9, the square one in its middle, and a few of this.
struct Pictures {
  std::vector<Sample> wide, square, coarse;
};

Pictures pictures(const SceneProbe& probe, const Camera& camera) {
  Pictures result;
  // What is small in the picture is looked at more closely.
  for (const int rows : {36, 144, 288}) {
    const int columns = rows * 16 / 9;
    result = {};
    const auto samples = probe.picture(camera, columns, rows);
    for (int i = 0; i < columns * rows; ++i) {
      const auto& sample = samples[static_cast<size_t>(i)];
      if (!sample) continue;
      result.wide.push_back(*sample);
      if (std::abs(2 * (i % columns) + 1 - columns) <= rows) result.square.push_back(*sample);
    }
    if (result.square.size() >= kEnough) break;
  }
  for (size_t i = 0; i < result.square.size(); i += kCoarse) result.coarse.push_back(result.square[i]);
  return result;
}

}  // namespace

Vec3 automatic_light(const SceneProbe& probe, const Camera& camera, double distance, const RoomBox* room) {
  const Pictures seen = pictures(probe, camera);
  const auto bright = [&](const Vec3& place) {
    return probe.lit(seen.square, place).dark <= kMostDark && probe.lit(seen.wide, place).dark <= kMostDark;
  };
  const auto within = [](const Vec3d& place) {
    return std::max({std::fabs(place.x), std::fabs(place.y), std::fabs(place.z)}) <= kLargestCoordinate;
  };
  if (room != nullptr) {
    std::vector<std::pair<double, Vec3>> places;
    for (const double height : {0.75, 0.85}) {
      for (const double along : {0.5, 0.4, 0.6, 0.3, 0.7, 0.2, 0.8, 0.12, 0.88}) {
        for (const double across : {0.5, 0.4, 0.6, 0.3, 0.7, 0.2, 0.8}) {
          const Vec3 place = room->place(along, height, across).as<float>();
          const Lit lit = probe.lit(seen.coarse, place);
          if (lit.dark <= 1.5 * kMostDark) places.emplace_back(-std::round(1e6 * lit.light), place);
        }
      }
    }
    std::stable_sort(places.begin(), places.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (const auto& [light, place] : places) {
      if (bright(place)) return place;
    }
  }
  // Over one of the viewer's shoulders, and from there down to the eye, where nothing that is seen is in shadow.
  const Vec3d eye = camera.eye.as<double>(), forward = normalized(camera.direction.as<double>());
  const Vec3d right = normalized(cross(forward, camera.up.as<double>())), up = cross(right, forward);
  for (const double share : {1.0, 0.8, 0.6, 0.45, 0.33, 0.24, 0.17, 0.12, 0.08, 0.05, 0.03}) {
    for (const Vec3d& way :
         {right * 0.6 + up * 0.9, right * -0.6 + up * 0.9, right * 0.9 + up * 0.4, right * -0.9 + up * 0.4}) {
      const Vec3d place = eye + way * (share * distance);
      if (within(place) && bright(place.as<float>())) return place.as<float>();
    }
  }
  return camera.eye;
}

}  // namespace raypool
