// Scenes at map coordinates: the same picture as near the origin, and everything reported in the file's coordinates.
#include "scene/far_places.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "scene/gltf_fixture.hpp"
#include "scene/obj_text.hpp"

namespace raypool {
namespace {

const Vec3d kMap = {448251, 36, 5411932};
/// A step of 1/256: what single precision holds near the origin, and not on the map.
const double kFine = 0x1p-8;

/// A pyramid above a floor, in a box of 4 around the origin.
const std::vector<Vec3d> kPlaces = {{-2, -2, -2},    {-2, -2, 2},        {2, -2, 2},  {2, -2, -2},
                                    {-1, -1, kFine}, {1, -1 + kFine, 1}, {1, -1, -1}, {kFine, 2, -kFine}};
const std::vector<std::array<uint32_t, 3>> kTriangles = {{0, 1, 2}, {0, 2, 3}, {4, 5, 7}, {5, 6, 7}, {6, 4, 7}};

std::string obj_at(const Vec3d& offset) {
  std::string text;
  for (const Vec3d& p : kPlaces) text += fmt::format("v {} {} {}\n", p.x + offset.x, p.y + offset.y, p.z + offset.z);
  for (const auto& t : kTriangles) text += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  return text;
}

std::string ply_at(const Vec3d& offset, const char* type) {
  std::string text = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty {} x\nproperty {} y\nproperty {} z\n"
      "element face {}\nproperty list uchar uint vertex_indices\nend_header\n",
      kPlaces.size(), type, type, type, kTriangles.size());
  for (const Vec3d& p : kPlaces) {
    for (int axis = 0; axis < 3; ++axis) {
      if (std::string(type) == "double") {
        append(text, p[axis] + offset[axis]);
      } else {
        append(text, static_cast<float>(p[axis] + offset[axis]));
      }
    }
  }
  for (const auto& t : kTriangles) {
    append(text, uint8_t{3});
    for (const uint32_t corner : t) append(text, corner);
  }
  return text;
}

/// The mesh is at its node, which is below one that turns z upwards. With a camera and a light.
std::string gltf_at(const Vec3d& offset) {
  GltfText document;
  std::vector<Vec3> positions;
  for (const Vec3d& p : kPlaces) positions.push_back(Vec3d{p.x, -p.z, p.y}.as<float>());
  std::vector<uint32_t> indices;
  for (const auto& t : kTriangles) indices.insert(indices.end(), t.begin(), t.end());
  const size_t position = document.add_positions(positions), index = document.add_indices(indices);
  Json& json = document.json;
  json["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", position}}}, {"indices", index}}}}}};
  json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}}}};
  json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
  const auto at = [&](double x, double y, double z) {
    return Json::array({offset.x + x, -offset.z - z, offset.y + y});
  };
  json["nodes"] = {
      {{"children", {1, 2, 3}}, {"matrix", {1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1}}},
      {{"mesh", 0}, {"translation", at(0, 0, 0)}},
      {{"camera", 0}, {"translation", at(0, kFine, 9)}, {"rotation", {0.7071067811865476, 0, 0, 0.7071067811865476}}},
      {{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}, {"translation", at(kFine, 6, 6)}}};
  json["scenes"] = {{{"nodes", {0}}}};
  return document.text();
}

class FarPlaces : public FileFixture {
 protected:
  SceneOptions seen_from(const Vec3d& offset) const {
    SceneOptions options;
    options.changes.eye = offset + Vec3d{1, 3 + kFine, 8};
    options.changes.look_at = offset + Vec3d{0, -kFine, 0};
    options.changes.light = offset + Vec3d{4, 7 + kFine, 5};
    return options;
  }
  void expect_same(const Scene& near, const Scene& far) {
    EXPECT_EQ(near.centre, Vec3d{});
    EXPECT_EQ(far.centre, kMap);
    EXPECT_EQ(corners_of(far), corners_of(near));
    EXPECT_EQ(far.camera.eye, near.camera.eye);
    EXPECT_EQ(far.camera.direction, near.camera.direction);
    EXPECT_EQ(far.light.position, near.light.position);
    EXPECT_EQ(far.warnings, std::vector<std::string>());
    EXPECT_EQ(picture_of(far), picture_of(near));
  }
};

TEST_F(FarPlaces, AnObjFileDrawsTheSameOnTheMap) {
  expect_same(load_scene(write("near.obj", obj_at({})), seen_from({})),
              load_scene(write("far.obj", obj_at(kMap)), seen_from(kMap)));
}

TEST_F(FarPlaces, APlyFileDrawsTheSameOnTheMap) {
  expect_same(load_scene(write("near.ply", ply_at({}, "double")), seen_from({})),
              load_scene(write("far.ply", ply_at(kMap, "double")), seen_from(kMap)));
}

TEST_F(FarPlaces, AGltfFileDrawsTheSameOnTheMapWithItsCameraAndLight) {
  const Scene near = load_scene(write("near.gltf", gltf_at({}))), far = load_scene(write("far.gltf", gltf_at(kMap)));
  EXPECT_EQ(far.centre, kMap);
  EXPECT_EQ(corners_of(far), corners_of(near));
  EXPECT_EQ(far.camera.eye, near.camera.eye);
  EXPECT_EQ(far.light.position, near.light.position);
  EXPECT_EQ(picture_of(far), picture_of(near));
}

TEST_F(FarPlaces, AViewIsInTheFilesCoordinates) {
  const Scene scene = load_scene(write("far.obj", obj_at(kMap)), seen_from(kMap));
  const Json json = Json::parse(to_json(scene.view()));
  EXPECT_EQ(json["eye"].dump(), "[448252.0,39.0039062,5411940.0]");
  EXPECT_EQ(json["light"]["position"].dump(), "[448255.0,43.0039062,5411937.0]");
  SceneOptions options;
  options.view = write("view.json", to_json(scene.view()));
  const Scene again = load_scene(folder_ + "/far.obj", options);
  EXPECT_EQ(again.camera.eye, scene.camera.eye);
  EXPECT_EQ(again.light.position, scene.light.position);
  options.changes.look_at = Vec3d{448252, 39.0039062, 5411940};
  EXPECT_EQ(refusal([&] { load_scene(folder_ + "/far.obj", options); }),
            "the camera is to look at (448252, 39.0039062, 5411940), where its eye is: give another point (--look-at) "
            "or eye (--eye)");
  options = seen_from(kMap);
  options.changes.eye = Vec3d{-2e9, 0, 0};
  EXPECT_NE(refusal([&] { load_scene(folder_ + "/far.obj", options); }).find("eye is (-2000000000, 0, 0)"),
            std::string::npos);
}

TEST_F(FarPlaces, AViewsDecimalsAreThoseThatWereGiven) {
  SceneOptions options = seen_from(kMap);
  options.changes.eye = Vec3d{448254.1, 38.7, 5411937.3};
  const Scene scene = load_scene(write("far.obj", obj_at(kMap)), options);
  EXPECT_EQ(Json::parse(to_json(scene.view()))["eye"].dump(), "[448254.1,38.7,5411937.3]");
}

TEST_F(FarPlaces, AWrittenObjFileReadsBackBitForBit) {
  const Scene scene = load_obj(write("far.obj", obj_at(kMap + Vec3d{0.3, 0.1, 0.7})));
  write_obj(scene, folder_ + "/written.obj");
  const Scene back = load_obj(folder_ + "/written.obj");
  EXPECT_EQ(back.centre, scene.centre);
  EXPECT_EQ(corners_of(back), corners_of(scene));
}

TEST_F(FarPlaces, ASceneUpToSixteenDiagonalsAwayKeepsItsCoordinates) {
  const double diagonal = std::sqrt(48.0);
  const Scene near = load_obj(write("near.obj", obj_at({kFarDiagonals * diagonal - 2.01, 0, 0})));
  EXPECT_EQ(near.centre, Vec3d{});
  EXPECT_EQ(near.vertices[0].x, static_cast<float>(kFarDiagonals * diagonal - 4.01));
  const Scene far = load_obj(write("far.obj", obj_at({kFarDiagonals * diagonal - 1.99, 0, 0})));
  EXPECT_GT(far.centre.x, 100);
  EXPECT_EQ(far.centre.y, 0);
}

TEST_F(FarPlaces, ANumberRoundsAsItsTextDoes) {
  // Exactly the middle of two numbers of single precision, and by less than double can hold above and below it.
  for (const char* text :
       {"1.00000005960464477539062500", "1.00000005960464477539062501", "1.00000005960464477539062499",
        "-16777217.00000000000001", "0.1", "-0", "1e-46", "7.0064923216240853e-46", "3.5e38"}) {
    float single = 0;
    double number = 0;
    ASSERT_TRUE(read_float(text, single) && read_double(text, number)) << text;
    EXPECT_EQ(as_bits(static_cast<float>(number)), as_bits(single)) << text;
  }
}

TEST_F(FarPlaces, DetailThatIsLostIsTold) {
  // What is at the origin keeps the scene from being recentred.
  const std::string apart = obj_at(kMap * 4.0 + Vec3d{0.3, 0.1, 0.7}) + "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 9 10 11\n";
  EXPECT_EQ(warnings(load_obj(write("apart.obj", apart))),
            std::vector<std::string>{
                "apart.obj: single precision moves corners by up to 0.7 in the file's units, which 5 of 6 triangles "
                "are too small for: leave out what is far away from them"});
  const Scene stored = load_scene(write("far.ply", ply_at(kMap * 4.0, "float")));
  EXPECT_EQ(stored.centre.x, 4 * kMap.x);
  EXPECT_EQ(warnings(stored),
            std::vector<std::string>{
                "far.ply: single precision moves corners by up to 1 in the file's units, which 5 of 5 triangles are "
                "too small for: export the file with coordinates in double precision, or near its origin"});
}

}  // namespace
}  // namespace raypool
