#include "convergence/reference_scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace raypool::convergence {
namespace {

/// Rays leave a surface by this share of its largest coordinate: some roundings of Embree, which is in single
/// precision.
constexpr double kOffset = 2e-6;
/// A ray to a light ends before it by this share.
constexpr double kBeforeLight = 1e-4;

using Place = std::array<double, 2>;

template <typename T>
T between(double u, double v, const T& a, const T& b, const T& c) {
  T mixed{};
  for (size_t i = 0; i < mixed.size(); ++i)
    mixed[i] = static_cast<typename T::value_type>((1 - u - v) * a[i] + u * b[i] + v * c[i]);
  return mixed;
}

/// Number of a texel, of one beyond the edge too.
int64_t wrapped(int64_t texel, int64_t size, shader::Wrap wrap) {
  const auto modulo = [&](int64_t of) { return (texel % of + of) % of; };
  switch (wrap) {
    case shader::Wrap::Clamp:
      return std::clamp<int64_t>(texel, 0, size - 1);
    case shader::Wrap::Mirror:
      return std::min(modulo(2 * size), 2 * size - 1 - modulo(2 * size));
    default:
      return modulo(size);
  }
}

/// As glTF says of samplers, with filter linear or nearest.
class Sampler {
 public:
  Sampler(const SurfaceTexture& texture, const SurfaceImage& image) : texture_(texture), image_(image) {}

  std::array<double, 4> at(const Place& place) const {
    const double x = place[0] * image_.width, y = place[1] * image_.height;
    if (texture_.nearest) return texel(std::floor(x), std::floor(y));
    const double column = std::floor(x - 0.5), row = std::floor(y - 0.5);
    const double right = x - 0.5 - column, below = y - 0.5 - row;
    const auto a = texel(column, row), b = texel(column + 1, row);
    const auto c = texel(column, row + 1), d = texel(column + 1, row + 1);
    std::array<double, 4> color{};
    for (size_t i = 0; i < color.size(); ++i)
      color[i] = (1 - below) * ((1 - right) * a[i] + right * b[i]) + below * ((1 - right) * c[i] + right * d[i]);
    return color;
  }

 private:
  std::array<double, 4> texel(double column, double row) const {
    const auto x = static_cast<size_t>(wrapped(static_cast<int64_t>(column), image_.width, texture_.wrap_s));
    const auto y = static_cast<size_t>(wrapped(static_cast<int64_t>(row), image_.height, texture_.wrap_t));
    std::array<double, 4> color{};
    for (size_t i = 0; i < color.size(); ++i) color[i] = image_.texels[4 * (y * image_.width + x) + i] / 65535.0;
    return color;
  }

  const SurfaceTexture& texture_;
  const SurfaceImage& image_;
};

}  // namespace

ReferenceScene::ReferenceScene(const Scene& scene)
    : scene_(scene),
      surfaces_(*scene.surfaces),
      embree_(scene),
      far_(10 * static_cast<double>(scene.bounds().diagonal())),
      weights_(scene.triangles.size()) {
  double sum = 0;
  for (uint32_t i = 0; i < scene.triangles.size(); ++i) {
    const SurfaceMaterial& material = surfaces_.materials[scene.triangle_materials[i]];
    // Those with a texture of their emission are found by chance alone.
    if (!material.emits() || material.emission_texture) continue;
    weights_[i] = area(i) * largest_channel(material.emission.as<double>());
    if (weights_[i] == 0) continue;
    sum += weights_[i];
    shining_.push_back(i);
    sums_.push_back(sum);
  }
  lamp_ = shining_.empty() && surfaces_.lights.empty();
}

Vec3d ReferenceScene::corner(uint32_t triangle, int k) const { return scene_.corner(triangle, k).as<double>(); }

Vec3d ReferenceScene::face_of(uint32_t triangle) const {
  const Vec3d a = corner(triangle, 0);
  return normalized(cross(corner(triangle, 1) - a, corner(triangle, 2) - a));
}

double ReferenceScene::area(uint32_t triangle) const {
  const Vec3d a = corner(triangle, 0);
  return 0.5 * length(cross(corner(triangle, 1) - a, corner(triangle, 2) - a));
}

std::optional<Meeting> ReferenceScene::meet(const PathRay& ray) const {
  RayQuery query;
  query.origin = ray.origin.as<float>();
  query.direction = ray.direction.as<float>();
  query.limit = INFINITY;
  Hit hit;
  if (!embree_.nearest(query, hit)) return std::nullopt;
  Meeting meeting;
  meeting.triangle = hit.triangle;
  const Vec3d a = corner(hit.triangle, 0);
  const Vec3d first = corner(hit.triangle, 1) - a, second = corner(hit.triangle, 2) - a;
  // Where the ray meets the plane; a point of an edge may be a rounding outside.
  const Vec3d across = cross(ray.direction, second), from_corner = ray.origin - a;
  const double determinant = dot(first, across);
  if (determinant == 0) return std::nullopt;
  const double u = dot(from_corner, across) / determinant;
  const double v = dot(ray.direction, cross(from_corner, first)) / determinant;
  meeting.distance = dot(second, cross(from_corner, first)) / determinant;
  meeting.place = ray.origin + ray.direction * meeting.distance;
  meeting.face = face_of(hit.triangle);
  meeting.inside = dot(meeting.face, ray.direction) > 0;
  if (meeting.inside) meeting.face = meeting.face * -1.0;
  complete(meeting, u, v);
  if (dot(meeting.normal, meeting.face) < 0) meeting.normal = meeting.normal * -1.0;
  if (dot(meeting.normal, ray.direction) >= 0) meeting.normal = meeting.face;
  meeting.reflecting.normal = meeting.normal;
  meeting.reflecting.face = meeting.face;
  return meeting;
}

void ReferenceScene::complete(Meeting& meeting, double u, double v) const {
  const auto& [a, b, c] = surfaces_.triangles[meeting.triangle];
  const auto& normals = surfaces_.normals;
  meeting.normal =
      normalized(normals[a].as<double>() * (1 - u - v) + normals[b].as<double>() * u + normals[c].as<double>() * v);
  std::array<double, 4> color{1, 1, 1, 1};
  const auto doubles = [](const Rgba& rgba) { return std::array<double, 4>{rgba[0], rgba[1], rgba[2], rgba[3]}; };
  const auto& colors = surfaces_.colors;
  if (!colors.empty()) color = between(u, v, doubles(colors[a]), doubles(colors[b]), doubles(colors[c]));
  Place place{};
  const auto& texcoords = surfaces_.texcoords;
  if (!texcoords.empty()) {
    const auto pair = [&](uint32_t i) { return Place{texcoords[i][0], texcoords[i][1]}; };
    place = between(u, v, pair(a), pair(b), pair(c));
  }
  const SurfaceMaterial& material = surfaces_.materials[scene_.triangle_materials[meeting.triangle]];
  const auto textured = [&](const std::optional<uint32_t>& number) {
    if (!number) return std::array<double, 4>{1, 1, 1, 1};
    const SurfaceTexture& texture = surfaces_.textures[*number];
    return Sampler(texture, surfaces_.images[texture.image]).at(place);
  };
  const auto base = textured(material.base_color_texture);
  for (size_t i = 0; i < color.size(); ++i) color[i] *= base[i] * static_cast<double>(material.base_color[i]);
  const auto rough = textured(material.metallic_roughness_texture), glow = textured(material.emission_texture);
  meeting.reflecting.color = {color[0], color[1], color[2]};
  meeting.reflecting.roughness = static_cast<double>(material.roughness) * rough[1];
  meeting.reflecting.metallic = static_cast<double>(material.metallic) * rough[2];
  meeting.emission = times(material.emission.as<double>(), {glow[0], glow[1], glow[2]});
  meeting.transmission = static_cast<double>(material.transmission);
  meeting.ior = static_cast<double>(material.ior);
  if (material.alpha_mode == AlphaMode::Blend) meeting.coverage = color[3];
  if (material.alpha_mode == AlphaMode::CutOut)
    meeting.coverage = color[3] < static_cast<double>(material.alpha_cutoff) ? 0 : 1;
}

PathRay ReferenceScene::leaving(const Vec3d& place, const Vec3d& side, const Vec3d& direction) const {
  return {place + side * (kOffset * (largest_of(place) + 1)), direction};
}

bool ReferenceScene::sees(const Vec3d& place, const Vec3d& face, const Vec3d& point) const {
  const Vec3d origin = leaving(place, face, {}).origin;
  RayQuery query;
  query.origin = origin.as<float>();
  query.direction = (point - origin).as<float>();
  query.limit = static_cast<float>(1 - kBeforeLight);
  return !embree_.occluded(query);
}

double ReferenceScene::share_through_holes(const Vec3d& place, const Vec3d& face, const Vec3d& point,
                                           uint32_t most) const {
  double share = 1;
  Vec3d from = place, side = face;
  for (uint32_t met = 0; share > 0; ++met) {
    if (sees(from, side, point)) return share;
    if (met == most) return 0;
    const Vec3d origin = leaving(from, side, {}).origin;
    const std::optional<Meeting> meeting = meet({origin, normalized(point - origin)});
    if (!meeting) return 0;
    share *= 1 - meeting->coverage;
    from = meeting->place;
    side = meeting->face * -1.0;
  }
  return 0;
}

LitPoint ReferenceScene::shining_point(Random& random) const {
  const double chosen = uniform(random) * sums_.back();
  const auto found = std::upper_bound(sums_.begin(), sums_.end(), chosen);
  const uint32_t triangle = shining_[std::min<size_t>(found - sums_.begin(), shining_.size() - 1)];
  // The half of a parallelogram that is not the triangle is turned onto it.
  double u = uniform(random), v = uniform(random);
  if (u + v > 1) u = 1 - u, v = 1 - v;
  const Vec3d a = corner(triangle, 0);
  const SurfaceMaterial& material = surfaces_.materials[scene_.triangle_materials[triangle]];
  return {a + (corner(triangle, 1) - a) * u + (corner(triangle, 2) - a) * v, material.emission.as<double>(), triangle};
}

double ReferenceScene::density(uint32_t triangle, double distance, double cosine) const {
  if (weights_[triangle] == 0 || cosine <= 0) return 0;
  return weights_[triangle] / sums_.back() / area(triangle) * distance * distance / cosine;
}

ReferenceScene::Beam ReferenceScene::beam(size_t number, const Vec3d& place) const {
  if (lamp_) return {scene_.light.position.as<double>() - place, scene_.light.color.as<double>()};
  const SurfaceLight& light = surfaces_.lights[number];
  const Vec3d color = light.color.as<double>(), shines = light.direction.as<double>();
  if (light.kind == SurfaceLight::Kind::Directional) return {shines * -far_, color};
  const Vec3d to_light = light.position.as<double>() - place;
  const double distance = length(to_light);
  double strength = 1 / (distance * distance);
  if (light.range > 0 && distance > static_cast<double>(light.range)) strength = 0;
  if (light.kind == SurfaceLight::Kind::Spot) {
    const double inner = std::cos(static_cast<double>(light.inner_cone));
    const double outer = std::cos(static_cast<double>(light.outer_cone));
    const double cosine = -dot(to_light, shines) / distance;
    const double within = std::clamp((cosine - outer) / std::max(inner - outer, 0.001), 0.0, 1.0);
    strength *= within * within;
  }
  return {to_light, color * strength};
}

}  // namespace raypool::convergence
