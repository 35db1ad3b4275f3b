#include "convergence/furnace.hpp"

#include <array>
#include <cmath>
#include <memory>

namespace raypool::convergence {
namespace {

constexpr uint32_t kBall = 0, kBox = 1;  // materials
constexpr int kRings = 16, kSectors = 32;
constexpr float kHalfBox = 3;

class Faces {
 public:
  Faces(Scene& scene, Surfaces& surfaces) : scene_(scene), surfaces_(surfaces) {}

  void triangle(const Vec3d& a, const Vec3d& b, const Vec3d& c, uint32_t material) {
    const auto first = static_cast<uint32_t>(scene_.vertices.size());
    for (const Vec3d& corner : {a, b, c}) scene_.vertices.push_back(corner.as<float>());
    scene_.triangles.push_back({first, first + 1, first + 2});
    scene_.triangle_materials.push_back(material);
    surfaces_.triangles.push_back(scene_.triangles.back());
    surfaces_.positions = scene_.vertices;
    surfaces_.normals.resize(scene_.vertices.size(), scene_.normal(scene_.triangles.size() - 1));
  }
  void quad(const std::array<Vec3d, 4>& corners, uint32_t material) {
    triangle(corners[0], corners[1], corners[2], material);
    triangle(corners[0], corners[2], corners[3], material);
  }

 private:
  Scene& scene_;
  Surfaces& surfaces_;
};

Vec3d on_ball(int ring, int sector) {
  const double pi = std::acos(-1.0), down = pi * ring / kRings, round = 2 * pi * (sector % kSectors) / kSectors;
  return {std::sin(down) * std::cos(round), std::cos(down), -std::sin(down) * std::sin(round)};
}

void add_ball(Faces& faces) {
  for (int sector = 0; sector < kSectors; ++sector) {
    faces.triangle(on_ball(0, 0), on_ball(1, sector), on_ball(1, sector + 1), kBall);
    for (int ring = 1; ring + 1 < kRings; ++ring) {
      faces.quad(
          {on_ball(ring, sector), on_ball(ring + 1, sector), on_ball(ring + 1, sector + 1), on_ball(ring, sector + 1)},
          kBall);
    }
    faces.triangle(on_ball(kRings - 1, sector), on_ball(kRings, 0), on_ball(kRings - 1, sector + 1), kBall);
  }
}

void add_box(Faces& faces) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      std::array<Vec3d, 4> corners;
      for (int i = 0; i < 4; ++i) {
        corners[i][axis] = side * kHalfBox;
        corners[i][(axis + 1) % 3] = i == 0 || i == 3 ? -kHalfBox : kHalfBox;
        corners[i][(axis + 2) % 3] = i < 2 ? -kHalfBox : kHalfBox;
      }
      faces.quad(corners, kBox);
    }
  }
}

}  // namespace

Scene furnace(const SurfaceMaterial& ball, Finds finds) {
  Scene scene;
  Surfaces surfaces;
  scene.name = "furnace";
  scene.materials.resize(2);
  scene.camera.eye = {0, 0, 2.8f};
  scene.camera.fov = 46;
  // Black glass of the index of air lets all light in, and none out again.
  SurfaceMaterial box;
  box.base_color = {0, 0, 0, 1};
  box.transmission = 1;
  box.ior = 1;
  box.emission = {1, 1, 1};
  // Triangles with a texture of their emission are no lights; the light that a scene without lights has is dark.
  scene.light.color = {};
  if (finds == Finds::ByChance) {
    constexpr uint16_t kOne = 65535;
    surfaces.images.push_back({1, 1, {kOne, kOne, kOne, kOne}});
    box.emission_texture = surfaces.add_texture({});
  }
  surfaces.materials = {ball, box};
  Faces faces(scene, surfaces);
  add_ball(faces);
  add_box(faces);
  scene.surfaces = std::make_shared<const Surfaces>(std::move(surfaces));
  return scene;
}

}  // namespace raypool::convergence
