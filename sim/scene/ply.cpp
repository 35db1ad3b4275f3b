// PLY files as scenes: what the header declares, value by value. Not by Assimp 5.2: its reader takes a file that is cut
// off for a whole one, with made-up corners, and shifts binary data that begin with the byte of a line feed.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>

#include "bits.hpp"
#include "enum_array.hpp"
#include "files/input_file.hpp"
#include "scene/far_places.hpp"
#include "scene/losses.hpp"
#include "scene/polygon.hpp"
#include "scene/scene_file.hpp"

namespace raypool {
namespace {

enum class Format : uint8_t { Text, LittleEndian, BigEndian };

enum class Type : uint8_t { Int8, Uint8, Int16, Uint16, Int32, Uint32, Float, Double };
constexpr EnumArray<Type, size_t, 8> kBytes = {1, 1, 2, 2, 4, 4, 4, 8};
/// What the value 1 of a colour is: the largest number of an integer type.
constexpr EnumArray<Type, double, 8> kWhite = {127, 255, 32767, 65535, 2147483647, 4294967295, 1, 1};

struct Property {
  std::string name;
  Type type = Type::Float;
  bool list = false;
  Type count_type = Type::Uint8;  // of a list
};

struct Element {
  std::string name;
  uint64_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  Format format = Format::Text;
  std::vector<Element> elements;
  size_t end = 0;   // where the data begin
  size_t line = 0;  // number of its last line
};

std::string_view next_word(std::string_view& line) {
  constexpr std::string_view kBetweenWords = " \t\r\v\f";
  line.remove_prefix(std::min(line.find_first_not_of(kBetweenWords), line.size()));
  const std::string_view word = line.substr(0, line.find_first_of(kBetweenWords));
  line.remove_prefix(word.size());
  return word;
}

template <typename Number>
bool read_all(std::string_view word, Number& value) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  const auto result = std::from_chars(word.data(), word.data() + word.size(), value);
  return result.ec == std::errc() && result.ptr == word.data() + word.size();
}

class HeaderReader {
 public:
  HeaderReader(const std::string& path, const std::string& text) : path_(path), text_(text) {}

  Header read() {
    if (text_.empty()) throw InputError(path_ + ": the file is empty; export it again");
    const size_t first_end = text_.find_first_of("\r\n");
    if (first_end != std::string::npos && text_[first_end] == '\r' && text_.compare(first_end, 2, "\r\n") != 0)
      line_end_ = '\r';
    std::string_view line = next_line();
    if (next_word(line) != "ply") fail("the file does not begin with 'ply': it is not a PLY file; check the path");
    bool has_format = false;
    for (std::string_view key; key != "end_header";) {
      if (header_.end >= text_.size())
        fail("the header has no end_header: the file is cut off; copy or export it again");
      line = next_line();
      key = next_word(line);
      if (key == "format") {
        read_format(line);
        has_format = true;
      } else if (key == "element") {
        add_element(line);
      } else if (key == "property") {
        add_property(line);
      } else if (!key.empty() && key != "comment" && key != "obj_info" && key != "end_header") {
        fail(fmt::format("'{}' is no line of a PLY header; export the file again", shortened(key)));
      }
    }
    if (!has_format) fail("the header has no format line; export the file again");
    return header_;
  }

 private:
  [[noreturn]] void fail(const std::string& message) const {
    throw InputError(fmt::format("{}:{}: {}", path_, header_.line, message));
  }
  /// Binary rubbish is no text for a terminal.
  static std::string shortened(std::string_view word) {
    std::string text(word.substr(0, 20));
    for (char& c : text) {
      if (c < ' ' || c > '~') c = '?';
    }
    return text;
  }
  std::string_view next_line() {
    const size_t begin = header_.end, found = text_.find(line_end_, begin);
    const size_t end = found == std::string::npos ? text_.size() : found;
    header_.end = std::min(end + 1, text_.size());
    ++header_.line;
    return std::string_view(text_).substr(begin, end - begin);
  }
  void read_format(std::string_view line) {
    const std::string_view word = next_word(line);
    if (word != "ascii" && word != "binary_little_endian" && word != "binary_big_endian") {
      fail(fmt::format("format '{}' is not ascii, binary_little_endian or binary_big_endian; export the file again",
                       shortened(word)));
    }
    header_.format = word == "ascii"                  ? Format::Text
                     : word == "binary_little_endian" ? Format::LittleEndian
                                                      : Format::BigEndian;
  }
  void add_element(std::string_view line) {
    Element element;
    element.name = next_word(line);
    const std::string_view count = next_word(line);
    if (element.name.empty() || !read_all(count, element.count))
      fail("an element needs a name and a number, as in: element vertex 8");
    header_.elements.push_back(element);
  }
  void add_property(std::string_view line) {
    if (header_.elements.empty()) fail("a property before the first element; export the file again");
    Property property;
    std::string_view word = next_word(line);
    property.list = word == "list";
    if (property.list) {
      property.count_type = type_of(next_word(line));
      if (property.count_type >= Type::Float) fail("the length of a list must be an integer type");
      word = next_word(line);
    }
    property.type = type_of(word);
    property.name = next_word(line);
    if (property.name.empty()) fail("a property needs a type and a name, as in: property float x");
    header_.elements.back().properties.push_back(property);
  }
  Type type_of(std::string_view word) const {
    static const std::map<std::string_view, Type> kTypes = {
        {"char", Type::Int8},   {"int8", Type::Int8},     {"uchar", Type::Uint8},   {"uint8", Type::Uint8},
        {"short", Type::Int16}, {"int16", Type::Int16},   {"ushort", Type::Uint16}, {"uint16", Type::Uint16},
        {"int", Type::Int32},   {"int32", Type::Int32},   {"uint", Type::Uint32},   {"uint32", Type::Uint32},
        {"float", Type::Float}, {"float32", Type::Float}, {"double", Type::Double}, {"float64", Type::Double}};
    const auto found = kTypes.find(word);
    if (found == kTypes.end()) fail(fmt::format("'{}' is no type of a property, such as float", shortened(word)));
    return found->second;
  }

  const std::string& path_;
  const std::string& text_;
  Header header_;
  char line_end_ = '\n';  // as the first line has it: the byte behind the header's last line may be any of binary data
};

/// The data behind the header, one value after the other.
class Values {
 public:
  Values(const std::string& path, const std::string& data, const Header& header)
      : path_(path), data_(data), format_(header.format), place_(header.end), line_number_(header.line) {}

  /// Of one element: `what` and `number` name it in sentences.
  void begin(const std::string& what, uint64_t number) {
    what_ = &what;
    number_ = number;
    if (format_ != Format::Text) return;
    for (line_ = {}; line_.find_first_not_of(" \t\r") == std::string_view::npos;) {
      if (place_ >= data_.size()) cut_off();
      const size_t end = std::min(data_.find('\n', place_), data_.size());
      line_ = std::string_view(data_).substr(place_, end - place_);
      place_ = end + 1;
      ++line_number_;
    }
  }
  /// Text has each element on a line of its own.
  void end() {
    if (format_ == Format::Text && !next_word(line_).empty()) fail("has more values than the header declares");
  }

  double next(Type type) {
    if (format_ != Format::Text) return binary(type);
    const std::string_view word = next_word(line_);
    double value = 0;
    if (word.empty() && place_ >= data_.size()) cut_off();
    if (word.empty()) fail("has fewer values than the header declares");
    if (!read_all(word, value)) fail(fmt::format("has '{}', which is not a number", word.substr(0, 20)));
    return value;
  }

  [[noreturn]] void fail(const std::string& message) const {
    const std::string line = format_ == Format::Text ? fmt::format("{}:", line_number_) : "";
    throw InputError(fmt::format("{}:{} {} {} {}; correct the file", path_, line, *what_, number_, message));
  }
  /// Behind the last element.
  size_t bytes_left() const {
    if (place_ >= data_.size()) return 0;
    const size_t text = data_.find_first_not_of(" \t\r\n", place_);
    return text == std::string::npos ? 0 : data_.size() - place_;
  }
  size_t bytes() const { return data_.size(); }

 private:
  [[noreturn]] void cut_off() const {
    throw InputError(fmt::format("{}: the file is cut off in {} {}; copy or export it again", path_, *what_, number_));
  }
  double binary(Type type) {
    const size_t size = kBytes[type];
    if (data_.size() - place_ < size) cut_off();
    uint64_t bits = 0;
    for (size_t i = 0; i < size; ++i) {
      const size_t from = format_ == Format::BigEndian ? i : size - 1 - i;
      bits = bits << 8 | static_cast<uint8_t>(data_[place_ + from]);
    }
    place_ += size;
    switch (type) {
      case Type::Int8:
        return static_cast<int8_t>(bits);
      case Type::Int16:
        return static_cast<int16_t>(bits);
      case Type::Int32:
        return static_cast<int32_t>(bits);
      case Type::Float:
        return as_float(static_cast<uint32_t>(bits));
      case Type::Double: {
        double value = 0;
        std::memcpy(&value, &bits, sizeof value);
        return value;
      }
      default:
        return bits;
    }
  }

  const std::string& path_;
  const std::string& data_;
  Format format_;
  size_t place_;
  size_t line_number_;
  std::string_view line_;
  const std::string* what_ = nullptr;
  uint64_t number_ = 0;
};

class PlyReader {
 public:
  PlyReader(const std::string& path, const std::string& data, bool surfaces)
      : path_(path), header_(HeaderReader(path, data).read()), values_(path, data, header_) {
    if (surfaces) surfaces_.emplace();
  }

  Scene read() {
    for (const Element& element : header_.elements) {
      if (element.count > 0 && element.properties.empty())
        throw InputError(fmt::format("{}: element {} has no properties; correct the header", path_, element.name));
      if (element.name == "vertex") {
        read_vertices(element);
      } else if (element.name == "face" || element.name == "tristrips") {
        read_faces(element);
      } else {
        points_and_lines_ += element.name == "edge" ? element.count : 0;
        skip(element);
      }
    }
    add_triangles();
    if (scene_.triangles.empty())
      throw InputError(path_ + ": the file has no faces, only points or lines; nothing can be rendered");
    if (values_.bytes_left() > 0) {
      scene_.warnings.push_back(
          fmt::format("{}: {} bytes behind the last element are not read", path_, values_.bytes_left()));
    }
    if (has_normals_ && !surfaces_) tell_loss(scene_.warnings, path_, faces_, "face", Loss::VertexNormals);
    tell_loss(scene_.warnings, path_, points_and_lines_, "element", Loss::PointsOrLines);
    warn_of_faces(scene_.warnings, odd_faces_, [&](size_t face) { return fmt::format("{}: face {}", path_, face); });
    scene_.name = std::filesystem::path(path_).stem().string();
    if (surfaces_) add_surfaces();
    return std::move(scene_);
  }

 private:
  /// Where a property is in an element; none: -1.
  static int find(const Element& element, const std::vector<const char*>& names, bool list) {
    for (size_t i = 0; i < element.properties.size(); ++i) {
      const Property& property = element.properties[i];
      if (property.list == list && std::find(names.begin(), names.end(), property.name) != names.end())
        return static_cast<int>(i);
    }
    return -1;
  }

  /// One element's values: of each property its own, or a list's.
  void read_element(const Element& element, uint64_t number, std::vector<std::vector<double>>& values) {
    values_.begin(element.name, number);
    values.resize(element.properties.size());
    for (size_t i = 0; i < element.properties.size(); ++i) {
      const Property& property = element.properties[i];
      const double count = property.list ? values_.next(property.count_type) : 1;
      if (!(count >= 0 && count == std::floor(count))) values_.fail(fmt::format("has a list of length {}", count));
      values[i].clear();
      for (double k = 0; k < count; ++k) values[i].push_back(values_.next(property.type));
    }
    values_.end();
  }

  void skip(const Element& element) {
    std::vector<std::vector<double>> values;
    for (uint64_t number = 0; number < element.count; ++number) read_element(element, number, values);
  }

  void read_vertices(const Element& element) {
    std::array<int, 3> place{}, colour{};
    const std::array<const char*, 3> axes = {"x", "y", "z"};
    const std::array<std::vector<const char*>, 3> channels = {
        {{"red", "r", "diffuse_red"}, {"green", "g", "diffuse_green"}, {"blue", "b", "diffuse_blue"}}};
    for (size_t i = 0; i < 3; ++i) {
      place[i] = find(element, {axes[i]}, false);
      colour[i] = find(element, channels[i], false);
      if (place[i] < 0)
        throw InputError(fmt::format("{}: vertices have no '{}'; export the file again", path_, axes[i]));
    }
    has_normals_ = find(element, {"nx"}, false) >= 0;
    const VertexPlaces more = surfaces_ ? vertex_places(element) : VertexPlaces();
    for (const int axis : place)
      single_ = single_ || (header_.format != Format::Text && element.properties[axis].type == Type::Float);
    const bool coloured = colour[0] >= 0 && colour[1] >= 0 && colour[2] >= 0;
    std::vector<std::vector<double>> values;
    for (uint64_t number = 0; number < element.count; ++number) {
      read_element(element, number, values);
      Vec3d p, c;
      for (int i = 0; i < 3; ++i) {
        p[i] = values[place[i]][0];
        if (!(std::fabs(p[i]) <= kLargestCoordinate)) {
          values_.fail(fmt::format("has the coordinate {}, which is not in {:g} .. {:g}", p[i], -kLargestCoordinate,
                                   kLargestCoordinate));
        }
        if (!coloured) continue;
        const size_t channel = colour[i];
        const Type type = element.properties[channel].type;
        c[i] = (type == Type::Float ? static_cast<float>(values[channel][0]) : values[channel][0]) / kWhite[type];
        if (!(c[i] >= 0 && c[i] <= 1)) values_.fail(fmt::format("has the colour {}", values[channel][0]));
      }
      places_.add(p);
      if (coloured) colours_.push_back(c);
      if (surfaces_) add_vertex(element, values, more, coloured ? &c : nullptr);
    }
  }

  /// Where properties of vertices are that only surfaces have; none: -1.
  struct VertexPlaces {
    std::array<int, 3> normal{-1, -1, -1};
    std::array<int, 2> texcoord{-1, -1};
    int alpha = -1;
  };
  static VertexPlaces vertex_places(const Element& element) {
    VertexPlaces places;
    places.normal = {find(element, {"nx"}, false), find(element, {"ny"}, false), find(element, {"nz"}, false)};
    places.texcoord = {find(element, {"s", "u", "texture_u"}, false), find(element, {"t", "v", "texture_v"}, false)};
    places.alpha = find(element, {"alpha", "a"}, false);
    if (*std::min_element(places.normal.begin(), places.normal.end()) < 0) places.normal.fill(-1);
    if (std::min(places.texcoord[0], places.texcoord[1]) < 0) places.texcoord.fill(-1);
    return places;
  }
  /// With a colour: it is sRGB.
  void add_vertex(const Element& element, const std::vector<std::vector<double>>& values, const VertexPlaces& places,
                  const Vec3d* colour) {
    const auto number = [&](int place) { return values[static_cast<size_t>(place)][0]; };
    Vec3 normal;
    if (places.normal[0] >= 0) {
      for (int i = 0; i < 3; ++i) normal[i] = static_cast<float>(number(places.normal[static_cast<size_t>(i)]));
    }
    surfaces_->normals.push_back(normal);
    if (places.texcoord[0] >= 0) {
      Texcoord texcoord{};
      for (size_t i = 0; i < 2; ++i) {
        const double value = number(places.texcoord[i]);
        if (!(std::fabs(value) <= kLargestCoordinate))
          values_.fail(fmt::format("has the texture coordinate {}", value));
        texcoord[i] = static_cast<float>(i == 0 ? value : 1 - value);
      }
      surfaces_->texcoords.push_back(texcoord);
    }
    if (colour == nullptr) return;
    Rgba rgba{0, 0, 0, 1};
    for (int i = 0; i < 3; ++i) rgba[static_cast<size_t>(i)] = static_cast<float>(srgb_to_linear((*colour)[i]));
    if (places.alpha >= 0) {
      const double alpha = number(places.alpha) / kWhite[element.properties[static_cast<size_t>(places.alpha)].type];
      if (!(alpha >= 0 && alpha <= 1)) values_.fail(fmt::format("has the alpha {}", number(places.alpha)));
      rgba[3] = static_cast<float>(alpha);
    }
    surfaces_->colors.push_back(rgba);
  }

  void add_surfaces() {
    Surfaces& surfaces = *surfaces_;
    surfaces.triangles = scene_.triangles;
    surfaces.positions = scene_.vertices;
    for (const Material& material : scene_.materials)
      surfaces.materials.push_back(surfaces.colors.empty() ? surface_material(material.kd, {}) : SurfaceMaterial());
    finish(surfaces);
    scene_.surfaces = std::make_shared<const Surfaces>(std::move(surfaces));
  }

  void read_faces(const Element& element) {
    const int list = find(element, {"vertex_indices", "vertex_index"}, true);
    if (list < 0) {
      throw InputError(
          fmt::format("{}: element {} has no list vertex_indices; export the file again", path_, element.name));
    }
    if (find(element, {"red"}, false) >= 0) scene_.warnings.push_back(path_ + ": colours of faces are not used");
    faces_ += element.count;
    const bool strips = element.name == "tristrips";
    std::vector<std::vector<double>> values;
    for (uint64_t number = 0; number < element.count; ++number) {
      read_element(element, number, values);
      for (const double index : values[list]) {
        if (strips && index == -1) {
          end_face(strips, number);
          continue;
        }
        const auto vertices = static_cast<double>(places_.size());
        if (!(index >= 0 && index < vertices && index == std::floor(index))) {
          values_.fail(
              fmt::format("names vertex {}, which is out of range: {} vertices stand before it", index, vertices));
        }
        corners_.push_back(static_cast<uint32_t>(index));
      }
      if (const size_t corners = corners_.size() - begin_.back(); !strips && corners < 3)
        values_.fail(fmt::format("has {} corners, fewer than three", corners));
      end_face(strips, number);
    }
  }

  /// Of the corners that have been read since the last one.
  void end_face(bool strip, uint64_t number) {
    is_strip_.push_back(strip);
    number_of_.push_back(static_cast<uint32_t>(number));
    begin_.push_back(corners_.size());
  }

  /// Of all faces, now that it is known what is far away.
  void add_triangles() {
    places_.put_into(scene_, places_.centre(corners_));
    for (size_t face = 0; face < is_strip_.size(); ++face) {
      const std::vector<uint32_t> corners(corners_.data() + begin_[face], corners_.data() + begin_[face + 1]);
      if (is_strip_[face]) {
        add_strip(corners);
      } else {
        add_face(corners, number_of_[face]);
      }
    }
    places_.tell_lost_detail(scene_, path_, single_);
  }

  void add_face(const std::vector<uint32_t>& corners, uint64_t number) {
    const PolygonShape shape = triangulate(scene_.vertices, corners.data(), corners.size(), scene_.triangles);
    if (shape != PolygonShape::Flat) odd_faces_[shape].push_back(number);
    scene_.triangle_materials.resize(scene_.triangles.size(), material_of(corners));
  }

  /// Every second triangle of a strip goes the other way round.
  void add_strip(const std::vector<uint32_t>& corners) {
    for (size_t i = 2; i < corners.size(); ++i) {
      const std::vector<uint32_t> triangle = {corners[i - 2 + i % 2], corners[i - 1 - i % 2], corners[i]};
      scene_.triangles.push_back({triangle[0], triangle[1], triangle[2]});
      scene_.triangle_materials.push_back(material_of(triangle));
    }
  }

  /// Of the mean of the corners' colours, in steps of 1/15, so that there are few enough materials.
  uint32_t material_of(const std::vector<uint32_t>& corners) {
    constexpr double kSteps = 15;
    std::array<int, 3> colour = {-1, -1, -1};
    for (int i = 0; i < 3 && !colours_.empty(); ++i) {
      double sum = 0;
      for (const uint32_t corner : corners) sum += colours_[corner][i];
      colour[i] = static_cast<int>(std::lround(kSteps * sum / static_cast<double>(corners.size())));
    }
    const auto added = materials_.emplace(colour, size32(scene_.materials));
    if (!added.second) return added.first->second;
    Material material{"default_grey", {0.5f, 0.5f, 0.5f}, {}};
    if (!colours_.empty()) {
      material.name = fmt::format("colour_{:x}{:x}{:x}", colour[0], colour[1], colour[2]);
      for (int i = 0; i < 3; ++i) material.kd[i] = static_cast<float>(srgb_to_linear(colour[i] / kSteps));
    }
    scene_.materials.push_back(material);
    return added.first->second;
  }

  const std::string& path_;
  const Header header_;
  Values values_;
  Scene scene_;
  FilePlaces places_;                                 // of the vertices
  bool single_ = false;                               // the file has them in single precision
  std::vector<uint32_t> corners_;                     // of all faces, one after the other
  std::vector<size_t> begin_{0};                      // [face] its first corner; one more at the end
  std::vector<bool> is_strip_;                        // [face]
  std::vector<uint32_t> number_of_;                   // [face] in its element
  std::vector<Vec3d> colours_;                        // [vertex]; empty: without
  std::map<std::array<int, 3>, uint32_t> materials_;  // by colour
  std::map<PolygonShape, std::vector<size_t>> odd_faces_;
  bool has_normals_ = false;
  std::optional<Surfaces> surfaces_;  // where they are asked for
  size_t faces_ = 0, points_and_lines_ = 0;
};

}  // namespace

Scene load_ply(const std::string& path, bool surfaces) {
  std::string data = read_text_file(path, "PLY file");
  if (HeaderReader(path, data).read().format == Format::Text) use_line_feeds(data);
  Scene scene = PlyReader(path, data, surfaces).read();
  weld_vertices(scene);
  check_scene(scene, path);
  return scene;
}

}  // namespace raypool
