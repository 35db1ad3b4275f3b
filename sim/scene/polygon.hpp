// Faces of more than three corners become triangles that cover what the outline encloses, notches left out.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "scene/vec.hpp"

namespace raypool {

enum class PolygonShape : uint8_t {
  Flat,
  Bent,  ///< a corner is off the others' plane by more than a hundredth of the face's size: which triangles is a guess
  NoArea,    ///< all corners on one line; its triangles have no area either
  Crossing,  ///< the outline crosses itself and encloses nothing definite; it becomes a fan from its first corner
};

/// Appends the triangles of the face, wound like it. A convex quadrilateral is cut along its shorter diagonal.
PolygonShape triangulate(const std::vector<Vec3>& vertices, const uint32_t* corners, size_t count,
                         std::vector<std::array<uint32_t, 3>>& triangles);

/// One sentence for each kind of faces that cannot be drawn as they are; it begins with name(the first one's number).
void warn_of_faces(std::vector<std::string>& warnings, const std::map<PolygonShape, std::vector<size_t>>& faces,
                   const std::function<std::string(size_t)>& name);

}  // namespace raypool
