#include "numerics/reference.hpp"

#include <algorithm>
#include <cmath>

#include "bits.hpp"

namespace raypool::numerics {
namespace {

/// Of the largest coordinate or diagonal; a hit point in double precision is off by some 1e-15
/// of it, along a grazing ray by more.
constexpr double kReferenceOffset = 1e-13;
double as_double(uint32_t bits) { return static_cast<double>(as_float(bits)); }

}  // namespace

ReferenceTracer::ReferenceTracer(const Scene& scene) : scene_(scene), bvh_(build_bvh(scene)), traversal_(bvh_) {}

Vec3d ReferenceTracer::normal(uint32_t triangle) const {
  const Vec3d a = scene_.corner(triangle, 0).as<double>();
  return normalized(cross(scene_.corner(triangle, 1).as<double>() - a, scene_.corner(triangle, 2).as<double>() - a));
}

ReferenceCamera::ReferenceCamera(const std::array<uint32_t, kArguments>& arguments) {
  auto get = [&](int first) {
    return Vec3d{as_double(arguments[first]), as_double(arguments[first + 1]), as_double(arguments[first + 2])};
  };
  eye = get(argument::kEye);
  corner = get(argument::kCorner);
  step_x = get(argument::kStepX);
  step_y = get(argument::kStepY);
  light = get(argument::kLight);
  light_color = get(argument::kLightColor);
}

ReferenceShadowRay shadow_ray(const ReferenceTracer& tracer, const Vec3d& origin, const Vec3d& direction,
                              const DoubleHit& hit, const Vec3d& light) {
  Vec3d normal = tracer.normal(hit.triangle);
  if (dot(normal, direction) > 0) normal = normal * -1.0;
  const Vec3d point = origin + direction * hit.t;
  double scale = 0;
  for (int axis = 0; axis < 3; ++axis) scale = std::max({scale, std::fabs(point[axis]), std::fabs(origin[axis])});
  ReferenceShadowRay ray;
  ray.origin = point + normal * (kReferenceOffset * scale);
  ray.direction = light - ray.origin;
  const double distance = length(ray.direction);
  // From a corner, the distance to the plane has no error of the point: a light in the plane is exactly behind it.
  ray.cosine = distance > 0 ? dot(normal, light - tracer.scene().corner(hit.triangle, 0).as<double>()) / distance : 0;
  return ray;
}

bool same_surface(const ReferenceTracer& tracer, uint32_t a, uint32_t b) {
  if (a == b) return true;
  const Vec3d normal = tracer.normal(a);
  if (std::fabs(dot(normal, tracer.normal(b))) < 1 - 1e-9) return false;
  // Vertices are floats: they lie within their roundings of a common plane.
  const Vec3d from = tracer.scene().corner(a, 0).as<double>();
  for (int k = 0; k < 3; ++k) {
    const Vec3d corner = tracer.scene().corner(b, k).as<double>();
    if (std::fabs(dot(normal, corner - from)) > 1e-6 * std::max(length(corner), length(from))) return false;
  }
  return true;
}

PathImage render_reference(const ReferenceTracer& tracer, const std::array<uint32_t, kArguments>& arguments, int width,
                           int height, int depth, const std::function<void(double)>& progress) {
  const ReferenceCamera camera(arguments);
  const Scene& scene = tracer.scene();
  PathImage image(width, height, depth);
  auto scaled = [](const Vec3d& a, const Vec3d& b) { return Vec3d{a.x * b.x, a.y * b.y, a.z * b.z}; };
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const size_t pixel = static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
      Vec3d origin = camera.eye, direction = camera.direction(x, y), throughput{1, 1, 1};
      for (int reflections = 0; reflections < depth; ++reflections) {
        if (!(throughput.x > 0 || throughput.y > 0 || throughput.z > 0)) break;
        PathStep& step = image.step(pixel, reflections);
        step.followed = true;
        const DoubleHit hit = tracer.nearest(origin, direction, INFINITY);
        step.triangle = hit.triangle;
        if (hit.triangle == kNoTriangle) break;
        const Material& material = scene.materials[scene.triangle_materials[hit.triangle]];
        const ReferenceShadowRay shadow = shadow_ray(tracer, origin, direction, hit, camera.light);
        step.facing = shadow.cosine > 0;
        step.lit = step.facing && tracer.occluder(shadow.origin, shadow.direction, 1) == kNoTriangle;
        if (step.lit) {
          image.color[pixel] = image.color[pixel] +
                               scaled(scaled(throughput, material.kd.as<double>()), camera.light_color) * shadow.cosine;
        }
        const Vec3d normal = tracer.normal(hit.triangle);
        origin = shadow.origin;
        direction = direction - normal * (2 * dot(normal, direction));
        throughput = scaled(throughput, material.ks.as<double>());
      }
    }
    if (progress) progress(static_cast<double>(y + 1) / height);
  }
  return image;
}

}  // namespace raypool::numerics
