#include "scene/enclosure.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace raypool {
namespace {

constexpr double kLeastEnclosed = 0.7;  // of the directions from a place among the triangles
constexpr double kRoomy = 0.2;          // of the box's least length: half of what a place sees is further away
constexpr double kLeastContent = 0.08;  // of what places see: pieces that are hidden from outside
constexpr double kMostlyFront = 0.6;    // of what a place in a furnished room sees
constexpr double kLeastFront = 0.9;     // of what a place in an empty room sees
constexpr double kMostWalls = 0.75;     // of what a place in an empty room sees
constexpr double kLow = 0.3;            // of the height
constexpr double kWhole = 0.8;          // of the scene's lengths
constexpr double kOpen = 0.3;           // of a surface's directions: it is seen from outside
constexpr double kOnSide = 0.03;        // of the box

/// Whether any of it is seen from outside; asked of a piece only once.
class Hidden {
 public:
  Hidden(const SceneProbe& probe, const Shells& shells) : probe_(probe), shells_(shells), known_(shells.count) {}

  bool operator()(const Sample& sample) {
    const uint32_t shell = shells_.of_triangle[sample.triangle];
    if (exposed(sample.point, sample.normal)) known_[shell] = Seen;
    if (known_[shell] == Unknown) known_[shell] = search(shell) ? Seen : Unseen;
    return known_[shell] == Unseen;
  }

 private:
  enum Known : uint8_t { Unknown, Seen, Unseen };

  bool exposed(const Vec3d& point, const Vec3d& normal) const {
    return probe_.open_share(point, normal) > kOpen || probe_.open_share(point, normal * -1.0) > kOpen;
  }

  bool search(uint32_t shell) {
    if (triangles_.empty()) {
      triangles_.resize(shells_.count);
      for (size_t i = 0; i < shells_.of_triangle.size(); ++i) {
        if (!is_degenerate(probe_.scene(), i)) triangles_[shells_.of_triangle[i]].push_back(static_cast<uint32_t>(i));
      }
    }
    const std::vector<uint32_t>& of_shell = triangles_[shell];
    const size_t tried = std::min<size_t>(of_shell.size(), 12);
    size_t open = 0;
    for (size_t i = 0; i < tried; ++i) {
      const uint32_t triangle = of_shell[i * of_shell.size() / tried];
      const Scene& scene = probe_.scene();
      const Vec3d centre = (scene.corner(triangle, 0).as<double>() + scene.corner(triangle, 1).as<double>() +
                            scene.corner(triangle, 2).as<double>()) *
                           (1.0 / 3);
      open += exposed(centre, scene.normal(triangle).as<double>());
    }
    // What stands in a box has its underside in the box's own.
    return 4 * open > tried;
  }

  const SceneProbe& probe_;
  const Shells& shells_;
  std::vector<Known> known_;
  std::vector<std::vector<uint32_t>> triangles_;
};

/// Triangles cover at least five sides of the box by more than half.
bool is_box(const Scene& scene, const Box& box) {
  std::array<double, 6> covered{};
  const Vec3d extent = box.extent();
  for (size_t i = 0; i < scene.triangles.size(); ++i) {
    const Vec3d p = scene.corner(i, 0).as<double>() - box.lower, q = scene.corner(i, 1).as<double>() - box.lower,
                r = scene.corner(i, 2).as<double>() - box.lower;
    const Vec3d area = cross(q - p, r - p) * 0.5;
    for (int axis = 0; axis < 3; ++axis) {
      const double low = std::min({p[axis], q[axis], r[axis]}), high = std::max({p[axis], q[axis], r[axis]});
      const size_t side = 2 * axis;
      if (high <= kOnSide * extent[axis]) covered[side] += std::fabs(area[axis]);
      if (low >= (1 - kOnSide) * extent[axis]) covered[side + 1] += std::fabs(area[axis]);
    }
  }
  int walls = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double side = extent[(axis + 1) % 3] * extent[(axis + 2) % 3];
    for (const size_t end : {0u, 1u}) walls += covered[static_cast<size_t>(2 * axis) + end] > 0.5 * side;
  }
  return walls >= 5;
}

struct Place {
  Vec3d eye;
  std::vector<Sample> samples;
  double fronts = 0;  // share
};

/// Where something is in nearly all directions, and half of it not near.
std::vector<Place> enclosed_places(const SceneProbe& probe, const RoomBox& room) {
  const std::vector<Vec3d>& around = all_around();
  const double least = room.box().nth_extent(2);
  std::vector<Place> places;
  for (const double height : {0.55, 0.4}) {
    for (const double along : {0.08, 0.92, 0.28, 0.72, 0.5}) {
      for (const double across : {0.3, 0.7, 0.5, 0.12, 0.88}) {
        Place place{room.place(along, height, across), {}};
        std::vector<double> distances;
        for (const Vec3d& towards : around) {
          const auto sample = probe.hit(place.eye, towards);
          if (!sample) continue;
          place.samples.push_back(*sample);
          distances.push_back(sample->distance);
          place.fronts += sample->front;
        }
        const size_t seen = distances.size();
        if (static_cast<double>(seen) < kLeastEnclosed * static_cast<double>(around.size())) continue;
        std::sort(distances.begin(), distances.end());
        if (distances[0] <= 0.005 * probe.diagonal() || distances[seen / 2] < kRoomy * least) continue;
        place.fronts /= static_cast<double>(seen);
        places.push_back(std::move(place));
      }
    }
  }
  return places;
}

template <typename Fits>
void keep(std::vector<Place>& places, const Fits& fits) {
  places.erase(std::remove_if(places.begin(), places.end(), [&](const Place& place) { return !fits(place); }),
               places.end());
}

double share(size_t part, size_t of) { return of == 0 ? 0 : static_cast<double>(part) / static_cast<double>(of); }

/// What the place sees are the walls of a box about as large as the scene.
bool sees_box(const Place& place, const Box& room, double least) {
  Box seen;
  for (const Sample& sample : place.samples) seen.add(sample.point);
  for (int axis = 0; axis < 3; ++axis) {
    if (seen.extent()[axis] < kWhole * room.extent()[axis]) return false;
  }
  size_t on_sides = 0;
  for (const Sample& sample : place.samples) {
    bool on_side = false;
    for (int axis = 0; axis < 3; ++axis) {
      const double from_lower = (sample.point[axis] - seen.lower[axis]) / seen.extent()[axis];
      on_side |= from_lower < kOnSide || from_lower > 1 - kOnSide;
    }
    on_sides += on_side;
  }
  return share(on_sides, place.samples.size()) > least;
}

/// Leaves the places that see the fronts of pieces which are hidden from outside; none unless these are much of what is
/// seen there, and some stand low.
void keep_furnished(std::vector<Place>& places, const SceneProbe& probe, const Shells& shells, const RoomBox& room) {
  Hidden hidden(probe, shells);
  size_t seen = 0, content = 0;
  bool stands = false;
  keep(places, [&](const Place& place) {
    size_t here = 0;
    for (const Sample& sample : place.samples) {
      if (!sample.front || !hidden(sample)) continue;
      ++here;
      stands |= room.height_of(sample.point) < kLow;
    }
    if (here == 0) return false;
    seen += place.samples.size();
    content += here;
    return true;
  });
  if (share(content, seen) <= kLeastContent || !stands) places.clear();
}

}  // namespace

RoomBox::RoomBox(const Bounds& bounds, const Vec3d& up) {
  box_.add(bounds.lower.as<double>());
  box_.add(bounds.upper.as<double>());
  for (const int axis : {0, 1, 2}) {
    if (std::fabs(up[axis]) > std::fabs(up[vertical_])) vertical_ = axis;
  }
  upwards_ = up[vertical_] > 0;
  const int a = (vertical_ + 1) % 3, b = (vertical_ + 2) % 3;
  const bool first = box_.extent()[a] >= box_.extent()[b];
  along_ = first ? a : b;
  across_ = first ? b : a;
}

Vec3d RoomBox::place(double along, double height, double across) const {
  Vec3d share;
  share[vertical_] = upwards_ ? height : 1 - height;
  share[along_] = along;
  share[across_] = across;
  const Vec3d extent = box_.extent();
  return box_.lower + Vec3d{share.x * extent.x, share.y * extent.y, share.z * extent.z};
}

double RoomBox::height_of(const Vec3d& point) const {
  const double extent = box_.extent()[vertical_];
  const double share = extent > 0 ? (point[vertical_] - box_.lower[vertical_]) / extent : 0;
  return upwards_ ? share : 1 - share;
}

std::vector<Vec3d> places_inside(const SceneProbe& probe, const Shells& shells, const RoomBox& room,
                                 double outer_fronts) {
  std::vector<Place> places = enclosed_places(probe, room);
  // From outside an object is seen, unless it is a box with something in it.
  const bool is_object = outer_fronts >= 0.5;
  if (places.empty() || (is_object && !is_box(probe.scene(), room.box()))) return {};
  std::vector<Place> furnished = places;
  if (!is_object) keep(furnished, [](const Place& place) { return place.fronts >= kMostlyFront; });
  keep_furnished(furnished, probe, shells, room);
  if (furnished.empty()) {
    // Nothing is in it: walls, which outside show their backs or are a second time.
    keep(places, [&](const Place& place) {
      return place.fronts > kLeastFront && (is_object || outer_fronts < 1 - kLeastFront) &&
             sees_box(place, room.box(), is_object ? kLeastFront : kMostWalls);
    });
    furnished = std::move(places);
  }
  std::vector<Vec3d> eyes;
  for (const Place& place : furnished) eyes.push_back(place.eye);
  return eyes;
}

}  // namespace raypool
