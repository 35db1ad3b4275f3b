// The built-in scene "cornell": after the Cornell box, but closed, with camera and light inside.
#include <cmath>

#include "scene/mesh_builder.hpp"
#include "scene/scene.hpp"

namespace raypool {

Scene make_cornell(double detail) {
  Scene scene;
  scene.name = "cornell";
  MeshBuilder mesh(scene, detail);
  const uint32_t white = mesh.add_material("white", {0.73f, 0.73f, 0.70f}, {0, 0, 0});
  const uint32_t red = mesh.add_material("red", {0.63f, 0.065f, 0.05f}, {0, 0, 0});
  const uint32_t green = mesh.add_material("green", {0.14f, 0.45f, 0.09f}, {0, 0, 0});
  const uint32_t tile = mesh.add_material("floor", {0.62f, 0.60f, 0.56f}, {0.12f, 0.12f, 0.12f});
  const uint32_t mirror = mesh.add_material("mirror", {0.04f, 0.045f, 0.05f}, {0.88f, 0.9f, 0.92f});
  const uint32_t lamp = mesh.add_material("lamp", {0.98f, 0.95f, 0.86f}, {0, 0, 0});
  const uint32_t gold = mesh.add_material("gold", {0.48f, 0.31f, 0.07f}, {0.5f, 0.36f, 0.14f});

  // Metres; the back wall at z = 0, the wall behind the camera at z = 11.
  const double w = 5.5, h = 5.5, d = 11;
  auto wall = [&](uint32_t material, Vec3d a, Vec3d b, Vec3d c, Vec3d e) {
    mesh.use(material);
    mesh.quad(a, b, c, e);
  };
  wall(tile, {0, 0, d}, {w, 0, d}, {w, 0, 0}, {0, 0, 0});
  wall(white, {0, h, 0}, {w, h, 0}, {w, h, d}, {0, h, d});
  wall(white, {0, 0, 0}, {w, 0, 0}, {w, h, 0}, {0, h, 0});
  wall(white, {w, 0, d}, {0, 0, d}, {0, h, d}, {w, h, d});
  wall(red, {0, 0, d}, {0, 0, 0}, {0, h, 0}, {0, h, d});
  wall(green, {w, 0, 0}, {w, 0, d}, {w, h, d}, {w, h, 0});

  mesh.use(lamp);
  mesh.box({2.1, 5.44, 4.6}, {3.4, 5.49, 5.7});

  mesh.place(Transform::move({1.85, 0, 1.95}) * Transform::turn_y(-18));
  mesh.use(mirror);
  mesh.box({-0.82, 0, -0.82}, {0.82, 3.3, 0.82});
  mesh.place(Transform::move({3.75, 0, 3.65}) * Transform::turn_y(15));
  mesh.use(white);
  mesh.box({-0.82, 0, -0.82}, {0.82, 1.65, 0.82});
  mesh.place(Transform::move({3.75, 1.65, 3.65}));
  mesh.use(gold);
  mesh.sphere({0, 0.55, 0}, 0.55, mesh.segments(96, 8));

  mesh.place({});
  scene.camera = {{2.75f, 2.75f, 10.6f}, {0, -0.02f, -1}, {0, 1, 0}, 39};
  scene.light = {{2.9f, 5.0f, 6.2f}, {1.05f, 1.0f, 0.9f}};
  return scene;
}

}  // namespace raypool
