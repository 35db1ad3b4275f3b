// What only shader sets see of scene files.
#include "scene/surfaces.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "scene/gltf_fixture.hpp"
#include "scene/image_decoding.hpp"
#include "scene/image_fixture.hpp"
#include "scene/mesh_builder.hpp"

namespace raypool {
namespace {

constexpr bool kSurfaces = true;

/// The values of all corners, one after the other.
template <typename T>
std::vector<T> of_corners(const Surfaces& surfaces, const std::vector<T>& values) {
  std::vector<T> corners;
  for (const auto& triangle : surfaces.triangles) {
    for (const uint32_t vertex : triangle) corners.push_back(values.at(vertex));
  }
  return corners;
}

/// Every index is one of something, and positions are those of the scene.
void expect_sound(const Scene& scene) {
  ASSERT_TRUE(scene.surfaces);
  const Surfaces& surfaces = *scene.surfaces;
  ASSERT_EQ(surfaces.triangles.size(), scene.triangles.size());
  ASSERT_EQ(surfaces.materials.size(), scene.materials.size());
  EXPECT_EQ(surfaces.normals.size(), surfaces.positions.size());
  EXPECT_TRUE(surfaces.texcoords.empty() || surfaces.texcoords.size() == surfaces.positions.size());
  EXPECT_TRUE(surfaces.colors.empty() || surfaces.colors.size() == surfaces.positions.size());
  const std::vector<Vec3> corners = of_corners(surfaces, surfaces.positions);
  EXPECT_TRUE(corners == corners_of(scene));
  for (const Vec3& normal : surfaces.normals) EXPECT_NEAR(length(normal), 1, 1e-5);
  for (const SurfaceTexture& texture : surfaces.textures) EXPECT_LT(texture.image, surfaces.images.size());
  for (const SurfaceMaterial& material : surfaces.materials) {
    for (const auto& texture :
         {material.base_color_texture, material.emission_texture, material.metallic_roughness_texture})
      EXPECT_LT(texture.value_or(0), texture ? surfaces.textures.size() : 1);
  }
  for (const SurfaceImage& image : surfaces.images)
    EXPECT_EQ(image.texels.size(), size_t{4} * image.width * image.height);
}

class SurfacesOfFiles : public GltfFixture {
 protected:
  Scene gltf(GltfText document) const { return load_gltf(write("a.gltf", document.text()), "", kSurfaces).scene; }
  Scene obj(const std::string& text) const { return load_obj(write("a.obj", text), kSurfaces); }
  Scene ply(const std::string& text) const { return load_ply(write("a.ply", text), kSurfaces); }
  void expect_refused(GltfText document, const std::string& part) const {
    const std::string message = refusal([&] { gltf(document); });
    EXPECT_EQ(message.rfind("a.gltf: ", 0), 0u) << message;
    EXPECT_NE(message.find(part), std::string::npos) << message;
  }
};

template <size_t kCount>
size_t add_floats(GltfText& document, const std::vector<std::array<float, kCount>>& values) {
  const size_t begin = document.bytes.size();
  for (const auto& value : values) {
    for (const float number : value) append(document.bytes, number);
  }
  return document.add_accessor(values.size(), 5126, kCount == 2 ? "VEC2" : kCount == 3 ? "VEC3" : "VEC4", begin);
}

Json& attributes_of(GltfText& document) { return document.json["meshes"][0]["primitives"][0]["attributes"]; }

/// The triangle with all that vertices have.
GltfText full_triangle() {
  GltfText document = gltf_triangle();
  attributes_of(document)["NORMAL"] = add_floats<3>(document, {{0, 0, 1}, {0, 1, 1}, {0, 0, 2}});
  attributes_of(document)["TEXCOORD_0"] = add_floats<2>(document, {{0, 0}, {1, 0.25f}, {-3.5f, 2}});
  attributes_of(document)["COLOR_0"] = add_floats<4>(document, {{1, 0, 0, 1}, {0, 1, 0, 0.5f}, {0, 0, 1, 0}});
  return document;
}

TEST_F(SurfacesOfFiles, EachCornerOfAGltfFileHasItsNormalTexcoordAndColour) {
  GltfText document = full_triangle();
  document.json["nodes"][0]["scale"] = {1, 2, 1};
  const Scene read = gltf(document);
  expect_sound(read);
  const Surfaces& surfaces = *read.surfaces;
  EXPECT_TRUE(read.warnings.empty());
  EXPECT_EQ(of_corners(surfaces, surfaces.texcoords), (std::vector<Texcoord>{{0, 0}, {1, 0.25f}, {-3.5f, 2}}));
  EXPECT_EQ(of_corners(surfaces, surfaces.colors), (std::vector<Rgba>{{1, 0, 0, 1}, {0, 1, 0, 0.5f}, {0, 0, 1, 0}}));
  const std::vector<Vec3> normals = of_corners(surfaces, surfaces.normals);
  expect_near(normals[0], {0, 0, 1});
  // Twice as high, the surface is less inclined.
  expect_near(normals[1], normalized(Vec3{0, 0.5f, 1}));
  expect_near(normals[2], {0, 0, 1});
}

TEST_F(SurfacesOfFiles, NormalsOfAMirroredMeshPointOutwards) {
  GltfText document = full_triangle();
  document.json["nodes"][0]["scale"] = {-1, 1, 1};
  attributes_of(document)["NORMAL"] = add_floats<3>(document, {{1, 0, 1}, {1, 0, 1}, {1, 0, 1}});
  const Scene read = gltf(document);
  expect_sound(read);
  for (const Vec3& normal : read.surfaces->normals) expect_near(normal, normalized(Vec3{-1, 0, 1}));
  EXPECT_GT(dot(read.normal(0), read.surfaces->normals[0]), 0);
}

TEST_F(SurfacesOfFiles, AskedForOrNotTheSceneIsTheSame) {
  const auto expect_same = [](const Scene& a, const Scene& b) {
    EXPECT_FALSE(a.surfaces);
    EXPECT_TRUE(b.surfaces);
    EXPECT_TRUE(a.vertices == b.vertices);
    EXPECT_EQ(a.triangles, b.triangles);
    EXPECT_EQ(a.triangle_materials, b.triangle_materials);
    ASSERT_EQ(a.materials.size(), b.materials.size());
    for (size_t i = 0; i < a.materials.size(); ++i) {
      EXPECT_EQ(a.materials[i].kd, b.materials[i].kd);
      EXPECT_EQ(a.materials[i].ks, b.materials[i].ks);
    }
  };
  GltfText document = full_triangle();
  document.json["materials"] = {{{"pbrMetallicRoughness", {{"roughnessFactor", 0}}}}};
  document.json["meshes"][0]["primitives"][0]["material"] = 0;
  expect_same(scene(document), gltf(document));
  EXPECT_EQ(warnings(scene(document)),
            (std::vector<std::string>{"a.gltf: 1 primitive with vertex colours, which are not used",
                                      "a.gltf: 1 primitive with vertex normals, which are not used: shading is flat"}));
  write_obj(make_cornell(0.05), folder_ + "/c.obj");
  expect_same(load_obj(folder_ + "/c.obj"), load_obj(folder_ + "/c.obj", kSurfaces));
  expect_sound(load_obj(folder_ + "/c.obj", kSurfaces));
  SceneOptions options;
  options.surfaces = true;
  options.detail = 0.05;
  expect_sound(load_scene("room", options));
  EXPECT_FALSE(load_scene("room", {0.05, "", {}, ""}).surfaces);
}

TEST_F(SurfacesOfFiles, WithoutNormalsCornersHaveThoseOfTheirTriangles) {
  GltfText document;
  const size_t positions = document.add_positions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  // The strip folds along an edge that both triangles share.
  document.json["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", positions}}}, {"mode", 5}}}}}};
  document.json["nodes"] = {{{"mesh", 0}}};
  const Scene read = gltf(document);
  expect_sound(read);
  const std::vector<Vec3> normals = of_corners(*read.surfaces, read.surfaces->normals);
  for (size_t i = 0; i < 6; ++i) expect_near(normals[i], read.normal(i / 3));
  EXPECT_EQ(read.surfaces->positions.size(), 6u);
  EXPECT_EQ(read.vertices.size(), 4u);
}

TEST_F(SurfacesOfFiles, NormalsFollowMorphTargetsAndJoints) {
  GltfText document = full_triangle();
  const size_t moves = add_floats<3>(document, {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}),
               turns = add_floats<3>(document, {{1, 0, 0}, {1, -1, 0}, {1, 0, -1}});
  document.json["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", moves}, {"NORMAL", turns}}};
  document.json["meshes"][0]["weights"] = {1};
  const Scene morphed = gltf(document);
  for (const Vec3& normal : morphed.surfaces->normals) expect_near(normal, normalized(Vec3{1, 0, 1}));

  document = full_triangle();
  attributes_of(document)["NORMAL"] = add_floats<3>(document, {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}});
  attributes_of(document)["WEIGHTS_0"] = add_floats<4>(document, {{1, 0, 0, 0}, {1, 0, 0, 0}, {1, 0, 0, 0}});
  const size_t begin = document.bytes.size();
  document.bytes += std::string(12, '\0');
  attributes_of(document)["JOINTS_0"] = document.add_accessor(3, 5121, "VEC4", begin);
  const double half = std::sqrt(0.5);
  document.json["nodes"].push_back({{"rotation", {half, 0, 0, half}}});  // z to -y
  document.json["skins"] = {{{"joints", {1}}}};
  document.json["nodes"][0]["skin"] = 0;
  const Scene read = gltf(document);
  expect_sound(read);
  for (const Vec3& normal : read.surfaces->normals) expect_near(normal, {0, -1, 0});
}

TEST_F(SurfacesOfFiles, MaterialsOfAGltfFileKeepAllTheirNumbers) {
  GltfText document = full_triangle();
  document.json["materials"] = {
      {{"pbrMetallicRoughness",
        {{"baseColorFactor", {0.5, 0.25, 0.125, 0.75}}, {"metallicFactor", 0.5}, {"roughnessFactor", 0.25}}},
       {"emissiveFactor", {1, 0.5, 0}},
       {"alphaMode", "MASK"},
       {"alphaCutoff", 0.25},
       {"extensions",
        {{"KHR_materials_emissive_strength", {{"emissiveStrength", 8}}},
         {"KHR_materials_transmission", {{"transmissionFactor", 0.5}}},
         {"KHR_materials_ior", {{"ior", 1.25}}}}}},
      Json::object(),
      {{"alphaMode", "BLEND"}, {"extensions", {{"KHR_materials_clearcoat", Json::object()}}}}};
  Json& primitives = document.json["meshes"][0]["primitives"];
  primitives.push_back(primitives[0]);
  primitives.push_back(primitives[0]);
  primitives[0]["material"] = 0;
  primitives[1]["material"] = 2;
  const Scene read = gltf(document);
  expect_sound(read);
  const SurfaceMaterial &first = read.surfaces->materials[0], &plain = read.surfaces->materials[1],
                        &grey = read.surfaces->materials[3];
  EXPECT_EQ(first.base_color, (Rgba{0.5f, 0.25f, 0.125f, 0.75f}));
  EXPECT_EQ(first.emission, (Vec3{8, 4, 0}));
  EXPECT_EQ(first.metallic, 0.5f);
  EXPECT_EQ(first.roughness, 0.25f);
  EXPECT_EQ(first.transmission, 0.5f);
  EXPECT_EQ(first.ior, 1.25f);
  EXPECT_EQ(first.alpha_mode, AlphaMode::CutOut);
  EXPECT_EQ(first.alpha_cutoff, 0.25f);
  EXPECT_EQ(plain.metallic, 1);
  EXPECT_EQ(plain.roughness, 1);
  EXPECT_FALSE(plain.emits());
  EXPECT_EQ(read.surfaces->materials[2].alpha_mode, AlphaMode::Blend);
  EXPECT_EQ(grey.base_color, (Rgba{0.5f, 0.5f, 0.5f, 1}));
  EXPECT_EQ(warnings(read), std::vector<std::string>{"a.gltf: 1 material with extensions (KHR_materials_..., or Pm, Ps "
                                                     "and Pc of MTL), which are not used"});
}

/// The triangle with this image as its base colour.
GltfText textured(const Json& image) {
  GltfText document = full_triangle();
  document.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  document.json["meshes"][0]["primitives"][0]["material"] = 0;
  document.json["textures"] = {{{"source", 0}}};
  document.json["images"] = {image};
  return document;
}
Json data_uri(const std::string& bytes) { return {{"uri", "data:image/png;base64," + base64(bytes)}}; }

const std::string kTwoTexels = png_file(2, 1, 4, {255, 0, 128, 255, 0, 64, 255, 51});

TEST_F(SurfacesOfFiles, ColoursOfTexturesAreLinearAndOtherNumbersAsTheyStand) {
  GltfText document = textured(data_uri(kTwoTexels));
  document.json["materials"][0]["pbrMetallicRoughness"]["metallicRoughnessTexture"] = {{"index", 1}};
  document.json["materials"][0]["emissiveTexture"] = {{"index", 2}};
  document.json["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}}};
  document.json["textures"] = {{{"source", 0}, {"sampler", 0}}, {{"source", 0}}, {{"source", 0}}};
  const Scene read = gltf(document);
  expect_sound(read);
  const Surfaces& surfaces = *read.surfaces;
  ASSERT_EQ(surfaces.images.size(), 2u) << "as colour and as it stands";
  const auto linear = [](int value) {
    return static_cast<uint16_t>(std::lround(65535 * srgb_to_linear(value / 255.0)));
  };
  EXPECT_EQ(surfaces.images[0].width, 2u);
  EXPECT_EQ(surfaces.images[0].height, 1u);
  EXPECT_EQ(surfaces.images[0].texels,
            (std::vector<uint16_t>{65535, 0, linear(128), 65535, 0, linear(64), 65535, 51 * 257}));
  EXPECT_EQ(surfaces.images[1].texels,
            (std::vector<uint16_t>{65535, 0, 128 * 257, 65535, 0, 64 * 257, 65535, 51 * 257}));
  const SurfaceMaterial& material = surfaces.materials[0];
  EXPECT_EQ(surfaces.textures.at(*material.base_color_texture),
            (SurfaceTexture{0, shader::Wrap::Clamp, shader::Wrap::Mirror, true}));
  EXPECT_EQ(surfaces.textures.at(*material.metallic_roughness_texture), (SurfaceTexture{1}));
  EXPECT_EQ(surfaces.textures.at(*material.emission_texture), (SurfaceTexture{0}));
  EXPECT_TRUE(read.warnings.empty());
}

TEST_F(SurfacesOfFiles, ImagesMayBeFilesBufferViewsOrJpegs) {
  const std::string jpeg = jpeg_file(8, 8, std::vector<uint8_t>(192, 255));
  write("a wood.jpg", jpeg);
  expect_sound(gltf(textured({{"uri", "a%20wood.jpg"}})));
  EXPECT_EQ(gltf(textured({{"uri", "a%20wood.jpg"}})).surfaces->images.at(0).texels, std::vector<uint16_t>(256, 65535));
  GltfText document = textured({{"bufferView", 0}, {"mimeType", "image/jpeg"}});
  const size_t begin = document.bytes.size();
  document.bytes += jpeg;
  document.json["images"][0]["bufferView"] = document.json["bufferViews"].size();
  document.json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", begin}, {"byteLength", jpeg.size()}});
  EXPECT_EQ(gltf(document).surfaces->images.at(0).width, 8u);
}

TEST_F(SurfacesOfFiles, AnImageThatCannotBeReadIsLeftOutWithOneWarning) {
  const auto expect_warning = [&](GltfText document, const std::string& part) {
    document.json["materials"][0]["emissiveTexture"] = {{"index", 0}};  // asks for it again
    const Scene read = gltf(document);
    expect_sound(read);
    EXPECT_FALSE(read.surfaces->materials[0].base_color_texture);
    ASSERT_EQ(read.warnings.size(), 1u);
    EXPECT_NE(warnings(read)[0].find(part), std::string::npos) << warnings(read)[0];
  };
  expect_warning(textured({{"uri", "none.png"}}), "a.gltf: image 'none.png' is left out: none.png: ");
  expect_warning(textured(data_uri("no image")), "image 'images[0]' is left out: it is not a PNG or JPEG");
  expect_warning(textured(data_uri(kTwoTexels.substr(0, 50))), "not a PNG or JPEG that can be read");
  expect_warning(textured({{"uri", "../a.png"}}), "must be a file in the folder");
  expect_warning(textured({{"bufferView", 99}}), "images[0].bufferView is 99");
  GltfText webp = textured(data_uri(kTwoTexels));
  webp.json["textures"][0] = {{"extensions", {{"EXT_texture_webp", {{"source", 0}}}}}};
  expect_warning(webp, "textures[0] has no PNG or JPEG image, and is left out");
}

TEST_F(SurfacesOfFiles, TexcoordsAreThoseOfTheTextureAndMovedAsItAsks) {
  GltfText document = textured(data_uri(kTwoTexels));
  attributes_of(document)["TEXCOORD_1"] = add_floats<2>(document, {{0, 0}, {1, 0}, {0, 1}});
  Json& texture = document.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"];
  texture["texCoord"] = 1;
  EXPECT_EQ(of_corners(*gltf(document).surfaces, gltf(document).surfaces->texcoords),
            (std::vector<Texcoord>{{0, 0}, {1, 0}, {0, 1}}));
  texture["extensions"]["KHR_texture_transform"] = {
      {"offset", {0.5, 0.25}}, {"scale", {2, 4}}, {"rotation", std::acos(-1.0) / 2}};
  const Scene read = gltf(document);
  const std::vector<Texcoord> moved = of_corners(*read.surfaces, read.surfaces->texcoords);
  const std::vector<Texcoord> expected = {{0.5f, 0.25f}, {0.5f, -1.75f}, {4.5f, 0.25f}};
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(moved[i][0], expected[i][0], 1e-5);
    EXPECT_NEAR(moved[i][1], expected[i][1], 1e-5);
  }
  EXPECT_TRUE(read.warnings.empty());
  document.json["materials"][0]["emissiveTexture"] = {{"index", 0}};
  EXPECT_EQ(warnings(gltf(document)),
            std::vector<std::string>{
                "a.gltf: 1 material with textures at other coordinates than its first one, which are left out"});
}

TEST_F(SurfacesOfFiles, LightsOfAGltfFileKeepIntensityRangeAndCone) {
  GltfText document = full_triangle();
  document.json["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "point"}, {"color", {1, 0.5, 0.25}}, {"intensity", 8}, {"range", 20}},
      {{"type", "spot"}, {"spot", {{"innerConeAngle", 0.25}, {"outerConeAngle", 0.5}}}},
      {{"type", "directional"}, {"intensity", 3}}};
  for (size_t i = 0; i < 3; ++i) {
    document.json["nodes"].push_back({{"translation", {i, 3, 4}},
                                      {"rotation", {std::sqrt(0.5), 0, 0, std::sqrt(0.5)}},  // -z to y
                                      {"extensions", {{"KHR_lights_punctual", {{"light", i}}}}}});
  }
  const Scene read = gltf(document);
  const std::vector<SurfaceLight>& lights = read.surfaces->lights;
  ASSERT_EQ(lights.size(), 3u);
  EXPECT_TRUE(read.warnings.empty());
  EXPECT_EQ(lights[0].position, (Vec3{0, 3, 4}));
  EXPECT_EQ(lights[0].color, (Vec3{8, 4, 2}));
  EXPECT_EQ(lights[0].range, 20);
  EXPECT_EQ(lights[1].kind, SurfaceLight::Kind::Spot);
  EXPECT_EQ(lights[1].inner_cone, 0.25f);
  EXPECT_EQ(lights[1].outer_cone, 0.5f);
  expect_near(lights[1].direction, {0, 1, 0});
  EXPECT_EQ(lights[2].kind, SurfaceLight::Kind::Directional);
  EXPECT_EQ(lights[2].color, (Vec3{3, 3, 3}));
}

TEST_F(SurfacesOfFiles, WrongDataOfAGltfFileAreRefusedWithTheirPlace) {
  const auto broken = [&](const std::string& pointer, const Json& value, const std::string& part) {
    GltfText document = textured(data_uri(kTwoTexels));
    document.json[Json::json_pointer(pointer)] = value;
    expect_refused(document, part);
  };
  const std::string attributes = "/meshes/0/primitives/0/attributes";
  broken(attributes + "/NORMAL", 99, "attributes.NORMAL is 99");
  broken(attributes + "/NORMAL", 3, "must be 5126, or 5120 or 5122");
  broken(attributes + "/TEXCOORD_0", 0, "the type VEC2");
  broken(attributes + "/COLOR_0", 1, "a colour");
  broken("/accessors/2/count", 2, "attributes.NORMAL has 2 elements for 3 vertices");
  broken("/accessors/4/count", 1, "attributes.COLOR_0 has 1 elements for 3 vertices");
  broken("/textures", Json::array(), "baseColorTexture.index names one of textures, of which the file has none");
  broken("/textures/0/source", 2, "textures[0].source is 2");
  broken("/textures/0/sampler", 0, "names one of samplers");
  broken("/materials/0/alphaMode", "FOG", "alphaMode is 'FOG'; it must be OPAQUE, MASK or BLEND");
  broken("/materials/0/pbrMetallicRoughness/baseColorTexture/texCoord", -1, "texCoord is -1");
  GltfText document = textured(data_uri(kTwoTexels));
  document.json["samplers"] = {{{"wrapS", 1}}};
  document.json["textures"][0]["sampler"] = 0;
  expect_refused(document, "samplers[0].wrapS must be 10497, 33071 or 33648");
  document = full_triangle();
  attributes_of(document)["TEXCOORD_0"] = add_floats<2>(document, {{0, 0}, {NAN, 0}, {0, 0}});
  expect_refused(document, "has a texture coordinate that is infinite or no number");
}

TEST_F(SurfacesOfFiles, DamagedGltfFilesAreRefusedOrSound) {
  GltfText document = textured({{"bufferView", 5}});
  const size_t begin = document.bytes.size();
  document.bytes += kTwoTexels;
  document.json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", begin}, {"byteLength", kTwoTexels.size()}});
  const std::string whole = glb(document.finished(), document.bytes);
  Sequence random(46);
  size_t read = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    std::string bytes = whole;
    for (int i = 0; i < 1 + trial % 3; ++i) {
      const auto place = static_cast<size_t>(random.next(0, static_cast<double>(bytes.size())));
      bytes[place] = static_cast<char>(random.next(0, 256));
    }
    const std::string path = write("a.glb", bytes);
    try {
      expect_sound(load_gltf(path, "", kSurfaces).scene);
      ++read;
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    }
  }
  EXPECT_GT(read, 100u);
}

const std::string kObjSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST_F(SurfacesOfFiles, EachCornerOfAnObjFileHasItsNormalAndTexcoord) {
  const Scene read = obj(kObjSquare +
                         "vt 0 0\nvt 1 0.25\nvt 0.5\nvn 0 0 2\nvn 0 1 1\n"
                         "f 1/1/1 2/2/1 3/3/2 4//2\nf 1 2/-1/-2 3\n");
  expect_sound(read);
  EXPECT_TRUE(warnings(read).empty());
  const Surfaces& surfaces = *read.surfaces;
  const std::vector<Vec3> positions = of_corners(surfaces, surfaces.positions),
                          normals = of_corners(surfaces, surfaces.normals);
  const std::vector<Texcoord> texcoords = of_corners(surfaces, surfaces.texcoords);
  ASSERT_EQ(positions.size(), 9u);
  for (size_t i = 0; i < 6; ++i) {
    const bool upper = positions[i].y == 1;
    expect_near(normals[i], upper ? normalized(Vec3{0, 1, 1}) : Vec3{0, 0, 1});
    const Texcoord expected = positions[i] == Vec3{0, 0, 0}   ? Texcoord{0, 1}
                              : positions[i] == Vec3{1, 0, 0} ? Texcoord{1, 0.75f}
                              : positions[i] == Vec3{1, 1, 0} ? Texcoord{0.5f, 1}
                                                              : Texcoord{0, 0};
    EXPECT_EQ(texcoords[i], expected);
  }
  expect_near(normals[6], {0, 0, 1});
  EXPECT_EQ(texcoords[7], (Texcoord{0.5f, 1}));
}

TEST_F(SurfacesOfFiles, ColoursOfObjVerticesAreLinear) {
  const Scene read = obj("v 0 0 0 1 0.5 0\nv 1 0 0\nv 0 1 0 1 0 0 1\nf 1 2 3\n");
  expect_sound(read);
  const std::vector<Rgba> colours = of_corners(*read.surfaces, read.surfaces->colors);
  EXPECT_NEAR(colours[0][1], srgb_to_linear(0.5), 1e-6);
  EXPECT_EQ(colours[1], (Rgba{1, 1, 1, 1}));
  EXPECT_EQ(colours[2], (Rgba{0, 0, 1, 1}));
}

TEST_F(SurfacesOfFiles, WrongDataOfAnObjFileAreRefusedWithTheirLine) {
  const auto expect_line = [&](const std::string& text, const std::string& message) {
    EXPECT_EQ(refusal([&] { obj(kObjSquare + text); }), message);
  };
  expect_line("vt 0 0\nf 1/1 2/2 3/1\n", "a.obj:6: texture coordinate index 2 is out of range; the file has 1 of them");
  expect_line("vn 0 0 1\nf 1//1 2//1 3//9\n", "a.obj:6: normal index 9 is out of range; the file has 1 of them");
  expect_line("f 1/-1 2 3\n",
              "a.obj:5: texture coordinate index -1 is out of range; 0 of them stand above this line, numbered from 1");
  expect_line("vn 0 1\nf 1 2 3\n", "a.obj:5: normal has 2 numbers; give 3");
  expect_line("vt x\nf 1 2 3\n", "a.obj:5: 'x' in texture coordinate is not a number; correct the file");
  EXPECT_EQ(load_obj(write("a.obj", kObjSquare + "vt x\nvn 0\nf 1/7 2 3\n")).triangles.size(), 1u)
      << "without surfaces none of it counts";
}

TEST_F(SurfacesOfFiles, MtlFilesBecomeMetallicRoughness) {
  write("a.mtl",
        "newmtl pbr\nKd 0.5 0.25 0.125\nPm 0.75\nPr 0.5\nKe 2 4 8\n"
        "newmtl mirror\nKd 0.25 0.25 0.25\nKs 0.5 0.5 0.5\nillum 3\n"
        "newmtl shiny\nKd 0.5 0.5 0.5\nKs 0.5 0.5 0.5\nNs 30\nillum 2\n"
        "newmtl glass\nKd 0 0 0\nNi 1.25\nillum 7\n"
        "newmtl veil\nKd 1 1 1\nTr 0.75\n"
        "newmtl lamp\nKd 0 0 0\nKe 3\nillum 0\n");
  std::string text = "mtllib a.mtl\n" + kObjSquare;
  for (const char* name : {"pbr", "mirror", "shiny", "glass", "veil", "lamp"})
    text += std::string("usemtl ") + name + "\nf 1 2 3\n";
  const Scene read = obj(text);
  expect_sound(read);
  EXPECT_TRUE(warnings(read).empty());
  const std::vector<SurfaceMaterial>& materials = read.surfaces->materials;
  EXPECT_EQ(materials[0].base_color, (Rgba{0.5f, 0.25f, 0.125f, 1}));
  EXPECT_EQ(materials[0].metallic, 0.75f);
  EXPECT_EQ(materials[0].roughness, 0.5f);
  EXPECT_EQ(materials[0].emission, (Vec3{2, 4, 8}));
  EXPECT_EQ(materials[1].base_color, (Rgba{0.75f, 0.75f, 0.75f, 1}));
  EXPECT_NEAR(materials[1].metallic, 2.0 / 3, 1e-6);
  EXPECT_EQ(materials[1].roughness, 0);
  EXPECT_EQ(materials[2].metallic, 0);
  EXPECT_NEAR(materials[2].roughness, 0.5, 1e-6);
  EXPECT_EQ(materials[3].transmission, 1);
  EXPECT_EQ(materials[3].base_color, (Rgba{1, 1, 1, 1}));
  EXPECT_EQ(materials[3].ior, 1.25f);
  EXPECT_EQ(materials[3].alpha_mode, AlphaMode::Opaque);
  EXPECT_EQ(materials[4].base_color[3], 0.25f);
  EXPECT_EQ(materials[4].alpha_mode, AlphaMode::Blend);
  EXPECT_EQ(materials[5].emission, (Vec3{3, 3, 3}));
}

TEST_F(SurfacesOfFiles, TexturesOfMtlFilesAreFoundAndPutTogether) {
  write("Leaf.PNG", png_file(2, 1, 3, {255, 255, 255, 0, 0, 0}));
  write("mask.png", png_file(1, 1, 1, {51}));
  write("rough.png", png_file(1, 1, 1, {102}));
  write("a.mtl",
        "newmtl leaf\nmap_Kd -s 1 1 1 -clamp on .\\leaf.png\nmap_d mask.png\nmap_Bump x.png\n"
        "newmtl metal\nmap_Pr rough.png\nPm 1\nmap_Ke -o 0.5 0 Leaf.PNG\n");
  const Scene read = obj("mtllib a.mtl\n" + kObjSquare + "usemtl leaf\nf 1 2 3\nusemtl metal\nf 1 2 3\n");
  expect_sound(read);
  const Surfaces& surfaces = *read.surfaces;
  const SurfaceMaterial &leaf = surfaces.materials[0], &metal = surfaces.materials[1];
  EXPECT_EQ(leaf.base_color, (Rgba{1, 1, 1, 1}));
  EXPECT_EQ(leaf.alpha_mode, AlphaMode::CutOut);
  const SurfaceTexture& texture = surfaces.textures.at(leaf.base_color_texture.value());
  EXPECT_EQ(texture.wrap_s, shader::Wrap::Clamp);
  EXPECT_EQ(surfaces.images[texture.image].texels,
            (std::vector<uint16_t>{65535, 65535, 65535, 51 * 257, 0, 0, 0, 51 * 257}));
  EXPECT_EQ(metal.metallic, 1);
  EXPECT_EQ(metal.roughness, 1);
  EXPECT_EQ(metal.emission, (Vec3{1, 1, 1}));
  EXPECT_EQ(surfaces.images[surfaces.textures.at(metal.metallic_roughness_texture.value()).image].texels,
            (std::vector<uint16_t>{65535, 102 * 257, 65535, 65535}));
  EXPECT_EQ(warnings(read), (std::vector<std::string>{
                                "a.obj: 1 material with textures of normals, occlusion or other things, which are not "
                                "used",
                                "a.obj: 1 material with textures that are moved or scaled (-o, -s, -t), which is not "
                                "done"}));
}

TEST_F(SurfacesOfFiles, AMissingTextureOfAnMtlFileIsToldOnce) {
  write("a.mtl", "newmtl a\nKd 0.5 0.5 0.5\nmap_Kd wood.png\nnewmtl b\nmap_Kd wood.png\nnewmtl unused\nmap_Kd x.png\n");
  const Scene read = obj("mtllib a.mtl\n" + kObjSquare + "usemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\n");
  expect_sound(read);
  EXPECT_EQ(read.surfaces->materials[0].base_color[0], 0.5f);
  ASSERT_EQ(read.warnings.size(), 1u);
  EXPECT_EQ(warnings(read)[0].rfind("a.obj: image 'wood.png' is left out: it is not in '", 0), 0u);
}

TEST_F(SurfacesOfFiles, VerticesOfAPlyFileKeepNormalsTexcoordsAndColours) {
  const Scene read =
      ply("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
          "property float nx\nproperty float ny\nproperty float nz\nproperty float s\nproperty float t\n"
          "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n"
          "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
          "0 0 0 0 0 1 0 0 255 0 0 255\n1 0 0 0 1 1 1 0.25 0 128 0 51\n0 1 0 0 0 0 0.5 1 0 0 255 0\n3 0 1 2\n");
  expect_sound(read);
  EXPECT_TRUE(read.warnings.empty());
  const Surfaces& surfaces = *read.surfaces;
  const std::vector<Vec3> normals = of_corners(surfaces, surfaces.normals);
  expect_near(normals[1], normalized(Vec3{0, 1, 1}));
  expect_near(normals[2], {0, 0, 1});  // a zero is the triangle's
  EXPECT_EQ(of_corners(surfaces, surfaces.texcoords), (std::vector<Texcoord>{{0, 1}, {1, 0.75f}, {0.5f, 0}}));
  const std::vector<Rgba> colours = of_corners(surfaces, surfaces.colors);
  EXPECT_EQ(colours[0], (Rgba{1, 0, 0, 1}));
  EXPECT_NEAR(colours[1][1], srgb_to_linear(128 / 255.0), 1e-6);
  EXPECT_NEAR(colours[1][3], 0.2, 1e-6);
  EXPECT_EQ(surfaces.materials[0].base_color, (Rgba{1, 1, 1, 1})) << "colours are of vertices alone";
}

TEST_F(SurfacesOfFiles, ALoadedSceneWithSurfacesIsNotTakenFromTheCache) {
  GltfText document = full_triangle();
  const std::string path = write("a.gltf", document.text());
  SceneOptions options;
  options.surfaces = true;
  EXPECT_TRUE(load_scene(path, options).surfaces);
  EXPECT_FALSE(load_scene(path).surfaces);
}

TEST(ImageDecoding, SixteenBitsOfAPngAreKept) {
  // Grey of 16 bits, one texel 0x1234, its deflate block stored.
  const unsigned char kBytes[] = {
      0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0,    0,    0,    13,   'I',  'H',  'D',  'R',  0,    0,
      0,    1,    0,    0,    0,    1,    16,   0,    0,    0,    0,    0x6a, 0xee, 0x47, 0x16, 0,    0,    0,
      14,   'I',  'D',  'A',  'T',  0x78, 0x01, 0x01, 0x03, 0x00, 0xfc, 0xff, 0x00, 0x12, 0x34, 0x00, 0x5b, 0x00,
      0x47, 0,    0,    0,    0,    0,    0,    0,    0,    'I',  'E',  'N',  'D',  0xae, 0x42, 0x60, 0x82};
  const std::string bytes(reinterpret_cast<const char*>(kBytes), sizeof kBytes);
  std::string reason;
  const std::optional<SurfaceImage> image = decode_image(bytes, false, reason);
  ASSERT_TRUE(image) << reason;
  EXPECT_EQ(image->texels, (std::vector<uint16_t>{0x1234, 0x1234, 0x1234, 65535}));
  EXPECT_FALSE(decode_image("GIF89a", false, reason));
  EXPECT_NE(reason.find("not a PNG or JPEG"), std::string::npos);
}

}  // namespace
}  // namespace raypool
