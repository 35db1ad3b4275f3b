// What is kept of scenes is what would have been made again, and is made again when anything that it was made of
// differs.
#include "scene/scene_cache.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>

#include "files/input_file.hpp"
#include "scene/file_fixture.hpp"
#include "scene/test_traversal.hpp"
#include "scene/traversal.hpp"

namespace raypool {
namespace {

namespace fs = std::filesystem;

template <typename T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), sizeof(T) * a.size()) == 0);
}

void expect_same(const Scene& a, const Scene& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_TRUE(same_bytes(a.vertices, b.vertices));
  EXPECT_TRUE(same_bytes(a.triangles, b.triangles));
  EXPECT_TRUE(same_bytes(a.triangle_materials, b.triangle_materials));
  ASSERT_EQ(a.materials.size(), b.materials.size());
  for (size_t i = 0; i < a.materials.size(); ++i) {
    EXPECT_EQ(a.materials[i].name, b.materials[i].name);
    EXPECT_EQ(a.materials[i].kd, b.materials[i].kd);
    EXPECT_EQ(a.materials[i].ks, b.materials[i].ks);
  }
  EXPECT_EQ(a.cameras, b.cameras);
  EXPECT_EQ(a.warnings, b.warnings);
  EXPECT_EQ(a.centre, b.centre);
}

class SceneCacheTest : public ::testing::Test {
 protected:
  SceneCacheTest() : folder_(fs::temp_directory_path() / ("raypool-kept-" + std::to_string(getpid()))) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    write_obj(make_room(0.05), path("room.obj"));
  }
  ~SceneCacheTest() override { fs::remove_all(folder_); }

  std::string path(const char* name) const { return (folder_ / name).string(); }
  SceneCache cache() const { return SceneCache(path("kept")); }
  void append(const char* name, const std::string& text) const { std::ofstream(path(name), std::ios::app) << text; }
  /// Of the OBJ; `made_` counts how often it was read.
  Scene load(const SceneCache& cache) {
    return cache
        .file(path("room.obj"), "",
              [&] {
                ++made_;
                return SceneFile{load_obj(path("room.obj")), {}, {}, {}};
              })
        .scene;
  }
  std::vector<fs::path> entries() const {
    std::vector<fs::path> found;
    for (const auto& entry : fs::directory_iterator(path("kept"))) found.push_back(entry.path());
    return found;
  }

  const fs::path folder_;
  int made_ = 0;
};

TEST_F(SceneCacheTest, AFileIsReadOnceUntilItOrItsMaterialsChange) {
  const Scene first = load(cache()), second = load(cache());
  EXPECT_EQ(made_, 1);
  expect_same(first, second);
  append("room.mtl", "\n# one more line\n");
  expect_same(load(cache()), first);
  EXPECT_EQ(made_, 2) << "its materials are part of it";
  append("room.obj", "\n# one more line\n");
  load(cache());
  EXPECT_EQ(made_, 3);
  fs::rename(path("room.mtl"), path("away.mtl"));
  for (int again = 4; again <= 5; ++again) {
    EXPECT_FALSE(load(cache()).warnings.empty()) << "of materials that are missing";
    EXPECT_EQ(made_, again) << "they may come: nothing is kept";
  }
  fs::rename(path("away.mtl"), path("room.mtl"));
  EXPECT_TRUE(load(cache()).warnings.empty());
}

TEST_F(SceneCacheTest, TreesAreThoseOfTheTriangles) {
  const Scene scene = make_room(0.05);
  SceneTrees made;
  made.bvh = build_bvh(scene);
  made.wide = widen(made.bvh);
  int times = 0;
  const auto make = [&] {
    ++times;
    return made;
  };
  cache().trees(scene, make);
  const SceneTrees kept = cache().trees(scene, make);
  EXPECT_EQ(times, 1);
  EXPECT_TRUE(same_bytes(kept.bvh.nodes, made.bvh.nodes));
  EXPECT_TRUE(same_bytes(kept.bvh.blocks, made.bvh.blocks));
  EXPECT_EQ(kept.bvh.bounds.upper, made.bvh.bounds.upper);
  EXPECT_TRUE(same_bytes(kept.wide.nodes, made.wide.nodes));
  EXPECT_TRUE(same_bytes(kept.wide.blocks, made.wide.blocks));
  Scene moved = scene;
  moved.vertices[7].x += 0.001f;
  cache().trees(moved, make);
  EXPECT_EQ(times, 2);
}

TEST_F(SceneCacheTest, WhatIsDamagedIsMadeAgain) {
  const Scene first = load(cache());
  const std::string whole = read_file(entries().at(0).string(), "entry");
  for (const size_t at : {size_t{0}, size_t{9}, size_t{40}, whole.size() / 2, whole.size() - 1}) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 1);
    std::ofstream(entries().at(0), std::ios::binary) << damaged;
    made_ = 0;
    expect_same(load(cache()), first);
    EXPECT_EQ(made_, 1) << "byte " << at;
  }
  for (const size_t length : {size_t{0}, size_t{3}, size_t{31}, size_t{32}, whole.size() - 1}) {
    std::ofstream(entries().at(0), std::ios::binary | std::ios::trunc) << whole.substr(0, length);
    made_ = 0;
    expect_same(load(cache()), first);
    EXPECT_EQ(made_, 1) << length << " bytes";
  }
}

TEST_F(SceneCacheTest, WhatWasUsedLongestAgoGoesFirst) {
  load(cache());
  const uint64_t one = fs::file_size(entries().at(0));
  const SceneCache small(path("kept"), 2 * one + one / 2);
  for (int i = 0; i < 4; ++i) {
    append("room.obj", "\n# one more line\n");
    load(small);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  EXPECT_EQ(small.entries().size(), 2u);
  made_ = 0;
  load(small);
  EXPECT_EQ(made_, 0) << "the last one is still there";
  EXPECT_EQ(small.clear(), 2u);
  EXPECT_TRUE(entries().empty());
}

TEST_F(SceneCacheTest, RunsAtOnceAndKilledOnesLeaveWholeEntries) {
  std::vector<pid_t> children;
  for (int i = 0; i < 8; ++i) {
    const pid_t child = fork();
    if (child == 0) {
      for (int turn = 0; turn < 20; ++turn) {
        cache().clear();
        load(cache());
      }
      _exit(0);
    }
    children.push_back(child);
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(150));
  for (size_t i = 0; i < children.size(); i += 2) kill(children[i], SIGKILL);
  for (const pid_t child : children) {
    int status = 0;
    waitpid(child, &status, 0);
    EXPECT_TRUE(WIFSIGNALED(status) ? WTERMSIG(status) == SIGKILL : WEXITSTATUS(status) == 0);
  }
  const Scene expected = load_obj(path("room.obj"));
  expect_same(load(cache()), expected);
  expect_same(load(cache()), expected);
  for (const SceneCache::Entry& entry : cache().entries()) EXPECT_NE(entry.what, "damaged");
}

TEST_F(SceneCacheTest, AFolderThatCannotBeWrittenCostsNothingElse) {
  std::ofstream(path("file")) << "no folder";
  const SceneCache nowhere(path("file"));
  const Scene expected = load_obj(path("room.obj"));
  expect_same(load(nowhere), expected);
  EXPECT_TRUE(nowhere.entries().empty());
}

}  // namespace
}  // namespace raypool
