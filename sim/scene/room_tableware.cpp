// What stands on tables.
#include <algorithm>
#include <cmath>

#include "scene/room_parts.hpp"

namespace raypool::room {
void add_cup(MeshBuilder& mesh, const Palette& palette) {
  const int around = mesh.segments(32, 8);
  mesh.use(palette.porcelain);
  mesh.smooth_lathe({{0, 0}, {0.045, 0.0}, {0.07, 0.012}, {0.078, 0.018}, {0.068, 0.016}, {0.03, 0.008}, {0, 0.008}},
                    around, mesh.segments(14, 6));
  mesh.smooth_lathe({{0, 0.01},
                     {0.024, 0.01},
                     {0.030, 0.022},
                     {0.040, 0.05},
                     {0.043, 0.078},
                     {0.0405, 0.078},
                     {0.037, 0.05},
                     {0.033, 0.035}},
                    around, mesh.segments(20, 7));
  mesh.tube(
      [](double s) {
        return Vec3d{0.038 + 0.026 * std::sin(kPi * s), 0.048 - 0.020 * std::cos(kPi * s), 0};
      },
      0.0045, mesh.segments(14, 4), mesh.segments(8, 4));
  mesh.use(palette.soil);
  mesh.lathe({{0.039, 0.064}, {0, 0.064}}, around);
}

void add_carafe(MeshBuilder& mesh, const Palette& palette) {
  mesh.use(palette.bottle);
  mesh.smooth_lathe(
      {{0, 0}, {0.055, 0}, {0.064, 0.01}, {0.066, 0.08}, {0.05, 0.15}, {0.026, 0.2}, {0.024, 0.24}, {0.032, 0.27}},
      mesh.segments(40, 8), mesh.segments(30, 8));
  mesh.use(palette.chrome);
  mesh.sphere({0, 0.283, 0}, 0.027, mesh.segments(24, 8));
}

void add_bowl(MeshBuilder& mesh, const Palette& palette) {
  mesh.use(palette.ceramic);
  mesh.smooth_lathe(
      {{0, 0}, {0.07, 0}, {0.075, 0.012}, {0.13, 0.045}, {0.17, 0.085}, {0.164, 0.088}, {0.12, 0.055}, {0, 0.03}},
      mesh.segments(64, 10), mesh.segments(28, 7));
  const double fruit[6][3] = {{0.06, 0.085, 0.02},  {-0.055, 0.085, 0.045}, {-0.02, 0.085, -0.065},
                              {0.085, 0.09, -0.06}, {0.0, 0.145, 0.0},      {0.01, 0.088, 0.095}};
  const uint32_t colours[6] = {palette.accent,   palette.leaf_light, palette.books[4],
                               palette.books[0], palette.fabric,     palette.books[4]};
  for (int i = 0; i < 6; ++i) {
    mesh.use(colours[i]);
    mesh.cushion({fruit[i][0], fruit[i][1], fruit[i][2]}, {0.043, 0.041, 0.043}, 1, mesh.segments(32, 8), [](Vec3d p) {
      const double r = std::sqrt(p.x * p.x + p.z * p.z) / 0.043;  // a dimple at the stalk
      if (p.y > 0) p.y -= 0.012 * std::max(0.0, 1 - 3 * r);
      return p;
    });
  }
}

void add_laptop(MeshBuilder& mesh, const Palette& palette) {
  const Transform at = mesh.transform();
  mesh.use(palette.silver);
  mesh.plate({0, 0.008, 0}, {0.17, 0.008, 0.12}, 0.12, mesh.segments(48, 12), 4);
  mesh.use(palette.plastic);
  for (int row = 0; row < 5; ++row) {
    for (int key = 0; key < 13; ++key) {
      const double x = -0.147 + 0.0227 * key, z = -0.085 + 0.0215 * row;
      mesh.box({x, 0.0155, z}, {x + 0.0195, 0.0185, z + 0.0185});
    }
  }
  mesh.box({-0.05, 0.0155, 0.035}, {0.05, 0.0168, 0.1});
  mesh.place(at * Transform::move({0, 0.014, -0.118}) * Transform::turn_x(-20));
  mesh.use(palette.silver);
  mesh.box({-0.17, 0, -0.008}, {0.17, 0.225, 0});
  mesh.use(palette.screen);
  mesh.box({-0.162, 0.01, 0}, {0.162, 0.217, 0.0012});
  mesh.use(palette.sky);
  mesh.box({-0.14, 0.05, 0.0012}, {0.04, 0.19, 0.002});
  mesh.place(at);
}

void add_papers(MeshBuilder& mesh, const Palette& palette, uint64_t seed) {
  const Transform at = mesh.transform();
  Sequence random(seed);
  for (int sheet = 0; sheet < 4; ++sheet) {
    const double turn = random.next(-14, 14), shift = random.next(-0.02, 0.02), lift = 0.0008 * (sheet + 1);
    mesh.place(at * Transform::move({shift, lift, -shift}) * Transform::turn_y(turn));
    mesh.use(palette.paper);
    mesh.surface(mesh.segments(10, 2), mesh.segments(10, 2), false, false, [&](double s, double t) {
      const double curl = std::max(0.0, s - 0.6) * std::max(0.0, 0.5 - t);
      return Vec3d{(s - 0.5) * 0.21, 0.08 * curl, (0.5 - t) * 0.297};
    });
  }
  mesh.place(at * Transform::move({0.16, 0.006, 0}) * Transform::turn_y(random.next(-30, 30)));
  mesh.use(palette.accent);
  mesh.cylinder({0, 0, -0.07}, {0, 0, 0.07}, 0.0045, mesh.segments(10, 5));
  mesh.place(at);
}

void add_vase(MeshBuilder& mesh, const Palette& palette) {
  mesh.use(palette.ceramic);
  mesh.smooth_lathe({{0, 0},
                     {0.06, 0},
                     {0.07, 0.01},
                     {0.115, 0.12},
                     {0.10, 0.22},
                     {0.045, 0.30},
                     {0.04, 0.34},
                     {0.058, 0.37},
                     {0.05, 0.365},
                     {0.034, 0.33}},
                    mesh.segments(64, 10), mesh.segments(40, 9));
  Sequence random(77);
  for (int twig = 0; twig < 9; ++twig) {
    const double angle = twig * 2.4, lean = random.next(0.05, 0.22), height = random.next(0.62, 0.9);
    const Vec3d top{lean * std::cos(angle), height, lean * std::sin(angle)};
    mesh.use(palette.table_edge);
    mesh.tube(
        [&](double s) {
          return Vec3d{top.x * s * s, 0.30 + (top.y - 0.30) * s, top.z * s * s};
        },
        0.003, mesh.segments(10, 3), mesh.segments(5, 3));
    mesh.use(twig % 3 == 0 ? palette.books[4] : palette.accent);
    for (int berry = 0; berry < 5; ++berry) {
      const double s = 0.68 + 0.08 * berry, away = berry % 2 == 0 ? 0.014 : -0.014;
      mesh.sphere({top.x * s * s + away, 0.30 + (top.y - 0.30) * s, top.z * s * s + away}, 0.013, mesh.segments(12, 5));
    }
  }
}

}  // namespace raypool::room
