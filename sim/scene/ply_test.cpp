#include <fmt/format.h>

#include <algorithm>

#include "bits.hpp"
#include "scene/file_fixture.hpp"
#include "scene/scene_file.hpp"

namespace raypool {
namespace {

class Ply : public FileFixture {
 protected:
  Scene load(const std::string& bytes) const { return load_ply(write("a.ply", bytes)); }
  void expect_refusal(const std::string& bytes, const std::string& start, const std::string& part) const {
    const std::string message = refusal([&] { load(bytes); });
    EXPECT_EQ(message.rfind(start, 0), 0u) << message;
    EXPECT_NE(message.find(part), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
};

std::string header(const std::string& format, size_t vertices, size_t faces, const std::string& more = "") {
  return "ply\nformat " + format + " 1.0\ncomment of a test\nelement vertex " + std::to_string(vertices) +
         "\nproperty float x\nproperty float y\nproperty float z\n" + more + "element face " + std::to_string(faces) +
         "\nproperty list uchar int vertex_indices\nend_header\n";
}

const std::string kSquare = header("ascii", 4, 1) + "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";

std::string binary(const Scene& scene, bool big_endian) {
  std::string bytes =
      header(big_endian ? "binary_big_endian" : "binary_little_endian", scene.vertices.size(), scene.triangles.size());
  for (const Vec3& v : scene.vertices) {
    for (int axis = 0; axis < 3; ++axis) append(bytes, v[axis], big_endian);
  }
  for (const auto& triangle : scene.triangles) {
    bytes += '\3';
    for (const uint32_t index : triangle) append(bytes, index, big_endian);
  }
  return bytes;
}

TEST_F(Ply, TextAndBinaryOfBothEndsGiveTheTrianglesAndThePictureOfTheObj) {
  Scene scene = load_scene("cornell", {0.05, "", {}, ""});
  scene.materials = {{"default_grey", {0.5f, 0.5f, 0.5f}, {}}};
  std::fill(scene.triangle_materials.begin(), scene.triangle_materials.end(), 0);
  const Camera camera = scene.camera;
  const PointLight light = scene.light;
  write_obj(scene, folder_ + "/a.obj");
  const Scene obj = load_obj(folder_ + "/a.obj");
  std::string text = header("ascii", obj.vertices.size(), obj.triangles.size());
  for (const Vec3& v : obj.vertices) text += fmt::format("{} {} {}\n", v.x, v.y, v.z);
  for (const auto& t : obj.triangles) text += fmt::format("3 {} {} {}\n", t[0], t[1], t[2]);
  const auto picture = [&](Scene drawn) {
    drawn.camera = camera;
    drawn.light = light;
    return picture_of(drawn);
  };
  for (const std::string& bytes : {text, binary(obj, false), binary(obj, true)}) {
    const Scene ply = load(bytes);
    EXPECT_EQ(corners_of(ply), corners_of(obj));
    EXPECT_EQ(ply.triangle_materials, obj.triangle_materials);
    EXPECT_LT(ply.vertices.size(), obj.vertices.size());
    EXPECT_EQ(picture(ply), picture(obj));
  }
}

TEST_F(Ply, BinaryDataMayBeginWithAnyByte) {
  Scene scene;
  scene.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  scene.triangles = {{0, 1, 2}};
  const uint32_t line_feed = 0x3f80000a;
  std::memcpy(&scene.vertices[0].x, &line_feed, 4);
  EXPECT_EQ(corners_of(load(binary(scene, false))), corners_of(scene));
}

TEST_F(Ply, PolygonsAndStripsBecomeTriangles) {
  EXPECT_EQ(load(kSquare + "4 0 1 2 3\n").triangles.size(), 2u);
  // A notch stays open: the corner 3 is inside the hull.
  const Scene notch = load(header("ascii", 5, 1) + "0 0 0\n4 0 0\n4 4 0\n2 1 0\n0 4 0\n5 0 1 2 3 4\n");
  double area = 0;
  for (size_t i = 0; i < notch.triangles.size(); ++i) {
    const Vec3 a = notch.corner(i, 0);
    area += static_cast<double>(length(cross(notch.corner(i, 1) - a, notch.corner(i, 2) - a))) / 2;
  }
  EXPECT_EQ(area, 10);
  const std::string strips =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\n"
      "element tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n";
  const Scene strip = load(strips + "8 0 1 2 3 -1 3 2 1\n");
  const Vec3 a{0, 0, 0}, b{1, 0, 0}, c{0, 1, 0}, d{1, 1, 0};
  EXPECT_EQ(corners_of(strip), (std::vector<Vec3>{a, b, c, c, b, d, d, c, b}));
}

TEST_F(Ply, VerticesOfColourGiveMaterials) {
  const std::string colours = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  const Scene scene = load(header("ascii", 5, 3, colours) +
                           "0 0 0 255 0 0\n1 0 0 255 0 0\n0 1 0 255 0 0\n1 1 0 0 0 0\n0 0 1 255 0 0\n"
                           "3 0 1 2\n3 1 3 2\n3 0 1 4\n");
  ASSERT_EQ(scene.materials.size(), 2u);
  EXPECT_EQ(scene.triangle_materials, (std::vector<uint32_t>{0, 1, 0}));
  EXPECT_EQ(scene.materials[0].kd, (Vec3{1, 0, 0}));
  EXPECT_EQ(scene.materials[1].name, "colour_a00");
  EXPECT_NEAR(scene.materials[1].kd.x, 0.402, 0.001);  // sRGB 2/3
  EXPECT_EQ(load(kSquare + "3 0 1 2\n").materials[0].name, "default_grey");
}

TEST_F(Ply, OtherElementsAndPropertiesArePassedOver) {
  std::string bytes =
      "ply\r\nformat binary_little_endian 1.0\r\nobj_info x\r\nelement camera 1\r\nproperty double f\r\n"
      "property list uchar short l\r\nelement vertex 3\r\nproperty float x\r\nproperty float y\r\nproperty uchar "
      "quality\r\nproperty float z\r\nelement face 1\r\nproperty uchar flags\r\nproperty list ushort uint "
      "vertex_index\r\nend_header\r\n";
  append(bytes, 1.5);
  bytes += std::string("\2\0\0\0\0", 5);
  for (const Vec3& v : {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 2}}) {
    append(bytes, v.x);
    append(bytes, v.y);
    bytes += '\7';
    append(bytes, v.z);
  }
  bytes += std::string("\1\3\0", 3);
  for (const uint32_t index : {0, 1, 2}) append(bytes, index);
  EXPECT_EQ(corners_of(load(bytes)), (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 2}}));
}

TEST_F(Ply, OddFacesAndBytesLeftOverAreTold) {
  const Scene scene = load(kSquare + "4 0 2 1 3\nrest\n");
  EXPECT_EQ(warnings(scene), (std::vector<std::string>{"a.ply: 5 bytes behind the last element are not read",
                                                       "a.ply: face 0 crosses itself: it is filled as a fan, which may "
                                                       "be wrong; cut it up"}));
}

TEST_F(Ply, WhatCannotBeReadIsRefusedWithItsPlace) {
  expect_refusal("", "a.ply:", "empty");
  expect_refusal("solid x\n", "a.ply:1:", "not a PLY file");
  expect_refusal("ply\nformat ascii 1.0\nelement vertex 1\n", "a.ply:3:", "cut off");
  expect_refusal("ply\nformat utf8 1.0\nend_header\n", "a.ply:2:", "utf8");
  expect_refusal("ply\nend_header\n", "a.ply:2:", "format");
  expect_refusal("ply\nformat ascii 1.0\nelement vertex -1\nend_header\n", "a.ply:3:", "number");
  expect_refusal("ply\nformat ascii 1.0\nelement vertex 1\nproperty real x\nend_header\n", "a.ply:4:", "real");
  expect_refusal("ply\nformat ascii 1.0\nproperty int x\nend_header\n", "a.ply:3:", "before the first element");
  expect_refusal("ply\nformat ascii 1.0\nelement vertex 4000000000\nend_header\n", "a.ply:", "no properties");
  expect_refusal("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n", "a.ply:", "no 'y'");
  expect_refusal(header("ascii", 3, 0) + "0 0 0\n1 0 0\n0 1 0\n", "a.ply:", "no faces");
  expect_refusal(header("ascii", 3, 1) + "0 0 0\n1 0 0\n0 nan 0\n3 0 1 2\n", "a.ply:13: vertex 2 ", "nan");
  expect_refusal(header("ascii", 3, 1) + "0 0 0\n1 0 x\n0 1 0\n3 0 1 2\n", "a.ply:12: vertex 1 ", "'x'");
  expect_refusal(header("ascii", 3, 1) + "0 0 0\n1 0\n0 1 0\n3 0 1 2\n", "a.ply:12: vertex 1 ", "fewer values");
  expect_refusal(header("ascii", 3, 1) + "0 0 0\n1 0 0 0\n0 1 0\n3 0 1 2\n", "a.ply:12: vertex 1 ", "more values");
  expect_refusal(header("ascii", 3, 1) + "0 0 0\n1 0 2e9\n0 1 0\n3 0 1 2\n", "a.ply:12: vertex 1 ", "1e+09");
  expect_refusal(kSquare + "3 0 1 4\n", "a.ply:15: face 0 ", "4, which is out of range");
  expect_refusal(kSquare + "3 0 1 -1\n", "a.ply:15: face 0 ", "-1, which is out of range");
  expect_refusal(kSquare + "2 0 1\n", "a.ply:15: face 0 ", "2 corners");
  expect_refusal(kSquare + "-3 0 1 2\n", "a.ply:15: face 0 ", "length -3");
  expect_refusal(kSquare, "a.ply:", "cut off in face 0");
}

TEST_F(Ply, EveryShorterFileIsRefused) {
  Scene scene;
  scene.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  scene.triangles = {{0, 1, 2}, {2, 1, 0}};
  const std::string bytes = binary(scene, false);
  for (size_t size = 0; size < bytes.size(); ++size) expect_refusal(bytes.substr(0, size), "a.ply:", "");
  EXPECT_EQ(load(bytes).triangles.size(), 2u);
  expect_refusal(header("binary_little_endian", 4000000000u, 1) + "0123", "a.ply:", "cut off in vertex 0");
}

TEST_F(Ply, NormalsAndEdgesAreCountedInTheWordsOfOtherFormats) {
  const std::string normals = "property float nx\nproperty float ny\nproperty float nz\n";
  std::string text = header("ascii", 3, 1, normals + "element edge 2\nproperty int vertex1\nproperty int vertex2\n");
  text += "0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n0 1\n1 2\n3 0 1 2\n";
  EXPECT_EQ(warnings(load(text)),
            (std::vector<std::string>{"a.ply: 1 face with vertex normals, which are not used: shading is flat",
                                      "a.ply: 2 elements of points or lines, not drawn"}));
}

TEST_F(Ply, TheHeaderMayEndItsLinesAsOnAnyMachine) {
  const std::string cut = kSquare + "4 0 1 2 3\n";
  const std::vector<Vec3> wanted = corners_of(load(cut));
  std::string old_mac = cut;
  std::replace(old_mac.begin(), old_mac.end(), '\n', '\r');
  EXPECT_EQ(corners_of(load(old_mac)), wanted);
  EXPECT_EQ(corners_of(load("\xef\xbb\xbf" + cut)), wanted);
  // The byte behind such a header may be any: here those of line ends.
  for (const uint8_t byte : {uint8_t{0x0a}, uint8_t{0x0d}}) {
    std::string bytes = header("binary_big_endian", 3, 1);
    std::replace(bytes.begin(), bytes.end(), '\n', '\r');
    std::vector<Vec3> corners = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    corners[0].x = as_float(static_cast<uint32_t>(byte) << 24 | 0x0a0d00u);
    for (const Vec3& p : corners) {
      for (int axis = 0; axis < 3; ++axis) append(bytes, p[axis], true);
    }
    bytes += '\3';
    for (const uint32_t index : {0u, 1u, 2u}) append(bytes, index, true);
    EXPECT_EQ(corners_of(load(bytes)), corners) << int{byte};
  }
}

}  // namespace
}  // namespace raypool
