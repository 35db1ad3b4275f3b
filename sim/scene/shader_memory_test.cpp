// What shader sets find in the unit's memory, and what they are refused with.
#include "scene/shader_memory.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <map>
#include <set>
#include <sstream>

#include "config/data_folder.hpp"
#include "files/input_file.hpp"
#include "files/json_text.hpp"
#include "scene/file_fixture.hpp"
#include "scene/image_fixture.hpp"
#include "scene/shader_file.hpp"
#include "scene/shader_lights.hpp"
#include "scene/shader_values.hpp"

namespace raypool {
namespace {

using shader::Binding;
using shader::BindingKind;
using shader::Member;

/// Declares what a test has it declare.
class DeclaredSet : public shader::ShaderSet {
 public:
  explicit DeclaredSet(std::string folder) : folder_(std::move(folder)) {}
  const std::string& folder() const override { return folder_; }
  const std::vector<Binding>& bindings() const override { return bindings_; }
  const std::vector<Member>& push_constants() const override { return push_constants_; }
  const std::vector<shader::ShaderRecord>& shader_records() const override { return records_; }
  bool waits() const override { return false; }
  uint32_t path_words(const std::map<uint32_t, uint32_t>&, uint32_t) const override { return 0; }
  EnumArray<RayKernel, kernel::Function, kRayKernels> record(const shader::Resources&, const KernelTarget&,
                                                             const RecordLayout&) const override {
    throw InputError("nothing is recorded here");
  }

  DeclaredSet& add(uint32_t set, uint32_t binding, BindingKind kind, const std::string& name = "") {
    bindings_.push_back({{set, binding}, name, kind, {}, 0});
    return *this;
  }
  DeclaredSet& add_member(const Member& member) {
    Binding& block = bindings_.back();
    block.members.push_back(member);
    block.bytes = std::max(block.bytes, member.offset + 4 * member.rows * member.columns * member.elements);
    return *this;
  }
  std::vector<Binding> bindings_;
  std::vector<Member> push_constants_;
  std::vector<shader::ShaderRecord> records_;

 private:
  std::string folder_;
};

Member number(const std::string& name, uint32_t offset, bool is_float = true) {
  return {name, offset, 1, 1, 1, 4, 0, 0, is_float};
}
Member vector(const std::string& name, uint32_t offset, uint32_t rows = 3) {
  return {name, offset, rows, 1, 1, 4, 0, 0, true};
}
Member address(const std::string& name, uint32_t offset) { return {name, offset, 1, 1, 1, 4, 0, 0, false, true}; }
Member addresses(const std::string& name, uint32_t offset, uint32_t elements, uint32_t stride) {
  return {name, offset, 1, 1, elements, 8, 0, stride, false, true};
}
Member matrix(const std::string& name, uint32_t offset) { return {name, offset, 4, 4, 1, 4, 16, 0, true}; }

Scene square() {
  Scene scene;
  scene.name = "square";
  scene.vertices = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}};
  scene.triangles = {{0, 1, 2}, {0, 2, 3}};
  scene.triangle_materials = {1, 0};
  scene.materials = {{"red", {0.5f, 0, 0}, {}}, {"mirror", {0, 0, 0}, {0.5f, 0.5f, 0.5f}}};
  scene.camera = {{1, 2, 5}, {0.25f, -0.5f, -1}, {0, 1, 0}, 50};
  scene.light = {{1, 2, 3}, {4, 5, 6}};
  return scene;
}

/// The square with all that vertices and materials have, and one texture.
Scene full_square() {
  Scene scene = square();
  Surfaces surfaces;
  surfaces.triangles = scene.triangles;
  surfaces.positions = scene.vertices;
  surfaces.normals = {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}};
  surfaces.texcoords = {{0, 0}, {1, 0}, {1, 1}, {0, 0.5f}};
  surfaces.colors = {{1, 0, 0, 1}, {0, 1, 0, 1}, {0, 0, 1, 1}, {1, 1, 1, 0.5f}};
  surfaces.materials.resize(2);
  surfaces.materials[1] = {{1, 2, 3, 4}, {5, 6, 7},         8,  9,           10, 11, AlphaMode::Blend,
                           12,           std::optional(0u), 1u, std::nullopt};
  surfaces.images = {{2, 1, {1, 2, 3, 4, 5, 6, 7, 8}}};
  surfaces.textures = {{0, shader::Wrap::Mirror, shader::Wrap::Clamp, true}, {0}};
  scene.surfaces = std::make_shared<const Surfaces>(std::move(surfaces));
  return scene;
}

class ShaderMemoryTest : public FileFixture {
 protected:
  static ShaderFrame frame_of(const Scene& scene, uint32_t width = 64, uint32_t height = 48) {
    return {width, height, 3, 4, 0.125f, camera_numbers(scene, width, height)};
  }
  DeclaredSet set() const { return DeclaredSet(folder_); }
  shader::Resources build(const Scene& scene, const shader::ShaderSet& declared) {
    image_ = build_memory(ray_kernel_program(), scene);
    return build_shader_memory(image_, scene, declared, frame_of(scene));
  }
  float float_at(uint32_t address) const { return as_float(image_.memory.load(address)); }
  std::vector<float> floats(const shader::Buffer& buffer) const {
    std::vector<float> values;
    for (uint32_t i = 0; i < buffer.bytes; i += 4) values.push_back(float_at(buffer.address + i));
    return values;
  }
  std::vector<uint32_t> words(const shader::Buffer& buffer) const {
    std::vector<uint32_t> values;
    for (uint32_t i = 0; i < buffer.bytes; i += 4) values.push_back(image_.memory.load(buffer.address + i));
    return values;
  }
  void describe(const std::string& json) const { write("shaders.json", json); }
  void expect_refusal(const DeclaredSet& declared, const std::string& part) {
    const std::string message = refusal([&] { build(full_square(), declared); });
    EXPECT_NE(message.find(part), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }

  MemoryImage image_;
};

TEST_F(ShaderMemoryTest, BuffersOfRaypoolGlslHoldTheScene) {
  const Scene scene = full_square();
  DeclaredSet declared = set();
  const std::vector<const char*> names = {"raypool_indices", "RaypoolPositions", "", "raypool_texcoords",
                                          "raypool_colors",  "RaypoolMaterials", ""};
  for (uint32_t i = 0; i < names.size(); ++i) declared.add(0, 3 + i, BindingKind::Buffer, names[i]);
  const shader::Resources resources = build(scene, declared);
  for (const auto& [place, buffer] : resources.buffers) {
    EXPECT_EQ(buffer.address % 16, 0u);
    EXPECT_GE(buffer.address, kShaderDataBegin);
    EXPECT_LE(uint64_t{buffer.address} + buffer.bytes, image_.memory.size());
  }
  EXPECT_EQ(words(resources.buffers.at({0, 3})), (std::vector<uint32_t>{0, 1, 2, 0, 2, 3}));
  EXPECT_EQ(floats(resources.buffers.at({0, 4})), (std::vector<float>{0, 0, 0, 2, 0, 0, 2, 2, 0, 0, 2, 0}));
  EXPECT_EQ(floats(resources.buffers.at({0, 5})), (std::vector<float>{0, 0, 1, 1, 0, 0, 0, 1, 0, 0, 0, -1}));
  EXPECT_EQ(floats(resources.buffers.at({0, 6})), (std::vector<float>{0, 0, 1, 0, 1, 1, 0, 0.5f}));
  EXPECT_EQ(floats(resources.buffers.at({0, 7})),
            (std::vector<float>{1, 0, 0, 1, 0, 1, 0, 1, 0, 0, 1, 1, 1, 1, 1, 0.5f}));
  EXPECT_EQ(resources.buffers.at({0, 8}).bytes, 128u);
  EXPECT_EQ(resources.buffers.at({0, 9}).bytes, 80u) << "the scene's own light";
  EXPECT_EQ(resources.width, 64u);
  EXPECT_EQ(resources.height, 48u);
  EXPECT_EQ(image_.memory.size() % 64, 0u);
}

TEST_F(ShaderMemoryTest, MaterialRecordsLeadToTheirMaterialsAndKeepTheirColours) {
  const Scene scene = full_square();
  const shader::Resources resources = build(scene, set());
  EXPECT_TRUE(resources.buffers.empty());
  const MemoryImage before = build_memory(ray_kernel_program(), scene);
  for (uint32_t address = 0; address < before.memory.size(); address += 4) {
    const bool link = address >= before.material_base && address % kMaterialBytes == kMaterialSurface;
    if (link) continue;
    ASSERT_EQ(image_.memory.load(address), before.memory.load(address)) << address;
  }
  const uint32_t second = image_.memory.load(image_.material_base + kMaterialBytes + kMaterialSurface);
  EXPECT_EQ(second % 16, 0u);
  for (uint32_t i = 0; i < 12; ++i) EXPECT_EQ(float_at(second + 4 * i), static_cast<float>(i < 11 ? i + 1 : 12));
  EXPECT_EQ(image_.memory.load(second + 48), 2u);
  EXPECT_EQ(image_.memory.load(second + 52), 1u) << "texture 0 is white";
  EXPECT_EQ(image_.memory.load(second + 56), 2u);
  EXPECT_EQ(image_.memory.load(second + 60), 0u);
}

TEST_F(ShaderMemoryTest, TexturesAreRecordsOfTexels) {
  const Scene scene = full_square();
  const shader::Textures textures =
      build(scene, set().add(0, 10, BindingKind::Textures, "raypool_textures")).textures.at({0, 10});
  ASSERT_EQ(textures.count, 3u);
  EXPECT_EQ(textures.address % 32, 0u);
  const auto word = [&](uint32_t texture, uint32_t index) {
    return image_.memory.load(textures.address + texture * shader::kTextureBytes + 4 * index);
  };
  EXPECT_EQ(word(0, 1), 1u);
  EXPECT_EQ(image_.memory.load(word(0, 0)), 0xffffffffu);
  EXPECT_EQ(image_.memory.load(word(0, 0) + 4), 0xffffffffu);
  EXPECT_EQ(word(1, 0), word(2, 0)) << "two textures of one image";
  EXPECT_EQ(word(1, 0) % 64, 0u);
  EXPECT_EQ(word(1, 1), 2u);
  EXPECT_EQ(word(1, 2), 1u);
  EXPECT_EQ(word(1, 3), 2u | 1u << 2 | 16u);
  EXPECT_EQ(word(2, 3), 0u);
  EXPECT_EQ(image_.memory.load(word(1, 0)), 1u | 2u << 16);
  EXPECT_EQ(image_.memory.load(word(1, 0) + 12), 7u | 8u << 16);
}

TEST_F(ShaderMemoryTest, ASceneWithoutSurfacesIsFlatInItsColours) {
  const shader::Resources resources = build(square(), set()
                                                          .add(0, 3, BindingKind::Buffer)
                                                          .add(0, 5, BindingKind::Buffer)
                                                          .add(0, 7, BindingKind::Buffer)
                                                          .add(0, 8, BindingKind::Buffer));
  EXPECT_EQ(words(resources.buffers.at({0, 3})), (std::vector<uint32_t>{0, 1, 2, 0, 2, 3}));
  const std::vector<float> normals = floats(resources.buffers.at({0, 5}));
  ASSERT_EQ(normals.size(), 12u);
  for (size_t i = 0; i < 12; ++i) EXPECT_EQ(normals[i], i % 3 == 2 ? 1 : 0);
  for (const float channel : floats(resources.buffers.at({0, 7}))) EXPECT_EQ(channel, 1);
  const std::vector<float> materials = floats(resources.buffers.at({0, 8}));
  EXPECT_EQ(materials[0], 0.5f);
  EXPECT_EQ(materials[8], 1) << "roughness";
  EXPECT_EQ(materials[16 + 7], 1) << "a mirror is a smooth metal";
  EXPECT_EQ(materials[16 + 8], 0);
}

TEST_F(ShaderMemoryTest, TheFrameHasWhatTheKernelArgumentsHave) {
  const Scene scene = full_square();
  DeclaredSet declared = set();
  declared.add(0, 2, BindingKind::Block, "raypool_frame");
  declared.add_member(vector("eye", 0)).add_member(vector("corner", 12)).add_member(vector("step_x", 24));
  declared.add_member(vector("step_y", 36)).add_member(vector("light_position", 48));
  declared.add_member(vector("light_color", 60)).add_member(vector("background", 72));
  declared.add_member(number("offset", 84)).add_member(number("width", 88, false));
  declared.add_member(number("height", 92, false)).add_member(number("sample_number", 96, false));
  declared.add_member(number("samples", 100, false)).add_member(number("triangles", 104, false));
  declared.add_member(number("lights", 108, false)).add_member(vector("eye", 112, 4));
  const std::vector<shader::Word> words = build(scene, declared).blocks.at({0, 2});
  ASSERT_EQ(words.size(), 32u);
  const auto arguments = camera_arguments(scene, 64, 48, 32);
  for (size_t i = 0; i < 18; ++i) EXPECT_EQ(words[i].bits, arguments[i]) << i;
  for (size_t i = 18; i < 21; ++i) EXPECT_EQ(words[i].bits, 0u);
  EXPECT_EQ(as_float(words[21].bits), 0.125f);
  EXPECT_EQ(words[22].bits, 64u);
  EXPECT_EQ(words[23].bits, 48u);
  EXPECT_EQ(words[24].argument, std::optional(kSampleArgument));
  EXPECT_EQ(words[25].bits, 4u);
  EXPECT_FALSE(words[25].argument);
  EXPECT_EQ(words[26].bits, 2u);
  EXPECT_EQ(words[27].bits, 1u);
  EXPECT_EQ(words[28].bits, arguments[0]);
  EXPECT_EQ(as_float(words[31].bits), 1);
}

using Matrix4 = std::array<double, 16>;
std::array<double, 4> times(const Matrix4& m, const std::array<double, 4>& v) {
  std::array<double, 4> result{};
  for (size_t row = 0; row < 4; ++row) {
    for (size_t column = 0; column < 4; ++column) result[row] += m[4 * column + row] * v[column];
  }
  return result;
}

TEST_F(ShaderMemoryTest, MatricesOfTutorialsGiveTheDirectionsOfOurPixels) {
  const Scene scene = full_square();
  DeclaredSet declared = set();
  declared.add(0, 2, BindingKind::Block, "cam").add_member(matrix("viewInverse", 0));
  declared.add_member(matrix("projInverse", 64)).add_member(matrix("view", 128)).add_member(matrix("projection", 192));
  declared.add_member(matrix("viewProj", 256));
  const std::vector<shader::Word> words = build(scene, declared).blocks.at({0, 2});
  const auto read = [&](size_t first) {
    Matrix4 m{};
    for (size_t i = 0; i < 16; ++i) m[i] = static_cast<double>(as_float(words[first + i].bits));
    return m;
  };
  const Matrix4 inverse_view = read(0), inverse_projection = read(16), view = read(32), projection = read(48),
                both = read(64);
  const CameraNumbers camera = camera_numbers(scene, 64, 48);
  const auto get = [&](size_t i) { return Vec3d{camera[i], camera[i + 1], camera[i + 2]}; };
  for (const auto& [x, y] : {std::pair(0, 0), {63, 0}, {0, 47}, {40, 11}}) {
    const double dx = (x + 0.5) / 64 * 2 - 1, dy = (y + 0.5) / 48 * 2 - 1;
    const auto target = times(inverse_projection, {dx, dy, 1, 1});
    const Vec3d local = normalized(Vec3d{target[0], target[1], target[2]});
    const auto turned = times(inverse_view, {local.x, local.y, local.z, 0});
    const Vec3d ours = normalized(get(argument::kCorner) + get(argument::kStepX) * static_cast<double>(x) +
                                  get(argument::kStepY) * static_cast<double>(y));
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(turned[static_cast<size_t>(axis)], ours[axis], 1e-6);
    // A point in that direction is drawn at that pixel.
    const Vec3d point = get(argument::kEye) + ours * 3.0;
    for (const auto& clip : {times(projection, times(view, {point.x, point.y, point.z, 1})),
                             times(both, {point.x, point.y, point.z, 1})}) {
      EXPECT_NEAR(clip[0] / clip[3], dx, 1e-5);
      EXPECT_NEAR(clip[1] / clip[3], dy, 1e-5);
      EXPECT_GT(clip[2] / clip[3], 0);
      EXPECT_LT(clip[2] / clip[3], 1);
    }
  }
  EXPECT_NEAR(times(inverse_view, {0, 0, 0, 1})[1], 2, 1e-6) << "the eye";
}

TEST_F(ShaderMemoryTest, AFileDescribesBuffersOfAnyLayout) {
  write("wood.png", png_file(1, 1, 4, {255, 255, 255, 51}));
  describe(R"({"$schema": "../../schemas/shaders.json", "bindings": [
    {"set": 1, "binding": 0, "holds": {"interleaved": ["position", 1, "normal", "texcoord"], "pad_to": 48}},
    {"set": 1, "binding": 1, "holds": "indices"},
    {"set": 1, "binding": 2, "holds": {"floats": [0.5, -2]}},
    {"set": 1, "binding": 3, "holds": {"integers": [7, -1, 4294967295]}},
    {"set": 1, "binding": 4, "holds": {"images": ["wood.png", "wood.png"], "srgb": false}},
    {"set": 1, "binding": 5, "values": {"light": [1, 2, 3], "count": 9, "eye": "light_position",
      "grid": [[1, 2], [3, 4]]}},
    {"set": 1, "binding": 6, "holds": "tree"}],
    "push_constants": {"scale": 2.5},
    "specialization": {"0": 4, "1": 0.5, "7": true, "8": -1}})");
  DeclaredSet declared = set();
  for (uint32_t i = 0; i < 4; ++i) declared.add(1, i, BindingKind::Buffer, "anything");
  declared.bindings_[3].bytes = 12;
  declared.add(1, 4, BindingKind::Textures, "image").add(1, 6, BindingKind::Tree);
  declared.add(1, 5, BindingKind::Block, "b").add_member(vector("light", 0)).add_member(number("count", 12, false));
  declared.add_member(vector("eye", 16)).add_member({"grid", 32, 2, 1, 2, 4, 0, 16, true});
  declared.push_constants_ = {vector("light_color", 0), number("scale", 12)};
  const shader::Resources resources = build(full_square(), declared);
  const std::vector<float> vertices = floats(resources.buffers.at({1, 0}));
  ASSERT_EQ(vertices.size(), 48u);
  EXPECT_EQ(std::vector<float>(vertices.begin() + 36, vertices.end()),
            (std::vector<float>{0, 2, 0, 1, 0, 0, -1, 0, 0.5f, 0, 0, 0}));
  EXPECT_EQ(words(resources.buffers.at({1, 1})), (std::vector<uint32_t>{0, 1, 2, 0, 2, 3}));
  EXPECT_EQ(floats(resources.buffers.at({1, 2})), (std::vector<float>{0.5f, -2}));
  EXPECT_EQ(words(resources.buffers.at({1, 3})), (std::vector<uint32_t>{7, 0xffffffff, 0xffffffff}));
  EXPECT_EQ(resources.textures.at({1, 4}).count, 2u);
  const uint32_t texels = image_.memory.load(resources.textures.at({1, 4}).address);
  EXPECT_EQ(image_.memory.load(texels + 4), 65535u | 51u * 257 << 16);
  const std::vector<shader::Word>& block = resources.blocks.at({1, 5});
  EXPECT_EQ(as_float(block[2].bits), 3);
  EXPECT_EQ(block[3].bits, 9u);
  EXPECT_EQ(as_float(block[5].bits), 2) << "the light's y";
  EXPECT_EQ(as_float(block[9].bits), 2);
  EXPECT_EQ(as_float(block[12].bits), 3);
  ASSERT_EQ(resources.push_constants.size(), 4u);
  EXPECT_EQ(as_float(resources.push_constants[1].bits), 5);
  EXPECT_EQ(as_float(resources.push_constants[3].bits), 2.5f);
  EXPECT_EQ(resources.specialization,
            (std::map<uint32_t, uint32_t>{{0, 4}, {1, as_bits(0.5f)}, {7, 1}, {8, 0xffffffff}}));
}

TEST_F(ShaderMemoryTest, AFileDescribesBuffersThatOthersNameByTheirAddresses) {
  describe(R"({"bindings": [
    {"binding": 2, "holds": {"words": [7, 0.5, {"address": "triangle_materials"}, {"address": {"integers": [3]}}]}},
    {"binding": 3, "values": {"scene.vertices": {"address": {"interleaved": ["normal", -1]}}}}],
    "push_constants": {"numbers": {"address": {"integers": [3]}}}})");
  DeclaredSet declared = set().add(0, 2, BindingKind::Buffer, "objects");
  declared.add(0, 3, BindingKind::Block, "b").add_member(address("scene.vertices", 8));
  declared.push_constants_ = {address("numbers", 0)};
  const shader::Resources resources = build(full_square(), declared);
  const std::vector<uint32_t> objects = words(resources.buffers.at({0, 2}));
  ASSERT_EQ(objects.size(), 6u);
  EXPECT_EQ(objects[0], 7u);
  EXPECT_EQ(as_float(objects[1]), 0.5f);
  EXPECT_EQ(words({objects[2], 8}), (std::vector<uint32_t>{1, 0}));
  EXPECT_EQ(objects[3], 0u) << "the upper half of an address";
  EXPECT_EQ(words({objects[4], 4}), (std::vector<uint32_t>{3}));
  EXPECT_EQ(resources.push_constants.at(0).bits, objects[4]) << "what is alike is there once";
  EXPECT_EQ(resources.push_constants.at(1).bits, 0u);
  const std::vector<shader::Word>& block = resources.blocks.at({0, 3});
  ASSERT_EQ(block.size(), 4u);
  const std::vector<uint32_t> vertex = words({block[2].bits + 16, 16});
  EXPECT_EQ(as_float(vertex[0]), 1) << "of the second vertex";
  EXPECT_EQ(as_float(vertex[3]), -1);
}

TEST_F(ShaderMemoryTest, EachElementOfAnArrayOfAddressesHasItsOwn) {
  describe(R"({"bindings": [{"binding": 3, "values": {
      "buffers": [{"address": {"integers": [5]}}, {"address": {"integers": [6]}}, {"address": {"integers": [7]}}],
      "two": [[{"address": {"integers": [7]}}], [{"address": {"integers": [8]}}]]}}],
    "push_constants": {"pair": {"address": {"integers": [9]}},
      "pairs": [{"address": {"integers": [10]}}, {"address": {"integers": [11]}}]}})");
  DeclaredSet declared = set().add(0, 3, BindingKind::Block, "b");
  declared.add_member(addresses("buffers", 16, 3, 16)).add_member({"two", 64, 2, 1, 1, 8, 0, 0, false, true});
  declared.push_constants_ = {{"pair", 0, 2, 1, 1, 4, 0, 0, false}, {"pairs", 8, 2, 1, 2, 4, 0, 8, false}};
  const shader::Resources resources = build(full_square(), declared);
  const auto leads_to = [&](const std::vector<shader::Word>& all, size_t word) {
    EXPECT_EQ(all.at(word + 1).bits, 0u) << "the upper half of an address";
    return words({all[word].bits, 4}).at(0);
  };
  const std::vector<shader::Word>& block = resources.blocks.at({0, 3});
  for (uint32_t i = 0; i < 3; ++i) EXPECT_EQ(leads_to(block, 4 + 4 * i), 5 + i);
  EXPECT_EQ(leads_to(block, 16), 7u);
  EXPECT_EQ(leads_to(block, 18), 8u);
  for (uint32_t i = 0; i < 3; ++i) EXPECT_EQ(leads_to(resources.push_constants, 2 * i), 9 + i);

  const auto refused = [&](const std::string& buffers, const std::string& part) {
    describe(R"({"bindings": [{"binding": 3, "values": {"buffers": )" + buffers + "}}]}");
    DeclaredSet one = set().add(0, 3, BindingKind::Block, "b").add_member(addresses("buffers", 16, 3, 16));
    expect_refusal(one, part);
  };
  refused(R"({"address": "indices"})",
          "values.buffers has 1 address, and member 'buffers' has room for 3: give as many");
  refused(R"([{"address": "indices"}, 7, 8])", "values.buffers[1] is 7");
  describe(R"({"push_constants": {"scale": {"address": "indices"}}})");
  DeclaredSet scaled = set();
  scaled.push_constants_ = {vector("scale", 0, 2)};
  expect_refusal(scaled, "push_constants.scale is an address, and member 'scale' has no room for one: declare it");
}

TEST_F(ShaderMemoryTest, AFileDescribesMaterialsOfAnyLayout) {
  describe(R"({"bindings": [{"binding": 2, "holds": {"pad_to": 96, "materials": [
    "base_color", "diffuse", "specular", "emission", "metallic", "roughness", "transmission", "ior", "alpha",
    "alpha_cutoff", "alpha_mode", "illum", 5]}},
    {"binding": 3, "holds": {"materials": ["base_color_texture", "emission_texture", "metallic_roughness_texture",
      "shininess"]}}]})");
  Scene scene = full_square();
  auto surfaces = std::make_shared<Surfaces>(*scene.surfaces);
  surfaces->materials[0].metallic = 1;
  surfaces->materials[0].roughness = 0.0625f;
  surfaces->materials[1].metallic = 0.5f;
  surfaces->materials[1].roughness = 0.5f;
  scene.surfaces = surfaces;
  const shader::Resources resources =
      build(scene, set().add(0, 2, BindingKind::Buffer, "a").add(0, 3, BindingKind::Buffer, "b"));
  const std::vector<uint32_t> all = words(resources.buffers.at({0, 2}));
  ASSERT_EQ(all.size(), 48u);
  std::vector<float> second;
  for (size_t i = 24; i < 24 + 19; ++i) second.push_back(as_float(all[i]));
  EXPECT_EQ(second,
            (std::vector<float>{1, 2, 3, 4, 0.5f, 1, 1.5f, 0.52f, 1.02f, 1.52f, 5, 6, 7, 0.5f, 0.5f, 10, 11, 4, 12}));
  EXPECT_EQ(std::vector<uint32_t>(all.begin() + 43, all.end()), (std::vector<uint32_t>{2, 4, 5, 0, 0}));
  EXPECT_EQ(all[20], 3u) << "a smooth metal is a mirror of MTL";
  const std::vector<uint32_t> textures = words(resources.buffers.at({0, 3}));
  EXPECT_EQ(std::vector<uint32_t>(textures.begin() + 4, textures.begin() + 7), (std::vector<uint32_t>{1, 2, 0}));
  EXPECT_EQ(as_float(textures[7]), 30) << "2 / 0.5^4 - 2";
}

TEST_F(ShaderMemoryTest, AFileHasTheTableOfShadersAndTheirRecords) {
  describe(R"({"ray_generation": {"shader": "b.rgen", "record": {"color": [1, 2, 3]}},
    "miss": ["z.rmiss", {"shader": "a.rmiss", "record": {"weight": 4, "eye": "light_position"}}],
    "hit_groups": [{"closest_hit": "a.rchit", "any_hit": "b.rahit"}, {"any_hit": "c.rahit", "record": {"weight": 5}}],
    "callable": ["sun.rcall"], "geometries": "materials"})");
  const ShaderFile file(folder_);
  const shader::ShaderTable table = file.table();
  EXPECT_EQ(table.ray_generation, "b.rgen");
  EXPECT_EQ(table.misses, (std::vector<std::string>{"z.rmiss", "a.rmiss"}));
  EXPECT_EQ(table.callables, std::vector<std::string>{"sun.rcall"});
  ASSERT_EQ(table.hit_groups.size(), 2u);
  EXPECT_EQ(table.hit_groups[0].any_hit, "b.rahit");
  EXPECT_EQ(table.hit_groups[1].closest_hit, "");
  EXPECT_TRUE(file.geometries_are_materials());
  DeclaredSet declared = set();
  declared.records_ = {{{shader::RecordStage::RayGeneration, 0}, "b.rgen", {vector("color", 0)}, 12},
                       {{shader::RecordStage::Miss, 1}, "a.rmiss", {number("weight", 0), vector("eye", 4)}, 16},
                       {{shader::RecordStage::HitGroup, 1}, "c.rahit", {number("weight", 4)}, 8}};
  const shader::Resources resources = build(full_square(), declared);
  EXPECT_EQ(as_float(resources.records.at({shader::RecordStage::RayGeneration, 0}).at(2).bits), 3);
  EXPECT_EQ(as_float(resources.records.at({shader::RecordStage::Miss, 1}).at(0).bits), 4);
  EXPECT_EQ(as_float(resources.records.at({shader::RecordStage::Miss, 1}).at(3).bits), 3) << "the light's z";
  EXPECT_EQ(as_float(resources.records.at({shader::RecordStage::HitGroup, 1}).at(1).bits), 5);
  EXPECT_EQ(resources.geometries, image_.material_base);
  declared.records_ = {{{shader::RecordStage::Callable, 0}, "sun.rcall", {number("power", 0), number("size", 4)}, 8}};
  expect_refusal(declared, "shader record 0 of sun.rcall: members 'power', 'size' have no value: give them some");
}

TEST_F(ShaderMemoryTest, MistakesInTheTableAreNamedWithTheirPlace) {
  const auto refused = [&](const std::string& json, const std::string& part) {
    describe(json);
    const std::string message = refusal([&] { const ShaderFile file(folder_); });
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  refused(R"({"hit_groups": [{"closest": "a.rchit"}]})",
          "hit_groups[0] has the unknown key 'closest': did you mean closest_hit?");
  refused(R"({"miss": ["a.rmiss", {"record": {}}]})", "miss[1] has no 'shader'");
  refused(R"({"callable": [7]})", "callable[0] is 7");
  refused(R"({"geometries": "objects"})", "geometries must be \"materials\"");
  refused(R"({"ray_generation": {"shader": "a.rgen", "values": {}}})", "ray_generation has the unknown key 'values'");
  describe(R"({"push_constants": {}})");
  DeclaredSet declared = set();
  declared.push_constants_ = {address("numbers", 0)};
  expect_refusal(declared, "member 'numbers' is the address of a buffer: say in");
  describe(R"({"push_constants": {"numbers": 7}})");
  expect_refusal(declared, "push_constants.numbers is 7");
  describe(R"({"bindings": [{"binding": 2, "holds": {"materials": ["colour"]}}]})");
  expect_refusal(set().add(0, 2, BindingKind::Buffer, "b"), "is 'colour', which is nothing of a material");
}

TEST_F(ShaderMemoryTest, WhatIsNotKnownIsAskedForByNameOfSetBindingAndMember) {
  expect_refusal(set().add(2, 1, BindingKind::Buffer, "Vertices"),
                 "set 2, binding 1 ('Vertices') is a buffer that raypool.glsl does not declare: say in");
  DeclaredSet block = set().add(0, 2, BindingKind::Block, "cam").add_member(vector("sunDirection", 0));
  expect_refusal(block, "set 0, binding 2 ('cam'): member 'sunDirection' has no value: give it one");
  expect_refusal(set().add(0, 2, BindingKind::Block, "cam").add_member(vector("width", 0)),
                 "member 'width' is 3 numbers, and the value of this name is one number");
  expect_refusal(set().add(0, 2, BindingKind::Block, "cam").add_member(number("offset", 0, false)),
                 "member 'offset' is of integers, and the value of this name of floats");
  expect_refusal(set().add(0, 2, BindingKind::Block, "cam").add_member(number("sample", 0)),
                 "member 'sample' is of floats, and the value of this name of integers");
  DeclaredSet pushed = set();
  pushed.push_constants_ = {number("time", 0)};
  expect_refusal(pushed, "push constants: member 'time' has no value");
  DeclaredSet large = set().add(0, 3, BindingKind::Buffer, "raypool_indices");
  large.bindings_[0].bytes = 100;
  expect_refusal(large, "binding 3 ('raypool_indices') has 24 bytes, and the shaders declare 100");
  const auto refused = [&](const std::string& json, const DeclaredSet& declared, const std::string& part) {
    describe(json);
    expect_refusal(declared, part);
    EXPECT_EQ(refusal([&] { build(full_square(), declared); }).rfind("shaders.json: ", 0), 0u);
  };
  const auto binding = [](const std::string& rest) { return R"({"bindings": [{"binding": 2, )" + rest + "}]}"; };
  refused("[1]", set(), "must be an object");
  refused(R"({"bindngs": []})", set(), "unknown key 'bindngs': did you mean bindings?");
  refused(binding(R"("set": -1, "holds": "tree")"), set(), "bindings[0].set is -1");
  refused(binding(R"("set": 0)"), set(), "bindings[0] must have either 'holds' or");
  refused(R"({"bindings": [{"binding": 2, "holds": "tree"}, {"binding": 2, "holds": "tree"}]})", set(),
          "bindings[1] is the second one of set 0, binding 2");
  refused(R"({"specialization": {"a": 1}})", set(), "has the key 'a'; keys are constant_ids");
  refused(binding(R"("values": {"sunDirection": "sun"})"), block, "sunDirection is 'sun', which is no known value");
  refused(binding(R"("values": {"sunDirection": [1, 2]})"), block,
          "sunDirection has 2 numbers; member 'sunDirection' is 3 numbers: give 3");
  refused(binding(R"("values": {"sunDirection": [1, 2, "x"]})"), block, "sunDirection[2] is \"x\"");
  refused(binding(R"("holds": "indices")"), block, "declare as a uniform block: give it 'values'");
  const DeclaredSet buffer = set().add(0, 2, BindingKind::Buffer, "b");
  refused(binding(R"("values": {})"), buffer, "declare as a buffer: say what it 'holds'");
  refused(binding(R"("holds": "position")"), buffer, "is 'position', which is no buffer: did you mean positions?");
  refused(binding(R"("holds": {"interleaved": ["tangent"]})"), buffer, "is 'tangent', which is nothing of a vertex");
  refused(binding(R"("holds": {"interleaved": ["position"], "pad_to": 8})"), buffer,
          "must be a multiple of 4 and at least the 12 bytes of an element");
  refused(binding(R"("holds": {"floats": [1], "integers": [1]})"), buffer, "must have one of");
  refused(binding(R"("holds": {"integers": [0.5]})"), buffer, "must be a whole number");
  refused(binding(R"("holds": {"images": ["../wood.png"]})"), set().add(0, 2, BindingKind::Textures),
          "images[0] must be a file in the folder of this one");
  refused(binding(R"("holds": "picture")"), set().add(0, 2, BindingKind::Tree), "let it hold \"tree\"");
  refused(binding(R"("holds": "wood.png")"), set().add(0, 2, BindingKind::Textures), "must be \"textures\", or images");
}

TEST_F(ShaderMemoryTest, WordsOfPathsAreSavedBehindAllElse) {
  const shader::Resources resources = build(full_square(), set().add(0, 9, BindingKind::Buffer));
  EXPECT_EQ(resources.saved, image_.memory.size());
  EXPECT_EQ(resources.saved % 64, 0u);
  const shader::Buffer& last = resources.buffers.at({0, 9});
  EXPECT_GE(resources.saved, last.address + last.bytes);
}

TEST_F(ShaderMemoryTest, EachLightIsChosenWithItsProbability) {
  Scene scene = full_square();
  Surfaces surfaces = *scene.surfaces;
  surfaces.materials[0].emission = {2, 2, 2};
  surfaces.materials[1] = {};
  SurfaceLight light;
  for (const float color : {0.5f, 0.0f, 3.0f, 1.0f}) {
    light.color = {color, color, color};
    light.kind = color == 3 ? SurfaceLight::Kind::Spot : SurfaceLight::Kind::Point;
    light.inner_cone = 0.25f;
    light.outer_cone = 0.5f;
    surfaces.lights.push_back(light);
  }
  const ShaderLights chosen = shader_lights(scene, surfaces, scene.bounds().diagonal());
  ASSERT_EQ(chosen.lights.size(), 5u);
  std::vector<double> probabilities(5);
  for (size_t i = 0; i < 5; ++i) {
    const ShaderLight& each = chosen.lights[i];
    probabilities[i] += static_cast<double>(each.threshold) / 5;
    probabilities.at(each.other) += (1 - static_cast<double>(each.threshold)) / 5;
  }
  double sum = 0;
  for (size_t i = 0; i < 5; ++i) {
    EXPECT_NEAR(probabilities[i], chosen.lights[i].probability, 1e-6) << i;
    sum += probabilities[i];
  }
  EXPECT_NEAR(sum, 1, 1e-6);
  EXPECT_EQ(chosen.lights[1].probability, 0);
  const ShaderLight &triangle = chosen.lights[4], &spot = chosen.lights[2];
  EXPECT_EQ(triangle.kind, ShaderLight::kTriangle);
  EXPECT_EQ(triangle.triangle, 1u);
  EXPECT_NEAR(triangle.probability, 2 * 2 / chosen.total_weight, 1e-6) << "area 2, luminance 2";
  EXPECT_NEAR(std::cos(0.25f) * spot.spot_scale + spot.spot_offset, 1, 1e-5);
  EXPECT_NEAR(std::cos(0.5f) * spot.spot_scale + spot.spot_offset, 0, 1e-5);

  surfaces.materials[0].emission_texture = 0;
  surfaces.lights.clear();
  const ShaderLights own = shader_lights(scene, surfaces, 1);
  ASSERT_EQ(own.lights.size(), 1u) << "what has a texture is found by rays alone";
  EXPECT_EQ(own.lights[0].kind, ShaderLight::kLamp);
  EXPECT_EQ(own.lights[0].color, scene.light.color);
  EXPECT_EQ(own.lights[0].probability, 1);
}

/// A shelf between a floor and a sun, seen from below the shelf, where a point light is.
Scene shaded_floor() {
  Scene scene;
  for (const float height : {0.0f, 2.0f}) {
    const auto first = static_cast<uint32_t>(scene.vertices.size());
    const float wide = height > 0 ? 20 : 4;
    for (const auto& [x, z] : {std::pair(-wide, wide), {wide, wide}, {wide, -wide}, {-wide, -wide}})
      scene.vertices.push_back({x, height, z});
    scene.triangles.push_back({first, first + 1, first + 2});
    scene.triangles.push_back({first, first + 2, first + 3});
    scene.triangle_materials.insert(scene.triangle_materials.end(), 2, 0);
  }
  scene.materials = {{"grey", {0.5f, 0.5f, 0.5f}, {}}};
  scene.camera = {{0, 1, 3}, {0, -0.3f, -1}, {0, 1, 0}, 50};
  Surfaces surfaces = surfaces_of(scene);
  SurfaceLight sun, bulb;
  sun.kind = SurfaceLight::Kind::Directional;
  sun.direction = {0, -1, 0};
  sun.color = {2, 2, 2};
  bulb.position = {0, 1, 0};
  bulb.color = {1, 1, 1};
  surfaces.lights = {sun, bulb};
  scene.surfaces = std::make_shared<const Surfaces>(std::move(surfaces));
  return scene;
}

TEST_F(ShaderMemoryTest, LightsThatLightWhatIsSeenAreChosenMoreOften) {
  const Scene scene = shaded_floor();
  const float diagonal = scene.bounds().diagonal();
  const ShaderFrame frame = frame_of(scene);
  const auto sun = [&](const Surfaces& surfaces, const ShaderFrame* seen) {
    const ShaderLights chosen = shader_lights(scene, surfaces, diagonal, seen);
    EXPECT_NEAR(chosen.lights[0].probability + chosen.lights[1].probability, 1, 1e-6);
    return chosen.lights[0].probability;
  };
  Surfaces surfaces = *scene.surfaces;
  EXPECT_GT(sun(surfaces, nullptr), 0.9) << "by its power";
  EXPECT_LT(sun(surfaces, &frame), 0.11) << "it is behind the shelf";
  EXPECT_GT(sun(surfaces, &frame), 0.05) << "a survey may overlook something";
  EXPECT_EQ(sun(surfaces, &frame), sun(surfaces, &frame)) << "the same each time";
  surfaces.lights[0].direction = {0, 0.1f, -1};
  surfaces.lights[0].direction = normalized(surfaces.lights[0].direction);
  EXPECT_LT(sun(surfaces, &frame), 0.5) << "from below the floor's edge";
  surfaces.lights[0].direction = {0, -1, 0};
  surfaces.lights[1].position = {0, 9, 0};
  EXPECT_NEAR(sun(surfaces, &frame), sun(surfaces, nullptr), 1e-6) << "none is seen: by power";
}

TEST_F(ShaderMemoryTest, TrianglesAreChosenWithTheProbabilityThatShadersCompute) {
  Scene scene = shaded_floor();
  Surfaces surfaces = *scene.surfaces;
  // The shelf shines.
  surfaces.materials.push_back(surfaces.materials[0]);
  surfaces.materials[1].emission = {3, 3, 3};
  scene.triangle_materials = {0, 0, 1, 1};
  const ShaderFrame frame = frame_of(scene);
  const ShaderLights chosen = shader_lights(scene, surfaces, scene.bounds().diagonal(), &frame);
  ASSERT_EQ(chosen.lights.size(), 4u);
  double sum = 0;
  for (const ShaderLight& each : chosen.lights) sum += static_cast<double>(each.probability);
  EXPECT_NEAR(sum, 1, 1e-6);
  for (const size_t i : {2, 3}) EXPECT_NEAR(chosen.lights[i].probability, 800 * 3 / chosen.total_weight, 1e-5);
  EXPECT_GT(chosen.lights[2].probability, 0.25) << "nothing else is so bright below it";
  EXPECT_GT(chosen.lights[1].probability, 0.02) << "by its power the bulb had a part in three thousand";
}

TEST_F(ShaderMemoryTest, AlphaIsWithinItsSphere) {
  Scene scene = full_square();
  const auto values = [&] {
    return shader_values(scene, *scene.surfaces, shader_lights(scene, *scene.surfaces, 1), frame_of(scene), 1);
  };
  // Triangle 0, with corners (0, 0), (2, 0) and (2, 2), is blended.
  EXPECT_EQ(values().at("alpha_center").numbers, (std::vector<double>{1, 1, 0}));
  EXPECT_NEAR(values().at("alpha_radius").numbers[0], std::sqrt(2.0), 1e-3);
  auto surfaces = std::make_shared<Surfaces>(*scene.surfaces);
  surfaces->materials[1].alpha_mode = AlphaMode::Opaque;
  scene.surfaces = surfaces;
  EXPECT_EQ(values().at("alpha_radius").numbers[0], 0);
}

TEST_F(ShaderMemoryTest, TheSchemaListsTheKnownValues) {
  const Scene scene = full_square();
  const ShaderValues values =
      shader_values(scene, *scene.surfaces, shader_lights(scene, *scene.surfaces, 1), frame_of(scene), 1);
  std::set<std::string> known;
  for (const auto& value : values) known.insert(value.first);
  const std::string path = data_folder() + "/schemas/shaders.json";
  const auto schema = parse_json(read_text_file(path, "schema"), path);
  const auto& listed = schema["definitions"]["values"]["additionalProperties"]["oneOf"][0]["enum"];
  EXPECT_EQ(listed.get<std::set<std::string>>(), known);
}

/// What a command prints, with its errors.
std::string output_of(const std::string& command) {
  std::string text;
  FILE* const pipe = popen((command + " 2>&1").c_str(), "r");
  std::array<char, 4096> part{};
  while (pipe != nullptr && fgets(part.data(), part.size(), pipe) != nullptr) text += part.data();
  if (pipe == nullptr || pclose(pipe) != 0) ADD_FAILURE() << command << ": " << text;
  return text;
}

TEST_F(ShaderMemoryTest, StructsOfRaypoolGlslHaveTheLayoutOfTheMemory) {
  const std::string source = write("a.rchit", R"(#version 460
#extension GL_GOOGLE_include_directive : require
#include "raypool.glsl"
layout(location = 0) rayPayloadInEXT vec3 color;
hitAttributeEXT RaypoolHit hit;
void main() {
  const uint triangle = gl_PrimitiveID, seed = raypool_seed(gl_LaunchIDEXT.xy, hit.depth);
  const vec3 start = raypool_offset_origin(gl_WorldRayOriginEXT, gl_WorldRayDirectionEXT, gl_HitTEXT, hit.normal);
  const RaypoolMaterial material = raypool_material(hit.material);
  const uint light = raypool_choose_light(raypool_random(seed, 0u));
  const RaypoolLit lit = raypool_light(light, start, vec2(raypool_random(seed, 1u), raypool_random(seed, 2u)));
  color += raypool_record(hit.material).diffuse + raypool_materials[0].emission + lit.irradiance +
           raypool_normal(triangle, hit.barycentrics) + raypool_position(triangle, hit.barycentrics) +
           raypool_texture(material.base_color_texture, raypool_texcoord(triangle, hit.barycentrics)).rgb +
           raypool_color(triangle, hit.barycentrics).rgb + raypool_eye_direction(gl_LaunchIDEXT.xy) +
           raypool_light_likelihood(gl_WorldRayDirectionEXT, gl_HitTEXT, hit.normal, material.emission, 0u);
  imageStore(raypool_picture, ivec2(gl_LaunchIDEXT.xy), vec4(color, 0.0));
}
)");
  output_of(fmt::format("glslangValidator -V --target-env vulkan1.2 '-I{}/shaders' '{}' -o '{}.spv'", data_folder(),
                        source, source));
  std::istringstream text(output_of(fmt::format("spirv-dis '{}.spv'", source)));
  std::map<std::string, std::map<uint32_t, uint32_t>> offsets;  // [struct][member]
  for (std::string line; std::getline(text, line);) {
    std::istringstream words(line);
    std::string key, type, what;
    uint32_t member = 0, offset = 0;
    if (words >> key >> type >> member >> what >> offset && key == "OpMemberDecorate" && what == "Offset")
      offsets[type.substr(0, type.find('_'))][member] = offset;  // some types are there twice, one without a layout
  }
  const auto expect_offsets = [&](const std::string& type, const std::vector<uint32_t>& expected) {
    ASSERT_EQ(offsets[type].size(), expected.size()) << type;
    for (uint32_t i = 0; i < expected.size(); ++i) EXPECT_EQ(offsets[type][i], expected[i]) << type << " " << i;
  };
  expect_offsets("%RaypoolMaterial", {0, 12, 16, 28, 32, 36, 40, 44, 48, 52, 56, 60});
  expect_offsets("%RaypoolLight", {0, 12, 16, 28, 32, 44, 48, 60, 64, 68, 72, 76});
  expect_offsets("%RaypoolRecord", {kMaterialDiffuse, kMaterialSurface, kMaterialReflectance});
  EXPECT_EQ(offsets["%RaypoolFrame"].size(), 19u);
}

}  // namespace
}  // namespace raypool
