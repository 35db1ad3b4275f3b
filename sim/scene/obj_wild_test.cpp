// OBJ and MTL files as programs and people write them.
#include <fmt/format.h>

#include "scene/file_fixture.hpp"

namespace raypool {
namespace {

const std::string kOneTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
const std::string kRed = "newmtl red\nKd 0.75 0.25 0.125\n";
const std::string kMark = "\xef\xbb\xbf";
const Vec3 kRedKd{0.75f, 0.25f, 0.125f}, kGrey{0.5f, 0.5f, 0.5f};

using Texts = std::vector<std::string>;

class ObjInTheWild : public FileFixture {
 protected:
  Scene load(const std::string& text) const { return load_obj(write("a.obj", text)); }
  Scene load(const std::string& text, const std::string& mtl) const {
    write("m.mtl", mtl);
    return load("mtllib m.mtl\n" + text);
  }
  static Material first(const Scene& scene) { return scene.materials.at(scene.triangle_materials.at(0)); }
  /// Of a triangle that has a material with these statements.
  Scene with_material(const std::string& statements) const {
    return load(kOneTriangle + "usemtl a\nf 1 2 3\n", "newmtl a\n" + statements);
  }
  std::string refused(const std::string& text) const {
    return refusal([&] { load(text); });
  }
};

TEST_F(ObjInTheWild, AByteOrderMarkIsNoPartOfTheFirstLine) {
  write("red.mtl", kMark + kRed);
  const std::string triangle = kOneTriangle + "usemtl red\nf 1 2 3\n";
  EXPECT_EQ(first(load(kMark + "mtllib red.mtl\n" + triangle)).kd, kRedKd);
  const Scene scene = load(kMark + triangle);
  EXPECT_EQ(corners_of(scene), (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  // Two files that have been put together.
  EXPECT_EQ(corners_of(load(kMark + "# one\n" + kMark + triangle)), corners_of(scene));
  EXPECT_EQ(refused(std::string("v\0 \0000\0\n\0", 8)),
            "a.obj: the OBJ file is UTF-16 text, which is not read; save it as UTF-8");
}

TEST_F(ObjInTheWild, LinesMayEndAsOnAnyMachine) {
  const std::string text = "# two triangles\n" + kOneTriangle + "\nf 1 2 3\nf 1 3 2\n";
  const std::vector<Vec3> wanted = corners_of(load(text));
  for (const std::string end : {"\r", "\r\n", "\r\r\n"}) {
    std::string other;
    for (const char c : text) other += c == '\n' ? end : std::string(1, c);
    EXPECT_EQ(corners_of(load(other)), wanted) << other;
  }
  EXPECT_EQ(refused("v 0 0 0\rv 0 0\rf 1 1 1\r"), "a.obj:2: vertex has 2 numbers; give three");
  write("m.mtl", "newmtl red\rKd 0.75 0.25 0.125\r");
  EXPECT_EQ(first(load("mtllib m.mtl\r\n" + kOneTriangle + "usemtl red\rf 1 2 3")).kd, kRedKd);
}

TEST_F(ObjInTheWild, ABackslashContinuesAnyLine) {
  write("m.mtl", "newmtl \\\nred\nKd 0.75 \\\n 0.25 \\\r\n0.125\n");
  const std::string text =
      "mtllib \\\n m.mtl\nv 0 0 \\\n0\nv 1 \\\r\n 0 \\  \r\n 0\nv 0 1 0\nvn 0 \\\n 0 1\nusemtl \\\nred\nf 1 \\\n\\\n2 "
      "3\\\n";
  const Scene scene = load(text);
  EXPECT_EQ(corners_of(scene), (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  EXPECT_EQ(first(scene).kd, kRedKd);
  // Numbers of lines are the file's.
  EXPECT_EQ(refused("v 0 \\\n 0 \\\n 0\nv 0 x 0\nf 1 1 1\n"),
            "a.obj:4: 'x' in vertex is not a number; correct the file");
}

TEST_F(ObjInTheWild, ACommentEndsWithItsLine) {
  const Scene scene = load("# from C:\\models\\\n" + kOneTriangle + "v 5 5 5 # C:\\\nf 1 2 3 # \\\nf 1 3 2\n");
  EXPECT_EQ(scene.triangles.size(), 2u);
  EXPECT_EQ(corners_of(scene)[0], (Vec3{0, 0, 0}));
}

TEST_F(ObjInTheWild, OneNumberOfAColourStandsForAllThree) {
  const Material material = first(with_material("Ka 0\nKd 0.4\nKs +.25\t\nillum 3\n"));
  EXPECT_EQ(material.kd, (Vec3{0.4f, 0.4f, 0.4f}));
  EXPECT_EQ(material.ks, (Vec3{0.25f, 0.25f, 0.25f}));
  for (const char* colour : {"Kd", "Kd 0.1 0.2"}) {
    EXPECT_NE(refusal([&] { with_material(colour); }).find("give three, or one for all"), std::string::npos) << colour;
  }
  EXPECT_EQ(refusal([&] { with_material("Kd red\n"); }),
            "m.mtl:2: 'red' in colour Kd is not a number; correct the file");
}

TEST_F(ObjInTheWild, SpectralColoursAreGreyAndXyzOnesConverted) {
  const Scene spectral = with_material("Kd spectral paint.rfl 0.8\n");
  EXPECT_EQ(first(spectral).kd, kGrey);
  EXPECT_EQ(warnings(spectral), Texts{"a.obj: 1 material with a spectral colour, taken as grey"});
  // The white of D65 is white, the red primary red, and one number stands for all three.
  const Scene white = with_material("Kd xyz 0.95047 1 1.08883\n");
  const Scene red = with_material("Kd xyz 0.4124564 0.2126729 0.0193339\nKs xyz 0\n");
  const Scene equal = with_material("Kd xyz 0.5\n");
  const Vec3 of_equal{0.6024f, 0.4742f, 0.4544f};
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(first(white).kd[axis], 1, 1e-4);
    EXPECT_NEAR(first(red).kd[axis], axis == 0 ? 1 : 0, 1e-4);
    EXPECT_NEAR(first(equal).kd[axis], of_equal[axis], 1e-3);
  }
  EXPECT_EQ(warnings(red), Texts{"a.obj: 1 material with a colour in CIE XYZ, converted to RGB"});
  // Outside of what RGB has.
  EXPECT_EQ(first(with_material("Kd xyz 0 1 0\n")).kd.x, 0);
}

TEST_F(ObjInTheWild, NamesMayHaveBlanks) {
  write("red cube.mtl",
        "newmtl bright red\nKd 0.75 0.25 0.125\nnewmtl bright\nKd 0 0 1\nnewmtl Material #27\nKd 0 1 0\n");
  const Scene scene = load("mtllib red cube.mtl\n" + kOneTriangle +
                           "usemtl bright red\nf 1 2 3\nusemtl bright \t\nf 1 2 3\nusemtl Material #27\nf 1 2 3\n"
                           "usemtl bright red # and a comment\nf 1 2 3\nusemtl bright green\nf 1 2 3\n");
  EXPECT_EQ(scene.triangle_materials, (std::vector<uint32_t>{0, 1, 2, 0, 1}));
  EXPECT_EQ(warnings(scene), Texts{});
  EXPECT_EQ(first(load("mtllib \"red cube.mtl\"\n" + kOneTriangle + "usemtl bright red\nf 1 2 3\n")).kd, kRedKd);
}

TEST_F(ObjInTheWild, AllLibrariesOfALineAreReadAndTheFirstOfAMaterialCounts) {
  write("a b.mtl", kRed);
  write("c.mtl", "newmtl red\nKd 0 0 1\nnewmtl blue\nKd 0 0 1\n");
  const Scene scene = load("mtllib a b.mtl none here.mtl c.mtl x.mtl\nmtllib c.mtl\n" + kOneTriangle +
                           "usemtl blue\nf 1 2 3\nusemtl red\nf 1 2 3\n");
  ASSERT_EQ(scene.materials.size(), 3u);
  EXPECT_EQ(scene.triangle_materials, (std::vector<uint32_t>{2, 0}));
  EXPECT_EQ(warnings(scene).size(), 1u);
  EXPECT_EQ(warnings(scene).at(0).find("a.obj:1: material file 'none here.mtl' (and 1 more) is not in '"), 0u)
      << warnings(scene).at(0);
}

TEST_F(ObjInTheWild, LibrariesAreFoundAsExportersOfOtherMachinesNameThem) {
  std::filesystem::create_directories(folder_ + "/sub");
  write("sub/Red.mtl", kRed);
  write("beside.mtl", kRed);
  for (const char* name : {"sub\\Red.mtl", "sub/red.MTL", ".\\sub\\red.mtl", "./beside.mtl", "BESIDE.MTL",
                           "C:\\Users\\me\\beside.mtl", "/home/me/beside.mtl", "C:\\my models\\Beside.mtl"}) {
    const Scene scene = load(fmt::format("mtllib {}\r\n", name) + kOneTriangle + "usemtl red\nf 1 2 3\n");
    EXPECT_EQ(first(scene).kd, kRedKd) << name;
    EXPECT_EQ(warnings(scene), Texts{}) << name;
  }
}

TEST_F(ObjInTheWild, WithoutItsLibraryAFileIsGreyAndThatIsTold) {
  const Scene scene = load("v 0 0 0\nmtllib nowhere.mtl\n" + kOneTriangle + "usemtl red\nf 1 2 3\n");
  EXPECT_EQ(first(scene).kd, kGrey);
  EXPECT_EQ(warnings(scene), Texts{fmt::format("a.obj:2: material file 'nowhere.mtl' is not in '{}': what has its "
                                               "materials is grey; put it there",
                                               folder_)});
  const Scene none = load(kOneTriangle + "usemtl red\nf 1 2 3\nusemtl blue\nf 1 2 3\n");
  EXPECT_EQ(warnings(none), Texts{"a.obj: material 'blue' (and 1 more) is in no material file: what has it is grey"});
}

TEST_F(ObjInTheWild, ALibraryMayStandBehindTheFaces) {
  write("m.mtl", kRed);
  EXPECT_EQ(first(load(kOneTriangle + "usemtl red\nf 1 2 3\nmtllib m.mtl\n")).kd, kRedKd);
}

TEST_F(ObjInTheWild, CornersMayLeaveOutWhatIsNotUsed) {
  for (const char* face : {"f 1/ 2/ 3/", "f 1// 2// 3//", "f 1/0/0 2/0/0 3/0/0", "f 1/9/ 2/9/ 3/9/", "f +1 2 3"})
    EXPECT_EQ(load(kOneTriangle + face).triangles.size(), 1u) << face;
  for (const char* corner : {"1/x", "1//x", "1/2/3/4", "/1", "x", "1.5", "1\\2"}) {
    EXPECT_EQ(refused(kOneTriangle + "f 1 2 " + corner + "\n"),
              fmt::format("a.obj:4: '{}' is not a corner of a face; give f 1 2 3, f 1/2 ..., f 1//3 ... or f 1/2/3 ...",
                          corner));
  }
}

TEST_F(ObjInTheWild, OnlyModelsOfLightWithReflectionReflect) {
  for (const char* illum : {"0", "1", "2", "-1", "2.0"}) {
    const Scene scene = with_material(fmt::format("illum {}\nKd 0.5 0.5 0.5\nKs 0.5 0.5 0.5\n", illum));
    EXPECT_FALSE(scene.reflects()) << illum;
    EXPECT_EQ(warnings(scene), Texts{"a.obj: Ks is taken as a highlight, which is not drawn, of 1 material (illum 0, 1 "
                                     "or 2)"});
  }
  for (const char* illum : {"3", "5", "8", "10", "3.0"}) {
    const Scene scene = with_material(fmt::format("Ks 0.25 0.5 0.75\nillum {}\n", illum));
    EXPECT_EQ(first(scene).ks, (Vec3{0.25f, 0.5f, 0.75f})) << illum;
    EXPECT_EQ(warnings(scene), Texts{}) << illum;
  }
  const Scene without = with_material("Ks 0.5 0.5 0.5\n");
  EXPECT_TRUE(without.reflects());
  EXPECT_EQ(warnings(without), Texts{"a.obj: Ks is taken as a mirror reflection of 1 material (no illum)"});
  EXPECT_EQ(warnings(with_material("Ks 0 0 0\nillum 2\n")), Texts{});
  EXPECT_EQ(refusal([&] { with_material("illum glossy\n"); }),
            "m.mtl:2: 'glossy' in illum is not a number; correct the file");
}

TEST_F(ObjInTheWild, MaterialsThatAreDrawnAreCountedByHowTheyAreTaken) {
  std::string mtl = "newmtl unused\nKs 1 1 1\nillum 2\n", text = kOneTriangle;
  for (const char* illum : {"illum 2", "illum 1", "illum 3", ""}) {
    mtl += fmt::format("newmtl m{}\nKs 1 1 1\n{}\n", illum, illum);
    text += fmt::format("usemtl m{}\nf 1 2 3\n", illum);
  }
  EXPECT_EQ(
      warnings(load(text, mtl)),
      Texts{"a.obj: Ks is taken as a highlight, which is not drawn, of 2 materials (illum 0, 1 or 2), as a mirror "
            "reflection of 1 material (illum 3 or above), as a mirror reflection of 1 material (no illum)"});
}

TEST_F(ObjInTheWild, WhatHasNoCounterpartIsCountedInTheWordsOfOtherFormats) {
  const std::string mtl =
      "newmtl a\nmap_Kd -s 2 2 2 a.png\nd 0.25\nKe 5 5 5\nPm 1\nnewmtl b\nmap_Bump -bm 1 b.png\nmap_d "
      "alpha.png\nnewmtl c\n"
      "Tr 0.5\nmap_Ke c.png\nnewmtl plain\nKd 1 1 1\nKa 1 1 1\nKe 0 0 0\nd 1.0\nTr 1\nillum 4\nPm 0\nPr 0.5\nNs "
      "9\nmap_aat on\n"
      "newmtl glass\nillum 7\nKd 1 1 1\nnewmtl unused\nKe 1 1 1\n";
  const Scene scene = load(
      "v 0 0 0 1 0 0\nv 1 0 0\nv 0 1 0\nv 0 2 0 1\nvn 0 0 1\nvt 0 0\nusemtl a\nf 1/1/1 2/1/1 3/1/1\nusemtl b\nf 1//1 "
      "2//1 3//1\nusemtl c\nf 4 2 3\nusemtl plain\nf 4 2 3\nusemtl glass\nf 4/1 2/1 3/1\nl 1 2\np 1\ncurv 0 1 1 2\n",
      mtl);
  const std::string extensions =
      "a.obj: 1 material with extensions (KHR_materials_..., or Pm, Ps and Pc of MTL), which are not used";
  EXPECT_EQ(warnings(scene), (Texts{"a.obj: 3 materials with textures: the colours beside them are used alone",
                                    "a.obj: 2 materials with emission, which is not used: the one light is a point",
                                    "a.obj: 4 materials with transparency, drawn opaque", extensions,
                                    "a.obj: 2 faces with vertex colours, which are not used",
                                    "a.obj: 2 faces with vertex normals, which are not used: shading is flat",
                                    "a.obj: 2 elements of points or lines, not drawn",
                                    "a.obj: 1 free-form curve or surface not drawn"}));
}

}  // namespace
}  // namespace raypool
