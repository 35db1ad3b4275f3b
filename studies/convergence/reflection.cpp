#include "convergence/reflection.hpp"

#include <cmath>

#include "convergence/microfacets.hpp"

namespace raypool::convergence {
namespace {

constexpr double kLeastCosine = 1e-4;    // of a viewer
constexpr double kLeastHighlight = 0.2;  // of the samples, where a surface has both parts

}  // namespace

double uniform(Random& random) { return static_cast<double>(random() >> 11) * 0x1p-53; }

Vec3d times(const Vec3d& a, const Vec3d& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }

double largest_channel(const Vec3d& color) { return std::max({color.x, color.y, color.z}); }

Frame::Frame(const Vec3d& axis) : normal(axis) {
  const Vec3d other = std::fabs(normal.x) < 0.5 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
  tangent = normalized(cross(other, normal));
  bitangent = cross(normal, tangent);
}

Reflection::Reflection(const Surface& surface, const Vec3d& viewer)
    : surface_(surface),
      frame_(surface.normal),
      viewer_(viewer),
      width_(highlight_width(surface.roughness)),
      cosine_(std::max(dot(surface.normal, viewer), kLeastCosine)) {
  const double rest = 1 - surface.metallic;
  straight_ = Vec3d{kDielectric, kDielectric, kDielectric} * rest + surface.color * surface.metallic;
  // Light that the highlight does not reflect goes into the surface, and comes out again in its colour.
  if (rest > 0) matt_ = surface.color * (rest * (1 - highlight_albedo(cosine_, surface.roughness)));
  highlight_ = 1;
  const double reflected = largest_channel(fresnel(straight_, cosine_));
  if (largest_channel(matt_) > 0)
    highlight_ = std::max(reflected / (reflected + largest_channel(matt_)), kLeastHighlight);
}

bool Reflection::is_lit_from(const Vec3d& direction) const {
  return dot(direction, surface_.normal) > 0 && dot(direction, surface_.face) > 0;
}

Vec3d Reflection::value(const Vec3d& direction) const {
  if (!is_lit_from(direction)) return {};
  const double light = dot(direction, surface_.normal);
  const Vec3d half = normalized(direction + viewer_);
  const Vec3d mirrored = fresnel(straight_, dot(half, viewer_)) *
                         (microfacets(dot(half, surface_.normal), width_) * microfacets_seen(light, width_) *
                          microfacets_seen(cosine_, width_) / (4 * cosine_));
  return matt_ * (light / kPi) + mirrored;
}

double Reflection::density(const Vec3d& direction) const {
  const double light = dot(direction, surface_.normal);
  const double matt = std::max(light, 0.0) / kPi;
  const Vec3d half = normalized(direction + viewer_);
  const double facet = dot(half, surface_.normal);
  const double mirrored = microfacets(facet, width_) * facet / (4 * dot(half, viewer_));
  return (1 - highlight_) * matt + highlight_ * mirrored;
}

Vec3d Reflection::sample(Random& random) const {
  const bool highlight = uniform(random) < highlight_;
  const double angle = 2 * kPi * uniform(random), height = uniform(random);
  if (!highlight) {
    const double radius = std::sqrt(height);
    return frame_.out_of(radius * std::cos(angle), radius * std::sin(angle), std::sqrt(1 - height));
  }
  const double square = width_ * width_;
  const double cosine = std::sqrt((1 - height) / (1 + (square - 1) * height));
  const double sine = std::sqrt(std::max(1 - cosine * cosine, 0.0));
  const Vec3d half = frame_.out_of(sine * std::cos(angle), sine * std::sin(angle), cosine);
  return half * (2 * dot(half, viewer_)) - viewer_;
}

}  // namespace raypool::convergence
