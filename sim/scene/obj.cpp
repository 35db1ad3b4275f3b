// Wavefront OBJ in and out. tinyobjloader reads vertices and materials; before it, the file is scanned line by line,
// because tinyobjloader takes malformed numbers for zero and drops faces it cannot resolve, both without a line number.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <map>
#include <set>
#include <sstream>
#include <string_view>

#define TINYOBJLOADER_IMPLEMENTATION
#include <tiny_obj_loader.h>

#include "bits.hpp"
#include "files/input_file.hpp"
#include "files/output_files.hpp"
#include "scene/polygon.hpp"
#include "scene/scene.hpp"

namespace raypool {
namespace {

/// Calls visit(line number from 1, line without its end) for every line.
template <typename Visit>
void for_each_line(const std::string& text, Visit visit) {
  size_t number = 1;
  for (size_t start = 0; start < text.size(); ++number) {
    size_t end = text.find('\n', start);
    if (end == std::string::npos) end = text.size();
    std::string_view line(text.data() + start, end - start);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    visit(number, line);
    start = end + 1;
  }
}

/// Takes the next word off the front of `line`; empty at its end.
std::string_view next_word(std::string_view& line) {
  const size_t start = line.find_first_not_of(" \t");
  if (start == std::string_view::npos) return line = {};
  const size_t end = std::min(line.find_first_of(" \t", start), line.size());
  const std::string_view word = line.substr(start, end - start);
  line.remove_prefix(end);
  return word;
}

/// Reads a decimal number and nothing after it; the result may be infinite or NaN if the text says so.
bool read_float(std::string_view word, float& value) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  const auto result = std::from_chars(word.data(), word.data() + word.size(), value);
  // Both the too large (becomes infinite) and the too small (harmless) are out of range.
  if (result.ec == std::errc::result_out_of_range)
    value = static_cast<float>(std::strtod(std::string(word).c_str(), nullptr));
  return result.ec != std::errc::invalid_argument && result.ptr == word.data() + word.size();
}

[[noreturn]] void fail(const std::string& path, size_t line, const std::string& message) {
  throw InputError(fmt::format("{}:{}: {}", path, line, message));
}

void check_numbers(const std::string& path, size_t number, std::string_view rest, const char* what, float low,
                   float high) {
  for (int i = 0; i < 3; ++i) {
    const std::string_view word = next_word(rest);
    float value = 0;
    if (word.empty()) fail(path, number, fmt::format("{} has {} numbers; give three", what, i));
    if (!read_float(word, value))
      fail(path, number, fmt::format("'{}' in {} is not a number; give three numbers", word, what));
    if (!(value >= low && value <= high)) {
      fail(path, number,
           fmt::format("{} has {}, which is not in {:g} .. {:g}; correct or rescale the file", what, word, low, high));
    }
  }
}

void check_mtl(const std::string& path) {
  const std::string text = read_file(path, "material file");
  for_each_line(text, [&](size_t number, std::string_view line) {
    const std::string_view key = next_word(line);
    if (key == "Kd") check_numbers(path, number, line, "colour Kd", 0, 1000);
    if (key == "Ks") check_numbers(path, number, line, "colour Ks", 0, 1000);
  });
}

/// Comments behind vertices and faces become blanks: tinyobjloader takes them for indices. In lines with longer
/// keywords the character may belong to a name.
void blank_comments(std::string& text) {
  for (size_t place = text.find('#'); place != std::string::npos; place = text.find('#', place + 1)) {
    const size_t before = place == 0 ? std::string::npos : text.rfind('\n', place - 1);
    std::string_view line = std::string_view(text).substr(before == std::string::npos ? 0 : before + 1);
    const std::string_view key = next_word(line);
    if (key.size() > 2) continue;
    for (; place < text.size() && text[place] != '\n' && text[place] != '\r'; ++place) text[place] = ' ';
  }
}

/// The faces' corners, as indices of vertices from 0. tinyobjloader would fill a notch and lose corners beyond 255.
struct Faces {
  std::vector<uint32_t> corners;  // of all faces, one after the other
  std::vector<size_t> begin{0};   // [face] its first corner; one more at the end
  std::vector<size_t> lines;      // [face] of the file
};

/// Refuses everything of the file that tinyobjloader would swallow or misread.
Faces check_obj(const std::string& path, const std::string& text) {
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  Faces faces;
  long vertices = 0, largest = 0;
  size_t largest_line = 0;
  for_each_line(text, [&](size_t number, std::string_view line) {
    if (line.find('\0') != std::string_view::npos)
      fail(path, number, "a zero byte: this is not an OBJ text file; check the path");
    if (!line.empty() && line.back() == '\\')
      fail(path, number, "line continuation by '\\' is not supported; join the lines");
    const std::string_view key = next_word(line);
    if (key == "v") {
      check_numbers(path, number, line, "vertex", -kLargestCoordinate, kLargestCoordinate);
      ++vertices;
    } else if (key == "f") {
      int corners = 0;
      for (std::string_view word = next_word(line); !word.empty(); word = next_word(line), ++corners) {
        const std::string_view digits = word.substr(0, word.find('/'));
        long index = 0;
        const auto result = std::from_chars(digits.data(), digits.data() + digits.size(), index);
        if (result.ec != std::errc() || result.ptr != digits.data() + digits.size()) {
          fail(path, number, fmt::format("'{}' is not a vertex index; give f 1 2 3 or f 1/2/3 ...", word));
        }
        if (index == 0 || -index > vertices) {
          fail(path, number,
               fmt::format("vertex index {} is out of range; {} vertices stand above this line, numbered from 1", index,
                           vertices));
        }
        if (index > largest) largest = index, largest_line = number;
        faces.corners.push_back(static_cast<uint32_t>(index > 0 ? index - 1 : vertices + index));
      }
      if (corners < 3) fail(path, number, fmt::format("a face of {} corners; give at least three", corners));
      faces.begin.push_back(faces.corners.size());
      faces.lines.push_back(number);
    } else if (key == "mtllib") {
      bool found = false;
      std::string names(line);
      for (std::string_view word = next_word(line); !word.empty() && !found; word = next_word(line)) {
        const std::string file = (folder / std::string(word)).string();
        found = std::filesystem::is_regular_file(file);
        if (found) check_mtl(file);
      }
      if (!found) {
        fail(path, number,
             fmt::format(
                 "material file{} is not in '{}'; put it there, under a name without blanks, or remove the line (faces "
                 "are grey then)",
                 names, folder.empty() ? "." : folder.string()));
      }
    }
  });
  if (largest > vertices) {
    fail(path, largest_line,
         fmt::format("vertex index {} is out of range; the file has {} vertices", largest, vertices));
  }
  if (faces.lines.empty())
    throw InputError(path + ": the file has no faces (lines that begin with f); nothing can be rendered");
  return faces;
}

/// Negative materials are none.
void add_triangles(Scene& scene, const std::string& path, const Faces& faces, const std::vector<int>& materials) {
  const auto grey = size32(scene.materials);
  std::map<PolygonShape, std::vector<size_t>> lines;
  for (size_t face = 0; face < materials.size(); ++face) {
    const size_t begin = faces.begin[face];
    const PolygonShape shape =
        triangulate(scene.vertices, &faces.corners[begin], faces.begin[face + 1] - begin, scene.triangles);
    if (shape != PolygonShape::Flat) lines[shape].push_back(faces.lines[face]);
    scene.triangle_materials.resize(scene.triangles.size(),
                                    materials[face] < 0 ? grey : static_cast<uint32_t>(materials[face]));
  }
  if (std::any_of(materials.begin(), materials.end(), [](int material) { return material < 0; })) {
    scene.materials.push_back({"default_grey", {0.5f, 0.5f, 0.5f}, {0, 0, 0}});
  }
  warn_of_faces(scene.warnings, lines, [&](size_t line) { return fmt::format("{}:{}: the face", path, line); });
}

Vec3 to_vec3(const tinyobj::real_t* v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

}  // namespace

Scene load_obj(const std::string& path) {
  std::string text = read_file(path, "OBJ file");
  blank_comments(text);
  const Faces faces = check_obj(path, text);

  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  tinyobj::attrib_t attributes;
  std::vector<tinyobj::shape_t> shapes;
  std::vector<tinyobj::material_t> materials;
  std::string warning, error;
  std::istringstream stream(text);
  tinyobj::MaterialFileReader material_reader(folder.empty() ? "." : folder.string());
  if (!tinyobj::LoadObj(&attributes, &shapes, &materials, &warning, &error, &stream, &material_reader, false, false)) {
    while (!error.empty() && (error.back() == '\n' || error.back() == ' ')) error.pop_back();
    throw InputError(fmt::format("{}: not a readable OBJ file ({}); correct it", path, error));
  }

  Scene scene;
  scene.name = std::filesystem::path(path).stem().string();
  scene.vertices.resize(attributes.vertices.size() / 3);
  for (size_t i = 0; i < scene.vertices.size(); ++i) scene.vertices[i] = to_vec3(&attributes.vertices[3 * i]);
  for (const tinyobj::material_t& material : materials) {
    scene.materials.push_back({material.name, to_vec3(material.diffuse), to_vec3(material.specular)});
  }
  std::vector<int> face_materials;
  for (const tinyobj::shape_t& shape : shapes) {
    face_materials.insert(face_materials.end(), shape.mesh.material_ids.begin(), shape.mesh.material_ids.end());
  }
  if (face_materials.size() != faces.lines.size()) {
    throw InputError(fmt::format("{}: not a readable OBJ file ({} of {} faces were read); correct it", path,
                                 face_materials.size(), faces.lines.size()));
  }
  add_triangles(scene, path, faces, face_materials);

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
    fmt::format_to(std::back_inserter(mtl), "newmtl {}\nKd {} {} {}\nKs {} {} {}\n", names[i], m.kd.x, m.kd.y, m.kd.z,
                   m.ks.x, m.ks.y, m.ks.z);
  }
  fmt::format_to(std::back_inserter(obj), "# {}: {} vertices, {} triangles\nmtllib {}\n", scene.name,
                 scene.vertices.size(), scene.triangles.size(), mtl_name);
  for (const Vec3& v : scene.vertices) fmt::format_to(std::back_inserter(obj), "v {} {} {}\n", v.x, v.y, v.z);
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
