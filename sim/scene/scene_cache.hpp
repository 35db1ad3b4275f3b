// What is made of a scene in every run, kept in a folder: of a file its scene, of triangles their trees. Entries are
// found by what they were made of, byte for byte, and by the program that made them, so that none is ever out of date.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/scene_file.hpp"
#include "scene/wide_bvh.hpp"

namespace raypool {

class SceneCache {
 public:
  /// Scenes of fewer triangles are made faster than they are found.
  static constexpr size_t kLeastTriangles = 5000;
  /// Bytes of all entries; those that were used longest ago go first.
  static constexpr uint64_t kLimit = uint64_t{2} << 30;

  /// `folder` is made when something is kept in it.
  explicit SceneCache(std::string folder, uint64_t limit = kLimit) : folder_(std::move(folder)), limit_(limit) {}

  /// What load_scene() and Traversal use: none until a program sets it. Not to be changed while others use it.
  static const std::optional<SceneCache>& of_program() { return of_program_; }
  static void use(std::optional<SceneCache> cache) { of_program_ = std::move(cache); }

  /// What `read` makes of this file and, of those that have several, this camera. What it reads on the way with
  /// read_file() must be the same too; where something is missing (FilesRead) nothing is kept.
  SceneFile file(const std::string& path, const std::string& camera, const std::function<SceneFile()>& read) const;
  /// What `make` makes of the scene's triangles.
  SceneTrees trees(const Scene& scene, const std::function<SceneTrees()>& make) const;

  struct Entry {
    std::string what;  ///< "scene of conference.obj", "tree of 331179 triangles"
    uint64_t bytes = 0;
    std::filesystem::file_time_type used;
  };
  /// What is kept, the entry used last first.
  std::vector<Entry> entries() const;
  /// Removes all; returns how many there were.
  size_t clear() const;
  const std::string& folder() const { return folder_; }
  uint64_t limit() const { return limit_; }

 private:
  std::string path_of(const std::string& name) const;
  /// False: there is none, or it is damaged and was removed. `read` gets the payload; it throws BytesMissing where that
  /// is not what it reads.
  bool find(const std::string& name, const std::function<void(std::string_view)>& read) const;
  /// Never throws, as a run is none the worse without: a full disk or a folder that cannot be written keeps nothing.
  void keep(const std::string& name, const std::string& what, const std::string& payload) const;
  void remove_oldest() const;

  static std::optional<SceneCache> of_program_;
  std::string folder_;
  uint64_t limit_;
};

}  // namespace raypool
