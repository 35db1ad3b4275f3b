#include "scene/scene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "bits.hpp"
#include "scene/mesh_builder.hpp"
#include "scene/native_renderer.hpp"
#include "scene/traversal.hpp"

namespace raypool {
namespace {

bool inside(const Vec3& p, const Bounds& b) {
  return p.x > b.lower.x && p.x < b.upper.x && p.y > b.lower.y && p.y < b.upper.y && p.z > b.lower.z && p.z < b.upper.z;
}

/// Rays in all directions from eye and light hit something.
int count_leaks(const Scene& scene) {
  const Traversal traversal(scene);
  Sequence random(1);
  int leaks = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3d d{random.next(-1, 1), random.next(-1, 1), random.next(-1, 1)};
    Hit hit;
    leaks += !traversal.nearest({i % 2 == 0 ? scene.camera.eye : scene.light.position, d.as<float>(), INFINITY}, hit);
  }
  return leaks;
}

TEST(BuiltInScenes, RoomHasTheSizeOfTheConferenceRoom) {
  const Scene room = load_scene("room");
  EXPECT_NEAR(static_cast<double>(room.triangles.size()), 331000, 3310);
  EXPECT_EQ(room.materials.size(), 36u);
  std::vector<size_t> uses(36);
  for (uint32_t material : room.triangle_materials) ++uses.at(material);
  for (size_t i = 0; i < uses.size(); ++i) EXPECT_GT(uses[i], 0u) << room.materials[i].name;
  for (const Material& material : room.materials) EXPECT_EQ(material.ks, material.kd * 0.5f) << material.name;
}

TEST(BuiltInScenes, AreClosedWithCameraAndLightInside) {
  for (const char* name : {"cornell", "room"}) {
    SceneOptions options;
    options.detail = 0.1;
    const Scene scene = load_scene(name, options);
    EXPECT_TRUE(inside(scene.camera.eye, scene.bounds())) << name;
    EXPECT_TRUE(inside(scene.light.position, scene.bounds())) << name;
    EXPECT_EQ(count_leaks(scene), 0) << name;
  }
}

TEST(BuiltInScenes, NothingSticksThroughTheWallsOfTheRoom) {
  const Bounds bounds = make_room(1).bounds();
  EXPECT_EQ(bounds.lower, (Vec3{0, -0.02f, 0}));
  EXPECT_EQ(bounds.upper, (Vec3{9.6f, 3.1f, 6.4f}));
}

TEST(BuiltInScenes, AreTheSameEveryTimeAndScaleWithDetail) {
  const Scene a = make_room(0.2), b = make_room(0.2), half = make_room(0.5), full = make_room(1);
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_TRUE(a.vertices.size() == b.vertices.size() &&
              std::equal(a.vertices.begin(), a.vertices.end(), b.vertices.begin()));
  EXPECT_LT(a.triangles.size(), half.triangles.size());
  EXPECT_NEAR(static_cast<double>(half.triangles.size()) / full.triangles.size(), 0.5, 0.08);
  SceneOptions options;
  for (double bad : {0.0, -1.0, 100.0, std::nan("")}) {
    options.detail = bad;
    EXPECT_THROW(load_scene("room", options), InputError) << bad;
  }
}

double signed_volume(const Scene& scene) {
  double volume = 0;
  for (size_t i = 0; i < scene.triangles.size(); ++i) {
    volume +=
        dot(scene.corner(i, 0).as<double>(), cross(scene.corner(i, 1).as<double>(), scene.corner(i, 2).as<double>())) /
        6;
  }
  return volume;
}

TEST(MeshBuilder, ClosedShapesHaveTheirVolumeAndLookOutwards) {
  const double pi = 3.14159265358979;
  auto volume = [](const std::function<void(MeshBuilder&)>& add) {
    Scene scene;
    MeshBuilder mesh(scene, 1);
    mesh.place(Transform::move({3, 4, 5}) * Transform::turn_y(30) * Transform::turn_x(20));
    add(mesh);
    return signed_volume(scene);
  };
  EXPECT_NEAR(volume([](MeshBuilder& m) { m.box({0, 0, 0}, {1, 2, 3}); }), 6, 1e-4);
  EXPECT_NEAR(volume([](MeshBuilder& m) { m.room({0, 0, 0}, {1, 2, 3}); }), -6, 1e-4);
  EXPECT_NEAR(volume([](MeshBuilder& m) { m.sphere({0, 0, 0}, 1, 96); }), 4 * pi / 3, 0.02);
  EXPECT_NEAR(volume([](MeshBuilder& m) { m.cylinder({0, 0, 0}, {0, 2, 0}, 0.5, 96); }), pi / 2, 0.01);
  EXPECT_NEAR(volume([](MeshBuilder& m) { m.lathe({{0, 0}, {1, 0}, {0, 1}}, 96); }), pi / 3, 0.01);
  EXPECT_NEAR(volume([](MeshBuilder& m) { m.plate({0, 0, 0}, {1, 0.1, 2}, 1, 96, 8); }), 0.2 * 2 * pi, 0.06);
  EXPECT_NEAR(volume([](MeshBuilder& m) {
                m.tube([](double s) { return Vec3d{3 * s, 0, 0}; }, 0.2, 8, 96);
              }),
              0.36 * pi / 3 + 0.01, 0.05);
  const double ring = volume([&](MeshBuilder& m) {
    m.tube([&](double s) { return Vec3d{std::cos(2 * pi * s), 0, std::sin(2 * pi * s)}; }, 0.1, 96, 48, true);
  });
  EXPECT_NEAR(ring, 2 * pi * pi * 0.01, 0.003);
}

TEST(MeshBuilder, AClosedTubeJoinsWithoutATwist) {
  // A knot turns the frame that is carried along it: no edge may be longer than those of a straight tube by much.
  Scene scene;
  MeshBuilder mesh(scene, 1);
  const int along = 400, around = 16;
  mesh.tube(
      [](double s) {
        const double a = 2 * 3.14159265358979 * s, r = 0.5 + 0.22 * std::cos(3 * a);
        return Vec3d{r * std::cos(2 * a), r * std::sin(2 * a), 0.2 * std::sin(3 * a)};
      },
      0.1, along, around, true);
  double longest = 0;
  for (size_t i = 0; i < scene.triangles.size(); ++i)
    longest = std::max(longest, double{length(scene.corner(i, 0) - scene.corner(i, 1))});
  EXPECT_EQ(scene.triangles.size(), 2u * along * around);
  EXPECT_LT(longest, 2 * 3.14159265 * 0.1 / around * 1.6);
}

TEST(Indices, OutsideTheSceneAreRefused) {
  Scene scene = make_cornell(0.05);
  EXPECT_NO_THROW(check_scene(scene, "test"));
  scene.triangles[3][1] = size32(scene.vertices);
  EXPECT_THROW(check_scene(scene, "test"), InputError);
  scene = make_cornell(0.05);
  scene.triangle_materials[2] = 99;
  EXPECT_THROW(check_scene(scene, "test"), InputError);
  scene = make_cornell(0.05);
  scene.vertices[1].y = std::nanf("");
  EXPECT_THROW(check_scene(scene, "test"), InputError);
}

TEST(AutomaticView, LooksFromInsideARoomAndFromOutsideAtAnObject) {
  Scene scene = make_room(0.05);
  View view = automatic_view(scene);
  EXPECT_TRUE(inside(view.camera.eye, scene.bounds()));
  EXPECT_TRUE(inside(view.light.position, scene.bounds()));

  Scene ball;
  MeshBuilder mesh(ball, 1);
  mesh.add_material("grey", {0.5f, 0.5f, 0.5f}, {});
  mesh.sphere({100, 50, -20}, 7, 40);
  view = automatic_view(ball);
  EXPECT_FALSE(inside(view.camera.eye, ball.bounds()));
  // The whole sphere is in the picture and fills much of it.
  const Vec3d to_centre = Vec3d{100, 50, -20} - view.camera.eye.as<double>();
  const double angle = std::asin(7 / length(to_centre)) * 180 / 3.14159265358979;
  EXPECT_LT(angle, view.camera.fov * 0.5);
  EXPECT_GT(angle, view.camera.fov * 0.25);
  EXPECT_NEAR(dot(normalized(to_centre), normalized(view.camera.direction.as<double>())), 1, 1e-6);

  Scene block;  // walls close its box, but nothing is inside
  MeshBuilder block_mesh(block, 1);
  block_mesh.add_material("grey", {0.5f, 0.5f, 0.5f}, {});
  block_mesh.box({0, 0, 0}, {1, 1, 1});
  EXPECT_FALSE(inside(automatic_view(block).camera.eye, block.bounds()));
}

/// What the view shows of the scene at 48 x 48.
NativeStatistics drawn(Scene& scene, const ViewChanges& changes, FrameBuffer& frame) {
  const View view = automatic_view(scene, changes);
  scene.camera = view.camera;
  scene.light = view.light;
  check_scene(scene, "test");
  const MemoryImage image = build_memory(ray_kernel_program(), scene);
  NativeOptions options;
  options.width = options.height = 48;
  NativeStatistics statistics;
  frame = render_native(scene, image, Tracer(scene, image.material_base), options, &statistics);
  return statistics;
}

TEST(AutomaticView, ShowsLitSurfacesOfWhateverThereIs) {
  struct Case {
    const char* name;
    bool from_inside;
    void (*make)(MeshBuilder&);
  };
  const Case cases[] = {
      {"a triangle", false,
       [](MeshBuilder& m) {
         m.triangle({-1, -1, 0}, {1, -1, 0}, {0, 1, 0});
       }},
      {"its back", false,
       [](MeshBuilder& m) {
         m.triangle({-1, -1, 0}, {0, 1, 0}, {1, -1, 0});
       }},
      {"a ball on a floor", false,
       [](MeshBuilder& m) {
         m.sphere({0, 1, 0}, 1, 30);
         m.quad({-4, 0, 4}, {4, 0, 4}, {4, 0, -4}, {-4, 0, -4});
       }},
      {"a room with a box in it", true,
       [](MeshBuilder& m) {
         m.room({0, 0, 0}, {6, 3, 5});
         m.box({1, 0, 1}, {2, 0.9, 3});
       }},
      {"the same with walls that face outwards", true,
       [](MeshBuilder& m) {
         m.box({0, 0, 0}, {6, 3, 5});
         m.box({1, 0, 1}, {3, 1.6, 3});
       }},
      {"an empty room", true,
       [](MeshBuilder& m) {
         m.room({0, 0, 0}, {6, 3, 5});
       }},
      {"a corridor", true,
       [](MeshBuilder& m) {
         m.room({0, 0, 0}, {2, 2.4, 28});
         for (double z = 3.5; z < 25; z += 3.5) m.box({0, 0, z}, {0.25, 2.4, z + 0.2});
       }},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.name);
    Scene scene;
    MeshBuilder mesh(scene, 1);
    mesh.add_material("grey", {0.5f, 0.5f, 0.5f}, {});
    c.make(mesh);
    FrameBuffer frame(48, 48);
    const RayCounts rays = drawn(scene, {}, frame).ray_counts;
    EXPECT_EQ(inside(scene.camera.eye, scene.bounds()), c.from_inside);
    EXPECT_LT(rays.eye.ended, rays.eye.traced * (c.from_inside ? 1 : 8) / 10) << "nothing to be seen";
    EXPECT_LT(rays.shadow.futile, rays.shadow.traced / 2) << "most of it in the dark";
    const View again = automatic_view(scene);
    EXPECT_EQ(again.camera.eye, scene.camera.eye);
    EXPECT_EQ(again.light.position, scene.light.position);
  }
}

TEST(AutomaticView, KeepsWhatIsGivenAndChoosesTheRest) {
  Scene room = make_room(0.05);
  FrameBuffer frame(48, 48);
  ViewChanges changes;
  changes.eye = Vec3{1, 1.6f, 1};
  RayCounts rays = drawn(room, changes, frame).ray_counts;
  EXPECT_EQ(room.camera.eye, *changes.eye);
  EXPECT_LT(rays.shadow.futile, rays.shadow.traced / 2);
  changes.look_at = Vec3{5, 1, 3};
  changes.fov = 75.0f;
  changes.light = Vec3{4, 2.5f, 3};
  changes.up = Vec3{0, 0, 1};
  rays = drawn(room, changes, frame).ray_counts;
  EXPECT_EQ(room.camera.direction, (Vec3{4, -0.6f, 2}));
  EXPECT_EQ(room.camera.fov, 75);
  EXPECT_EQ(room.camera.up, *changes.up);
  EXPECT_EQ(room.light.position, *changes.light);
  changes.look_at = changes.eye;
  EXPECT_THROW(automatic_view(room, changes), InputError);
}

class ViewFile : public ::testing::Test {
 protected:
  // Tests may run side by side: each has its own file.
  std::string path_ = ::testing::TempDir() + "raypool_view_test_" +
                      ::testing::UnitTest::GetInstance()->current_test_info()->name() + ".json";
  void TearDown() override { std::filesystem::remove(path_); }
  std::string error_of(const std::string& text) {
    std::ofstream(path_) << text;
    try {
      load_view(path_);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
};

TEST_F(ViewFile, OfTheConferenceRoomHasThePublishedValues) {
  const View view = load_view("configs/views/conference.json");
  EXPECT_EQ(view.camera.eye, (Vec3{1610, 356, -322}));
  EXPECT_EQ(view.camera.direction, (Vec3{-1, -0.15f, 0.05f}));
  EXPECT_EQ(view.camera.up, (Vec3{0, 1, 0}));
  EXPECT_EQ(view.camera.fov, 60);
  EXPECT_EQ(view.light.position, (Vec3{350, 600, -200}));
  EXPECT_EQ(view.light.color, (Vec3{1, 1, 1}));
}

TEST_F(ViewFile, ReadsBackWhatWasWritten) {
  const Scene scene = make_room(0.02);
  write_view(scene.view(), path_);
  const View view = load_view(path_);
  EXPECT_EQ(view.camera.eye, scene.camera.eye);
  EXPECT_EQ(view.camera.direction, scene.camera.direction);
  EXPECT_EQ(view.camera.fov, scene.camera.fov);
  EXPECT_EQ(view.light.color, scene.light.color);
}

TEST_F(ViewFile, ErrorsNameTheKey) {
  const std::string light = R"("light": {"position": [0, 1, 0]})";
  EXPECT_EQ(error_of("{\"eye\": [0, 0, 0], \"target\": [0, 0, -1], " + light + "}"), "");
  EXPECT_NE(error_of("{\"eye\": [0, 0, 0], \"target\": [0, 0, 0], " + light + "}").find("direction"),
            std::string::npos);
  EXPECT_NE(error_of("{\"eye\": [0, 0], \"target\": [0, 0, -1], " + light + "}").find("eye"), std::string::npos);
  EXPECT_NE(error_of("{\"eye\": [0, 0, 1e30], \"target\": [0, 0, -1], " + light + "}").find("eye[2]"),
            std::string::npos);
  EXPECT_NE(error_of("{\"eye\": [0, 0, 0], \"direction\": [0, 2, 0], " + light + "}").find("parallel"),
            std::string::npos);
  EXPECT_NE(error_of("{\"eye\": [0, 0, 0], \"direction\": [0, 0, 1], \"fov\": 180, " + light + "}").find("fov"),
            std::string::npos);
  EXPECT_NE(error_of("{\"eye\": [0, 0, 0], \"direction\": [0, 0, 1], \"fow\": 60, " + light + "}").find("fow"),
            std::string::npos);
  EXPECT_NE(error_of("{\"eye\": [0, 0, 0], \"direction\": [0, 0, 1]}").find("light"), std::string::npos);
  EXPECT_NE(error_of("{\"eye\": [0, 0, 0],").find("JSON"), std::string::npos);
  EXPECT_THROW(load_view("no/such/view.json"), InputError);
}

TEST(AutomaticView, AScaledSceneHasTheScaledView) {
  const std::string path = testing::TempDir() + "raypool_scaled.obj";
  const Scene cube = load_scene("cornell", {0.05, "", {}, ""});
  for (const float scale : {1.0f, 1e-5f, 1e-8f, 1e-12f}) {
    Scene scaled = cube;
    for (Vec3& vertex : scaled.vertices) vertex = (vertex.as<double>() * static_cast<double>(scale)).as<float>();
    write_obj(scaled, path);
    const Scene read = load_scene(path);
    EXPECT_EQ(read.warnings, std::vector<std::string>()) << scale;
    const double seen = length(read.camera.eye.as<double>()) / static_cast<double>(scale);
    EXPECT_GT(seen, 1) << scale;
    EXPECT_LT(seen, 100) << scale;
  }
  std::filesystem::remove(path);
}

TEST(Scene, ASceneThatIsTooSmallForItsNumbersIsTold) {
  const std::string path = testing::TempDir() + "raypool_tiny.obj";
  std::ofstream(path) << "v 0 0 0\nv 1e-30 0 0\nv 0 1e-30 0\nf 1 2 3\n";
  EXPECT_EQ(load_scene(path).warnings,
            std::vector<std::string>{path + ": all of it is 1.4e-30 across, too small for single precision: its "
                                            "shading is wrong; scale the file up"});
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace raypool
