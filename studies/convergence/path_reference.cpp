#include "convergence/path_reference.hpp"

#include <cmath>

#include "convergence/microfacets.hpp"

namespace raypool::convergence {
namespace {

/// Of light between two media, for both polarisations alike; 1: all of it. `ratio` is the index before over that
/// behind.
double mirrored_by_glass(double cosine, double ratio) {
  const double square = 1 - ratio * ratio * (1 - cosine * cosine);
  if (square <= 0) return 1;
  const double behind = std::sqrt(square);
  const double s = (ratio * cosine - behind) / (ratio * cosine + behind);
  const double p = (cosine - ratio * behind) / (cosine + ratio * behind);
  return (s * s + p * p) / 2;
}

/// The balance heuristic.
double share(double density, double other) { return density / (density + other); }

/// The part of a surface that is neither missing nor glass.
double reflecting_part(const Meeting& meeting) { return meeting.coverage * (1 - meeting.transmission); }

}  // namespace

/// What is known of a path on its way from the eye.
struct PathReference::Path {
  PathRay ray;
  Vec3d weight{1, 1, 1};
  double density = 0;  ///< of the direction, per solid angle; 0: no other way finds light in it
};

PathReference::PathReference(const Scene& scene, uint32_t width, uint32_t height, uint32_t depth)
    : scene_(scene),
      eye_(scene.camera.eye.as<double>()),
      forward_(normalized(scene.camera.direction.as<double>())),
      width_(width),
      height_(height),
      depth_(depth) {
  const double half = std::tan(static_cast<double>(scene.camera.fov) * kPi / 360);
  right_ = normalized(cross(forward_, scene.camera.up.as<double>())) * half;
  up_ = normalized(cross(right_, forward_)) * half;
}

PathRay PathReference::eye_ray(double x, double y) const {
  const double across = (2 * x - width_) / height_, above = 1 - 2 * y / height_;
  return {eye_, normalized(forward_ + right_ * across + up_ * above)};
}

Vec3d PathReference::sample(uint32_t x, uint32_t y, Random& random) const {
  Path path;
  const double across = uniform(random), down = uniform(random);
  path.ray = eye_ray(x + across, y + down);
  Vec3d sum;
  for (uint32_t depth = 1; depth <= depth_ && largest_channel(path.weight) > 0; ++depth) {
    const std::optional<Meeting> meeting = scene_.meet(path.ray);
    if (!meeting) break;
    if (largest_channel(meeting->emission) > 0) {
      const double cosine = -dot(meeting->face, path.ray.direction);
      const double other = scene_.density(meeting->triangle, meeting->distance, cosine);
      const double counts = path.density > 0 ? share(path.density, other) : 1;
      sum = sum + times(path.weight, meeting->emission) * counts;
    }
    const Reflection reflection(meeting->reflecting, path.ray.direction * -1.0);
    const uint32_t left = depth_ - depth;
    if (reflecting_part(*meeting) > 0)
      sum = sum + times(path.weight, light_on(*meeting, reflection, left, random)) * reflecting_part(*meeting);
    if (left > 0) go_on(path, *meeting, reflection, random);
  }
  return sum;
}

/// What lights add directly, to the viewer: points through so many holes at most.
Vec3d PathReference::light_on(const Meeting& meeting, const Reflection& reflection, uint32_t left,
                              Random& random) const {
  Vec3d sum;
  for (size_t i = 0; i < scene_.beams(); ++i) {
    const ReferenceScene::Beam beam = scene_.beam(i, meeting.place);
    const Vec3d value = times(reflection.value(normalized(beam.to_light)), beam.irradiance);
    if (largest_channel(value) > 0) {
      sum = sum + value * scene_.share_through_holes(meeting.place, meeting.face, meeting.place + beam.to_light, left);
    }
  }
  return scene_.has_shining_triangles() ? sum + shining_on(meeting, reflection, left == 0, random) : sum;
}

Vec3d PathReference::shining_on(const Meeting& meeting, const Reflection& reflection, bool last, Random& random) const {
  const LitPoint point = scene_.shining_point(random);
  const Vec3d to_point = point.place - meeting.place;
  const double distance = length(to_point);
  if (!(distance > 0)) return {};
  const Vec3d direction = to_point * (1 / distance);
  const double cosine = std::fabs(dot(scene_.face_of(point.triangle), direction));
  const double density = scene_.density(point.triangle, distance, cosine);
  const Vec3d value = times(reflection.value(direction), point.emission);
  if (!(density > 0) || !(largest_channel(value) > 0) || !scene_.sees(meeting.place, meeting.face, point.place))
    return {};
  // Behind the last surface there is no other way to find it.
  const double counts = last ? 1 : share(density, reflecting_part(meeting) * reflection.density(direction));
  return value * (counts / density);
}

void PathReference::go_on(Path& path, const Meeting& meeting, const Reflection& reflection, Random& random) const {
  const double part = uniform(random);
  if (part >= meeting.coverage) {
    path.density = 0;
    path.ray = scene_.leaving(meeting.place, meeting.face * -1.0, path.ray.direction);
  } else if (part < meeting.coverage * meeting.transmission) {
    pass_glass(path, meeting, random);
  } else {
    const Vec3d direction = reflection.sample(random);
    const Vec3d value = reflection.value(direction);
    if (largest_channel(value) > 0) {
      const double density = reflection.density(direction);
      path.weight = times(path.weight, value) * (1 / density);
      path.density = reflecting_part(meeting) * density;
      path.ray = scene_.leaving(meeting.place, meeting.face, direction);
    } else {
      path.weight = {};
    }
  }
}

void PathReference::pass_glass(Path& path, const Meeting& meeting, Random& random) const {
  path.density = 0;
  const Vec3d& before = path.ray.direction;
  const double cosine = -dot(before, meeting.normal);
  const double ratio = meeting.inside ? meeting.ior : 1 / meeting.ior;
  if (uniform(random) < mirrored_by_glass(cosine, ratio)) {
    path.ray = scene_.leaving(meeting.place, meeting.face, before + meeting.normal * (2 * cosine));
    return;
  }
  const double behind = std::sqrt(1 - ratio * ratio * (1 - cosine * cosine));
  const Vec3d direction = normalized(before * ratio + meeting.normal * (ratio * cosine - behind));
  path.weight = times(path.weight, meeting.reflecting.color);
  path.ray = scene_.leaving(meeting.place, meeting.face * -1.0, direction);
}

}  // namespace raypool::convergence
