// The built-in scene "room": the shell of the meeting room, where everything stands, and the view.
#include <algorithm>
#include <cmath>

#include "scene/room_parts.hpp"

namespace raypool {
namespace {

using room::Palette;

// Metres: x along the table, away from the far wall with the screen; z from the window
// wall. The floor's upper side is y = 0.
constexpr double kLength = 9.6, kHeight = 3.1, kWidth = 6.4;
constexpr double kTableX = 4.35, kTableZ = 3.0;

Transform facing_room_from_far_wall(double z, double y) { return Transform::move({0, y, z}) * Transform::turn_y(90); }

void add_floor(MeshBuilder& mesh, const Palette& palette) {
  Sequence random(11);
  const uint32_t woods[3] = {palette.oak, palette.oak_dark, palette.oak_light};
  const double board = 0.16, gap = 0.0012;
  for (int row = 0; row * board < kWidth - 0.01; ++row) {
    for (double x = -random.next(0, 1.5); x < kLength;) {
      const double end = x + random.next(1.1, 1.9);
      mesh.use(woods[static_cast<int>(random.next(0, 2.999))]);
      const double from = std::max(0.0, x), to = std::min(kLength, end);
      if (to - from > 0.02) mesh.box({from + gap, -0.02, row * board + gap}, {to - gap, 0, (row + 1) * board - gap});
      x = end;
    }
  }
  // A woven rug with a border.
  mesh.use(palette.rug_border);
  mesh.plate({kTableX, 0.006, kTableZ}, {3.35, 0.006, 1.75}, 0.06, mesh.segments(120, 16), 2);
  mesh.use(palette.rug);
  mesh.surface(mesh.segments(84, 8), mesh.segments(42, 4), false, false, [](double s, double t) {
    const double weave = 0.0012 * std::sin(96 * 3.14159265358979 * s) * std::sin(48 * 3.14159265358979 * t);
    return Vec3d{kTableX + (s - 0.5) * 6.3, 0.0145 + weave, kTableZ + (0.5 - t) * 3.1};
  });
}

void add_shell(MeshBuilder& mesh, const Palette& palette) {
  mesh.use(palette.table_edge);
  mesh.quad({0, -0.02, kWidth}, {kLength, -0.02, kWidth}, {kLength, -0.02, 0}, {0, -0.02, 0});
  mesh.use(palette.ceiling);
  mesh.quad({0, kHeight, 0}, {kLength, kHeight, 0}, {kLength, kHeight, kWidth}, {0, kHeight, kWidth});
  mesh.use(palette.wall);
  mesh.quad({0, -0.02, 0}, {kLength, -0.02, 0}, {kLength, kHeight, 0}, {0, kHeight, 0});
  mesh.quad({kLength, -0.02, kWidth}, {0, -0.02, kWidth}, {0, kHeight, kWidth}, {kLength, kHeight, kWidth});
  mesh.quad({0, -0.02, kWidth}, {0, -0.02, 0}, {0, kHeight, 0}, {0, kHeight, kWidth});
  mesh.quad({kLength, -0.02, 0}, {kLength, -0.02, kWidth}, {kLength, kHeight, kWidth}, {kLength, kHeight, 0});
  // Skirting boards and a moulding under the ceiling.
  mesh.use(palette.frame);
  for (double y : {0.0, kHeight - 0.09}) {
    const double t = y == 0.0 ? 0.018 : 0.07;
    mesh.box({0, y, 0}, {kLength, y + 0.09, t});
    mesh.box({0, y, kWidth - t}, {kLength, y + 0.09, kWidth});
    mesh.box({0, y, t}, {t, y + 0.09, kWidth - t});
    mesh.box({kLength - t, y, t}, {kLength, y + 0.09, kWidth - t});
  }
  // A raft under the ceiling, from which the lamps hang.
  mesh.plate({kTableX, kHeight - 0.05, kTableZ}, {2.9, 0.035, 1.15}, 0.25, mesh.segments(96, 16), mesh.segments(6, 2));
}

void add_walls(MeshBuilder& mesh, const Palette& palette) {
  // Far wall: screen, bookshelf, clock.
  mesh.place(facing_room_from_far_wall(2.55, 1.62));
  room::add_screen(mesh, palette);
  mesh.place(facing_room_from_far_wall(6.28, 0));
  room::add_bookshelf(mesh, palette, 5);
  mesh.place(facing_room_from_far_wall(2.55, 2.68));
  room::add_clock(mesh, palette);
  mesh.place(facing_room_from_far_wall(3.55, 0) * Transform::move({0, 0, 0.0}));
  room::add_sideboard(mesh, palette);
  mesh.place(facing_room_from_far_wall(3.2, 0.796) * Transform::move({0, 0, 0.24}));
  room::add_knot(mesh, palette);
  mesh.place(facing_room_from_far_wall(1.85, 0.796) * Transform::move({0, 0, 0.22}));
  room::add_vase(mesh, palette);

  // Window wall: three windows with curtains, radiators, paintings between.
  for (int i = 0; i < 3; ++i) {
    const double x = 0.95 + 2.85 * i;
    mesh.place(Transform::move({x, 0.95, 0}));
    room::add_window(mesh, palette, 1.7, 1.65);
    mesh.place(Transform::move({x - 0.35, 0.06, 0}));
    room::add_curtain(mesh, palette, 0.5, 2.72, 0.7 * i);
    mesh.place(Transform::move({x + 1.55, 0.06, 0}));
    room::add_curtain(mesh, palette, 0.5, 2.72, 2.1 + 1.3 * i);
    mesh.place(Transform::move({x + 0.25, 0, 0}));
    room::add_radiator(mesh, palette, 1.2);
    mesh.place({});
    mesh.use(palette.brass);
    mesh.cylinder({x - 0.45, 2.80, 0.075}, {x + 2.15, 2.80, 0.075}, 0.016, mesh.segments(16, 5));
    for (double end : {x - 0.45, x + 2.15}) mesh.sphere({end, 2.80, 0.075}, 0.035, mesh.segments(20, 6));
  }

  // Near walls, seen in reflections.
  mesh.place(Transform::move({4.6, 1.65, kWidth}) * Transform::turn_y(180));
  room::add_painting(mesh, palette, 1.8, 1.1);
  mesh.place(Transform::move({2.3, 1.65, kWidth}) * Transform::turn_y(180));
  room::add_painting(mesh, palette, 0.9, 1.1);
  mesh.place(Transform::move({4.6, 0, kWidth - 0.55}) * Transform::turn_y(180));
  room::add_sofa(mesh, palette);
  mesh.place(Transform::move({kLength, 1.7, 3.2}) * Transform::turn_y(-90));
  room::add_painting(mesh, palette, 1.8, 1.2);
  // The door, behind the camera.
  mesh.place({});
  mesh.use(palette.table);
  mesh.box({kLength - 0.04, 0, 0.9}, {kLength, 2.1, 1.85});
  mesh.use(palette.brass);
  mesh.sphere({kLength - 0.09, 1.03, 1.75}, 0.035, mesh.segments(20, 6));
}

void add_furniture(MeshBuilder& mesh, const Palette& palette) {
  Sequence random(3);
  mesh.place(Transform::move({kTableX, 0.016, kTableZ}));
  room::add_table(mesh, palette);
  auto chair = [&](double x, double z, double turn) {
    mesh.place(Transform::move({x, 0.016, z}) * Transform::turn_y(turn + random.next(-13, 13)));
    room::add_chair(mesh, palette);
  };
  for (int i = 0; i < 5; ++i) {
    const double x = kTableX - 1.72 + 0.86 * i;
    chair(x, kTableZ - 0.98 - random.next(0, 0.16), 0);
    chair(x, kTableZ + 0.98 + random.next(0, 0.16), 180);
  }
  chair(kTableX - 2.85, kTableZ, 90);
  chair(kTableX + 2.95, kTableZ - 0.25, -70);

  for (int i = 0; i < 3; ++i) {
    mesh.place(Transform::move({kTableX - 1.5 + 1.5 * i, kHeight - 0.085, kTableZ}));
    room::add_pendant(mesh, palette, 0.24);
  }
  mesh.place(Transform::move({0.75, 0, 0.75}));
  room::add_plant(mesh, palette, 21, mesh.count(86, 12), 1.35, palette.terracotta);
  mesh.place(Transform::move({5.98, 0, 0.72}) * Transform::scale(0.9));
  room::add_plant(mesh, palette, 22, mesh.count(76, 12), 1.0, palette.ceramic);
  mesh.place(Transform::move({8.75, 0, 5.5}));
  room::add_plant(mesh, palette, 23, mesh.count(56, 12), 1.1, palette.ceramic);
  mesh.place(Transform::move({0.55, 0, 3.95}));
  room::add_floor_lamp(mesh, palette);
}

void add_tabletop(MeshBuilder& mesh, const Palette& palette) {
  const double top = 0.766;
  Sequence random(8);
  for (int i = 0; i < 5; ++i) {
    for (int side = 0; side < 2; ++side) {
      const double x = kTableX - 1.72 + 0.86 * i, outward = side == 0 ? -1 : 1, turn = side == 0 ? 180 : 0;
      mesh.place(Transform::move({x + outward * 0.24, top, kTableZ + outward * 0.38}) *
                 Transform::turn_y(random.next(0, 360)));
      room::add_cup(mesh, palette);
      mesh.place(Transform::move({x, top, kTableZ + outward * 0.50}) * Transform::turn_y(turn + random.next(-12, 12)));
      if ((i + side) % 2 == 0) {
        room::add_laptop(mesh, palette);
      } else {
        room::add_papers(mesh, palette, static_cast<uint64_t>(40 + 2 * i + side));
      }
    }
  }
  mesh.place(Transform::move({kTableX + 0.45, top + 0.003, kTableZ}));
  room::add_bowl(mesh, palette);
  for (double x : {-1.1, -0.92, 1.45}) {
    mesh.place(Transform::move({kTableX + x, top + 0.003, kTableZ + 0.03 * x}));
    room::add_carafe(mesh, palette);
  }
}

}  // namespace

Palette room::add_palette(MeshBuilder& mesh) {
  auto add = [&](const char* name, float r, float g, float b) {
    return mesh.add_material(name, {r, g, b}, {r / 2, g / 2, b / 2});
  };
  Palette p{};
  p.wall = add("wall", 0.62f, 0.575f, 0.49f);
  p.ceiling = add("ceiling", 0.62f, 0.61f, 0.58f);
  p.oak = add("oak", 0.46f, 0.29f, 0.15f);
  p.oak_dark = add("oak_dark", 0.40f, 0.24f, 0.12f);
  p.oak_light = add("oak_light", 0.53f, 0.35f, 0.20f);
  p.rug = add("rug", 0.13f, 0.20f, 0.31f);
  p.rug_border = add("rug_border", 0.55f, 0.46f, 0.32f);
  p.table = add("table", 0.42f, 0.20f, 0.085f);
  p.table_edge = add("table_edge", 0.10f, 0.06f, 0.04f);
  p.fabric = add("fabric", 0.64f, 0.24f, 0.07f);
  p.shell = add("shell", 0.11f, 0.11f, 0.12f);
  p.chrome = add("chrome", 0.66f, 0.67f, 0.69f);
  p.plastic = add("plastic", 0.05f, 0.05f, 0.055f);
  p.shelf = add("shelf", 0.52f, 0.36f, 0.21f);
  p.books[0] = add("book_red", 0.55f, 0.10f, 0.09f);
  p.books[1] = add("book_green", 0.13f, 0.34f, 0.22f);
  p.books[2] = add("book_blue", 0.12f, 0.24f, 0.48f);
  p.books[3] = add("book_cream", 0.80f, 0.74f, 0.60f);
  p.books[4] = add("book_mustard", 0.78f, 0.55f, 0.12f);
  p.leaf = add("leaf", 0.13f, 0.38f, 0.09f);
  p.leaf_light = add("leaf_light", 0.30f, 0.54f, 0.13f);
  p.soil = add("soil", 0.12f, 0.07f, 0.045f);
  p.ceramic = add("ceramic", 0.76f, 0.77f, 0.76f);
  p.terracotta = add("terracotta", 0.64f, 0.30f, 0.17f);
  p.brass = add("brass", 0.72f, 0.52f, 0.22f);
  p.glow = add("glow", 0.98f, 0.95f, 0.84f);
  p.curtain = add("curtain", 0.58f, 0.50f, 0.38f);
  p.sky = add("sky", 0.42f, 0.60f, 0.80f);
  p.frame = add("frame", 0.70f, 0.69f, 0.66f);
  p.screen = add("screen", 0.05f, 0.10f, 0.20f);
  p.paper = add("paper", 0.80f, 0.80f, 0.77f);
  p.silver = add("silver", 0.60f, 0.61f, 0.63f);
  p.porcelain = add("porcelain", 0.78f, 0.77f, 0.74f);
  p.bottle = add("bottle", 0.28f, 0.56f, 0.50f);
  p.sofa = add("sofa", 0.20f, 0.32f, 0.33f);
  p.accent = add("accent", 0.80f, 0.22f, 0.16f);
  return p;
}

Scene make_room(double detail) {
  Scene scene;
  scene.name = "room";
  MeshBuilder mesh(scene, detail);
  const Palette palette = room::add_palette(mesh);
  add_shell(mesh, palette);
  add_floor(mesh, palette);
  add_walls(mesh, palette);
  add_furniture(mesh, palette);
  add_tabletop(mesh, palette);
  scene.camera = {{8.75f, 1.92f, 5.05f}, {-5.5f, -1.15f, -2.6f}, {0, 1, 0}, 56};
  scene.light = {{7.3f, 2.35f, 4.1f}, {1.0f, 0.95f, 0.86f}};
  return scene;
}

}  // namespace raypool
