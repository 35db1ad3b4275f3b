// Wavefront OBJ in and out. What a file has wrong gets its line; names are looked up when all of it has been read,
// since a library may stand behind the faces that use it.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <filesystem>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <string_view>

#include "bits.hpp"
#include "files/input_file.hpp"
#include "files/output_files.hpp"
#include "scene/far_places.hpp"
#include "scene/losses.hpp"
#include "scene/mtl.hpp"
#include "scene/obj_text.hpp"
#include "scene/polygon.hpp"
#include "scene/scene.hpp"

namespace raypool {
namespace {

namespace fs = std::filesystem;

/// What of the faces and beside them is not drawn.
struct ObjLosses {
  size_t coloured_faces = 0, faces_with_normals = 0, points_and_lines = 0, free_forms = 0;
};

class ObjReader {
 public:
  explicit ObjReader(const std::string& path) : path_(path), text_(path, "OBJ file") {}

  Scene read() {
    for (ObjLine line; text_.next(line);) {
      if (line.key == "v") {
        add_vertex(line);
      } else if (line.key == "f") {
        add_face(line);
      } else if (line.key == "usemtl") {
        material_ = names_.emplace(line.rest, size32(names_)).first->second;
      } else if (line.key == "mtllib") {
        add_libraries(line);
      } else if (line.key == "l" || line.key == "p") {
        ++losses_.points_and_lines;
      } else if (line.key == "curv" || line.key == "curv2" || line.key == "surf") {
        ++losses_.free_forms;
      }
    }
    check_faces();
    places_.put_into(scene_, places_.centre(corners_));
    scene_.name = fs::path(path_).stem().string();
    add_triangles();
    add_warnings();
    return std::move(scene_);
  }

 private:
  struct Corner {
    uint32_t vertex;
    bool normal;
  };
  struct Missing {
    size_t line;
    std::string name;
  };
  static constexpr uint32_t kNone = ~uint32_t{0};

  void add_vertex(const ObjLine& line) {
    const std::vector<std::string_view> words = words_of(line.rest);
    if (words.size() < 3) text_.fail(line, fmt::format("vertex has {} numbers; give three", words.size()));
    Vec3d p;
    for (size_t i = 0; i < 3; ++i) {
      p[static_cast<int>(i)] = double_of(text_, line, words[i], "vertex", -kLargestCoordinate, kLargestCoordinate);
    }
    places_.add(p);
    // A colour stands behind the place, or behind its weight.
    coloured_.push_back(words.size() >= 6);
  }

  /// v, v/t, v//n or v/t/n; the numbers behind the first may be left out.
  bool add_corner(const ObjLine& line, std::string_view word) {
    std::array<std::string_view, 3> parts;
    size_t count = 0;
    for (std::string_view rest = word;; ++count) {
      const size_t slash = rest.find('/');
      if (count == parts.size()) refuse_corner(line, word);
      parts[count] = rest.substr(0, slash);
      if (slash == std::string_view::npos) break;
      rest.remove_prefix(slash + 1);
    }
    std::array<long, 3> indices{};
    for (size_t i = 0; i < parts.size(); ++i) {
      std::string_view digits = parts[i];
      if (digits.empty() && i > 0) continue;
      if (!digits.empty() && digits.front() == '+') digits.remove_prefix(1);
      const auto result = std::from_chars(digits.data(), digits.data() + digits.size(), indices[i]);
      if (result.ec != std::errc() || result.ptr != digits.data() + digits.size()) refuse_corner(line, word);
    }
    const long index = indices[0], vertices = static_cast<long>(places_.size());
    if (index == 0 || -index > vertices) {
      text_.fail(line,
                 fmt::format("vertex index {} is out of range; {} vertices stand above this line, numbered from 1",
                             index, vertices));
    }
    if (index > largest_) largest_ = index, largest_line_ = line.number;
    corners_.push_back(static_cast<uint32_t>(index > 0 ? index - 1 : vertices + index));
    return indices[2] != 0;
  }
  [[noreturn]] void refuse_corner(const ObjLine& line, std::string_view word) const {
    text_.fail(line,
               fmt::format("'{}' is not a corner of a face; give f 1 2 3, f 1/2 ..., f 1//3 ... or f 1/2/3 ...", word));
  }

  void add_face(const ObjLine& line) {
    bool normals = false;
    std::string_view rest = line.rest;
    for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest))
      normals = add_corner(line, word) || normals;
    const size_t corners = corners_.size() - begin_.back();
    if (corners < 3) text_.fail(line, fmt::format("a face of {} corners; give at least three", corners));
    begin_.push_back(corners_.size());
    lines_.push_back(line.number);
    materials_of_.push_back(material_);
    losses_.faces_with_normals += normals;
  }

  /// The path of a library as the file names it; empty: it is nowhere. Exporters of Windows write "\" between folders,
  /// whole paths of the machine that they ran on, and do not mind upper and lower case.
  std::string find_library(std::string name) const {
    const fs::path folder = fs::path(path_).parent_path();
    const auto is_file = [](const fs::path& path) {
      std::error_code none;
      return fs::is_regular_file(path, none);
    };
    if (is_file(folder / name)) return (folder / name).string();
    tell_missing((folder / name).string());
    std::replace(name.begin(), name.end(), '\\', '/');
    const fs::path own = folder / name, beside = folder / fs::path(name).filename();
    for (const fs::path& path : {own, beside}) {
      if (is_file(path)) return path.string();
      std::error_code none;
      for (fs::directory_iterator entry(path.parent_path().empty() ? "." : path.parent_path(), none), end;
           !none && entry != end; entry.increment(none)) {
        if (lower(entry->path().filename().string()) == lower(path.filename().string()) && is_file(entry->path()))
          return (path.parent_path() / entry->path().filename()).string();
      }
    }
    return "";
  }
  static std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
    return text;
  }
  bool read_library(std::string name) {
    if (name.size() > 2 && name.front() == '"' && name.back() == '"') name = name.substr(1, name.size() - 2);
    const std::string path = name.empty() ? "" : find_library(name);
    if (path.empty()) return false;
    if (libraries_.insert(path).second) read_mtl(path, materials_);
    return true;
  }

  /// One name, which may have blanks, or several: of words that are next to each other the most that name a file.
  void add_libraries(const ObjLine& line) {
    std::vector<std::string_view> words = words_of(line.rest);
    std::string missing;
    const auto miss = [&] {
      if (!missing.empty()) missing_libraries_.push_back({line.number, missing});
      missing.clear();
    };
    for (size_t i = 0; i < words.size();) {
      size_t end = words.size();
      const auto name = [&] {
        const char* const first = words[i].data();
        return std::string(first, words[end - 1].data() + words[end - 1].size());
      };
      while (end > i && !read_library(name())) --end;
      if (end > i) {
        miss();
        i = end;
        continue;
      }
      if (words[i].front() == '#') break;
      missing += (missing.empty() ? "" : " ") + std::string(words[i++]);
      if (lower(fs::path(missing).extension().string()) == ".mtl") miss();
    }
    miss();
  }

  void check_faces() const {
    const auto vertices = static_cast<long>(places_.size());
    if (largest_ > vertices) {
      ObjLine line;
      line.number = largest_line_;
      text_.fail(line, fmt::format("vertex index {} is out of range; the file has {} vertices", largest_, vertices));
    }
    if (lines_.empty())
      throw InputError(path_ + ": the file has no faces (lines that begin with f); nothing can be rendered");
  }

  /// A name as the library has it, or before what looks like a comment behind it, or its first word.
  static std::vector<std::string_view> readings(std::string_view name) {
    std::string_view rest = name;
    return {name, trimmed(name.substr(0, name.find(" #"))), next_word(rest)};
  }

  /// [name] The first material of it; the grey if there is none.
  std::vector<uint32_t> find_materials() {
    std::map<std::string_view, uint32_t> first;
    for (uint32_t i = 0; i < materials_.size(); ++i) first.emplace(materials_[i].name, i);
    std::vector<uint32_t> result(names_.size(), size32(materials_));
    for (const auto& [name, number] : names_) {
      bool found = name.empty();
      for (const std::string_view reading : readings(name)) {
        const auto material = first.find(reading);
        if (material == first.end()) continue;
        result[number] = material->second;
        found = true;
        break;
      }
      if (!found) unknown_.push_back(name);
    }
    return result;
  }

  void add_triangles() {
    const auto grey = size32(materials_);
    for (const MtlMaterial& material : materials_) scene_.materials.push_back(material.material());
    const std::vector<uint32_t> material_of = find_materials();
    used_.resize(materials_.size() + 1);
    std::map<PolygonShape, std::vector<size_t>> odd;
    for (size_t face = 0; face < lines_.size(); ++face) {
      const size_t begin = begin_[face], end = begin_[face + 1];
      const PolygonShape shape = triangulate(scene_.vertices, &corners_[begin], end - begin, scene_.triangles);
      if (shape != PolygonShape::Flat) odd[shape].push_back(lines_[face]);
      const uint32_t material = materials_of_[face] == kNone ? grey : material_of[materials_of_[face]];
      scene_.triangle_materials.resize(scene_.triangles.size(), material);
      used_[material] = true;
      losses_.coloured_faces += std::any_of(&corners_[begin], &corners_[begin] + (end - begin),
                                            [this](uint32_t corner) { return coloured_[corner]; });
    }
    if (used_[grey]) scene_.materials.push_back({"default_grey", {0.5f, 0.5f, 0.5f}, {0, 0, 0}});
    warn_of_faces(scene_.warnings, odd, [&](size_t line) { return fmt::format("{}:{}: the face", path_, line); });
  }

  void add_warnings() {
    std::vector<std::string>& warnings = scene_.warnings;
    const auto more = [](size_t count) { return count == 1 ? "" : fmt::format(" (and {} more)", count - 1); };
    if (!missing_libraries_.empty()) {
      const fs::path folder = fs::path(path_).parent_path();
      warnings.push_back(
          fmt::format("{}:{}: material file '{}'{} is not in '{}': what has its materials is grey; put it there", path_,
                      missing_libraries_.front().line, missing_libraries_.front().name, more(missing_libraries_.size()),
                      folder.empty() ? "." : folder.string()));
    } else if (!unknown_.empty()) {
      warnings.push_back(fmt::format("{}: material '{}'{} is in no material file: what has it is grey", path_,
                                     unknown_.front(), more(unknown_.size())));
    }
    places_.tell_lost_detail(scene_, path_);
    tell_of_materials(warnings, path_, materials_, used_);
    tell_loss(warnings, path_, losses_.coloured_faces, "face", Loss::VertexColours);
    tell_loss(warnings, path_, losses_.faces_with_normals, "face", Loss::VertexNormals);
    tell_loss(warnings, path_, losses_.points_and_lines, "element", Loss::PointsOrLines);
    tell_count(warnings, path_, losses_.free_forms, "free-form curve or surface", "not drawn", "not drawn");
  }

  const std::string& path_;
  ObjText text_;
  Scene scene_;
  ObjLosses losses_;
  FilePlaces places_;                      // of the vertices
  std::vector<bool> coloured_;             // [vertex]
  std::vector<uint32_t> corners_;          // of all faces, one after the other
  std::vector<size_t> begin_{0};           // [face] its first corner; one more at the end
  std::vector<size_t> lines_;              // [face] of the file
  std::vector<uint32_t> materials_of_;     // [face] number in names_, or kNone
  std::map<std::string, uint32_t> names_;  // of materials, as usemtl has them
  uint32_t material_ = kNone;              // of the faces that follow
  long largest_ = 0;                       // index of a vertex
  size_t largest_line_ = 0;
  std::set<std::string> libraries_;  // that have been read
  std::vector<MtlMaterial> materials_;
  std::vector<bool> used_;  // [material] by a triangle; the last one is the grey
  std::vector<Missing> missing_libraries_;
  std::vector<std::string> unknown_;  // materials that no library has
};

}  // namespace

Scene load_obj(const std::string& path) {
  Scene scene = ObjReader(path).read();
  check_scene(scene, path);
  return scene;
}

void write_obj(const Scene& scene, const std::string& path) {
  // A blank would end the name in the mtllib line.
  std::string mtl_name = std::filesystem::path(path).stem().string() + ".mtl";
  for (char& c : mtl_name) {
    if (c >= 0 && c <= ' ') c = '_';
  }
  const std::filesystem::path mtl_path = std::filesystem::path(path).parent_path() / mtl_name;
  if (mtl_path == path)
    throw InputError(path + ": this is the name of its material file; end the OBJ file's name in .obj");
  // Names must be single words, each used once.
  std::vector<std::string> names;
  std::set<std::string> taken;
  for (const Material& material : scene.materials) {
    std::string name = material.name.empty() ? "material" : material.name;
    for (char& c : name) {
      if ((c >= 0 && c <= ' ') || c == '#') c = '_';
    }
    if (taken.count(name) != 0) name += fmt::format("_{}", names.size());
    taken.insert(name);
    names.push_back(name);
  }

  fmt::memory_buffer mtl, obj;
  for (size_t i = 0; i < names.size(); ++i) {
    const Material& m = scene.materials[i];
    fmt::format_to(std::back_inserter(mtl), "newmtl {}\nKd {} {} {}\nKs {} {} {}\n{}", names[i], m.kd.x, m.kd.y, m.kd.z,
                   m.ks.x, m.ks.y, m.ks.z, m.reflects() ? "illum 3\n" : "");
  }
  fmt::format_to(std::back_inserter(obj), "# {}: {} vertices, {} triangles\nmtllib {}\n", scene.name,
                 scene.vertices.size(), scene.triangles.size(), mtl_name);
  for (const Vec3& v : scene.vertices)
    fmt::format_to(std::back_inserter(obj), "v {}\n", fmt::join(texts_in_file(scene.centre, v), " "));
  for (size_t i = 0; i < scene.triangles.size(); ++i) {
    if (i == 0 || scene.triangle_materials[i] != scene.triangle_materials[i - 1]) {
      fmt::format_to(std::back_inserter(obj), "usemtl {}\n", names[scene.triangle_materials[i]]);
    }
    const auto& t = scene.triangles[i];
    fmt::format_to(std::back_inserter(obj), "f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  }
  OutputFiles files;
  files.write(mtl_path, fmt::to_string(mtl));
  files.write(path, fmt::to_string(obj));
  files.publish();
}

}  // namespace raypool
