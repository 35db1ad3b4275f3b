// What a glTF file's nodes make of their meshes: joints, targets, instances, numbers of every kind.
#include <fmt/format.h>

#include <cmath>

#include "scene/gltf_fixture.hpp"

namespace raypool {
namespace {

using Texts = std::vector<std::string>;

/// Numbers of any type, interleaved with `gap` bytes.
template <typename Number>
size_t add(GltfText& document, const std::vector<Number>& numbers, int component, size_t components, size_t gap = 0) {
  const size_t begin = document.bytes.size();
  for (size_t i = 0; i < numbers.size(); ++i) {
    append(document.bytes, numbers[i]);
    if (i % components == components - 1) document.bytes.append(gap, '\x55');
  }
  const char* type = components == 1 ? "SCALAR" : components == 3 ? "VEC3" : components == 4 ? "VEC4" : "MAT4";
  const size_t accessor = document.add_accessor(numbers.size() / components, component, type, begin);
  if (gap > 0) document.json["bufferViews"].back()["byteStride"] = components * sizeof(Number) + gap;
  return accessor;
}

size_t add_floats(GltfText& document, const std::vector<float>& numbers, size_t components) {
  return add(document, numbers, 5126, components);
}

/// Column by column.
std::vector<float> scale_and_move(float scale, const Vec3& move) {
  return {scale, 0, 0, 0, 0, scale, 0, 0, 0, 0, scale, 0, move.x, move.y, move.z, 1};
}

class GltfGeometryTest : public GltfFixture {
 protected:
  void expect_corners(const GltfText& document, const std::vector<Vec3>& wanted) const {
    const std::vector<Vec3> corners = corners_of(scene(document));
    ASSERT_EQ(corners.size(), wanted.size());
    for (size_t i = 0; i < wanted.size(); ++i) expect_near(corners[i], wanted[i]);
  }
  static Json& primitive(GltfText& document) { return document.json["meshes"][0]["primitives"][0]; }
};

TEST_F(GltfGeometryTest, PositionsMayBeQuantised) {
  const auto check = [&](auto numbers, int component, bool normalized, size_t gap, const std::vector<Vec3>& wanted) {
    GltfText document = gltf_triangle();
    const size_t accessor = add(document, numbers, component, 3, gap);
    document.json["accessors"][accessor]["normalized"] = normalized;
    primitive(document)["attributes"]["POSITION"] = accessor;
    document.json["extensionsRequired"] = {"KHR_mesh_quantization"};
    document.json["nodes"][0]["translation"] = {1, 0, 0};
    expect_corners(document, wanted);
  };
  check(std::vector<uint16_t>{0, 0, 0, 65535, 0, 0, 0, 13107, 0}, 5123, true, 2, {{1, 0, 0}, {2, 0, 0}, {1, 0.2f, 0}});
  check(std::vector<uint16_t>{0, 0, 0, 300, 0, 0, 0, 1, 0}, 5123, false, 0, {{1, 0, 0}, {301, 0, 0}, {1, 1, 0}});
  check(std::vector<int16_t>{-32768, 0, 0, 32767, 0, 0, 0, -32767, 0}, 5122, true, 2,
        {{0, 0, 0}, {2, 0, 0}, {1, -1, 0}});
  check(std::vector<int16_t>{-300, 0, 0, 7, 0, 0, 0, 1, 0}, 5122, false, 2, {{-299, 0, 0}, {8, 0, 0}, {1, 1, 0}});
  check(std::vector<int8_t>{-128, 0, 0, 127, 0, 0, 0, 127, 0}, 5120, true, 1, {{0, 0, 0}, {2, 0, 0}, {1, 1, 0}});
  check(std::vector<int8_t>{-5, 0, 0, 7, 0, 0, 0, 1, 0}, 5120, false, 1, {{-4, 0, 0}, {8, 0, 0}, {1, 1, 0}});
  check(std::vector<uint8_t>{0, 0, 0, 255, 0, 0, 0, 51, 0}, 5121, true, 1, {{1, 0, 0}, {2, 0, 0}, {1, 0.2f, 0}});
  check(std::vector<uint8_t>{0, 0, 0, 200, 0, 0, 0, 1, 0}, 5121, false, 0, {{1, 0, 0}, {201, 0, 0}, {1, 1, 0}});
}

/// Has an accessor replace elements.
void make_sparse(GltfText& document, size_t accessor, const std::vector<uint8_t>& places, size_t values) {
  const size_t indices = document.add_indices(places);
  const auto view = [&](size_t of) { return document.json["accessors"][of]["bufferView"]; };
  document.json["accessors"][accessor]["sparse"] = {
      {"count", places.size()},
      {"indices", {{"bufferView", view(indices)}, {"componentType", 5121}}},
      {"values", {{"bufferView", view(values)}}}};
}

TEST_F(GltfGeometryTest, SparseAccessorsReplaceElements) {
  GltfText document = gltf_triangle();
  make_sparse(document, 0, {1, 2}, document.add_positions({{7, 0, 0}, {0, 8, 0}}));
  expect_corners(document, {{0, 0, 0}, {7, 0, 0}, {0, 8, 0}});
  // Indices, too; and without a view all others are zero.
  GltfText other = gltf_triangle();
  make_sparse(other, 1, {1, 2}, other.add_indices(std::vector<uint16_t>{2, 1}));
  expect_corners(other, {{0, 0, 0}, {0, 1, 0}, {2, 0, 0}});
  GltfText zeros = gltf_triangle();
  zeros.json["accessors"][0].erase("bufferView");
  make_sparse(zeros, 0, {1, 2}, zeros.add_positions({{7, 0, 0}, {0, 8, 0}}));
  expect_corners(zeros, {{0, 0, 0}, {7, 0, 0}, {0, 8, 0}});
  zeros.json["accessors"][0]["sparse"]["indices"]["byteOffset"] = 1;
  expect_refusal(zeros, "accessors[0].sparse.indices needs 3 bytes of a view of 2");
  zeros.json["accessors"][0]["count"] = 2;
  zeros.json["accessors"][0]["sparse"]["indices"]["byteOffset"] = 0;
  expect_refusal(zeros, "accessors[0].sparse.indices has index 2, which is out of range: the accessor has 2 elements");
  zeros.json["accessors"][0]["count"] = 1e9;
  expect_refusal(zeros, "accessors[0].count is 1000000000");
}

TEST_F(GltfGeometryTest, MorphTargetsCountByTheirWeights) {
  GltfText document = gltf_triangle();
  const size_t up = document.add_positions({{0, 0, 0}, {0, 0, 0}, {0, 4, 0}});
  const size_t right = add(document, std::vector<int8_t>{1, 0, 0, 1, 0, 0, 1, 0, 0}, 5120, 3, 1);
  primitive(document)["targets"] = {{{"POSITION", up}}, {{"NORMAL", 99}}, {{"POSITION", right}}};
  document.json["meshes"][0]["weights"] = {0.5, 1, 0};
  const std::vector<Vec3> by_default = {{0, 0, 0}, {2, 0, 0}, {0, 3, 0}};
  expect_corners(document, by_default);
  EXPECT_EQ(warnings(scene(document)), Texts{});
  // Each node may have its own, or none: then they are the mesh's.
  document.json["nodes"] = {{{"mesh", 0}},
                            {{"mesh", 0}, {"weights", {0, 0, 2}}},
                            {{"mesh", 0}, {"weights", {0, 0, 0}}},
                            {{"mesh", 0}, {"weights", {-1, 0, 1}}}};
  std::vector<Vec3> wanted = by_default;
  for (const Vec3& p : std::vector<Vec3>{
           {2, 0, 0}, {4, 0, 0}, {2, 1, 0}, {0, 0, 0}, {2, 0, 0}, {0, 1, 0}, {1, 0, 0}, {3, 0, 0}, {1, -3, 0}})
    wanted.push_back(p);
  expect_corners(document, wanted);
  // A target that leaves most vertices where they are.
  GltfText sparse = gltf_triangle();
  const size_t moves = add_floats(sparse, std::vector<float>(9), 3);
  make_sparse(sparse, moves, {2}, sparse.add_positions({{0, 0, 5}}));
  sparse.json["accessors"][moves].erase("bufferView");
  primitive(sparse)["targets"] = {{{"POSITION", moves}}};
  sparse.json["nodes"][0]["weights"] = {1};
  expect_corners(sparse, {{0, 0, 0}, {2, 0, 0}, {0, 1, 5}});
  sparse.json["accessors"][moves]["count"] = 4;
  expect_refusal(sparse, "targets[0].POSITION has 4 elements for 3 vertices");
}

/// The triangle with a skin of two joints; its corners have the first, both, and the second.
GltfText with_skin() {
  GltfText document = gltf_triangle();
  const std::vector<uint8_t> joints = {0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0};
  const std::vector<float> weights = {1, 0, 0, 0, 0.25f, 0.75f, 0, 0, 1, 0, 0, 0};
  const size_t numbers = add(document, joints, 5121, 4), shares = add_floats(document, weights, 4);
  std::vector<float> inverse = scale_and_move(1, {0, 0, 0}), second = scale_and_move(0.5f, {0, -1, 0});
  inverse.insert(inverse.end(), second.begin(), second.end());
  Json& attributes = document.json["meshes"][0]["primitives"][0]["attributes"];
  attributes["JOINTS_0"] = numbers;
  attributes["WEIGHTS_0"] = shares;
  document.json["skins"] = {{{"joints", {2, 3}}, {"inverseBindMatrices", add_floats(document, inverse, 16)}}};
  // Neither the node's own place nor that of what is above it counts.
  document.json["nodes"] = {{{"children", {1}}, {"translation", {100, 0, 0}}},
                            {{"mesh", 0}, {"skin", 0}, {"scale", {5, 5, 5}}},
                            {{"children", {3}}, {"translation", {0, 10, 0}}},
                            {{"scale", {1, 4, 1}}, {"translation", {0, 0, 1}}}};
  document.json["scenes"] = {{{"nodes", {0, 2}}}};
  return document;
}

TEST_F(GltfGeometryTest, ASkinnedMeshStandsWhereItsJointsAre) {
  // By the first joint p + (0, 10, 0); by the second p/2 - (0, 1, 0), four times as high, + (0, 10, 1).
  const std::vector<Vec3> wanted = {{0, 10, 0}, {2 * 0.25f + 1 * 0.75f, 10 * 0.25f + 6 * 0.75f, 0.75f}, {0, 8, 1}};
  GltfText document = with_skin();
  expect_corners(document, wanted);
  EXPECT_EQ(warnings(scene(document)), Texts{});
  // Weights that do not add up to 1 are shares all the same, and those of whole numbers.
  GltfText shares = with_skin();
  primitive(shares)["attributes"]["WEIGHTS_0"] =
      add(shares, std::vector<uint8_t>{255, 0, 0, 0, 50, 150, 0, 0, 128, 0, 0, 0}, 5121, 4);
  shares.json["accessors"].back()["normalized"] = true;
  expect_corners(shares, wanted);
  // A vertex without any has the first joint; a second set adds to the first.
  GltfText none = with_skin();
  primitive(none)["attributes"]["WEIGHTS_0"] = add_floats(none, std::vector<float>(12), 4);
  expect_corners(none, {{0, 10, 0}, {2, 10, 0}, {0, 8, 1}});
  primitive(none)["attributes"]["JOINTS_1"] = primitive(none)["attributes"]["JOINTS_0"];
  primitive(none)["attributes"]["WEIGHTS_1"] = 3;
  expect_corners(none, wanted);
}

TEST_F(GltfGeometryTest, SkinsMayLackInverseMatricesAndHaveJointsOutsideOfTheScene) {
  GltfText document = with_skin();
  document.json["skins"][0].erase("inverseBindMatrices");
  document.json["scenes"] = {{{"nodes", {0}}}};
  const Vec3 second{0, 14, 1};
  expect_corners(document, {{0, 10, 0}, {2, 10, 0.75f}, second});
}

TEST_F(GltfGeometryTest, TargetsMoveWhatJointsMoveThen) {
  GltfText document = with_skin();
  primitive(document)["targets"] = {{{"POSITION", document.add_positions({{0, 0, 0}, {0, 0, 0}, {2, 0, 0}})}}};
  document.json["nodes"][1]["weights"] = {1};
  EXPECT_EQ(corners_of(scene(document))[2], (Vec3{1, 8, 1}));
}

TEST_F(GltfGeometryTest, WhatOfAMeshHasNoJointsStandsInItsNode) {
  GltfText document = with_skin();
  Json plain = primitive(document);
  plain["attributes"] = {{"POSITION", 0}};
  document.json["meshes"][0]["primitives"].push_back(plain);
  const std::vector<Vec3> corners = corners_of(scene(document));
  ASSERT_EQ(corners.size(), 6u);
  EXPECT_EQ(corners[0], (Vec3{100, 0, 0}));
  EXPECT_EQ(corners[1], (Vec3{110, 0, 0}));
  EXPECT_EQ(corners[3], (Vec3{0, 10, 0}));
  // Without a skin in the node the joints of a mesh mean nothing.
  document.json["nodes"][1].erase("skin");
  EXPECT_EQ(corners_of(scene(document))[4], (Vec3{110, 0, 0}));
}

TEST_F(GltfGeometryTest, BrokenSkinsAreRefusedWithTheirPlace) {
  const auto broken = [&](const std::string& pointer, const Json& value, const std::string& part) {
    GltfText document = with_skin();
    document.json[Json::json_pointer(pointer)] = value;
    expect_refusal(document, part);
  };
  broken("/skins/0/joints", {2}, "JOINTS_0 has joint 1, which is out of range: the skin has 1");
  broken("/skins/0/joints", {2, 3, 0}, "inverseBindMatrices has 2 matrices for 3 joints");
  broken("/skins/0/joints", {2, 9}, "skins[0].joints[1] is 9");
  broken("/nodes/1/skin", 1, "nodes[1].skin is 1");
  broken("/accessors/2/count", 2, "JOINTS_0 has 2 elements, and its weights 3, for 3 vertices");
  broken("/accessors/2/componentType", 5126, "joints' numbers");
  GltfText loop = with_skin();
  loop.json["nodes"][3]["children"] = {2};
  loop.json["scenes"] = {{{"nodes", {0}}}};
  expect_refusal(loop, "has more than 1000 nodes above it, or is its own ancestor");
  GltfText lacking = with_skin();
  primitive(lacking)["attributes"].erase("WEIGHTS_0");
  expect_refusal(lacking, "has no 'WEIGHTS_0'");
}

TEST_F(GltfGeometryTest, InstancesStandInTheirNode) {
  GltfText document = gltf_triangle();
  const float half = std::sqrt(0.5f);
  const size_t moves = document.add_positions({{0, 0, 0}, {0, 0, 3}});
  const size_t turns = add_floats(document, {0, 0, 0, 1, 0, 0, half, half}, 4);
  const size_t scales = document.add_positions({{1, 1, 1}, {-2, 1, 1}});
  document.json["nodes"][0]["translation"] = {10, 0, 0};
  document.json["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
  Json& attributes = document.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
  attributes = {{"TRANSLATION", moves}, {"ROTATION", turns}, {"SCALE", scales}, {"_ID", 99}};
  // The second one is mirrored, and so keeps its front, and turned from x to y.
  const std::vector<Vec3> first = {{10, 0, 0}, {12, 0, 0}, {10, 1, 0}}, second = {{10, 0, 3}, {9, 0, 3}, {10, -4, 3}};
  std::vector<Vec3> both = first;
  both.insert(both.end(), second.begin(), second.end());
  expect_corners(document, both);
  EXPECT_EQ(warnings(scene(document)), Texts{});
  // Any of the three may be left out, and rotations be whole numbers.
  attributes = {{"ROTATION", add(document, std::vector<int8_t>{0, 0, 0, 127, 0, 0, 90, 90}, 5120, 4)}};
  document.json["accessors"].back()["normalized"] = true;
  expect_corners(document, {first[0], first[1], first[2], {10, 0, 0}, {10, 2, 0}, {9, 0, 0}});
  attributes = {{"TRANSLATION", moves}, {"SCALE", 0}};
  expect_refusal(document, "SCALE has 3 elements, and another attribute 2");
  attributes = {{"ROTATION", add_floats(document, {0, 0, 0, 0}, 4)}};
  expect_refusal(document, "ROTATION has a zero as rotation 0");
}

TEST_F(GltfGeometryTest, HiddenNodesHideWhatIsBelowThemButTheirCameras) {
  GltfText document = gltf_triangle();
  const Json hidden = {{"KHR_node_visibility", {{"visible", false}}}};
  document.json["extensionsRequired"] = {"KHR_node_visibility"};
  document.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
  document.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1}}}}};
  document.json["nodes"] = {{{"mesh", 0}, {"extensions", {{"KHR_node_visibility", {{"visible", true}}}}}},
                            {{"children", {2, 3}}, {"extensions", hidden}},
                            {{"mesh", 0}, {"extensions", {{"KHR_node_visibility", {{"visible", true}}}}}},
                            {{"camera", 0}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}}};
  document.json["scenes"] = {{{"nodes", {0, 1}}}};
  const SceneFile file = load(document);
  EXPECT_EQ(file.scene.triangles.size(), 1u);
  EXPECT_TRUE(file.camera);
  EXPECT_FALSE(file.light);
  EXPECT_EQ(warnings(file.scene), Texts{"a.gltf: 2 nodes that are hidden (KHR_node_visibility), not drawn"});
  document.json["nodes"][0]["extensions"] = hidden;
  expect_refusal(document, "the scene has no triangles, only hidden nodes; nothing can be rendered");
  document.json["nodes"][0]["extensions"]["KHR_node_visibility"]["visible"] = 0;
  expect_refusal(document, "visible is 0; it must be true or false");
}

TEST_F(GltfGeometryTest, InstancesAreCountedBeforeTheyAreMade) {
  GltfText document;
  const size_t positions = document.add_positions(kCorners);
  const size_t indices = document.add_indices(std::vector<uint8_t>(300'000, 0));
  document.json["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", positions}}}, {"indices", indices}}}}}};
  document.json["nodes"] = {{{"mesh", 0}}};
  const size_t moves = add_floats(document, std::vector<float>(3), 3);
  document.json["accessors"][moves].erase("bufferView");
  document.json["accessors"][moves]["count"] = 1001;
  document.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] = moves;
  expect_refusal(document, "nodes[0] brings the scene to 100100000 triangles; 100000000 are the most");
}

}  // namespace
}  // namespace raypool
