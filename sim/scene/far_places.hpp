// Scenes at map coordinates: a file's coordinates are counted from a point near the scene before they are rounded to
// single precision, and reported in the file's coordinates again. docs/use/scene-preparation.md has the rule.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace raypool {

/// A scene is recentred when a coordinate of its box is larger than this many diagonals of the box.
inline constexpr double kFarDiagonals = 16;

/// Where a file has its corners, in double.
class FilePlaces {
 public:
  void add(const Vec3d& place) { places_.push_back(place); }
  void clear() { places_.clear(); }
  size_t size() const { return places_.size(); }

  /// The centre that the rule gives for the places that `corners` name: zero unless they are far from the origin.
  Vec3d centre(const std::vector<uint32_t>& corners) const;
  /// Makes the scene's vertices of them, counted from `centre`.
  void put_into(Scene& scene, const Vec3d& centre) const;
  /// Adds a warning when triangles of the scene, made by put_into(), have lost their shape. `single`: the file has its
  /// coordinates in single precision itself.
  void tell_lost_detail(Scene& scene, const std::string& path, bool single = false) const;

 private:
  std::vector<Vec3d> places_;
};

/// Counted from the centre, in single precision.
Vec3 from_file(const Vec3d& centre, const Vec3d& place);
/// The file's coordinates of a place of the scene: around a centre the shortest decimals that are read as it.
Vec3d in_file(const Vec3d& centre, const Vec3& place);
/// The same as text.
std::array<std::string, 3> texts_in_file(const Vec3d& centre, const Vec3& place);

}  // namespace raypool
