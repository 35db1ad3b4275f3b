#include "scene/scene_cache.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "files/input_file.hpp"
#include "isa/input_error.hpp"
#include "scene/kept_bytes.hpp"

namespace raypool {
namespace {

namespace fs = std::filesystem;

using Digest = std::array<uint64_t, 2>;
constexpr uint64_t kMagic = 0x31656e6563537072;  // "rpScene1"
constexpr const char* kEnding = ".kept";

/// Of an entry, in front of its name for people and its payload.
struct Header {
  uint64_t magic, name_bytes, payload_bytes, digest;  // of name and payload
};

Digest digest_of(std::string_view bytes) {
  const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
  return {hash.low64, hash.high64};
}
uint64_t digest_of(std::string_view name, std::string_view payload) {
  return digest_of(payload)[0] ^ digest_of(name)[1];
}

/// Of the program that runs: another one may make something else of the same file.
const Digest& digest_of_program() {
  static const Digest digest = digest_of(read_file("/proc/self/exe", "program"));
  return digest;
}

/// The digest of all that is put in.
class Key {
 public:
  explicit Key(const char* kind) {
    put(digest_of_program());
    put(std::string_view(kind));
  }
  void put(std::string_view bytes) { put(digest_of(bytes)); }
  template <typename T>
  void put(const std::vector<T>& values) {
    put(std::string_view(reinterpret_cast<const char*>(values.data()), sizeof(T) * values.size()));
  }
  std::string name() const {
    const Digest all =
        digest_of(std::string_view(reinterpret_cast<const char*>(digests_.data()), sizeof(Digest) * digests_.size()));
    return fmt::format("{:016x}{:016x}", all[0], all[1]);
  }

 private:
  void put(const Digest& digest) { digests_.push_back(digest); }
  std::vector<Digest> digests_;
};

/// A file that was read on the way.
struct FileRead {
  std::string path;
  Digest digest;
};

/// None where it cannot be read.
std::optional<Digest> digest_of_file(const std::string& path) {
  try {
    return digest_of(read_file(path, "file"));
  } catch (const InputError&) {
    return std::nullopt;
  }
}

/// All that is put into an entry or got from it, in this order. `bytes(value)` puts or gets one.
template <typename File, typename Bytes>
void each_member(File& file, const Bytes& bytes) {
  auto& scene = file.scene;
  bytes(scene.name);
  bytes(scene.vertices);
  bytes(scene.triangles);
  bytes(scene.triangle_materials);
  for (auto& material : scene.materials) {
    bytes(material.name);
    bytes(material.kd);
    bytes(material.ks);
  }
  bytes(scene.camera);
  bytes(scene.light);
  bytes(scene.cameras);
  bytes(scene.warnings);
  bytes(scene.centre);
  bytes(file.camera);
  bytes(file.light);
  bytes(file.up);
}

void put(BytesWriter& out, const SceneFile& file) {
  out.put(uint64_t{file.scene.materials.size()});
  each_member(file, [&](const auto& value) { out.put(value); });
}

void get(BytesReader& in, SceneFile& file) {
  uint64_t materials = 0;
  in.get(materials);
  file.scene.materials.resize(materials);
  each_member(file, [&](auto& value) { in.get(value); });
}

/// A file's bytes, mapped into memory.
class Mapped {
 public:
  explicit Mapped(const std::string& path) {
    file_ = open(path.c_str(), O_RDONLY | O_CLOEXEC);
    struct stat status {};
    if (file_ < 0 || fstat(file_, &status) != 0 || !S_ISREG(status.st_mode) || status.st_size == 0) return;
    size_ = static_cast<size_t>(status.st_size);
    void* const mapped = mmap(nullptr, size_, PROT_READ, MAP_PRIVATE | MAP_POPULATE, file_, 0);
    if (mapped == MAP_FAILED) return;
    bytes_ = static_cast<const char*>(mapped);
    futimens(file_, nullptr);  // it is used now; where that is not allowed it may go sooner
  }
  ~Mapped() {
    if (bytes_ != nullptr) munmap(const_cast<char*>(bytes_), size_);
    if (file_ >= 0) close(file_);
  }
  Mapped(const Mapped&) = delete;
  Mapped& operator=(const Mapped&) = delete;
  bool opened() const { return file_ >= 0; }
  std::string_view bytes() const { return bytes_ == nullptr ? std::string_view() : std::string_view(bytes_, size_); }

 private:
  int file_ = -1;
  size_t size_ = 0;
  const char* bytes_ = nullptr;
};

/// Of an entry that is whole.
struct Parts {
  std::string_view name, payload;
  uint64_t digest;
};
std::optional<Parts> parts_of(std::string_view entry) {
  Header header{};
  if (entry.size() < sizeof header) return std::nullopt;
  std::memcpy(&header, entry.data(), sizeof header);
  entry.remove_prefix(sizeof header);
  if (header.magic != kMagic || header.name_bytes > entry.size() ||
      header.payload_bytes != entry.size() - header.name_bytes)
    return std::nullopt;
  return Parts{entry.substr(0, header.name_bytes), entry.substr(header.name_bytes), header.digest};
}
struct KeptFile {
  fs::path path;
  uint64_t bytes;
  fs::file_time_type used;
};
/// Of a folder: entries, or what was left behind by runs that were killed.
std::vector<KeptFile> files_in(const fs::path& folder, bool unfinished) {
  std::vector<KeptFile> files;
  std::error_code none;
  for (fs::directory_iterator at(folder, none), end; !none && at != end; at.increment(none)) {
    const fs::path path = at->path();
    const bool kept = path.extension() == kEnding;
    const bool begun = path.stem().extension() == kEnding;
    if (unfinished ? !begun : !kept) continue;
    std::error_code gone;  // another run may have removed it
    const uint64_t bytes = fs::file_size(path, gone);
    const fs::file_time_type used = gone ? fs::file_time_type() : fs::last_write_time(path, gone);
    if (!gone) files.push_back({path, bytes, used});
  }
  std::sort(files.begin(), files.end(), [](const KeptFile& a, const KeptFile& b) { return a.used > b.used; });
  return files;
}

}  // namespace

std::optional<SceneCache> SceneCache::of_program_;

std::string SceneCache::path_of(const std::string& name) const {
  return (fs::path(folder_) / (name + kEnding)).string();
}

bool SceneCache::find(const std::string& name, const std::function<void(std::string_view)>& read) const {
  const Mapped mapped(path_of(name));
  if (!mapped.opened()) return false;
  const std::optional<Parts> parts = parts_of(mapped.bytes());
  if (parts && digest_of(parts->name, parts->payload) == parts->digest) {
    try {
      read(parts->payload);
      return true;
    } catch (const BytesMissing&) {
    }
  }
  std::error_code none;
  fs::remove(path_of(name), none);
  return false;
}

void SceneCache::keep(const std::string& name, const std::string& what, const std::string& payload) const {
  if (payload.size() > limit_ / 2) return;
  static std::atomic<uint32_t> number{0};
  const std::string path = path_of(name), begun = fmt::format("{}.{}-{}", path, getpid(), number++);
  std::error_code none;
  fs::create_directories(folder_, none);
  const Header header{kMagic, what.size(), payload.size(), digest_of(what, payload)};
  bool whole = false;
  {
    std::ofstream file(begun, std::ios::binary);
    file.write(reinterpret_cast<const char*>(&header), sizeof header);
    file << what << payload;
    file.close();
    whole = file.good();
  }
  if (whole) fs::rename(begun, path, none);
  if (!whole || none) fs::remove(begun, none);
  remove_oldest();
}

void SceneCache::remove_oldest() const {
  std::error_code none;
  uint64_t bytes = 0;
  for (const KeptFile& file : files_in(folder_, false)) {
    bytes += file.bytes;
    if (bytes > limit_) fs::remove(file.path, none);
  }
  for (const KeptFile& file : files_in(folder_, true)) {
    if (fs::file_time_type::clock::now() - file.used > std::chrono::hours(1)) fs::remove(file.path, none);
  }
}

SceneFile SceneCache::file(const std::string& path, const std::string& camera,
                           const std::function<SceneFile()>& read) const {
  // A pipe can be read once.
  if (std::error_code none; !fs::is_regular_file(path, none)) return read();
  const std::optional<Digest> digest = digest_of_file(path);
  if (!digest) return read();
  Key key("file");
  key.put(std::string_view(path));
  key.put(std::string_view(camera));
  key.put(std::string_view(reinterpret_cast<const char*>(digest->data()), sizeof *digest));
  SceneFile file;
  bool same = true;
  const bool found = find(key.name(), [&](std::string_view payload) {
    BytesReader in(payload);
    uint64_t count = 0;
    in.get(count);
    for (uint64_t i = 0; same && i < count; ++i) {
      FileRead other;
      in.get(other.path);
      in.get(other.digest);
      same = digest_of_file(other.path) == other.digest;
    }
    if (same) get(in, file);
  });
  if (found && same) return file;

  std::vector<FileRead> others;
  bool unsure = false;
  {
    const FilesRead watching([&](const std::string& other, const std::string* bytes) {
      if (bytes == nullptr) {
        unsure = true;
      } else if (other != path) {
        others.push_back({other, digest_of(*bytes)});
      } else {
        unsure |= digest_of(*bytes) != *digest;
      }
    });
    file = read();
  }
  // What was not there may come: then the same files make another scene. And a file may have changed meanwhile.
  if (unsure || file.scene.triangles.size() < kLeastTriangles) return file;
  BytesWriter out;
  out.put(uint64_t{others.size()});
  for (const FileRead& other : others) {
    out.put(other.path);
    out.put(other.digest);
  }
  put(out, file);
  keep(key.name(), "scene of " + path, out.bytes());
  return file;
}

SceneTrees SceneCache::trees(const Scene& scene, const std::function<SceneTrees()>& make) const {
  if (scene.triangles.size() < kLeastTriangles) return make();
  Key key("trees");
  key.put(scene.vertices);
  key.put(scene.triangles);
  SceneTrees trees;
  const auto each = [](auto& of, const auto& member) {
    member(of.bvh.nodes);
    member(of.bvh.blocks);
    member(of.bvh.bounds);
    member(of.wide.nodes);
    member(of.wide.blocks);
  };
  if (find(key.name(), [&](std::string_view payload) {
        BytesReader in(payload);
        each(trees, [&](auto& member) { in.get(member); });
      }))
    return trees;
  trees = make();
  BytesWriter out;
  each(trees, [&](auto& member) { out.put(member); });
  keep(key.name(), fmt::format("trees of {} triangles", scene.triangles.size()), out.bytes());
  return trees;
}

std::vector<SceneCache::Entry> SceneCache::entries() const {
  std::vector<Entry> entries;
  for (const KeptFile& file : files_in(folder_, false)) {
    const Mapped mapped(file.path.string());
    const std::optional<Parts> parts = parts_of(mapped.bytes());
    entries.push_back({parts ? std::string(parts->name) : "damaged", file.bytes, file.used});
  }
  return entries;
}

size_t SceneCache::clear() const {
  size_t removed = 0;
  std::error_code none;
  for (const KeptFile& file : files_in(folder_, false)) removed += fs::remove(file.path, none);
  for (const KeptFile& file : files_in(folder_, true)) fs::remove(file.path, none);
  return removed;
}

}  // namespace raypool
