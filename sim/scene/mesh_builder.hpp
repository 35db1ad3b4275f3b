// Shapes for the built-in scenes. Everything is a function of its arguments; nothing is
// random but what a fixed seed gives.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace raypool {

inline constexpr double kPi = 3.14159265358979323846;

/// Rotation, scale and translation of points.
struct Transform {
  Vec3d x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};  ///< images of the axes
  Vec3d origin;

  Vec3d operator()(const Vec3d& p) const { return origin + x * p.x + y * p.y + z * p.z; }
  /// This after `inner`.
  Transform operator*(const Transform& inner) const;

  /// For normals of what this transforms: their direction counts, whatever their length becomes.
  Transform of_normals() const;

  static Transform move(const Vec3d& by);
  static Transform scale(double by);
  static Transform turn_x(double degrees);
  static Transform turn_y(double degrees);
  static Transform turn_z(double degrees);
};

/// Adds shapes to a scene. Closed shapes are wound with their normals outwards.
class MeshBuilder {
 public:
  /// `detail` scales the triangle counts of curved shapes.
  MeshBuilder(Scene& scene, double detail) : scene_(scene), detail_(detail) {}

  uint32_t add_material(const std::string& name, const Vec3& kd, const Vec3& ks);
  void use(uint32_t material) { material_ = material; }
  void place(const Transform& transform) { transform_ = transform; }
  const Transform& transform() const { return transform_; }

  /// `full` segments at detail 1, fewer or more at another.
  int segments(int full, int least = 3) const;
  /// `full` things at detail 1, fewer when there is less of it; never more.
  int count(int full, int least = 1) const;

  void triangle(const Vec3d& a, const Vec3d& b, const Vec3d& c);
  void quad(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d);
  void box(const Vec3d& lower, const Vec3d& upper);
  /// Inside out: the walls of a room.
  void room(const Vec3d& lower, const Vec3d& upper);

  /// point(s, t) for s and t in 0 .. 1, nu by nv quads. A wrapped direction shares its last points
  /// with its first. Seen from the side to which ds x dt points, triangles are counter-clockwise;
  /// those that collapse to a line are left out.
  void surface(int nu, int nv, bool wrap_u, bool wrap_v, const std::function<Vec3d(double, double)>& point);

  struct ProfilePoint {
    double radius, height;
  };
  /// Solid of revolution about y; the profile runs upwards along the outside. Straight between points.
  void lathe(const std::vector<ProfilePoint>& profile, int around);
  /// The same with a smooth curve through the points, `along` segments.
  void smooth_lathe(const std::vector<ProfilePoint>& profile, int around, int along);
  void sphere(const Vec3d& centre, double radius, int around);
  void cylinder(const Vec3d& from, const Vec3d& to, double radius, int around);
  /// Round tube along path(s), s in 0 .. 1; with rounded ends, or closed to a ring.
  void tube(const std::function<Vec3d(double)>& path, double radius, int along, int around, bool closed = false);
  /// Superellipsoid: exponent 1 is an ellipsoid, small ones approach a box. `bend` moves each point of it.
  void cushion(const Vec3d& centre, const Vec3d& half, double exponent, int around,
               const std::function<Vec3d(Vec3d)>& bend = nullptr);
  /// Flat plate with an outline of a superellipse (exponent as above) and a rounded edge; y is its thickness.
  void plate(const Vec3d& centre, const Vec3d& half, double exponent, int around, int rounding);

 private:
  uint32_t vertex(const Vec3d& p);
  void index(uint32_t a, uint32_t b, uint32_t c);

  Scene& scene_;
  double detail_;
  uint32_t material_ = 0;
  Transform transform_;
};

/// Small generator with a fixed sequence (splitmix64).
class Sequence {
 public:
  explicit Sequence(uint64_t seed) : state_(seed) {}
  /// In low .. high.
  double next(double low, double high);

 private:
  uint64_t state_;
};

}  // namespace raypool
