#include "referee/certificate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "referee/sectors.hpp"

namespace raypool::referee {
namespace {

/// A number of which double has some bits, and how far off it may be at most. Floats are multiples of 2^-149 below
/// 2^128, so no product of four of their differences overflows or becomes subnormal: every operation of double is off
/// by less than 2^-53 of its result. Each bound is 2^-52 of it, and 2^-48 of itself more than it must be, for what is
/// rounded in computing the bound.
struct Bounded {
  double value = 0, error = 0;

  static Bounded of(double value, double error) {
    return {value, (error + std::fabs(value) * 0x1p-52) * (1 + 0x1p-48)};
  }
  friend Bounded operator-(const Bounded& a, const Bounded& b) { return of(a.value - b.value, a.error + b.error); }
  friend Bounded operator*(const Bounded& a, const Bounded& b) {
    return of(a.value * b.value, std::fabs(a.value) * b.error + std::fabs(b.value) * a.error + a.error * b.error);
  }
  /// -1 or 1; 0: not known.
  int sign() const { return value > error ? 1 : value < -error ? -1 : 0; }
};

/// A float as a whole number of 2^-149.
struct Whole {
  static Exact of(float x) { return {std::ldexp(static_cast<double>(x), 149)}; }
};
struct Double {
  static Bounded of(float x) { return {static_cast<double>(x), 0}; }
};

/// The corners of a triangle where the ray is a point: seen along it, its origin at (0, 0), and all lengths times the
/// direction's largest component. Number is Exact, or Bounded.
template <typename Number, typename From>
struct Seen {
  std::array<Number, 3> x, y;

  Seen(const RayQuery& ray, const std::array<Vec3, 3>& corners) {
    int z_axis = 0;
    for (const int axis : {1, 2}) {
      if (std::fabs(ray.direction[axis]) > std::fabs(ray.direction[z_axis])) z_axis = axis;
    }
    const int x_axis = (z_axis + 1) % 3, y_axis = (z_axis + 2) % 3;
    const Number dx = From::of(ray.direction[x_axis]), dy = From::of(ray.direction[y_axis]),
                 dz = From::of(ray.direction[z_axis]);
    for (size_t corner = 0; corner < 3; ++corner) {
      const auto from_origin = [&](int axis) { return From::of(corners[corner][axis]) - From::of(ray.origin[axis]); };
      const Number z = from_origin(z_axis);
      x[corner] = dz * from_origin(x_axis) - dx * z;
      y[corner] = dz * from_origin(y_axis) - dy * z;
    }
  }
  /// On which side of the edge opposite to a corner the ray passes.
  Number side(int corner) const {
    const int a = (corner + 1) % 3, b = (corner + 2) % 3;
    return x[a] * y[b] - y[a] * x[b];
  }
  Point corner(int i) const { return {x[i], y[i]}; }
};
using ExactlySeen = Seen<Exact, Whole>;

/// Of sides of different signs the ray passes outside.
bool passes_outside(const int (&signs)[3]) {
  const bool above = signs[0] > 0 || signs[1] > 0 || signs[2] > 0;
  return above && (signs[0] < 0 || signs[1] < 0 || signs[2] < 0);
}

/// t of the triangle's plane; none where it is parallel to the ray.
std::optional<Exact> plane_time(const RayQuery& ray, const std::array<Vec3, 3>& corners) {
  Exact sides[2][3], over, under;
  for (int axis = 0; axis < 3; ++axis) {
    for (size_t i = 0; i < 2; ++i) sides[i][axis] = Whole::of(corners[i + 1][axis]) - Whole::of(corners[0][axis]);
  }
  for (int axis = 0; axis < 3; ++axis) {
    const int i = (axis + 1) % 3, j = (axis + 2) % 3;
    const Exact normal = sides[0][i] * sides[1][j] - sides[0][j] * sides[1][i];
    over = over + normal * (Whole::of(corners[0][axis]) - Whole::of(ray.origin[axis]));
    under = under + normal * Whole::of(ray.direction[axis]);
  }
  if (under.sign() == 0) return std::nullopt;
  return over / under;
}

/// A meeting, with the directions in which the triangle lies around the ray.
struct Found {
  Meeting meeting;
  std::optional<ExactlySeen> seen;  // on its border
};

bool between_limits(const Exact& t, float limit) { return t.sign() > 0 && (std::isinf(limit) || t < Exact(limit)); }

std::optional<Found> meet(const RayQuery& ray, const std::array<Vec3, 3>& corners, uint32_t number) {
  const Seen<Bounded, Double> nearly(ray, corners);
  int signs[3] = {nearly.side(0).sign(), nearly.side(1).sign(), nearly.side(2).sign()};
  if (passes_outside(signs)) return std::nullopt;
  Found found;
  int zeros = 0;
  if (signs[0] == 0 || signs[1] == 0 || signs[2] == 0) {
    found.seen.emplace(ray, corners);
    for (int i = 0; i < 3; ++i) zeros += (signs[i] = found.seen->side(i).sign()) == 0 ? 1 : 0;
    if (zeros == 3 || passes_outside(signs)) return std::nullopt;
  }
  const std::optional<Exact> t = plane_time(ray, corners);
  if (!t) return std::nullopt;
  const float nearest = t->nearest_float();
  const bool exactly = between_limits(*t, ray.limit), rounded = nearest > 0 && nearest < ray.limit;
  if (!exactly && !rounded) return std::nullopt;
  found.meeting = {number, static_cast<Passing>(zeros), *t, nearest, exactly && rounded};
  return found;
}

/// The directions around the ray in which a triangle lies that it meets on its border.
void add_sector(const ExactlySeen& seen, Passing passing, Sectors& sectors) {
  for (int i = 0; i < 3; ++i) {
    const Point a = seen.corner((i + 1) % 3), b = seen.corner((i + 2) % 3), opposite = seen.corner(i);
    const bool here = opposite.x.sign() == 0 && opposite.y.sign() == 0;
    if (passing == Passing::Corner ? !here : cross(a, b).sign() != 0) continue;
    // The corner is here, and the triangle between the two others; or it lies on one side of the edge between them.
    const bool left = passing == Passing::Corner ? cross(a, b).sign() > 0 : cross(a, opposite).sign() > 0;
    left ? sectors.add(a, b) : sectors.add(b, a);
    return;
  }
}

bool is_ray(const RayQuery& ray) {
  bool moves = false;
  for (int axis = 0; axis < 3; ++axis) {
    if (!std::isfinite(ray.origin[axis]) || !std::isfinite(ray.direction[axis])) return false;
    moves |= ray.direction[axis] != 0;
  }
  return moves && ray.limit > 0;
}

std::vector<Found> find_meetings(const HitCase& hit_case) {
  std::vector<Found> found;
  if (!is_ray(hit_case.ray)) return found;
  for (uint32_t i = 0; i < hit_case.triangles.size(); ++i) {
    if (auto each = meet(hit_case.ray, hit_case.triangles[i], i)) found.push_back(std::move(*each));
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Found& a, const Found& b) { return a.meeting.t < b.meeting.t; });
  return found;
}

}  // namespace

const char* name_of(Passing passing) {
  constexpr const char* kNames[] = {"inside", "edge", "corner"};
  return kNames[static_cast<int>(passing)];
}

bool Certificate::allows(uint32_t triangle) const {
  return std::binary_search(allowed.begin(), allowed.end(), triangle);
}

const Meeting* Certificate::meeting(uint32_t triangle) const {
  const auto found = std::find_if(meetings.begin(), meetings.end(),
                                  [&](const Meeting& meeting) { return meeting.triangle == triangle; });
  return found == meetings.end() ? nullptr : &*found;
}

Certificate certify(const HitCase& hit_case) {
  Certificate result;
  const std::vector<Found> found = find_meetings(hit_case);
  Sectors sectors;
  float hidden = 0;
  for (size_t first = 0, end = 0; first < found.size(); first = end) {
    for (end = first; end < found.size() && found[end].meeting.t == found[first].meeting.t; ++end) {
      const Meeting& meeting = found[end].meeting;
      if (result.miss || meeting.nearest == hidden) result.allowed.push_back(meeting.triangle);
      if (!result.miss || !meeting.certain) continue;
      meeting.passing == Passing::Inside ? sectors.add_all() : add_sector(*found[end].seen, meeting.passing, sectors);
    }
    if (!result.miss || !sectors.cover_all()) continue;
    result.miss = false;
    result.hidden_from = found[first].meeting.t;
    hidden = found[first].meeting.nearest;
  }
  for (const Found& each : found) result.meetings.push_back(each.meeting);
  std::sort(result.allowed.begin(), result.allowed.end());
  return result;
}

}  // namespace raypool::referee
