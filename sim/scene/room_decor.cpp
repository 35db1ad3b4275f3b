// Lamps, plants, curtains, windows, and what hangs on the walls.
#include <algorithm>
#include <cmath>

#include "scene/room_parts.hpp"

namespace raypool::room {
void add_pendant(MeshBuilder& mesh, const Palette& palette, double cord) {
  const int around = mesh.segments(64, 10), along = mesh.segments(24, 5);
  mesh.use(palette.brass);
  mesh.lathe({{0, -0.03}, {0.06, -0.03}, {0.06, 0}, {0, 0}}, mesh.segments(24, 8));
  mesh.smooth_lathe(
      {{0.235, -cord - 0.25}, {0.225, -cord - 0.17}, {0.16, -cord - 0.07}, {0.05, -cord - 0.02}, {0.0, -cord}}, around,
      along);
  mesh.tube(
      [&](double s) {
        return Vec3d{0.233 * std::cos(2 * kPi * s), -cord - 0.25, 0.233 * std::sin(2 * kPi * s)};
      },
      0.007, around, mesh.segments(8, 4), true);
  mesh.use(palette.frame);
  mesh.smooth_lathe({{0.0, -cord - 0.012},
                     {0.045, -cord - 0.03},
                     {0.15, -cord - 0.08},
                     {0.216, -cord - 0.175},
                     {0.228, -cord - 0.25}},
                    around, along);
  mesh.use(palette.glow);
  mesh.sphere({0, -cord - 0.17, 0}, 0.07, mesh.segments(24, 8));
  mesh.use(palette.plastic);
  mesh.cylinder({0, -cord + 0.005, 0}, {0, -0.02, 0}, 0.006, mesh.segments(8, 4));
}

void add_floor_lamp(MeshBuilder& mesh, const Palette& palette) {
  mesh.use(palette.brass);
  mesh.smooth_lathe({{0, 0}, {0.16, 0}, {0.165, 0.012}, {0.14, 0.025}, {0.02, 0.04}}, mesh.segments(40, 8),
                    mesh.segments(12, 4));
  mesh.cylinder({0, 0.03, 0}, {0, 1.5, 0}, 0.012, mesh.segments(12, 5));
  mesh.use(palette.porcelain);
  // A pleated shade.
  mesh.surface(mesh.segments(160, 16), mesh.segments(10, 2), true, false, [](double s, double t) {
    const double r = (0.26 - 0.10 * t) * (1 + 0.025 * std::cos(40 * 2 * kPi * s)), a = -2 * kPi * s;
    return Vec3d{r * std::cos(a), 1.34 + 0.34 * t, r * std::sin(a)};
  });
}

void add_plant(MeshBuilder& mesh, const Palette& palette, uint64_t seed, int leaves, double height, uint32_t pot) {
  Sequence random(seed);
  const int around = mesh.segments(48, 8);
  mesh.use(pot);
  mesh.smooth_lathe(
      {{0, 0}, {0.13, 0}, {0.15, 0.02}, {0.19, 0.20}, {0.215, 0.38}, {0.205, 0.40}, {0.19, 0.36}, {0.185, 0.33}},
      around, mesh.segments(28, 7));
  mesh.use(palette.soil);
  mesh.smooth_lathe({{0.188, 0.345}, {0.10, 0.36}, {0, 0.365}}, around, 4);
  const int nu = mesh.segments(6, 2), nv = mesh.segments(12, 3);
  for (int i = 0; i < leaves; ++i) {
    // A stem leaves the pot, bends outwards and carries a folded, drooping leaf.
    const double angle = i * 137.50776 * kPi / 180, share = (i + 0.5) / leaves;
    const double rise = height * (0.95 - 0.55 * share) * random.next(0.85, 1.1),
                 reach = (0.10 + 0.32 * share) * random.next(0.75, 1.2);
    const double length = random.next(0.26, 0.40), half = length * random.next(0.19, 0.26),
                 droop = random.next(0.25, 0.75) + 0.5 * share;
    const double tip = random.next(-0.5, 0.5);
    const Vec3d out{std::cos(angle), 0, std::sin(angle)}, side{-out.z, 0, out.x};
    const Vec3d foot = out * 0.05 + Vec3d{0, 0.34, 0}, top = out * reach + Vec3d{0, 0.36 + rise, 0};
    mesh.use(palette.leaf);
    mesh.tube([&](double s) { return foot + (top - foot) * s - out * (0.5 * reach * s * (1 - s)); }, 0.006,
              mesh.segments(4, 2), mesh.segments(5, 3));
    mesh.use(random.next(0, 1) < 0.4 ? palette.leaf_light : palette.leaf);
    mesh.surface(nu, nv, false, false, [&](double s, double t) {
      const double across = 2 * s - 1, width = half * std::pow(std::sin(kPi * std::pow(t, 0.75)), 0.8);
      const double fall = droop * t * t - 0.25 * t;
      return top + out * (length * t * (1 - 0.25 * droop * t)) + side * (across * width + 0.04 * tip * t * t) +
             Vec3d{0, -length * fall + 0.35 * width * across * across + 0.006 * std::sin(9 * kPi * t), 0};
    });
  }
}

void add_curtain(MeshBuilder& mesh, const Palette& palette, double width, double height, double phase) {
  mesh.use(palette.curtain);
  mesh.surface(mesh.segments(120, 24), mesh.segments(12, 3), false, false, [&](double s, double t) {
    const double folds = 2 * kPi * (9 * s + 0.25 * std::sin(5 * s + phase)) + phase;
    const double depth = 0.055 * (1 - 0.35 * t) * (1 + 0.3 * std::sin(3 * folds / 7));
    return Vec3d{width * s + 0.02 * (1 - t) * std::sin(folds * 0.5), height * t, 0.075 + depth * std::sin(folds)};
  });
}

void add_window(MeshBuilder& mesh, const Palette& palette, double width, double height) {
  mesh.use(palette.sky);
  mesh.box({0.03, 0.03, 0.0}, {width - 0.03, height - 0.03, 0.012});
  mesh.use(palette.frame);
  const double bar = 0.055, depth = 0.06;
  mesh.box({0, 0, 0}, {width, bar, depth});
  mesh.box({0, height - bar, 0}, {width, height, depth});
  mesh.box({0, bar, 0}, {bar, height - bar, depth});
  mesh.box({width - bar, bar, 0}, {width, height - bar, depth});
  mesh.box({width / 2 - bar / 2, bar, 0}, {width / 2 + bar / 2, height - bar, depth});
  for (double x : {bar, width / 2 + bar / 2})
    mesh.box({x, height * 0.62, 0}, {x + width / 2 - 1.5 * bar, height * 0.62 + 0.03, depth - 0.02});
  mesh.box({-0.06, -0.04, 0}, {width + 0.06, 0, 0.20});
}

void add_screen(MeshBuilder& mesh, const Palette& palette) {
  mesh.use(palette.plastic);
  mesh.box({-1.23, -0.70, 0}, {1.23, 0.70, 0.05});
  mesh.use(palette.screen);
  mesh.box({-1.2, -0.67, 0.05}, {1.2, 0.67, 0.052});
  // The talk on it: a title, a bar chart and a curve.
  mesh.use(palette.paper);
  mesh.box({-1.05, 0.44, 0.052}, {0.15, 0.52, 0.054});
  mesh.box({-1.05, 0.36, 0.052}, {-0.35, 0.385, 0.054});
  mesh.box({-1.05, -0.50, 0.052}, {-0.08, -0.492, 0.054});
  const double bars[7] = {0.18, 0.26, 0.24, 0.38, 0.47, 0.60, 0.74};
  for (int i = 0; i < 7; ++i) {
    mesh.use(i == 6 ? palette.accent : i % 2 == 0 ? palette.sky : palette.books[4]);
    mesh.box({-1.0 + 0.135 * i, -0.49, 0.052}, {-0.91 + 0.135 * i, -0.49 + bars[i], 0.056});
  }
  mesh.use(palette.books[4]);
  mesh.tube(
      [](double s) {
        return Vec3d{0.2 + 0.8 * s, -0.42 + 0.62 * std::pow(s, 1.8) + 0.05 * std::sin(9 * s), 0.055};
      },
      0.011, mesh.segments(64, 12), mesh.segments(8, 4));
  mesh.use(palette.paper);
  mesh.box({0.15, -0.5, 0.052}, {1.05, -0.492, 0.054});
  mesh.box({0.15, -0.5, 0.052}, {0.158, 0.3, 0.054});
}

void add_painting(MeshBuilder& mesh, const Palette& palette, double width, double height) {
  const double x = width / 2, y = height / 2;
  mesh.use(palette.brass);
  mesh.box({-x, -y, 0}, {x, -y + 0.03, 0.035});
  mesh.box({-x, y - 0.03, 0}, {x, y, 0.035});
  mesh.box({-x, -y + 0.03, 0}, {-x + 0.03, y - 0.03, 0.035});
  mesh.box({x - 0.03, -y + 0.03, 0}, {x, y - 0.03, 0.035});
  mesh.use(palette.paper);
  mesh.box({-x + 0.03, -y + 0.03, 0}, {x - 0.03, y - 0.03, 0.02});
  // Three hills under a sun.
  const uint32_t colours[3] = {palette.books[1], palette.books[2], palette.sofa};
  for (int hill = 0; hill < 3; ++hill) {
    mesh.use(colours[hill]);
    mesh.surface(mesh.segments(48, 8), 1, false, false, [&](double s, double t) {
      const double top = 0.62 - 0.17 * hill + 0.09 * std::sin((4 + hill) * s + 1.7 * hill) + 0.04 * std::sin(11 * s);
      return Vec3d{(2 * s - 1) * (x - 0.06), -y + 0.06 + t * top * (height - 0.12), 0.022 + 0.002 * hill};
    });
  }
  mesh.use(palette.accent);
  const double r = 0.13 * height;
  const int around = mesh.segments(40, 10);
  for (int i = 0; i < around; ++i) {
    const double a = 2 * kPi * i / around, b = 2 * kPi * (i + 1) / around;
    const Vec3d c{0.22 * width, 0.26 * height, 0.0215};
    mesh.triangle(c, c + Vec3d{r * std::cos(a), r * std::sin(a), 0}, c + Vec3d{r * std::cos(b), r * std::sin(b), 0});
  }
}

void add_clock(MeshBuilder& mesh, const Palette& palette) {
  const Transform at = mesh.transform();
  mesh.place(at * Transform::turn_x(90));  // the axis of revolution points into the room
  mesh.use(palette.paper);
  mesh.lathe({{0.19, 0.0}, {0.19, 0.02}, {0.0, 0.021}}, mesh.segments(64, 12));
  mesh.use(palette.plastic);
  mesh.tube(
      [](double s) {
        return Vec3d{0.2 * std::cos(2 * kPi * s), 0.02, 0.2 * std::sin(2 * kPi * s)};
      },
      0.018, mesh.segments(72, 12), mesh.segments(10, 5), true);
  mesh.place(at);
  for (int hour = 0; hour < 12; ++hour) {
    mesh.place(at * Transform::turn_z(30.0 * hour));
    mesh.box({-0.005, 0.145, 0.021}, {0.005, 0.175, 0.025});
  }
  mesh.place(at * Transform::turn_z(-305));
  mesh.box({-0.007, -0.02, 0.022}, {0.007, 0.10, 0.027});
  mesh.place(at * Transform::turn_z(-60));
  mesh.box({-0.005, -0.02, 0.028}, {0.005, 0.15, 0.031});
  mesh.place(at);
}

void add_knot(MeshBuilder& mesh, const Palette& palette) {
  mesh.use(palette.table_edge);
  mesh.box({-0.09, 0, -0.09}, {0.09, 0.05, 0.09});
  mesh.use(palette.brass);
  mesh.tube(
      [](double s) {
        const double a = 2 * kPi * s, r = 0.5 + 0.22 * std::cos(3 * a);
        return Vec3d{0.28 * r * std::cos(2 * a), 0.255 + 0.28 * r * std::sin(2 * a), 0.075 * std::sin(3 * a)};
      },
      0.024, mesh.segments(180, 30), mesh.segments(16, 5), true);
}

void add_radiator(MeshBuilder& mesh, const Palette& palette, double width) {
  mesh.use(palette.frame);
  const int fins = static_cast<int>(width / 0.075);
  for (int i = 0; i < fins; ++i) {
    mesh.cushion({0.0375 + 0.075 * i, 0.36, 0.075}, {0.027, 0.26, 0.05}, 0.45, mesh.segments(16, 6));
  }
  for (double y : {0.16, 0.56}) mesh.cylinder({0, y, 0.075}, {width, y, 0.075}, 0.018, mesh.segments(12, 5));
}

}  // namespace raypool::room
