// The automatic view and light, of models of the kinds that are brought. What is asked of each: the eye is outside what
// is solid, the object fills the picture, and hardly anything that is seen is black.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "scene/image.hpp"
#include "scene/mesh_builder.hpp"
#include "scene/native_renderer.hpp"
#include "scene/scene.hpp"
#include "scene/traversal.hpp"

namespace raypool {
namespace {

constexpr double kPi = 3.14159265358979323846;

struct Model {
  const char* name;
  double least_covered;  ///< share of the picture that shows the object
  /// Adds the object; what is added after it has returned is around it.
  std::function<void(MeshBuilder&)> object, around;
};

void ground(MeshBuilder& mesh, double half, double height = 0) {
  mesh.quad({-half, height, half}, {half, height, half}, {half, height, -half}, {-half, height, -half});
}

void cube(MeshBuilder& mesh) { mesh.box({-1, 0, -1}, {1, 2, 1}); }

/// A prism along z over a gable, with its underside.
void roof(MeshBuilder& mesh, double half_width, double half_depth, double eaves, double ridge) {
  const Vec3d a{-half_width, eaves, half_depth}, b{half_width, eaves, half_depth}, c{0, ridge, half_depth};
  const Vec3d back{0, 0, -2 * half_depth};
  mesh.triangle(a, b, c);
  mesh.triangle(b + back, a + back, c + back);
  mesh.quad(a + back, b + back, b, a);
  mesh.quad(b, b + back, c + back, c);
  mesh.quad(a + back, a, c, c + back);
}

void tree(MeshBuilder& mesh) {
  mesh.cylinder({0, 0, 0}, {0, 3, 0}, 0.3, 16);
  for (int i = 0; i < 7; ++i) {
    const double a = i * 2.4, height = 1.6 + 0.25 * i;
    mesh.cylinder({0, height, 0}, {1.6 * std::cos(a), height + 1, 1.6 * std::sin(a)}, 0.12, 10);
    mesh.cylinder({1.2 * std::cos(a), height + 0.5, 1.2 * std::sin(a)},
                  {1.7 * std::cos(a), height + 1.3, 1.7 * std::sin(a)}, 0.5, 12);
  }
}

/// A floor that turns up into a wall behind.
void backdrop(MeshBuilder& mesh) {
  mesh.surface(1, 24, false, false, [](double s, double t) {
    const double x = 60 * s - 30;
    if (t < 1.0 / 3) return Vec3d{x, 0, 20 - 90 * t};
    if (t > 2.0 / 3) return Vec3d{x, 10 + 60 * (t - 2.0 / 3), -20};
    const double a = (3 * t - 1) * kPi / 2;
    return Vec3d{x, 10 - 10 * std::cos(a), -10 - 10 * std::sin(a)};
  });
}

// NOLINTNEXTLINE(readability-function-size): a list
std::vector<Model> models() {
  const auto none = [](MeshBuilder&) {};
  return {
      {"two stacked cubes", 0.3,
       [](MeshBuilder& m) {
         m.box({0, 0, 0}, {1, 1, 1});
         m.box({0, 1, 0}, {1, 2, 1});
       },
       none},
      {"three stacked boxes of different sizes", 0.3,
       [](MeshBuilder& m) {
         m.box({-2, 0, -2}, {2, 2, 2});
         m.box({-1, 2, -1.5}, {1.5, 4, 1});
         m.box({-0.5, 4, -0.5}, {0.5, 5, 0.5});
       },
       none},
      {"boxes side by side", 0.25,
       [](MeshBuilder& m) {
         for (int i = 0; i < 4; ++i) m.box({2.0 * i, 0, 0}, {2.0 * i + 2, 2 + 0.7 * i, 2});
       },
       none},
      {"27 cubes that touch", 0.4,
       [](MeshBuilder& m) {
         for (int i = 0; i < 27; ++i) {
           const Vec3d lower{i % 3 * 1.0, i / 3 % 3 * 1.0, i / 9 * 1.0};
           m.box(lower, lower + Vec3d{1, 1, 1});
         }
       },
       none},
      {"27 cubes with gaps", 0.4,
       [](MeshBuilder& m) {
         for (int i = 0; i < 27; ++i) {
           const Vec3d lower{i % 3 * 1.0, i / 3 % 3 * 1.0, i / 9 * 1.0};
           m.box(lower, lower + Vec3d{0.96, 0.96, 0.96});
         }
       },
       none},
      {"boxes that overlap", 0.3,
       [](MeshBuilder& m) {
         m.box({0, 0, 0}, {4, 3, 4});
         m.box({3, 0.5, 1}, {6, 4, 3});
         m.box({1, 1, -2}, {2.5, 5, 2});
       },
       none},
      {"a ball with a core", 0.5,
       [](MeshBuilder& m) {
         m.sphere({0, 0, 0}, 2, 32);
         m.sphere({0.2, 0, 0}, 1, 24);
         m.box({-1.4, -0.3, -0.3}, {-1, 0.3, 0.3});
       },
       none},
      {"a table", 0.2,
       [](MeshBuilder& m) {
         m.box({0, 1, 0}, {3, 1.2, 2});
         for (const double x : {0.1, 2.7}) {
           for (const double z : {0.1, 1.7}) m.box({x, 0, z}, {x + 0.2, 1, z + 0.2});
         }
       },
       none},
      {"a table with legs that go through its top", 0.2,
       [](MeshBuilder& m) {
         m.box({0, 1, 0}, {3, 1.4, 2});
         for (const double x : {0.1, 2.6}) {
           for (const double z : {0.1, 1.6}) m.cylinder({x + 0.15, 0, z + 0.15}, {x + 0.15, 1.3, z + 0.15}, 0.15, 16);
         }
       },
       none},
      {"a house with eaves", 0.3,
       [](MeshBuilder& m) {
         m.box({-2, 0, -3}, {2, 3, 3});
         roof(m, 3, 4, 3, 5);
       },
       none},
      {"a house under a flat roof", 0.2,
       [](MeshBuilder& m) {
         m.box({0, 0, 0}, {5, 3, 4});
         m.box({-2, 3, -2}, {7, 3.2, 6});
         m.box({2, 0, 3.9}, {3, 2, 4.1});
       },
       none},
      {"a tree of cylinders", 0.1, tree, none},
      {"a bowl", 0.3,
       [](MeshBuilder& m) {
         m.lathe({{0.0, 0}, {0.8, 0}, {1.6, 0.5}, {2, 1.3}, {1.9, 1.3}, {1.5, 0.6}, {0.75, 0.1}, {0, 0.1}}, 40);
       },
       none},
      {"a thin sheet", 0.25,
       [](MeshBuilder& m) {
         m.quad({0, 0, 0}, {3, 0, 0}, {3, 2, 0}, {0, 2, 0});
       },
       none},
      {"a sheet that lies", 0.25, [](MeshBuilder& m) { ground(m, 3); }, none},
      {"a long stick", 0.02,
       [](MeshBuilder& m) {
         m.cylinder({0, 0, 0}, {20, 0, 0}, 0.2, 12);
       },
       none},
      {"a ring of columns", 0.1,
       [](MeshBuilder& m) {
         for (int i = 0; i < 12; ++i) {
           const double x = 5 * std::cos(i * kPi / 6), z = 5 * std::sin(i * kPi / 6);
           m.cylinder({x, 0, z}, {x, 4, z}, 0.4, 16);
           m.box({x - 0.6, 4, z - 0.6}, {x + 0.6, 4.4, z + 0.6});
         }
       },
       none},
      {"a heap of balls", 0.3,
       [](MeshBuilder& m) {
         for (int i = 0; i < 64; ++i) m.sphere({i % 4 * 2.1, i / 4 % 4 * 2.1, i / 16 * 2.1}, 1, 12);
       },
       none},
      {"a cloud of leaves", 0.15,
       [](MeshBuilder& m) {
         Sequence random(7);
         for (int i = 0; i < 1500; ++i) {
           const Vec3d p{random.next(-1, 1), random.next(-1, 1), random.next(-1, 1)};
           if (length(p) > 1) continue;
           const Vec3d a{random.next(-0.1, 0.1), random.next(-0.1, 0.1), random.next(-0.1, 0.1)};
           const Vec3d b{random.next(-0.1, 0.1), random.next(-0.1, 0.1), random.next(-0.1, 0.1)};
           m.quad(p, p + a, p + a + b, p + b);
         }
       },
       none},
      {"a cube on a huge plane", 0.25, cube, [](MeshBuilder& m) { ground(m, 1000); }},
      {"a cube on a plane ten times as wide", 0.25, cube, [](MeshBuilder& m) { ground(m, 10); }},
      {"a house on a slab of ground", 0.25,
       [](MeshBuilder& m) {
         m.box({-2, 0, -3}, {2, 3, 3});
         roof(m, 2.5, 3.5, 3, 5);
       },
       [](MeshBuilder& m) {
         m.box({-50, -1, -50}, {50, 0, 50});
       }},
      {"a table on tiles", 0.15,
       [](MeshBuilder& m) {
         m.box({-1.5, 1, -1}, {1.5, 1.2, 1});
         for (const double x : {-1.4, 1.2}) {
           for (const double z : {-0.9, 0.7}) m.box({x, 0, z}, {x + 0.2, 1, z + 0.2});
         }
       },
       [](MeshBuilder& m) {
         for (int i = 0; i < 400; ++i) {
           const double x = i % 20 * 2.0 - 20, z = i / 20 * 2.0 - 20;
           m.quad({x, 0, z + 1.9}, {x + 1.9, 0, z + 1.9}, {x + 1.9, 0, z}, {x, 0, z});
         }
       }},
      {"a tower that grows out of the ground's mesh", 0.1,
       [](MeshBuilder& m) {
         m.quad({-1, 0, 1}, {1, 0, 1}, {1, 4, 1}, {-1, 4, 1});
         m.quad({1, 0, 1}, {1, 0, -1}, {1, 4, -1}, {1, 4, 1});
         m.quad({1, 0, -1}, {-1, 0, -1}, {-1, 4, -1}, {1, 4, -1});
         m.quad({-1, 0, -1}, {-1, 0, 1}, {-1, 4, 1}, {-1, 4, -1});
         m.quad({-1, 4, 1}, {1, 4, 1}, {1, 4, -1}, {-1, 4, -1});
       },
       [](MeshBuilder& m) {
         for (int i = 0; i < 400; ++i) {
           if (i == 210) continue;  // under the tower
           const double x = i % 20 * 2.0 - 21, z = i / 20 * 2.0 - 21;
           m.quad({x, 0, z + 2}, {x + 2, 0, z + 2}, {x + 2, 0, z}, {x, 0, z});
         }
       }},
      {"a house among hills", 0.1,
       [](MeshBuilder& m) {
         m.box({-2, -1, -3}, {2, 3, 3});
         roof(m, 2.5, 3.5, 3, 5);
       },
       [](MeshBuilder& m) {
         m.surface(60, 60, false, false, [](double s, double t) {
           const double x = 200 * s - 100, z = 100 - 200 * t;
           return Vec3d{x, 2 * (std::cos(x / 12) * std::cos(z / 15) - 1), z};
         });
       }},
      {"a cube in a sky of six sides", 0.2, cube,
       [](MeshBuilder& m) {
         m.room({-40, -30, -40}, {40, 50, 40});
       }},
      {"a cube in a box that faces outwards", 0.2, cube,
       [](MeshBuilder& m) {
         m.box({-40, -30, -40}, {40, 50, 40});
       }},
      {"a cube on the ground under a round sky", 0.2, cube,
       [](MeshBuilder& m) {
         ground(m, 70);
         m.sphere({0, 0, 0}, 100, 40);
       }},
      {"a cube before a backdrop", 0.2, cube, backdrop},
      {"a cube, and a speck far away", 0.25, cube,
       [](MeshBuilder& m) {
         m.triangle({500, 40, 0}, {500.1, 40, 0}, {500, 40.1, 0});
       }},
      {"a cube before a wall", 0.2, cube,
       [](MeshBuilder& m) {
         ground(m, 20);
         m.quad({-20, 0, -6}, {20, 0, -6}, {20, 20, -6}, {-20, 20, -6});
       }},
  };
}

/// A scene with its automatic view.
struct Viewed {
  Scene scene;
  size_t object = 0;  ///< so many triangles are of the object
};

using Change = std::function<void(Scene&)>;

Viewed view_of(const std::function<void(MeshBuilder&)>& object, const std::function<void(MeshBuilder&)>& around,
               const Transform& place = {}, const Change& change = nullptr) {
  Viewed viewed;
  MeshBuilder mesh(viewed.scene, 1);
  mesh.add_material("grey", {0.5f, 0.5f, 0.5f}, {});
  mesh.place(place);
  object(mesh);
  viewed.object = viewed.scene.triangles.size();
  if (around) around(mesh);
  Scene changed = viewed.scene;
  if (change) change(changed);
  const View view = automatic_view(changed);
  viewed.scene.camera = view.camera;
  viewed.scene.light = view.light;
  return viewed;
}

/// How often the triangles wind around a point: 1 inside one closed solid, 0 outside all.
double winding(const Scene& scene, size_t triangles, const Vec3& point) {
  double angle = 0;
  for (size_t i = 0; i < triangles; ++i) {
    Vec3d p[3];
    for (int k = 0; k < 3; ++k) p[k] = scene.corner(i, k).as<double>() - point.as<double>();
    const double a = length(p[0]), b = length(p[1]), c = length(p[2]);
    angle += 2 * std::atan2(dot(p[0], cross(p[1], p[2])),
                            a * b * c + dot(p[0], p[1]) * c + dot(p[1], p[2]) * a + dot(p[2], p[0]) * b);
  }
  return angle / (4 * kPi);
}

struct Drawn {
  double object = 0;  ///< share of the pixels
  double seen = 0;    ///< anything at all
  double black = 0;   ///< of these
};

/// By the kernels, and the eye rays again to know what they hit.
Drawn drawn(const Viewed& viewed, uint32_t width, uint32_t height) {
  const Scene& scene = viewed.scene;
  const MemoryImage image = build_memory(ray_kernel_program(), scene);
  const Tracer tracer(scene, image.material_base);
  NativeOptions options;
  options.width = width;
  options.height = height;
  options.depth = 1;
  NativeStatistics statistics;
  uint64_t of_object = 0;
  options.trace = [&](const Ray& ray, Intersection& intersection) {
    Hit hit;
    if ((ray[word::kFlags] & kShadowFlag) == 0 && tracer.traversal().nearest(to_query(ray), hit))
      of_object += hit.triangle < viewed.object;
    return tracer.trace(ray, intersection);
  };
  const std::vector<uint8_t> picture = to_rgb8(render_native(scene, image, tracer, options, &statistics));
  double lit = 0;
  for (size_t i = 0; i < picture.size(); i += 3) lit += picture[i] > 0 || picture[i + 1] > 0 || picture[i + 2] > 0;
  const RayCounts& rays = statistics.ray_counts;
  const auto pixels = static_cast<double>(rays.eye.traced), seen = pixels - static_cast<double>(rays.eye.ended);
  return {static_cast<double>(of_object) / pixels, seen / pixels, seen > 0 ? 1 - lit / seen : 1};
}

/// What every model must show, wherever it is and whatever its size.
void expect_shown(const Model& model, const Transform& place, const Change& change = nullptr) {
  SCOPED_TRACE(model.name);
  const Viewed viewed = view_of(model.object, model.around, place, change);
  EXPECT_LT(winding(viewed.scene, viewed.object, viewed.scene.camera.eye), 0.5) << "the eye is inside a solid";
  const Drawn square = drawn(viewed, 128, 128), wide = drawn(viewed, 192, 108);
  EXPECT_GT(square.object, model.least_covered) << "the object is small in the picture";
  EXPECT_LE(square.black, 0.1);
  EXPECT_LE(wide.black, 0.1) << "in a wide picture";
}

TEST(AutomaticView, ShowsModelsFromOutsideLargeAndLit) {
  for (const Model& model : models()) expect_shown(model, {});
}

TEST(AutomaticView, ShowsThemWhateverTheirSizePlaceAndTurn) {
  const std::vector<Model> all = models();
  for (size_t i = 0; i < all.size(); ++i) {
    const auto step = static_cast<double>(i);
    SCOPED_TRACE(i);
    expect_shown(all[i], Transform::move({300, -200 + 10 * step, 100}) * Transform::turn_y(37 + 50 * step));
    expect_shown(all[i], Transform::scale(i % 2 == 0 ? 1e-5 : 1e5) * Transform::turn_y(-20 * step));
  }
}

TEST(AutomaticView, ShowsSolidsFromOutsideWhicheverWayTheirTrianglesTurn) {
  const auto turn = [](const std::function<bool()>& turned) {
    return [turned](Scene& scene) {
      for (auto& triangle : scene.triangles) {
        if (turned()) std::swap(triangle[1], triangle[2]);
      }
    };
  };
  Sequence random(3);
  for (const Model& model : models()) {
    expect_shown(model, {}, turn([&] { return random.next(0, 1) < 0.5; }));
    // Turned round, what is one box is an empty corridor.
    if (std::string(model.name) != "a long stick") expect_shown(model, {}, turn([] { return true; }));
  }
}

TEST(AutomaticView, ShowsThemWhereNoTwoTrianglesShareAVertex) {
  for (const Model& model : models()) {
    expect_shown(model, {}, [](Scene& scene) {
      const std::vector<Vec3> vertices = std::exchange(scene.vertices, {});
      for (auto& triangle : scene.triangles) {
        for (uint32_t& index : triangle) {
          scene.vertices.push_back(vertices[index]);
          index = static_cast<uint32_t>(scene.vertices.size() - 1);
        }
      }
    });
  }
}

TEST(AutomaticView, ShowsModelsAtTheEndsOfSinglePrecision) {
  const Model model{"a cube", 0.25, cube, nullptr};
  for (const double size : {1e-38, 1e-30, 1e-12, 1e6, 3e8}) {
    SCOPED_TRACE(size);
    expect_shown(model, Transform::scale(size));
  }
}

TEST(AutomaticView, ShowsRoomsFromInside) {
  const auto furniture = [](MeshBuilder& m) {
    m.box({1, 0, 1}, {2.5, 0.8, 3});
    m.box({4, 0, 1}, {5, 1.8, 2});
    m.box({1.2, 0.8, 1.5}, {1.6, 1.1, 1.9});
  };
  struct Room {
    const char* name;
    std::function<void(MeshBuilder&)> walls;
    bool furnished;
  };
  const Room rooms[] = {
      {"walls that face inwards",
       [](MeshBuilder& m) {
         m.room({0, 0, 0}, {6, 3, 5});
       },
       true},
      {"walls that face outwards",
       [](MeshBuilder& m) {
         m.box({0, 0, 0}, {6, 3, 5});
       },
       true},
      {"thick walls",
       [](MeshBuilder& m) {
         m.room({0, 0, 0}, {6, 3, 5});
         m.box({-0.2, -0.2, -0.2}, {6.2, 3.2, 5.2});
       },
       true},
      {"thick walls and nothing inside",
       [](MeshBuilder& m) {
         m.room({0, 0, 0}, {6, 3, 5});
         m.box({-0.1, -0.1, -0.1}, {6.1, 3.1, 5.1});
       },
       false},
      {"walls of one piece each",
       [](MeshBuilder& m) {
         m.box({-0.2, -0.2, -0.2}, {6.2, 0, 5.2});
         m.box({-0.2, 3, -0.2}, {6.2, 3.2, 5.2});
         m.box({-0.2, 0, -0.2}, {0, 3, 5.2});
         m.box({6, 0, -0.2}, {6.2, 3, 5.2});
         m.box({0, 0, -0.2}, {6, 3, 0});
         m.box({0, 0, 5}, {6, 3, 5.2});
       },
       true},
  };
  for (const Room& room : rooms) {
    SCOPED_TRACE(room.name);
    const Viewed viewed = view_of(
        room.furnished ? furniture : [](MeshBuilder&) {}, room.walls);
    const Vec3 eye = viewed.scene.camera.eye;
    EXPECT_TRUE(eye.x > 0 && eye.y > 0 && eye.z > 0 && eye.x < 6 && eye.y < 3 && eye.z < 5);
    EXPECT_LT(winding(viewed.scene, viewed.object, eye), 0.5) << "the eye is inside a piece of furniture";
    const Drawn picture = drawn(viewed, 128, 128);
    EXPECT_EQ(picture.seen, 1);
    EXPECT_LE(picture.black, 0.1);
    if (room.furnished) {
      EXPECT_GT(picture.object, 0.05);
    }
  }
}

TEST(AutomaticView, LightsWhatAGivenEyeSees) {
  for (const Model& model : models()) {
    SCOPED_TRACE(model.name);
    Viewed viewed = view_of(model.object, model.around);
    const Vec3d eye = viewed.scene.camera.eye.as<double>(), way = viewed.scene.camera.direction.as<double>();
    // From behind, or from above.
    for (const Vec3d& from : {eye + normalized(way) * (2 * length(eye)), Vec3d{1, 2 * length(eye) + 1, 2}}) {
      ViewChanges changes;
      changes.eye = from.as<float>();
      changes.look_at = Vec3{0, 1, 0};
      const View view = automatic_view(viewed.scene, changes);
      viewed.scene.camera = view.camera;
      viewed.scene.light = view.light;
      const Drawn picture = drawn(viewed, 96, 96);
      EXPECT_EQ(view.camera.eye, *changes.eye);
      if (picture.seen > 0.002) {
        EXPECT_LE(picture.black, 0.1);
      }
    }
  }
}

TEST(AutomaticView, LooksSomewhereWhereNoTriangleHasAnArea) {
  for (const float size : {0.0f, 3.0f}) {
    Scene scene;
    scene.vertices = {{5, 5, 5}, {5 + size, 5, 5}, {5 - size, 5, 5}};
    scene.triangles = {{0, 1, 2}};
    scene.triangle_materials = {0};
    scene.materials.emplace_back();
    const View view = automatic_view(scene);
    scene.camera = view.camera;
    scene.light = view.light;
    EXPECT_NO_THROW(check_scene(scene, "test"));
  }
}

}  // namespace
}  // namespace raypool
