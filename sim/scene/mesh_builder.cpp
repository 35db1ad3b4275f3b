// Tessellation of the shapes that the built-in scenes are made of.
#include "scene/mesh_builder.hpp"

#include <algorithm>
#include <cmath>

#include "bits.hpp"

namespace raypool {
namespace {

double power(double base, double exponent) { return std::copysign(std::pow(std::fabs(base), exponent), base); }

/// Of an angle in degrees; exact for quarter turns, so that what stands against a wall does not stick through it.
double cosine(double degrees) {
  const double quarters = degrees / 90;
  if (quarters == std::floor(quarters))
    return std::fmod(std::fabs(quarters), 2) == 1 ? 0 : std::fmod(std::fabs(quarters), 4) == 0 ? 1 : -1;
  return std::cos(degrees * kPi / 180);
}

/// Catmull-Rom curve through the points, s in 0 .. 1.
MeshBuilder::ProfilePoint curve_at(const std::vector<MeshBuilder::ProfilePoint>& points, double s) {
  const int last = static_cast<int>(points.size()) - 1;
  const double place = s * last;
  const int i = std::min(static_cast<int>(place), last - 1);
  const double f = place - i;
  auto at = [&](int k) { return points[std::clamp(k, 0, last)]; };
  auto blend = [&](double a, double b, double c, double d) {
    return 0.5 * (2 * b + (c - a) * f + (2 * a - 5 * b + 4 * c - d) * f * f + (3 * b - a - 3 * c + d) * f * f * f);
  };
  const auto a = at(i - 1), b = at(i), c = at(i + 1), d = at(i + 2);
  return {std::max(0.0, blend(a.radius, b.radius, c.radius, d.radius)), blend(a.height, b.height, c.height, d.height)};
}

}  // namespace

Transform Transform::operator*(const Transform& inner) const {
  auto turn = [this](const Vec3d& v) { return x * v.x + y * v.y + z * v.z; };
  return {turn(inner.x), turn(inner.y), turn(inner.z), (*this)(inner.origin)};
}

Transform Transform::of_normals() const {
  const double sign = dot(cross(x, y), z) < 0 ? -1 : 1;
  return {cross(y, z) * sign, cross(z, x) * sign, cross(x, y) * sign, {}};
}

Transform Transform::move(const Vec3d& by) { return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, by}; }
Transform Transform::scale(double by) { return {{by, 0, 0}, {0, by, 0}, {0, 0, by}, {}}; }
Transform Transform::turn_x(double degrees) {
  const double c = cosine(degrees), s = cosine(degrees - 90);
  return {{1, 0, 0}, {0, c, s}, {0, -s, c}, {}};
}
Transform Transform::turn_y(double degrees) {
  const double c = cosine(degrees), s = cosine(degrees - 90);
  return {{c, 0, -s}, {0, 1, 0}, {s, 0, c}, {}};
}
Transform Transform::turn_z(double degrees) {
  const double c = cosine(degrees), s = cosine(degrees - 90);
  return {{c, s, 0}, {-s, c, 0}, {0, 0, 1}, {}};
}

uint32_t MeshBuilder::add_material(const std::string& name, const Vec3& kd, const Vec3& ks) {
  scene_.materials.push_back({name, kd, ks});
  return static_cast<uint32_t>(scene_.materials.size() - 1);
}

int MeshBuilder::segments(int full, int least) const {
  return std::max(least, static_cast<int>(std::lround(full * std::sqrt(detail_))));
}

int MeshBuilder::count(int full, int least) const {
  return std::clamp(static_cast<int>(std::lround(full * std::sqrt(detail_))), std::min(least, full), full);
}

uint32_t MeshBuilder::vertex(const Vec3d& p) {
  scene_.vertices.push_back(transform_(p).as<float>());
  return static_cast<uint32_t>(scene_.vertices.size() - 1);
}

void MeshBuilder::index(uint32_t a, uint32_t b, uint32_t c) {
  const auto& v = scene_.vertices;
  if (v[a] == v[b] || v[b] == v[c] || v[c] == v[a]) return;
  scene_.triangles.push_back({a, b, c});
  scene_.triangle_materials.push_back(material_);
}

void MeshBuilder::triangle(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const uint32_t i = vertex(a), j = vertex(b), k = vertex(c);
  index(i, j, k);
}

void MeshBuilder::quad(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  const uint32_t i = vertex(a), j = vertex(b), k = vertex(c), l = vertex(d);
  index(i, j, k);
  index(i, k, l);
}

void MeshBuilder::box(const Vec3d& l, const Vec3d& u) {
  uint32_t v[8];
  for (int i = 0; i < 8; ++i)
    v[i] = vertex({(i & 1) != 0 ? u.x : l.x, (i & 2) != 0 ? u.y : l.y, (i & 4) != 0 ? u.z : l.z});
  const int sides[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (const auto& s : sides) {
    index(v[s[0]], v[s[1]], v[s[2]]);
    index(v[s[0]], v[s[2]], v[s[3]]);
  }
}

void MeshBuilder::room(const Vec3d& lower, const Vec3d& upper) {
  const size_t first = scene_.triangles.size();
  box(lower, upper);
  for (size_t i = first; i < scene_.triangles.size(); ++i) std::swap(scene_.triangles[i][1], scene_.triangles[i][2]);
}

void MeshBuilder::surface(int nu, int nv, bool wrap_u, bool wrap_v, const std::function<Vec3d(double, double)>& point) {
  const int columns = wrap_u ? nu : nu + 1, rows = wrap_v ? nv : nv + 1;
  const auto first = size32(scene_.vertices);
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) vertex(point(static_cast<double>(i) / nu, static_cast<double>(j) / nv));
  }
  auto at = [&](int i, int j) { return first + static_cast<uint32_t>((j % rows) * columns + i % columns); };
  for (int j = 0; j < nv; ++j) {
    for (int i = 0; i < nu; ++i) {
      index(at(i, j), at(i + 1, j), at(i + 1, j + 1));
      index(at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  }
}

void MeshBuilder::lathe(const std::vector<ProfilePoint>& profile, int around) {
  const int steps = static_cast<int>(profile.size()) - 1;
  surface(around, steps, true, false, [&](double s, double t) {
    const ProfilePoint& p = profile[std::lround(t * steps)];
    const double angle = -2 * kPi * s;
    return Vec3d{p.radius * std::cos(angle), p.height, p.radius * std::sin(angle)};
  });
}

void MeshBuilder::smooth_lathe(const std::vector<ProfilePoint>& profile, int around, int along) {
  std::vector<ProfilePoint> points;
  for (int i = 0; i <= along; ++i) points.push_back(curve_at(profile, static_cast<double>(i) / along));
  points.front() = profile.front();
  points.back() = profile.back();
  lathe(points, around);
}

void MeshBuilder::sphere(const Vec3d& centre, double radius, int around) {
  cushion(centre, {radius, radius, radius}, 1, around);
}

void MeshBuilder::cylinder(const Vec3d& from, const Vec3d& to, double radius, int around) {
  const Vec3d axis = normalized(to - from);
  const Vec3d side = normalized(cross(axis, std::fabs(axis.y) < 0.9 ? Vec3d{0, 1, 0} : Vec3d{1, 0, 0}));
  const Vec3d other = cross(axis, side);
  surface(around, 3, true, false, [&](double s, double t) {
    const int ring = static_cast<int>(std::lround(t * 3));
    const double r = ring == 0 || ring == 3 ? 0 : radius;
    return (ring < 2 ? from : to) + side * (r * std::cos(2 * kPi * s)) + other * (r * std::sin(2 * kPi * s));
  });
}

void MeshBuilder::tube(const std::function<Vec3d(double)>& path, double radius, int along, int around, bool closed) {
  // A frame that is carried along the path without twisting.
  std::vector<Vec3d> centres, sides, others;
  Vec3d side{0, 0, 0};
  for (int i = 0; i <= along; ++i) {
    const double s = static_cast<double>(i) / along, h = 0.5 / along;
    const Vec3d before = path(closed || i > 0 ? s - h : s), after = path(closed || i < along ? s + h : s);
    const Vec3d axis = normalized(after - before);
    if (i == 0) side = std::fabs(axis.y) < 0.9 ? Vec3d{0, 1, 0} : Vec3d{1, 0, 0};
    side = normalized(side - axis * dot(side, axis));
    centres.push_back(path(s));
    sides.push_back(side);
    others.push_back(cross(axis, side));
  }
  // A closed path's frame may come back turned; that turn is spread along it.
  const double turn = closed ? std::atan2(dot(sides.back(), others[0]), dot(sides.back(), sides[0])) : 0;
  const int caps = closed ? 0 : 2, rows = along + 2 * caps;
  surface(around, rows, true, closed, [&](double s, double t) {
    const int row = static_cast<int>(std::lround(t * rows)) - caps;
    const size_t i = std::clamp(row, 0, along);
    const double beyond = row < 0 ? row : row > along ? row - along : 0;  // -2 .. 2 in the caps
    const double cap_angle = beyond / std::max(caps, 1) * 0.5 * kPi;
    const double angle = 2 * kPi * s - turn * static_cast<double>(i) / along;
    const double r = std::abs(beyond) == caps && caps > 0 ? 0 : radius * std::cos(cap_angle);
    const Vec3d axis = cross(sides[i], others[i]);
    return centres[i] + axis * (radius * std::sin(cap_angle)) + sides[i] * (r * std::cos(angle)) +
           others[i] * (r * std::sin(angle));
  });
}

void MeshBuilder::cushion(const Vec3d& centre, const Vec3d& half, double exponent, int around,
                          const std::function<Vec3d(Vec3d)>& bend) {
  const int down = std::max(3, around / 2);
  surface(around, down, true, false, [&](double s, double t) {
    // Points crowd towards the flat sides' edges where the exponent is small; that is where they are needed.
    const double a = -2 * kPi * s, b = kPi * (t - 0.5);
    const bool pole = t == 0 || t == 1;
    const double ring = pole ? 0 : power(std::cos(b), exponent);
    Vec3d p{half.x * ring * power(std::cos(a), exponent), half.y * power(std::sin(b), exponent),
            half.z * ring * power(std::sin(a), exponent)};
    if (bend) p = bend(p);
    return centre + p;
  });
}

void MeshBuilder::plate(const Vec3d& centre, const Vec3d& half, double exponent, int around, int rounding) {
  const int rows = rounding + 2;
  surface(around, rows, true, false, [&](double s, double t) {
    const int row = static_cast<int>(std::lround(t * rows));
    const double a = -2 * kPi * s;
    const double b = kPi * (static_cast<double>(std::clamp(row - 1, 0, rounding)) / rounding - 0.5);
    const double inset = half.y * (1 - std::cos(b));
    const double rx = row == 0 || row == rows ? 0 : half.x - inset, rz = row == 0 || row == rows ? 0 : half.z - inset;
    return centre + Vec3d{rx * power(std::cos(a), exponent), half.y * std::sin(b), rz * power(std::sin(a), exponent)};
  });
}

double Sequence::next(double low, double high) {
  state_ += 0x9e3779b97f4a7c15u;
  uint64_t z = state_;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  z ^= z >> 31;
  return low + (high - low) * static_cast<double>(z >> 11) * 0x1p-53;
}

}  // namespace raypool
