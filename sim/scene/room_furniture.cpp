// Chairs, table, shelves, sofa.
#include <algorithm>
#include <cmath>

#include "scene/room_parts.hpp"

namespace raypool::room {
namespace {

/// Smooth path through points, s in 0 .. 1 (Catmull-Rom).
Vec3d through(const std::vector<Vec3d>& points, double s) {
  const int last = static_cast<int>(points.size()) - 1;
  const double place = std::clamp(s, 0.0, 1.0) * last;
  const int i = std::min(static_cast<int>(place), last - 1);
  const double f = place - i;
  auto at = [&](int k) { return points[std::clamp(k, 0, last)]; };
  const Vec3d a = at(i - 1), b = at(i), c = at(i + 1), d = at(i + 2);
  return (b * 2.0 + (c - a) * f + (a * 2.0 - b * 5.0 + c * 4.0 - d) * (f * f) +
          (b * 3.0 - a - c * 3.0 + d) * (f * f * f)) *
         0.5;
}

}  // namespace

void add_chair(MeshBuilder& mesh, const Palette& palette) {
  const Transform at = mesh.transform();
  const int ring = mesh.segments(8, 5);
  for (int leg = 0; leg < 5; ++leg) {
    mesh.place(at * Transform::turn_y(72.0 * leg + 36));
    mesh.use(palette.chrome);
    mesh.tube(
        [](double s) {
          return Vec3d{0.02 + 0.28 * s, 0.115 - 0.045 * s * s, 0};
        },
        0.017, mesh.segments(8, 2), ring);
    mesh.use(palette.plastic);
    mesh.cushion({0.30, 0.032, 0}, {0.030, 0.032, 0.022}, 0.8, mesh.segments(12, 6));
  }
  mesh.place(at);
  mesh.use(palette.chrome);
  mesh.cylinder({0, 0.07, 0}, {0, 0.43, 0}, 0.028, mesh.segments(20, 6));
  mesh.tube(
      [](double s) {
        return through({{0, 0.41, -0.08}, {0, 0.40, -0.24}, {0, 0.50, -0.30}, {0, 0.66, -0.285}}, s);
      },
      0.02, mesh.segments(20, 4), ring);

  mesh.use(palette.fabric);
  const int around = mesh.segments(46, 12);
  mesh.cushion({0, 0.475, 0}, {0.255, 0.05, 0.25}, 0.42, around, [](Vec3d p) {
    p.y += 0.45 * p.x * p.x - (p.z > 0.08 ? 1.1 * (p.z - 0.08) * (p.z - 0.08) : 0.0);
    return p;
  });
  auto back = [](Vec3d p) {
    const double taper = 1 - 0.28 * (p.y + 0.3) * (p.y + 0.3);
    p.x *= taper;
    p.z += 0.95 * p.x * p.x - 0.16 * p.y - 0.045 * std::cos(p.y * 7.5);
    return p;
  };
  mesh.cushion({0, 0.84, -0.215}, {0.24, 0.29, 0.028}, 0.42, around, back);
  mesh.use(palette.shell);
  mesh.cushion({0, 0.84, -0.243}, {0.25, 0.30, 0.012}, 0.42, mesh.segments(32, 10), back);

  for (double side : {-1.0, 1.0}) {
    mesh.use(palette.chrome);
    mesh.tube(
        [side](double s) {
          return through({{side * 0.16, 0.435, -0.05},
                          {side * 0.29, 0.44, -0.05},
                          {side * 0.305, 0.55, -0.06},
                          {side * 0.295, 0.675, -0.02}},
                         s);
        },
        0.013, mesh.segments(20, 4), ring);
    mesh.use(palette.plastic);
    mesh.cushion({side * 0.295, 0.69, 0.02}, {0.034, 0.016, 0.14}, 0.55, mesh.segments(16, 8));
  }
}

void add_table(MeshBuilder& mesh, const Palette& palette) {
  const int around = mesh.segments(160, 24);
  mesh.use(palette.table);
  mesh.plate({0, 0.728, 0}, {2.5, 0.022, 0.74}, 0.42, around, mesh.segments(10, 2));
  mesh.use(palette.table_edge);
  mesh.plate({0, 0.69, 0}, {2.42, 0.016, 0.66}, 0.42, around, mesh.segments(4, 2));
  // A strip of leather with the sockets along the middle.
  mesh.plate({0, 0.7505, 0}, {1.9, 0.002, 0.11}, 0.3, around, 2);
  const Transform at = mesh.transform();
  for (double x : {-1.45, 1.45}) {
    mesh.place(at * Transform::move({x, 0, 0}));
    mesh.use(palette.table_edge);
    mesh.smooth_lathe({{0.13, 0.03}, {0.085, 0.14}, {0.075, 0.35}, {0.09, 0.55}, {0.20, 0.675}}, mesh.segments(48, 8),
                      mesh.segments(24, 4));
    mesh.use(palette.chrome);
    mesh.smooth_lathe({{0, 0}, {0.36, 0}, {0.37, 0.012}, {0.34, 0.028}, {0.16, 0.045}, {0.12, 0.06}},
                      mesh.segments(64, 8), mesh.segments(16, 5));
  }
  mesh.place(at);
}

void add_bookshelf(MeshBuilder& mesh, const Palette& palette, uint64_t seed) {
  const double width = 1.9, height = 2.3, depth = 0.32, board = 0.03;
  Sequence random(seed);
  mesh.use(palette.shelf);
  mesh.box({0, 0, 0}, {board, height, depth});
  mesh.box({width - board, 0, 0}, {width, height, depth});
  mesh.box({width / 2 - board / 2, 0.08, 0}, {width / 2 + board / 2, height - board, depth - 0.01});
  mesh.box({board, 0.08, 0}, {width - board, height, 0.012});
  mesh.box({-0.02, height, -0.0}, {width + 0.02, height + 0.04, depth + 0.02});
  mesh.box({board, 0, 0.0}, {width - board, 0.08, depth - 0.03});
  const int shelves = 6, spine = mesh.segments(8, 2);
  for (int row = 0; row < shelves; ++row) {
    const double y = 0.08 + row * (height - 0.08) / shelves;
    for (int half = 0; half < 2; ++half) {
      const double left = half == 0 ? board : width / 2 + board / 2, right = left + width / 2 - 1.5 * board;
      mesh.use(palette.shelf);
      mesh.box({left, y, 0.012}, {right, y + board, depth - 0.005});
      // Books with rounded spines until the compartment, or a part of it, is full.
      const double end = right - random.next(0.0, 0.34);
      double x = left + 0.01;
      while (true) {
        const double thick = random.next(0.018, 0.052), tall = random.next(0.20, 0.31), deep = random.next(0.17, 0.25);
        if (x + thick > end) break;
        mesh.use(palette.books[static_cast<int>(random.next(0, 4.999))]);
        const double foot = y + board, front = depth - 0.04 - random.next(0, 0.02);
        // Ten points around the book, the first and last at the back; the spine is an arc.
        auto outline = [&](double s) {
          const double angle = kPi * s;
          return Vec3d{x + thick / 2 - thick / 2 * std::cos(angle), 0, front + 0.4 * thick * std::sin(angle)};
        };
        mesh.surface(spine + 2, 3, false, false, [&](double s, double t) {
          const int column = static_cast<int>(std::lround(s * (spine + 2))),
                    level = static_cast<int>(std::lround(t * 3));
          Vec3d p = outline(std::clamp((column - 1.0) / spine, 0.0, 1.0));
          if (column == 0 || column == spine + 2) p.z = front - deep;
          if (level == 0 || level == 3) p.x = x + thick / 2, p.z = std::min(p.z, front);
          p.y = level < 2 ? foot : foot + tall;
          return p;
        });
        x += thick + 0.0015;
      }
    }
  }
}

void add_sideboard(MeshBuilder& mesh, const Palette& palette) {
  mesh.use(palette.shelf);
  mesh.box({0, 0.16, 0.02}, {2.0, 0.76, 0.44});
  mesh.use(palette.table);
  mesh.plate({1.0, 0.778, 0.25}, {1.03, 0.018, 0.24}, 0.12, mesh.segments(96, 16), mesh.segments(6, 2));
  for (int door = 0; door < 4; ++door) {
    mesh.use(palette.oak_light);
    mesh.box({0.02 + 0.495 * door, 0.18, 0.44}, {0.495 + 0.495 * door, 0.74, 0.458});
    mesh.use(palette.brass);
    const double x = (door % 2 == 0 ? 0.45 : 0.065) + 0.495 * door;
    mesh.tube(
        [x](double s) {
          return Vec3d{x, 0.40 + 0.14 * s, 0.46 + 0.035 * std::sin(kPi * s)};
        },
        0.006, mesh.segments(16, 4), mesh.segments(8, 4));
  }
  mesh.use(palette.brass);
  for (double x : {0.12, 1.88}) {
    for (double z : {0.08, 0.38}) mesh.cylinder({x, 0, z}, {x, 0.16, z}, 0.018, mesh.segments(12, 5));
  }
}

void add_sofa(MeshBuilder& mesh, const Palette& palette) {
  const int around = mesh.segments(32, 10);
  mesh.use(palette.sofa);
  mesh.cushion({0, 0.24, 0}, {1.0, 0.12, 0.44}, 0.18, around);
  mesh.cushion({0, 0.55, -0.34}, {1.0, 0.34, 0.13}, 0.25, around);
  for (double side : {-1.0, 1.0}) {
    mesh.cushion({side * 0.94, 0.40, 0}, {0.11, 0.24, 0.45}, 0.3, around);
    mesh.cushion({side * 0.41, 0.43, 0.06}, {0.41, 0.10, 0.36}, 0.3, around);
  }
  mesh.use(palette.fabric);
  const Transform at = mesh.transform();
  mesh.place(at * Transform::move({-0.6, 0.66, -0.12}) * Transform::turn_x(-18) * Transform::turn_z(12));
  mesh.cushion({0, 0, 0}, {0.22, 0.22, 0.07}, 0.5, mesh.segments(40, 8));
  mesh.place(at);
  mesh.use(palette.table_edge);
  for (double x : {-0.85, 0.85}) {
    for (double z : {-0.32, 0.32}) mesh.cylinder({x, 0, z}, {x, 0.14, z}, 0.022, mesh.segments(12, 5));
  }
}

}  // namespace raypool::room
