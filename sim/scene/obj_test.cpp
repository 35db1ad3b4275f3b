#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "scene/scene.hpp"

namespace raypool {
namespace {

class Obj : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        ::testing::TempDir() + "raypool_obj_test_" + ::testing::UnitTest::GetInstance()->current_test_info()->name();
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& text) {
    std::ofstream(folder_ + "/" + name, std::ios::binary) << text;
    return folder_ + "/" + name;
  }
  Scene load(const std::string& text) { return load_obj(write("a.obj", text)); }
  /// The message without the folder's name; empty when the file is accepted.
  std::string error_of(const std::string& text) {
    try {
      load(text);
    } catch (const InputError& error) {
      const std::string message = error.what();
      return message.rfind(folder_ + "/", 0) == 0 ? message.substr(folder_.size() + 1) : message;
    }
    return "";
  }
  void expect_error(const std::string& text, const std::string& start, const std::string& part) {
    const std::string message = error_of(text);
    EXPECT_EQ(message.rfind(start, 0), 0u) << message;
    EXPECT_NE(message.find(part), std::string::npos) << message;
  }

  std::string folder_;
};

const std::string kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

TEST_F(Obj, WrittenSceneReadsBackBitForBit) {
  for (const char* name : {"room", "cornell"}) {
    SceneOptions options;
    options.detail = 0.05;
    const Scene scene = load_scene(name, options);
    const std::string path = folder_ + "/my scene.obj";
    write_obj(scene, path);
    const Scene back = load_obj(path);
    EXPECT_EQ(back.triangles, scene.triangles);
    EXPECT_TRUE(back.vertices.size() == scene.vertices.size() &&
                std::equal(back.vertices.begin(), back.vertices.end(), scene.vertices.begin()));
    EXPECT_EQ(back.triangle_materials, scene.triangle_materials);
    ASSERT_EQ(back.materials.size(), scene.materials.size());
    for (size_t i = 0; i < back.materials.size(); ++i) {
      EXPECT_EQ(back.materials[i].name, scene.materials[i].name);
      EXPECT_EQ(back.materials[i].kd, scene.materials[i].kd);
      EXPECT_EQ(back.materials[i].ks, scene.materials[i].ks);
    }
  }
}

TEST_F(Obj, PolygonsBecomeTriangles) {
  EXPECT_EQ(load("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n").triangles.size(), 2u);
  EXPECT_EQ(load("v 0 0 0\nv 2 0 0\nv 3 1 0\nv 1 3 0\nv -1 1 0\nf 1 2 3 4 5\n").triangles.size(), 3u);
}

TEST_F(Obj, FacesThatCannotBeDrawnAsTheyAreAreNamed) {
  const std::string corners = "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 2 1 0\nv 0 4 0\nv 4 4 3\n";
  EXPECT_EQ(load(corners + "f 3 4 5 1 2\nf 1 2 3 5\n").warnings, std::vector<std::string>());
  const auto warnings = load(corners + "f 1 2 3\nf 1 3 2 5\nf 1 2 6 5\nf 1 -5 6 5\nf 1 2 2 1\n").warnings;
  ASSERT_EQ(warnings.size(), 3u);
  EXPECT_NE(warnings[0].find("a.obj:9: the face (as do 1 more) is not flat"), std::string::npos) << warnings[0];
  EXPECT_NE(warnings[1].find("a.obj:11: the face has no area"), std::string::npos) << warnings[1];
  EXPECT_NE(warnings[2].find("a.obj:8: the face crosses itself"), std::string::npos) << warnings[2];
}

TEST_F(Obj, FacesKeepTheirMaterialsWhateverTheirCorners) {
  write("m.mtl", "newmtl a\nnewmtl b\n");
  const Scene scene = load(
      "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nusemtl b\nf 1 2 3 4\no x\nf 1 2 3\nusemtl a\ng y\nf -4 -3 -2 "
      "-1\n");
  EXPECT_EQ(scene.triangle_materials, (std::vector<uint32_t>{1, 1, 1, 0, 0}));
  EXPECT_EQ(scene.triangles[2], (std::array<uint32_t, 3>{0, 1, 2}));
}

TEST_F(Obj, AcceptsWindowsLinesRelativeIndicesAndEverySlashForm) {
  const Scene scene = load("# text\r\n" + kTriangle +
                           "vt 0 0\nvn 0 0 1\r\nf -3 -2 -1\r\nf 1/1 2/1 3/1\nf 1//1 2//1 3//1\nf 1/1/1 2/1/1 3/1/1");
  EXPECT_EQ(scene.triangles.size(), 4u);
  for (const auto& triangle : scene.triangles) EXPECT_EQ(triangle, (std::array<uint32_t, 3>{0, 1, 2}));
}

TEST_F(Obj, FacesWithoutMaterialAreGrey) {
  write("m.mtl", "newmtl shiny\nKd 0.1 0.2 0.3\nKs 0.4 0.5 0.6\n");
  const Scene scene = load("mtllib m.mtl\n" + kTriangle + "f 1 2 3\nusemtl shiny\nf 1 2 3\nusemtl unknown\nf 1 2 3\n");
  ASSERT_EQ(scene.triangles.size(), 3u);
  auto material = [&](size_t triangle) { return scene.materials[scene.triangle_materials[triangle]]; };
  EXPECT_EQ(material(0).kd, (Vec3{0.5f, 0.5f, 0.5f}));
  EXPECT_EQ(material(1).kd, (Vec3{0.1f, 0.2f, 0.3f}));
  EXPECT_EQ(material(1).ks, (Vec3{0.4f, 0.5f, 0.6f}));
  EXPECT_EQ(material(2).name, "default_grey");
}

TEST_F(Obj, DegenerateTrianglesAreKept) {
  const Scene scene = load(kTriangle + "v 2 0 0\nf 1 2 3\nf 1 2 4\nf 1 1 2\n");
  ASSERT_EQ(scene.triangles.size(), 3u);
  EXPECT_FALSE(is_degenerate(scene, 0));
  EXPECT_TRUE(is_degenerate(scene, 1));
  EXPECT_TRUE(is_degenerate(scene, 2));
}

TEST_F(Obj, ErrorsNameFileAndLine) {
  expect_error("v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n", "a.obj:2:", "nan");
  expect_error("v 0 0 0\nv 0 1 0\n\nv inf 0 0\nf 1 2 3\n", "a.obj:4:", "inf");
  expect_error("v 0 0 1e999\nf 1 1 1\n", "a.obj:1:", "1e999");
  expect_error("v 0 0 1e12\nf 1 1 1\n", "a.obj:1:", "rescale");
  expect_error("v 0 0 abc\nf 1 1 1\n", "a.obj:1:", "abc");
  expect_error("v 0 0\nf 1 1 1\n", "a.obj:1:", "three");
  expect_error(kTriangle + "f 1 2 9\n", "a.obj:4:", "9");
  expect_error(kTriangle + "f 1 2 0\n", "a.obj:4:", "0");
  expect_error(kTriangle + "f 1 2 -4\n", "a.obj:4:", "-4");
  expect_error(kTriangle + "f 1 2 x\n", "a.obj:4:", "x");
  expect_error(kTriangle + "f 1 2\n", "a.obj:4:", "at least three");
  expect_error(kTriangle, "a.obj:", "no faces");
  expect_error("", "a.obj:", "no faces");
  EXPECT_EQ(error_of(kTriangle + "v 1e-60 +1.5 -0\nf 1 2 3 # text\n"), "");
}

TEST_F(Obj, ErrorsInMaterialsNameFileAndLine) {
  write("m.mtl", "newmtl a\nKd 0.1 0.2\n");
  expect_error("mtllib m.mtl\n" + kTriangle + "f 1 2 3\n", "m.mtl:2:", "three");
  write("m.mtl", "newmtl a\nKs 0.1 nan 0.1\n");
  expect_error("mtllib m.mtl\n" + kTriangle + "f 1 2 3\n", "m.mtl:2:", "nan");
}

TEST_F(Obj, MissingFilesAndFoldersAreInputErrors) {
  EXPECT_THROW(load_scene(folder_ + "/none.obj"), InputError);
  EXPECT_THROW(load_scene(folder_), InputError);
  EXPECT_THROW(write_obj(load(kTriangle + "f 1 2 3\n"), folder_ + "/none/a.obj"), InputError);
}

}  // namespace
}  // namespace raypool
