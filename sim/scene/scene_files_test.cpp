#include "scene/scene_files.hpp"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>

#include "isa/input_error.hpp"

namespace raypool {
namespace {

namespace fs = std::filesystem;

class SceneFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "raypool-scenes-XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
    setenv("SCENES", folder("first:" + folder("second").string()).c_str(), 1);
    for (const char* file : {"first/bunny.obj", "second/bunny.obj", "second/sponza.glb", "second/rooms/hall.ply",
                             "second/packed.obj.xz", "second/notes.txt", "here/kitchen.obj"}) {
      fs::create_directories(folder(file).parent_path());
      std::ofstream(folder(file)) << "\n";
    }
  }
  void TearDown() override {
    unsetenv("SCENES");
    fs::remove_all(folder_);
  }
  fs::path folder(const std::string& name) const { return folder_ / name; }
  static std::string refusal(const std::string& name) {
    try {
      return "found " + find_scene(name);
    } catch (const InputError& error) {
      return error.what();
    }
  }

  fs::path folder_;
};

TEST_F(SceneFiles, AreFoundInTheFoldersOfScenesInTheirOrder) {
  EXPECT_EQ(find_scene("bunny.obj"), folder("first/bunny.obj"));
  EXPECT_EQ(find_scene("sponza.glb"), folder("second/sponza.glb"));
  EXPECT_EQ(find_scene("rooms/hall.ply"), folder("second/rooms/hall.ply"));
}

TEST_F(SceneFiles, NeedNoEnding) {
  EXPECT_EQ(find_scene("sponza"), folder("second/sponza.glb"));
  EXPECT_EQ(find_scene(folder("here/kitchen").string()), folder("here/kitchen.obj"));
}

TEST_F(SceneFiles, OfTheProjectsExamplesAreFoundWhateverScenesSays) {
  EXPECT_EQ(fs::path(find_scene("tour")).filename(), "tour.obj");
}

TEST_F(SceneFiles, WhereThePathSaysComeFirst) {
  const std::string path = folder("second/bunny.obj").string();
  EXPECT_EQ(find_scene(path), path);
}

TEST_F(SceneFiles, ThatAreMistypedNameTheNearest) {
  EXPECT_EQ(refusal("spnza.glb").substr(0, 49), "spnza.glb: no such scene: did you mean sponza.glb");
  EXPECT_EQ(refusal("spnza").substr(0, 45), "spnza: no such scene: did you mean sponza.glb");
  EXPECT_EQ(refusal("rom").substr(0, 38), "rom: no such scene: did you mean room?");
  const std::string beside = folder("here/kichen.obj").string(), right = folder("here/kitchen.obj").string();
  const std::string text = beside + ": no such scene: did you mean " + right + "?";
  EXPECT_EQ(refusal(beside).substr(0, text.size()), text);
  EXPECT_EQ(refusal("notes.tx"),
            "notes.tx: no such scene; give cornell, room, or the path of a .obj, .gltf, .glb or "
            ".ply file");
}

TEST_F(SceneFiles, ThatArePackedSayHowToUnpackThem) {
  EXPECT_EQ(refusal("packed"), "packed: the scene is packed: unpack it with xz --decompress --keep '" +
                                   folder("second/packed.obj.xz").string() + "'");
}

}  // namespace
}  // namespace raypool
