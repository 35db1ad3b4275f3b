#include "scene/subject.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tuple>

#include "bits.hpp"

namespace raypool {
namespace {

// How much larger than all the rest, in two directions, is what the rest stands on, before or in. What faces outwards
// may be something solid with a core.
constexpr double kLargerPlane = 2.5, kLargerSheet = 4, kLargerSky = 3, kLargerSolid = 8;
constexpr double kThin = 0.04;    // of its second largest length: as thick as a slab of ground may be
constexpr double kSheet = 0.5;    // the area of a sheet's mean direction, of all its area
constexpr double kTileSizes = 4;  // the larger of two tiles of one floor, of the smaller
constexpr double kStrayArea = 0.01, kStrayDistance = 4;  // of all; of the size of the rest
constexpr size_t kMostSurroundings = 16;
constexpr int kLeastTriangles = 4;  // of a subject

class Union {
 public:
  explicit Union(size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }
  uint32_t find(uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(uint32_t a, uint32_t b) {
    a = find(a), b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<uint32_t> parent_;
};

/// Numbers of what `find` calls the same, in order of appearance.
Shells numbered(Union& sets, const std::vector<uint32_t>& of_triangle) {
  Shells shells;
  std::vector<uint32_t> number(of_triangle.empty() ? 0 : 1 + *std::max_element(of_triangle.begin(), of_triangle.end()),
                               UINT32_MAX);
  shells.of_triangle.reserve(of_triangle.size());
  for (const uint32_t i : of_triangle) {
    uint32_t& shell = number[sets.find(i)];
    if (shell == UINT32_MAX) shell = shells.count++;
    shells.of_triangle.push_back(shell);
  }
  return shells;
}

struct Piece {
  Box box;
  Vec3d direction;  // the sum of the areas, each along its normal
  double area = 0;
  double facing_out = 0;  // a volume: above zero where the triangles face away from the first of their corners
  Vec3d first;
  int triangles = 0;
};

std::vector<Piece> pieces_of(const Scene& scene, const Shells& shells) {
  std::vector<Piece> pieces(shells.count);
  for (size_t i = 0; i < scene.triangles.size(); ++i) {
    const Vec3d a = scene.corner(i, 0).as<double>(), b = scene.corner(i, 1).as<double>(),
                c = scene.corner(i, 2).as<double>();
    const Vec3d area = cross(b - a, c - a) * 0.5;
    if (!(length(area) > 0)) continue;
    Piece& piece = pieces[shells.of_triangle[i]];
    if (piece.triangles == 0) piece.first = a;
    for (const Vec3d& corner : {a, b, c}) piece.box.add(corner);
    piece.facing_out += dot(area, a - piece.first);
    piece.direction = piece.direction + area;
    piece.area += length(area);
    ++piece.triangles;
  }
  return pieces;
}

int thinnest_axis(const Box& box) {
  const Vec3d extent = box.extent();
  return extent.x <= extent.y && extent.x <= extent.z ? 0 : extent.y <= extent.z ? 1 : 2;
}

/// Flat pieces of about the same size at the same height become one: the tiles of a floor.
void join_layers(const Scene& scene, Shells& shells) {
  const std::vector<Piece> pieces = pieces_of(scene, shells);
  struct Flat {
    double size, height;
    uint32_t piece;
  };
  std::array<std::vector<Flat>, 3> layers;
  for (uint32_t i = 0; i < pieces.size(); ++i) {
    const Box& box = pieces[i].box;
    const int axis = thinnest_axis(box);
    const double size = box.nth_extent(1);
    if (pieces[i].triangles > 0 && box.extent()[axis] <= kThin * size)
      layers[axis].push_back({size, box.lower[axis], i});
  }
  Union sets(pieces.size());
  for (auto& layer : layers) {
    std::sort(layer.begin(), layer.end(),
              [](const Flat& a, const Flat& b) { return std::pair(a.height, a.piece) < std::pair(b.height, b.piece); });
    for (size_t i = 1; i < layer.size(); ++i) {
      const Flat &a = layer[i - 1], &b = layer[i];
      const double smaller = std::min(a.size, b.size), larger = std::max(a.size, b.size);
      if (b.height - a.height <= kThin * smaller && larger <= kTileSizes * smaller) sets.join(a.piece, b.piece);
    }
  }
  shells = numbered(sets, shells.of_triangle);
}

/// By their second largest length, the largest first; those without area are left out.
std::vector<uint32_t> by_size(const std::vector<Piece>& pieces) {
  std::vector<uint32_t> order;
  for (uint32_t i = 0; i < pieces.size(); ++i) {
    if (pieces[i].triangles > 0) order.push_back(i);
  }
  std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
    return std::pair(-pieces[a].box.nth_extent(1), a) < std::pair(-pieces[b].box.nth_extent(1), b);
  });
  return order;
}

constexpr int kSides = 6;

/// All corners of the triangle are in a thin layer at this side of its piece's box.
bool in_layer(const Scene& scene, size_t triangle, const Box& box, int side) {
  const int axis = side / 2;
  const double thickness = kThin * box.nth_extent(1);
  for (int corner = 0; corner < 3; ++corner) {
    const double place = scene.corner(triangle, corner)[axis];
    if (side % 2 == 0 ? place > box.lower[axis] + thickness : place < box.upper[axis] - thickness) return false;
  }
  return true;
}

/// A piece with a thin layer at one of its sides, and much less beyond it, becomes two: something that stands on ground
/// of the same mesh.
void part_from_ground(const Scene& scene, Shells& shells) {
  const std::vector<Piece> pieces = pieces_of(scene, shells);
  struct Large {
    uint32_t piece;
    std::array<Box, kSides> beyond;  // of each side: what is not wholly in the layer there
    int ground = -1;                 // side
    uint32_t number = 0;             // of what stands on it
  };
  std::vector<Large> large;
  for (const uint32_t i : by_size(pieces)) {
    if (large.size() == kMostSurroundings) break;
    large.push_back({i, {}});
  }
  std::vector<Large*> of_piece(pieces.size());
  for (Large& one : large) of_piece[one.piece] = &one;
  for (size_t i = 0; i < scene.triangles.size(); ++i) {
    Large* one = of_piece[shells.of_triangle[i]];
    for (int side = 0; side < kSides && one != nullptr; ++side) {
      if (in_layer(scene, i, pieces[one->piece].box, side)) continue;
      for (int corner = 0; corner < 3; ++corner) one->beyond[side].add(scene.corner(i, corner).as<double>());
    }
  }
  for (Large& one : large) {
    for (int side = 0; side < kSides && one.ground < 0; ++side) {
      const Box& rest = one.beyond[side];
      if (rest.empty() || rest.nth_extent(0) * kLargerPlane > pieces[one.piece].box.nth_extent(1)) continue;
      one.ground = side;
      one.number = shells.count++;
    }
  }
  for (size_t i = 0; i < scene.triangles.size(); ++i) {
    const Large* one = of_piece[shells.of_triangle[i]];
    if (one != nullptr && one->ground >= 0 && !in_layer(scene, i, pieces[one->piece].box, one->ground))
      shells.of_triangle[i] = one->number;
  }
}

/// No corner of it is before one of its triangles and another behind; of a few of both.
bool is_convex(const Scene& scene, const std::vector<uint32_t>& triangles, double size) {
  const size_t step = 1 + triangles.size() / 97;
  for (size_t i = 0; i < triangles.size(); i += step) {
    if (is_degenerate(scene, triangles[i])) continue;
    const Vec3d origin = scene.corner(triangles[i], 0).as<double>(), normal = scene.normal(triangles[i]).as<double>();
    bool before = false, behind = false;
    for (size_t k = 0; k < triangles.size(); k += step) {
      for (int corner = 0; corner < 3; ++corner) {
        const double height = dot(scene.corner(triangles[k], corner).as<double>() - origin, normal);
        before |= height > 0.01 * size, behind |= height < -0.01 * size;
      }
    }
    if (before && behind) return false;
  }
  return true;
}

/// What a piece may be around something smaller, if anything.
struct Surroundings {
  double larger = 0;  // than all the rest; 0: it may not
  bool sky = false;   // the rest must be in it
};
Surroundings surroundings(const Scene& scene, const Shells& shells, uint32_t number, const Piece& piece) {
  const double facing = length(piece.direction) / piece.area;
  if (piece.box.nth_extent(2) <= kThin * piece.box.nth_extent(1) || facing > 0.98) return {kLargerPlane};
  std::vector<uint32_t> triangles;
  for (size_t i = 0; i < scene.triangles.size(); ++i) {
    if (shells.of_triangle[i] == number) triangles.push_back(static_cast<uint32_t>(i));
  }
  if (is_convex(scene, triangles, piece.box.nth_extent(0)))
    return {piece.facing_out > 0 ? kLargerSolid : kLargerSky, true};
  return {facing < kSheet ? 0 : kLargerSheet};
}

/// How many of the largest pieces are around the others: as many as leave something that is much smaller than all of
/// these.
size_t count_surroundings(const Scene& scene, const Shells& shells, const std::vector<Piece>& pieces,
                          const std::vector<uint32_t>& order) {
  std::vector<Box> rest(order.size() + 1);
  std::vector<int> left(order.size() + 1);
  for (size_t i = order.size(); i-- > 0;) {
    rest[i] = rest[i + 1];
    rest[i].add(pieces[order[i]].box);
    left[i] = left[i + 1] + pieces[order[i]].triangles;
  }
  std::vector<Surroundings> around;
  size_t count = 0;
  for (size_t k = 0; k < std::min(order.size(), kMostSurroundings); ++k) {
    around.push_back(surroundings(scene, shells, order[k], pieces[order[k]]));
    if (around.back().larger == 0 || left[k + 1] < kLeastTriangles) break;
    bool all_larger = true;
    for (size_t i = 0; i <= k; ++i) {
      const Box& box = pieces[order[i]].box;
      all_larger &= box.nth_extent(1) >= around[i].larger * rest[k + 1].nth_extent(0);
      // Of what is before a wall, or on the ground, some may stick through it; but nothing is seen beyond the sky.
      if (around[i].sky) all_larger &= box.contains(rest[k + 1].lower) && box.contains(rest[k + 1].upper);
    }
    if (all_larger) count = k + 1;
  }
  return count;
}

/// Small pieces so far away that what they lie around would be small in the picture.
std::vector<uint32_t> strays(const std::vector<Piece>& pieces, std::vector<uint32_t> order) {
  std::sort(order.begin(), order.end(),
            [&](uint32_t a, uint32_t b) { return std::pair(-pieces[a].area, a) < std::pair(-pieces[b].area, b); });
  Box all, most;
  double area = 0, of_most = 0;
  for (const uint32_t i : order) {
    all.add(pieces[i].box);
    area += pieces[i].area;
  }
  size_t first = 0;
  for (; first < order.size() && of_most < (1 - kStrayArea) * area; ++first) {
    most.add(pieces[order[first]].box);
    of_most += pieces[order[first]].area;
  }
  const double size = most.nth_extent(0);
  order.erase(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(first));
  const auto is_far = [&](uint32_t i) {
    const Box& box = pieces[i].box;
    double gap = 0;
    for (int axis = 0; axis < 3; ++axis)
      gap = std::max({gap, box.lower[axis] - most.upper[axis], most.lower[axis] - box.upper[axis]});
    return gap > size;
  };
  const bool hide_the_rest = all.nth_extent(0) > kStrayDistance * size;
  return hide_the_rest && std::all_of(order.begin(), order.end(), is_far) ? order : std::vector<uint32_t>();
}

Subject subject_of(const Scene& scene, std::vector<bool> triangles) {
  Subject subject;
  std::vector<bool> used(scene.vertices.size());
  for (size_t i = 0; i < scene.triangles.size(); ++i) {
    if (is_degenerate(scene, i)) triangles[i] = false;
    if (!triangles[i]) continue;
    for (const uint32_t index : scene.triangles[i]) {
      if (!used[index]) subject.vertices.push_back(scene.vertices[index].as<double>());
      used[index] = true;
    }
  }
  for (const Vec3d& vertex : subject.vertices) subject.box.add(vertex);
  subject.triangles = std::move(triangles);
  return subject;
}

}  // namespace

void Box::add(const Vec3d& point) {
  for (int axis = 0; axis < 3; ++axis) {
    lower[axis] = std::min(lower[axis], point[axis]);
    upper[axis] = std::max(upper[axis], point[axis]);
  }
}

void Box::add(const Box& other) {
  if (other.empty()) return;
  add(other.lower);
  add(other.upper);
}

bool Box::contains(const Vec3d& p) const {
  return p.x >= lower.x && p.y >= lower.y && p.z >= lower.z && p.x <= upper.x && p.y <= upper.y && p.z <= upper.z;
}

double Box::nth_extent(int n) const {
  std::array<double, 3> extents = {extent().x, extent().y, extent().z};
  std::sort(extents.rbegin(), extents.rend());
  return extents[n];
}

Shells shells_of(const Scene& scene) {
  std::vector<uint32_t> order(scene.vertices.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto place = [&](uint32_t i) {
    const Vec3& v = scene.vertices[i];
    return std::tuple(v.x, v.y, v.z);
  };
  std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return place(a) < place(b); });
  Union sets(scene.vertices.size());
  for (size_t i = 1; i < order.size(); ++i) {
    if (place(order[i - 1]) == place(order[i])) sets.join(order[i - 1], order[i]);
  }
  std::vector<uint32_t> of_triangle;
  of_triangle.reserve(scene.triangles.size());
  for (const auto& triangle : scene.triangles) {
    sets.join(triangle[0], triangle[1]);
    sets.join(triangle[0], triangle[2]);
    of_triangle.push_back(triangle[0]);
  }
  return numbered(sets, of_triangle);
}

Subject find_subject(const Scene& scene, const Shells& connected) {
  Shells shells = connected;
  join_layers(scene, shells);
  part_from_ground(scene, shells);
  const std::vector<Piece> pieces = pieces_of(scene, shells);
  std::vector<uint32_t> order = by_size(pieces);
  const size_t around = count_surroundings(scene, shells, pieces, order);
  std::vector<bool> left_out(shells.count);
  for (size_t i = 0; i < around; ++i) left_out[order[i]] = true;
  order.erase(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(around));
  for (const uint32_t stray : strays(pieces, order)) left_out[stray] = true;

  std::vector<bool> triangles;
  triangles.reserve(scene.triangles.size());
  for (const uint32_t shell : shells.of_triangle) triangles.push_back(!left_out[shell]);
  Subject subject = subject_of(scene, std::move(triangles));
  subject.has_surroundings = around > 0;
  return subject;
}

}  // namespace raypool
