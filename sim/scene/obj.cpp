// Wavefront OBJ in and out. What a file has wrong gets its line; names are looked up when all of it has been read,
// since a library may stand behind the faces that use it.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "bits.hpp"
#include "files/input_file.hpp"
#include "files/output_files.hpp"
#include "scene/far_places.hpp"
#include "scene/losses.hpp"
#include "scene/mtl.hpp"
#include "scene/mtl_surfaces.hpp"
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
  ObjReader(const std::string& path, bool surfaces) : path_(path), text_(path, "OBJ file") {
    if (surfaces) surfaces_.emplace();
  }

  Scene read() {
    for (ObjLine line; text_.next(line);) {
      if (line.key == "v") {
        add_vertex(line);
      } else if (line.key == "f") {
        add_face(line);
      } else if (surfaces_ && line.key == "vt") {
        add_texcoord(line);
      } else if (surfaces_ && line.key == "vn") {
        add_normal(line);
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
    if (surfaces_) add_surfaces();
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
    if (!surfaces_ || words.size() < 6) return;
    colours_.resize(places_.size() - 1, {1, 1, 1, 1});
    Rgba colour{0, 0, 0, 1};
    for (size_t i = 0; i < 3; ++i) {
      const size_t word = (words.size() == 6 ? 3 : 4) + i;
      colour[i] = static_cast<float>(srgb_to_linear(double_of(text_, line, words[word], "colour of a vertex", 0, 1)));
    }
    colours_.push_back(colour);
  }

  std::vector<float> floats_of(const ObjLine& line, const char* what, size_t least, size_t most) const {
    const std::vector<std::string_view> words = words_of(line.rest);
    if (words.size() < least) text_.fail(line, fmt::format("{} has {} numbers; give {}", what, words.size(), most));
    std::vector<float> numbers(most);
    for (size_t i = 0; i < std::min(most, words.size()); ++i)
      numbers[i] = number_of(text_, line, words[i], what, -kLargestCoordinate, kLargestCoordinate);
    return numbers;
  }
  /// v points upwards in the file, and may be left out.
  void add_texcoord(const ObjLine& line) {
    const std::vector<float> uv = floats_of(line, "texture coordinate", 1, 2);
    texcoords_.push_back({uv[0], 1 - uv[1]});
  }
  void add_normal(const ObjLine& line) {
    const std::vector<float> normal = floats_of(line, "normal", 3, 3);
    normals_.push_back({normal[0], normal[1], normal[2]});
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
    if (surfaces_) {
      corner_texcoords_.push_back(
          attribute(line, indices[1], texcoords_.size(), texcoord_range_, "texture coordinate"));
      corner_normals_.push_back(attribute(line, indices[2], normals_.size(), normal_range_, "normal"));
    }
    return indices[2] != 0;
  }
  /// The largest index of a kind, and the line that has it.
  struct IndexRange {
    long largest = 0;
    size_t line = 0;
  };
  /// What an index of a corner names, of `count` that stand above it; kNone: it has none.
  uint32_t attribute(const ObjLine& line, long index, size_t count, IndexRange& range, const char* what) const {
    if (index == 0) return kNone;
    if (const auto above = static_cast<long>(count); index < 0) {
      if (-index > above) {
        text_.fail(line, fmt::format("{} index {} is out of range; {} of them stand above this line, numbered from 1",
                                     what, index, count));
      }
      index += above + 1;
    }
    if (index > range.largest) range = {index, line.number};
    return static_cast<uint32_t>(std::min<long>(index - 1, kNone));
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

  bool read_library(std::string name) {
    if (name.size() > 2 && name.front() == '"' && name.back() == '"') name = name.substr(1, name.size() - 2);
    const std::string path = name.empty() ? "" : find_named_file(fs::path(path_).parent_path().string(), name);
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
      if (lower_case(fs::path(missing).extension().string()) == ".mtl") miss();
    }
    miss();
  }

  void check_range(const IndexRange& range, size_t count, const char* what) const {
    if (range.largest <= static_cast<long>(count)) return;
    ObjLine line;
    line.number = range.line;
    text_.fail(line, fmt::format("{} index {} is out of range; the file has {} of them", what, range.largest, count));
  }
  void check_faces() const {
    const auto vertices = static_cast<long>(places_.size());
    if (largest_ > vertices) {
      ObjLine line;
      line.number = largest_line_;
      text_.fail(line, fmt::format("vertex index {} is out of range; the file has {} vertices", largest_, vertices));
    }
    check_range(texcoord_range_, texcoords_.size(), "texture coordinate");
    check_range(normal_range_, normals_.size(), "normal");
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
      if (surfaces_) add_corners_of(begin, end);
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

  /// Of the surfaces, for the triangles of the face with these corners, which are those of the scene's end.
  void add_corners_of(size_t begin, size_t end) {
    corner_of_.clear();
    for (size_t corner = end; corner-- > begin;) corner_of_[corners_[corner]] = corner;
    for (size_t i = surfaces_->triangles.size(); i < scene_.triangles.size(); ++i) {
      std::array<uint32_t, 3> triangle = scene_.triangles[i];
      for (uint32_t& vertex : triangle) {
        const size_t corner = corner_of_.at(vertex);
        const std::array<uint32_t, 3> key = {vertex, corner_texcoords_[corner], corner_normals_[corner]};
        const auto [known, is_new] = surface_vertices_.emplace(key, size32(surfaces_->positions));
        if (is_new) {
          surfaces_->positions.push_back(scene_.vertices[vertex]);
          surfaces_->texcoords.push_back(key[1] == kNone ? Texcoord{} : texcoords_[key[1]]);
          surfaces_->normals.push_back(key[2] == kNone ? Vec3{} : normals_[key[2]]);
          if (!colours_.empty())
            surfaces_->colors.push_back(vertex < colours_.size() ? colours_[vertex] : Rgba{1, 1, 1, 1});
        }
        vertex = known->second;
      }
      surfaces_->triangles.push_back(triangle);
    }
  }
  void add_surfaces() {
    add_mtl_surfaces(path_, materials_, used_, *surfaces_, scene_.warnings);
    if (surfaces_->materials.size() < scene_.materials.size())
      surfaces_->materials.push_back(surface_material(scene_.materials.back().kd, {}));
    finish(*surfaces_);
    scene_.surfaces = std::make_shared<const Surfaces>(std::move(*surfaces_));
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
    tell_of_materials(warnings, path_, materials_, used_, surfaces_.has_value());
    if (!surfaces_) {
      tell_loss(warnings, path_, losses_.coloured_faces, "face", Loss::VertexColours);
      tell_loss(warnings, path_, losses_.faces_with_normals, "face", Loss::VertexNormals);
    }
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

  // Where surfaces are asked for.
  struct IndexHash {
    size_t operator()(const std::array<uint32_t, 3>& indices) const {
      uint64_t hash = 0;
      for (const uint32_t index : indices) {
        hash = (hash ^ index) * 0x9e3779b97f4a7c15u;
        hash ^= hash >> 32;
      }
      return hash;
    }
  };
  std::optional<Surfaces> surfaces_;
  std::vector<Texcoord> texcoords_;
  std::vector<Vec3> normals_;
  std::vector<Rgba> colours_;                                // [vertex] up to the last one with a colour
  std::vector<uint32_t> corner_texcoords_, corner_normals_;  // as corners_
  IndexRange texcoord_range_, normal_range_;
  std::unordered_map<uint32_t, size_t> corner_of_;                                     // [vertex] of the face at hand
  std::unordered_map<std::array<uint32_t, 3>, uint32_t, IndexHash> surface_vertices_;  // vertex, texcoord, normal
};

}  // namespace

Scene load_obj(const std::string& path, bool surfaces) {
  Scene scene = ObjReader(path, surfaces).read();
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
