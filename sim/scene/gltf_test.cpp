#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scene/gltf_fixture.hpp"

namespace raypool {
namespace {

using Document = GltfText;

class Gltf : public GltfFixture {};

/// The scene as glTF: its materials are matt, or mirrors of no diffuse colour.
Document to_gltf(const Scene& scene) {
  Document document;
  const size_t positions = document.add_positions(scene.vertices);
  Json primitives = Json::array();
  for (size_t i = 0; i < scene.triangles.size(); ++i) {
    std::vector<uint32_t> indices;
    const uint32_t material = scene.triangle_materials[i];
    for (; i < scene.triangles.size() && scene.triangle_materials[i] == material; ++i)
      indices.insert(indices.end(), scene.triangles[i].begin(), scene.triangles[i].end());
    --i;
    primitives.push_back({{"attributes", {{"POSITION", positions}}},
                          {"indices", document.add_indices(indices)},
                          {"material", material}});
  }
  for (const Material& material : scene.materials) {
    const bool mirror = material.reflects();
    const Vec3 c = mirror ? material.ks : material.kd;
    document.json["materials"].push_back({{"name", material.name},
                                          {"pbrMetallicRoughness",
                                           {{"baseColorFactor", {c.x, c.y, c.z, 1}},
                                            {"metallicFactor", mirror ? 1 : 0},
                                            {"roughnessFactor", mirror ? 0 : 1}}}});
  }
  document.json["meshes"] = {{{"primitives", primitives}}};
  document.json["nodes"] = {{{"mesh", 0}}};
  return document;
}

TEST_F(Gltf, TextAndBinaryGiveTheTrianglesMaterialsAndThePictureOfTheObj) {
  Scene scene = load_scene("cornell", {0.05, "", {}, ""});
  for (Material& material : scene.materials) (material.ks.x > 0.3f ? material.kd : material.ks) = {};
  write_obj(scene, folder_ + "/a.obj");
  Scene obj = load_obj(folder_ + "/a.obj");
  obj.camera = scene.camera;
  obj.light = scene.light;
  Document document = to_gltf(obj);
  const std::string text = write("a.gltf", document.text());
  const std::string binary = write("a.glb", glb(document.finished(), document.bytes));
  Json external = document.finished();
  external["buffers"][0]["uri"] = "all%20bytes.bin";
  write("all bytes.bin", document.bytes);
  const std::string beside = write("b.gltf", external.dump());
  for (const std::string& path : {text, binary, beside}) {
    Scene gltf = load_gltf(path).scene;
    EXPECT_EQ(corners_of(gltf), corners_of(obj));
    EXPECT_EQ(gltf.triangle_materials, obj.triangle_materials);
    ASSERT_EQ(gltf.materials.size(), obj.materials.size());
    for (size_t i = 0; i < obj.materials.size(); ++i) {
      EXPECT_EQ(gltf.materials[i].name, obj.materials[i].name);
      EXPECT_EQ(gltf.materials[i].kd, obj.materials[i].kd);
      EXPECT_EQ(gltf.materials[i].ks, obj.materials[i].ks);
    }
    gltf.camera = scene.camera;
    gltf.light = scene.light;
    EXPECT_EQ(picture_of(gltf), picture_of(obj));
    // And back.
    write_obj(gltf, folder_ + "/back.obj");
    EXPECT_EQ(corners_of(load_obj(folder_ + "/back.obj")), corners_of(obj));
  }
}

TEST_F(Gltf, NodesPlaceInstancesAndMirroredOnesKeepTheirFront) {
  Document document = gltf_triangle();
  const double half = std::sqrt(0.5);
  document.json["nodes"] = {
      {{"translation", {10, 0, 0}}, {"children", {1, 2, 3}}},
      {{"mesh", 0}, {"rotation", {0, 0, half, half}}, {"scale", {3, 1, 1}}},  // a quarter turn about z
      {{"mesh", 0}, {"scale", {-1, 1, 1}}},
      {{"mesh", 0}, {"matrix", {1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 5, 0, 1}}}};  // y to z
  document.json["scenes"] = {{{"nodes", {0}}}};
  const std::vector<Vec3> corners = corners_of(scene(document));
  const std::vector<Vec3> wanted = {{10, 0, 0}, {10, 6, 0}, {9, 0, 0},  // turned
                                    {10, 0, 0}, {10, 1, 0}, {8, 0, 0},  // mirrored
                                    {10, 5, 0}, {12, 5, 0}, {10, 5, 1}};
  ASSERT_EQ(corners.size(), wanted.size());
  for (size_t i = 0; i < wanted.size(); ++i) expect_near(corners[i], wanted[i]);
}

TEST_F(Gltf, VerticesAtOnePlaceBecomeOne) {
  Document document = gltf_triangle();
  document.json["nodes"].push_back({{"mesh", 0}, {"scale", {-1, 1, 1}}});
  const Scene both = scene(document);
  EXPECT_EQ(both.triangles.size(), 2u);
  EXPECT_EQ(both.vertices.size(), 4u);
}

TEST_F(Gltf, StripsFansAndInterleavedPositionsAreRead) {
  Document document;
  const std::vector<Vec3> square = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  const size_t fan = document.add_indices<uint8_t>({0, 1, 3, 2}), both = document.add_indices<uint32_t>({0, 1, 2, 3});
  // Positions behind a normal each; the last one ends with the view, and with the buffer.
  const size_t begin = document.bytes.size();
  for (const Vec3& p : square) {
    for (const Vec3& v : {Vec3{0, 0, 1}, p}) {
      for (int axis = 0; axis < 3; ++axis) append(document.bytes, v[axis]);
    }
  }
  const size_t positions = document.add_accessor(4, 5126, "VEC3", begin);
  document.json["bufferViews"][positions]["byteStride"] = 24;
  document.json["accessors"][positions]["byteOffset"] = 12;
  const Json attributes = {{"POSITION", positions}};
  document.json["meshes"] = {{{"primitives",
                               {{{"attributes", attributes}, {"indices", both}, {"mode", 5}},
                                {{"attributes", attributes}, {"indices", fan}, {"mode", 6}},
                                {{"attributes", attributes}, {"mode", 5}},
                                {{"attributes", attributes}, {"mode", 1}}}}}};
  document.json["nodes"] = {{{"mesh", 0}}};
  const Scene read = scene(document);
  const Vec3 a = square[0], b = square[1], c = square[2], d = square[3];
  EXPECT_EQ(corners_of(read), (std::vector<Vec3>{a, b, c, c, b, d, a, b, d, a, d, c, a, b, c, c, b, d}));
  EXPECT_EQ(warnings(read), std::vector<std::string>{"a.gltf: 1 primitive of points or lines, not drawn"});
}

TEST_F(Gltf, MaterialsFollowTheRule) {
  Document document = gltf_triangle();
  const auto material = [](double metallic, double roughness) {
    return Json{
        {"pbrMetallicRoughness",
         {{"baseColorFactor", {0.8, 0.5, 0.25, 1}}, {"metallicFactor", metallic}, {"roughnessFactor", roughness}}}};
  };
  document.json["materials"] = {material(0, 1), material(0, 0),     material(1, 0),
                                material(1, 1), material(0.5, 0.5), {{"name", "plain"}}};
  const std::vector<Material> read = scene(document).materials;
  const std::vector<std::pair<Vec3, Vec3>> wanted = {{{0.8f, 0.5f, 0.25f}, {0, 0, 0}},
                                                     {{0.8f, 0.5f, 0.25f}, {0.04f, 0.04f, 0.04f}},
                                                     {{0, 0, 0}, {0.8f, 0.5f, 0.25f}},
                                                     {{0.8f, 0.5f, 0.25f}, {0, 0, 0}},
                                                     {{0.7f, 0.4375f, 0.21875f}, {0.105f, 0.0675f, 0.03625f}},
                                                     {{1, 1, 1}, {0, 0, 0}}};
  ASSERT_EQ(read.size(), wanted.size() + 1);  // the triangle has none, and is grey
  for (size_t i = 0; i < wanted.size(); ++i) {
    expect_near(read[i].kd, wanted[i].first);
    expect_near(read[i].ks, wanted[i].second);
  }
  EXPECT_EQ(read[4].name, "material_4");
  EXPECT_EQ(read[5].name, "plain");
  EXPECT_EQ(read[6].name, "default_grey");
}

/// The triangle with two cameras and an orthographic one.
Document with_cameras() {
  Document document = gltf_triangle();
  document.json["cameras"] = {
      {{"type", "orthographic"}, {"orthographic", {{"xmag", 1}, {"ymag", 1}}}, {"name", "Plan"}},
      {{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}}},
      {{"type", "perspective"}, {"perspective", {{"yfov", 1.2}, {"znear", 0.1}}}, {"name", "Side"}}};
  document.json["nodes"].push_back({{"camera", 0}, {"translation", {0, 0, 9}}});
  document.json["nodes"].push_back({{"camera", 1}, {"translation", {1, 2, 6}}, {"name", "Front"}});
  document.json["nodes"].push_back(
      {{"camera", 2}, {"translation", {5, 0, 0}}, {"rotation", {0, std::sqrt(0.5), 0, std::sqrt(0.5)}}});
  return document;
}

TEST_F(Gltf, TheFirstPerspectiveCameraOrTheNamedOneLooks) {
  const SceneFile first = load(with_cameras());
  ASSERT_TRUE(first.camera);
  EXPECT_EQ(first.camera->eye, (Vec3{1, 2, 6}));
  EXPECT_EQ(first.camera->direction, (Vec3{0, 0, -1}));
  EXPECT_EQ(first.camera->up, (Vec3{0, 1, 0}));
  EXPECT_NEAR(first.camera->fov, 0.7 * 180 / 3.14159265358979, 1e-4);
  EXPECT_EQ(first.scene.cameras, (std::vector<std::string>{"Front", "Plan", "Side"}));
  const SceneFile side = load(with_cameras(), "Side");
  expect_near(side.camera->eye, {5, 0, 0});
  expect_near(side.camera->direction, {-1, 0, 0});
  EXPECT_NEAR(side.camera->fov, 1.2 * 180 / 3.14159265358979, 1e-4);
  expect_refusal_of(with_cameras().text(), "'Plan' is orthographic", "Plan");
  expect_refusal_of(with_cameras().text(), "no camera 'Top' in it; its cameras are Plan, Front, Side", "Top");
  expect_refusal_of(gltf_triangle().text(), "no camera in it", "Top");
}

TEST_F(Gltf, WordsOfTheCommandLineChangeTheViewOfTheFile) {
  const std::string path = write("a.gltf", with_cameras().text());
  SceneOptions options;
  const Scene own = load_scene(path, options);
  EXPECT_EQ(own.camera.eye, (Vec3{1, 2, 6}));
  options.changes.eye = Vec3d{1, 1, 3};
  options.changes.fov = 30.0f;
  options.changes.light = Vec3d{0, 8, 1};
  const Scene changed = load_scene(path, options);
  EXPECT_EQ(changed.camera.eye, (Vec3{1, 1, 3}));
  EXPECT_EQ(changed.camera.direction, (Vec3{0, 0, -1}));
  EXPECT_EQ(changed.camera.fov, 30.0f);
  EXPECT_EQ(changed.light.position, (Vec3{0, 8, 1}));
  options.view = write("view.json", to_json(View{}));
  EXPECT_EQ(load_scene(path, options).camera.up, (Vec3{0, 1, 0}));
  options.camera = "Side";
  EXPECT_THROW(load_scene(path, options), InputError);
  EXPECT_THROW(load_scene("cornell", {1, "", {}, "Side"}), InputError);
}

Document with_lights(const std::vector<std::string>& types) {
  Document document = gltf_triangle();
  Json& lights = document.json["extensions"]["KHR_lights_punctual"]["lights"];
  for (const std::string& type : types) {
    const double place = lights.size();
    document.json["nodes"].push_back({{"translation", {place, 3, 4}},
                                      {"rotation", {std::sqrt(0.5), 0, 0, std::sqrt(0.5)}},  // -z to y
                                      {"name", "lamp" + std::to_string(lights.size())},
                                      {"extensions", {{"KHR_lights_punctual", {{"light", lights.size()}}}}}});
    lights.push_back({{"type", type}, {"color", {1, 0.5, 0.25}}, {"intensity", 40}});
  }
  return document;
}

TEST_F(Gltf, ASceneIsSeenThroughItsCameraInItsLight) {
  Document document = with_lights({"point"});
  document.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1}}}}};
  const double half = std::sqrt(0.5);
  document.json["nodes"].push_back({{"camera", 0}, {"translation", {1, 0, 5}}, {"rotation", {0, 0, half, half}}});
  const Scene seen = load_scene(write("a.gltf", document.text()));
  expect_near(seen.camera.direction, {0, 0, -1});
  expect_near(seen.camera.up, {-1, 0, 0});
  EXPECT_EQ(seen.light.position, (Vec3{0, 3, 4}));
  EXPECT_EQ(seen.light.color, (Vec3{1, 0.5f, 0.25f}));
}

TEST_F(Gltf, WithoutCameraTheViewIsChosenAndWithoutLightOneThatLights) {
  EXPECT_FALSE(load(gltf_triangle()).camera);
  for (const Document& document : {gltf_triangle(), with_cameras()}) {
    Document copy = document;
    const Scene read = load_scene(write("a.gltf", copy.text()));
    const std::vector<uint8_t> drawn = picture_of(read);
    Scene dark = read;
    dark.light.color = {0, 0, 0};
    EXPECT_NE(drawn, picture_of(dark)) << "nothing is lit";
  }
}

TEST_F(Gltf, AnOrthographicCameraAloneIsTold) {
  Document document = with_cameras();
  document.json["nodes"].erase(2);
  document.json["nodes"].erase(2);
  const SceneFile file = load(document);
  EXPECT_FALSE(file.camera);
  EXPECT_EQ(warnings(file.scene), std::vector<std::string>{"a.gltf: the camera is orthographic, which ours is not: the "
                                                           "view is chosen automatically"});
}

TEST_F(Gltf, OnePointLightIsOursAndTheOthersAreTold) {
  const SceneFile file = load(with_lights({"directional", "spot", "point", "point"}));
  ASSERT_TRUE(file.light);
  EXPECT_EQ(file.light->position, (Vec3{2, 3, 4}));
  EXPECT_EQ(file.light->color, (Vec3{1, 0.5f, 0.25f}));
  EXPECT_EQ(
      warnings(file.scene),
      (std::vector<std::string>{
          "a.gltf: the light is 'lamp2' (point), as a point with its colour: its fall-off and intensity (40) are not "
          "used",
          "a.gltf: a scene has one light, and 3 others of the file are not used: remove what should not shine from the "
          "file, or put the light elsewhere with --light=X,Y,Z"}));
  const SceneFile two = load(with_lights({"directional", "spot"}));
  EXPECT_EQ(two.light->position, (Vec3{1, 3, 4}));
  EXPECT_NE(warnings(two.scene).back().find("one light, and another one of the file is not used: remove"),
            std::string::npos);
  // Shines along y: it comes from far below.
  const SceneFile sun = load(with_lights({"directional"}));
  const double diagonal = std::sqrt(5);
  EXPECT_NEAR(sun.light->position.x, 1, 1e-3);
  EXPECT_NEAR(sun.light->position.y, 0.5 - 100 * diagonal, 1e-3);
  EXPECT_NEAR(sun.light->position.z, 0, 1e-3);
  EXPECT_FALSE(load(gltf_triangle()).light);
}

TEST_F(Gltf, WhatHasNoCounterpartIsCounted) {
  Document document = gltf_triangle();
  Json textured = {{"emissiveFactor", {1, 0, 0}},
                   {"alphaMode", "BLEND"},
                   {"normalTexture", {{"index", 0}}},
                   {"extensions", {{"KHR_materials_clearcoat", Json::object()}}}};
  document.json["materials"] = {textured, textured, textured};
  Json& primitives = document.json["meshes"][0]["primitives"];
  primitives.push_back(primitives[0]);
  primitives[0]["material"] = 0;
  primitives[1]["material"] = 2;
  primitives[1]["attributes"]["COLOR_0"] = 7;
  primitives[0]["attributes"]["NORMAL"] = 7;
  primitives[1]["attributes"]["NORMAL"] = 7;
  document.json["nodes"].push_back({{"mesh", 0}, {"weights", {0.5}}});
  document.json["animations"] = {Json::object(), Json::object()};
  document.json["scenes"] = {{{"nodes", {0, 1}}}, Json::object()};
  const std::string extensions =
      "a.gltf: 2 materials with extensions (KHR_materials_..., or Pm, Ps and Pc of MTL), which are not used";
  EXPECT_EQ(warnings(scene(document)),
            (std::vector<std::string>{"a.gltf: scenes[0] alone is drawn, of 2 scenes",
                                      "a.gltf: 2 materials with textures: the colours beside them are used alone",
                                      "a.gltf: 2 materials with emission, which is not used: the one light is a point",
                                      "a.gltf: 2 materials with transparency, drawn opaque", extensions,
                                      "a.gltf: 1 primitive with vertex colours, which are not used",
                                      "a.gltf: 2 primitives with vertex normals, which are not used: shading is flat",
                                      "a.gltf: 2 animations not played: all is where the nodes are"}));
}

TEST_F(Gltf, EmissionOfAnyStrengthIsNoReasonToRefuse) {
  for (const Json& factor : {Json{10, 10, 10}, Json{0, 1.0000001, 0}, Json{1e30, -1, 0}}) {
    Document document = gltf_triangle();
    document.json["materials"] = {{{"emissiveFactor", factor},
                                   {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 1e9}}}}}}};
    document.json["meshes"][0]["primitives"][0]["material"] = 0;
    const Scene read = scene(document);
    EXPECT_EQ(warnings(read).at(0), "a.gltf: 1 material with emission, which is not used: the one light is a point");
    EXPECT_EQ(read.materials.at(0).kd, (Vec3{1, 1, 1}));
  }
}

TEST_F(Gltf, OfFactorsBeyondTheirRangeTheNearestIsTaken) {
  Document document = gltf_triangle();
  document.json["materials"] = {
      {{"pbrMetallicRoughness",
        {{"baseColorFactor", {1.5, 0.5, -0.25, 2}}, {"metallicFactor", -0.0000001}, {"roughnessFactor", 1.01}}}}};
  document.json["meshes"][0]["primitives"][0]["material"] = 0;
  const Scene read = scene(document);
  EXPECT_EQ(read.materials.at(0).kd, (Vec3{1, 0.5f, 0}));
  EXPECT_EQ(warnings(read),
            std::vector<std::string>{"a.gltf: 1 material with factors beyond 0 .. 1, of which the nearest is taken"});
}

TEST_F(Gltf, AFileThatContradictsItselfIsNotCalledCutOff) {
  const Document good = gltf_triangle();
  std::string bytes = glb(good.finished(), good.bytes);
  for (const size_t length : {bytes.size() - 4, size_t{100}, size_t{12}, size_t{0}}) {
    for (size_t i = 0; i < 4; ++i) bytes[8 + i] = static_cast<char>(length >> (8 * i) & 255);
    const std::string path = write("a.glb", bytes), message = refusal([&] { load_gltf(path); });
    EXPECT_NE(message.find(fmt::format("its header declares a file of {} bytes, and it has {};", length, bytes.size())),
              std::string::npos)
        << message;
    EXPECT_EQ(message.find("cut off"), std::string::npos) << message;
  }
}

TEST_F(Gltf, BrokenFilesAreRefusedWithTheirPlace) {
  expect_refusal_of("", "empty");
  expect_refusal_of("{", "not valid JSON");
  expect_refusal_of("{}", "has no 'asset'");
  expect_refusal_of("[1]", "it must be an object");
  expect_refusal_of(R"({"asset": {"version": "1.0"}})", "asset.version is '1.0'");
  expect_refusal_of(R"({"asset": {"version": "2.0"}})", "no triangles");
  expect_refusal_of(R"({"asset": {"version": "2.0"}, "x": 1e999})", "not valid JSON");
  const Document good = gltf_triangle();
  Document document = good;
  const std::string whole = glb(good.finished(), good.bytes);
  for (size_t size = 1; size < whole.size(); ++size) expect_refusal_of(whole.substr(0, size), "");
  std::string longer = whole;  // its last chunk declares 48 bytes, of which there are 44
  longer[whole.size() - 44 - 8] = 48;
  expect_refusal_of(longer, "the file is cut off");
  const auto broken = [&](const std::string& pointer, const Json& value, const std::string& part) {
    document = good;
    document.json[Json::json_pointer(pointer)] = value;
    expect_refusal(document, part);
  };
  broken("/buffers", {{{"byteLength", 4000}}}, "fewer than its byteLength of 4000");
  broken("/bufferViews/0/byteLength", 4000, "bufferViews[0] goes to byte 4000 of a buffer of 42");
  broken("/bufferViews/0/buffer", 1, "bufferViews[0].buffer is 1; it must be a whole number in 0 .. 0");
  broken("/accessors/0/count", 4, "accessors[0] needs 48 bytes of a view of 36");
  broken("/accessors/0/count", -1, "accessors[0].count is -1");
  broken("/accessors/0/count", "3", "accessors[0].count is \"3\"");
  broken("/accessors/0/componentType", 5125, "accessors[0].componentType must be 5126, or 5120 to 5123");
  broken("/accessors/0/bufferView", 2, "accessors[0].bufferView is 2");
  broken("/accessors/0/sparse", Json::object(), "accessors[0].sparse has no 'count'");
  broken("/accessors/1/type", "VEC2", "whole numbers");
  broken("/bufferViews/0/byteStride", 8, "byteStride is 8");
  broken("/meshes/0/primitives/0/attributes", Json::object(), "has no 'POSITION'");
  broken("/meshes/0/primitives/0/mode", 7, "mode is 7");
  broken("/meshes/0/primitives/0/mode", 0, "only points or lines");
  broken("/meshes/0/primitives/0/material", 0, "names one of materials, of which the file has none");
  broken("/nodes/0/mesh", 1, "nodes[0].mesh is 1");
  broken("/nodes/0/children", {0}, "its own ancestor");
  broken("/nodes/0/rotation", {0, 0, 0, 0}, "rotation is zero");
  broken("/nodes/0/scale", {1, 1}, "has 2 numbers; give 3");
  broken("/nodes/0/translation", {1e9, 1e9, 2e9}, "translation[2] is 2000000000.0");
  broken("/nodes/0/matrix", {1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, "must end each column");
  broken("/scene", 3, "scene is 3");
  broken("/extensionsRequired", {"KHR_draco_mesh_compression"}, "KHR_draco_mesh_compression, which is not read");
  broken("/cameras", {{{"type", "fisheye"}}}, "fisheye");
  broken("/cameras", {{{"type", "perspective"}, {"perspective", {{"yfov", 4}}}}}, "yfov is 4");
}

TEST_F(Gltf, IndicesAndPositionsOutOfRangeAreRefused) {
  Document document = gltf_triangle();
  document.bytes[40] = 3;
  expect_refusal(document, "meshes[0].primitives[0].indices has index 3, which is out of range: there are 3 vertices");
  document = gltf_triangle();
  const float nan = NAN;
  std::memcpy(document.bytes.data() + 16, &nan, 4);
  expect_refusal(document, "meshes[0].primitives[0].attributes.POSITION has vertex 1 at (2, nan, 0)");
  document = gltf_triangle();
  document.json["nodes"][0]["scale"] = {1e9, 1, 1};
  expect_refusal(document, "vertex 1 is (2000000000, 0, 0)");
  document = gltf_triangle();
  document.json["accessors"][1]["count"] = 2;
  expect_refusal(document, "has 2 corners, which make no triangles");
}

TEST_F(Gltf, BuffersLieInTheFolderOfTheFile) {
  Document document = gltf_triangle();
  Json json = document.finished();
  const auto refused = [&](const std::string& uri, const std::string& part) {
    json["buffers"][0]["uri"] = uri;
    expect_refusal_of(json.dump(), part);
  };
  refused("../a.bin", "buffers[0].uri is '../a.bin'; it must be a file in the folder");
  refused("/etc/passwd", "must be a file in the folder");
  refused("http://example.org/a.bin", "must be a file in the folder");
  refused("data:,abc", "not base64");
  refused("data:;base64,a!==", "not base64");
  json["buffers"][0].erase("uri");
  expect_refusal_of(json.dump(), "has no uri");
  json["buffers"][0]["uri"] = "missing.bin";
  const std::string path = write("a.gltf", json.dump());
  EXPECT_EQ(refusal([&] { load_gltf(path); }).rfind("missing.bin: ", 0), 0u);
}

TEST_F(Gltf, NodesWithoutEndAreRefused) {
  Document document = gltf_triangle();
  for (size_t i = 1; i < 2000; ++i) {
    document.json["nodes"][i - 1]["children"] = {i};
    document.json["nodes"][i] = Json::object();
  }
  document.json["scenes"] = {{{"nodes", {0}}}};
  expect_refusal(document, "more than 1000 nodes above it");
  expect_refusal_of(std::string(200000, '['), "not valid JSON");
}

TEST_F(Gltf, AMeshInTooManyPlacesIsRefused) {
  Document document;
  const size_t positions = document.add_positions(kCorners);
  const size_t indices = document.add_indices(std::vector<uint8_t>(900'000, 0));
  document.json["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", positions}}}, {"indices", indices}}}}}};
  for (int i = 0; i < 334; ++i) document.json["nodes"].push_back({{"mesh", 0}});
  expect_refusal(document, "nodes[333] brings the scene to 100200000 triangles; 100000000 are the most");
}

TEST_F(Gltf, NamesDoNotSpoilALineOfOutput) {
  Document document = with_cameras();
  document.json["cameras"][2]["name"] = "Si\n\x1b[1mde";
  EXPECT_EQ(load(document).scene.cameras[2], "Si  [1mde");
}

TEST_F(Gltf, TheEndingGivesTheFormat) {
  const std::string other = write("a.stl", "solid");
  EXPECT_EQ(
      refusal([&] { load_scene(other); }),
      "a.stl: a scene cannot be read from this; give cornell, room, or the path of a .obj, .gltf, .glb or .ply file");
  EXPECT_EQ(refusal([&] { load_scene(folder_ + "/none.glb"); }),
            "none.glb: no such scene; give cornell, room, or the path of a .obj, .gltf, .glb or .ply file");
  Document document = gltf_triangle();
  EXPECT_EQ(load_scene(write("A.GLTF", document.text())).triangles.size(), 1u);
}

}  // namespace
}  // namespace raypool
