#include "scene/shader_memory.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bits.hpp"
#include "files/input_file.hpp"
#include "isa/did_you_mean.hpp"
#include "isa/input_error.hpp"
#include "scene/image_decoding.hpp"
#include "scene/shader_file.hpp"
#include "scene/shader_lights.hpp"
#include "scene/shader_values.hpp"

namespace raypool {
namespace {

using Words = std::vector<uint32_t>;

/// What a binding of raypool.glsl is.
struct KnownBinding {
  uint32_t binding;
  const char *variable, *block;
  const char* holds;
};
constexpr std::array<KnownBinding, 7> kKnownBindings = {{{3, "raypool_indices", "RaypoolIndices", "indices"},
                                                         {4, "raypool_positions", "RaypoolPositions", "positions"},
                                                         {5, "raypool_normals", "RaypoolNormals", "normals"},
                                                         {6, "raypool_texcoords", "RaypoolTexcoords", "texcoords"},
                                                         {7, "raypool_colors", "RaypoolColors", "colors"},
                                                         {8, "raypool_materials", "RaypoolMaterials", "materials"},
                                                         {9, "raypool_lights", "RaypoolLights", "lights"}}};

/// RaypoolMaterial, word by word.
struct ShaderMaterial {
  Rgba base_color;
  Vec3 emission;
  float metallic, roughness, transmission, ior, alpha_cutoff;
  uint32_t alpha_mode, base_color_texture, emission_texture, metallic_roughness_texture;
};
static_assert(sizeof(ShaderMaterial) == 64);

template <typename T>
void append_words(Words& words, const T& value) {
  static_assert(sizeof(T) % 4 == 0);
  const size_t first = words.size();
  words.resize(first + sizeof(T) / 4);
  std::memcpy(&words[first], &value, sizeof value);
}
template <typename T>
Words words_of(const std::vector<T>& values) {
  Words words;
  words.reserve(values.size() * sizeof(T) / 4);
  for (const T& value : values) append_words(words, value);
  return words;
}

class ShaderMemory {
 public:
  ShaderMemory(MemoryImage& image, const Scene& scene, const Surfaces& surfaces, const shader::ShaderSet& set,
               const ShaderFrame& frame)
      : image_(image),
        scene_(scene),
        surfaces_(surfaces),
        set_(set),
        frame_(frame),
        file_(set.folder()),
        diagonal_(scene.bounds().diagonal()),
        lights_(shader_lights(scene, surfaces, diagonal_, &frame)),
        values_(shader_values(scene, surfaces, lights_, frame, diagonal_)),
        end_(std::max(kShaderDataBegin, image.memory.size())) {}

  shader::Resources build() {
    materials_ = place(contents("materials"), 64);
    for (uint32_t i = 0; i < scene_.materials.size(); ++i) {
      image_.memory.store(image_.material_base + i * kMaterialBytes + kMaterialSurface,
                          materials_.address + i * static_cast<uint32_t>(sizeof(ShaderMaterial)));
    }
    for (const shader::Binding& binding : set_.bindings()) {
      switch (binding.kind) {
        case shader::BindingKind::Tree:
          expect(binding, "tree");
          break;
        case shader::BindingKind::Picture:
          if (file_.holds_nothing(binding.place))
            resources_.unseen.insert(binding.place);
          else
            expect(binding, "picture");
          break;
        case shader::BindingKind::Block:
          add_block(binding);
          break;
        case shader::BindingKind::Buffer:
          add_buffer(binding);
          break;
        case shader::BindingKind::Textures:
          add_textures(binding);
          break;
      }
    }
    put_members(file_.push_constants(), set_.push_constants(), "push constants", resources_.push_constants);
    for (const shader::ShaderRecord& record : set_.shader_records()) {
      std::vector<shader::Word>& words = resources_.records[record.place];
      words.resize((size_t{record.bytes} + 3) / 4);
      put_members(file_.record(record.place), record.members,
                  fmt::format("shader record {} of {}", record.place.second, record.shader), words);
    }
    if (file_.geometries_are_materials()) resources_.geometries = image_.material_base;
    resources_.specialization = file_.specialization();
    resources_.width = frame_.width;
    resources_.height = frame_.height;
    resources_.saved = reserve(0, 64);
    image_.memory.grow(resources_.saved);
    return std::move(resources_);
  }

 private:
  static std::string name_of(const shader::Binding& binding) {
    return fmt::format("set {}, binding {}{}", binding.place.first, binding.place.second,
                       binding.name.empty() ? "" : fmt::format(" ('{}')", binding.name));
  }
  [[noreturn]] void fail(const std::string& message) const {
    throw InputError(fmt::format("{}: {}", set_.folder(), message));
  }

  uint64_t aligned(uint64_t alignment) const { return (end_ + alignment - 1) / alignment * alignment; }
  bool fits(uint64_t bytes, uint64_t alignment) const {
    constexpr uint64_t kMost = UINT32_MAX - 63;
    return aligned(alignment) + bytes <= kMost;
  }
  uint32_t reserve(uint64_t bytes, uint64_t alignment) {
    const uint64_t begin = aligned(alignment);
    if (!fits(bytes, alignment)) {
      throw InputError(
          fmt::format("{}: buffers and textures for shaders need more than the 4 GiB that addresses reach; "
                      "use smaller textures or fewer triangles",
                      scene_.name));
    }
    end_ = begin + bytes;
    image_.memory.grow(static_cast<uint32_t>(end_));
    return static_cast<uint32_t>(begin);
  }
  shader::Buffer place(const Words& words, uint64_t alignment = 16) {
    const shader::Buffer buffer = {reserve(4 * uint64_t{words.size()}, alignment),
                                   static_cast<uint32_t>(4 * words.size())};
    for (uint32_t i = 0; i < words.size(); ++i) image_.memory.store(buffer.address + 4 * i, words[i]);
    return buffer;
  }

  /// Where the file describes a tree or a picture, it must be one.
  void expect(const shader::Binding& binding, const char* kind) const {
    const std::optional<JsonPlace> entry = file_.binding(binding.place);
    if (!entry) return;
    const std::optional<JsonPlace> holds = entry->find("holds");
    if (!holds || !holds->json().is_string() || holds->text() != kind) {
      entry->fail(fmt::format("is for {}, which the shaders declare as a {}: let it hold \"{}\"", name_of(binding),
                              std::string(kind) == "tree" ? "tree (accelerationStructureEXT)" : "picture (image2D)",
                              kind));
    }
  }

  // Uniform blocks and push constants.

  void add_block(const shader::Binding& binding) {
    if (const std::optional<JsonPlace> entry = file_.binding(binding.place); entry && entry->find("holds"))
      entry->fail(
          fmt::format("is for {}, which the shaders declare as a uniform block: give it 'values'", name_of(binding)));
    std::vector<shader::Word>& words = resources_.blocks[binding.place];
    words.resize((size_t{binding.bytes} + 3) / 4);
    put_members(file_.values(binding.place), binding.members, name_of(binding), words);
  }
  void put_members(const std::optional<JsonPlace>& values, const std::vector<shader::Member>& members,
                   const std::string& name, std::vector<shader::Word>& words) {
    std::vector<std::string> without;
    for (const shader::Member& member : members) {
      const std::string where = fmt::format("{}: {}: member '{}'", set_.folder(), name, member.name);
      const std::optional<JsonPlace> given = values ? values->find(member.name.c_str()) : std::nullopt;
      if (member.is_address || (given && is_address(*given))) {
        put_addresses(member, given, where, words);
        continue;
      }
      if (given && !given->json().is_string()) {
        put_numbers(member, *given, words);
        continue;
      }
      const std::string value = given ? given->text() : value_of_member(member.name, values_);
      const auto known = values_.find(value);
      if (known == values_.end() && given) {
        std::vector<std::string> names;
        for (const auto& each : values_) names.push_back(each.first);
        given->fail(fmt::format("is '{}', which is no known value{}", value,
                                did_you_mean(value, names, fmt::format("known are {}", fmt::join(names, ", ")))));
      }
      if (known == values_.end()) {
        without.push_back(member.name);
        continue;
      }
      put_value(member, known->second, where, words);
    }
    if (without.empty()) return;
    throw InputError(fmt::format("{}: {}: {} '{}' {} no value: give {}, known or in numbers, in {}", set_.folder(),
                                 name, without.size() == 1 ? "member" : "members", fmt::join(without, "', '"),
                                 without.size() == 1 ? "has" : "have", without.size() == 1 ? "it one" : "them some",
                                 file_.path()));
  }

  /// Whether it is an address, or a list that begins with one.
  static bool is_address(const JsonPlace& given) {
    if (given.json().is_array() && given.size() > 0) return is_address(given.at(size_t{0}));
    return given.json().is_object();
  }
  /// One for each element, of two words. A uvec2 takes one too.
  void put_addresses(const shader::Member& member, const std::optional<JsonPlace>& given, const std::string& where,
                     std::vector<shader::Word>& words) {
    if (!given) {
      throw InputError(fmt::format("{} is the address of a buffer: say in {} what it holds, as {{\"address\": ...}}",
                                   where, file_.path()));
    }
    const bool is_pair = !member.is_float && member.rows == 2 && member.columns == 1;
    if (!member.is_address && !is_pair) {
      given->fail(
          fmt::format("is an address, and member '{}' has no room for one: declare it as a uint64_t, a "
                      "buffer_reference or a uvec2",
                      member.name));
    }
    const uint32_t rows = member.is_address ? member.rows : 1;
    const std::vector<JsonPlace> list = leaves_of(*given);
    if (list.size() != size_t{member.elements} * rows) {
      given->fail(fmt::format("has {} address{}, and member '{}' has room for {}: give as many", list.size(),
                              list.size() == 1 ? "" : "es", member.name, member.elements * rows));
    }
    for (uint32_t i = 0; i < list.size(); ++i) {
      const size_t place = (member.offset + i / rows * member.element_stride + i % rows * member.row_stride) / 4;
      words.resize(std::max(words.size(), place + 2));
      words[place] = {address_of(list[i]), std::nullopt};
      words[place + 1] = {0, std::nullopt};
    }
  }
  /// {"address": what a buffer may hold}; the same buffer for the same words.
  uint32_t address_of(const JsonPlace& given) {
    given.refuse_unknown({"address"});
    const JsonPlace holds = given.at("address");
    const std::string text = holds.json().dump();
    const auto known = addresses_.find(text);
    if (known != addresses_.end()) return known->second;
    return addresses_[text] = described(holds).address;
  }

  // Buffers.

  void add_buffer(const shader::Binding& binding) {
    const std::optional<JsonPlace> entry = file_.binding(binding.place);
    const std::optional<JsonPlace> holds = entry ? entry->find("holds") : std::nullopt;
    if (entry && !holds)
      entry->fail(
          fmt::format("is for {}, which the shaders declare as a buffer: say what it 'holds'", name_of(binding)));
    const shader::Buffer buffer = holds ? described(*holds) : known(binding);
    if (buffer.bytes < binding.bytes) {
      fail(fmt::format("{} has {} bytes, and the shaders declare {}: declare it smaller, or give it more in {}",
                       name_of(binding), buffer.bytes, binding.bytes, file_.path()));
    }
    resources_.buffers[binding.place] = buffer;
  }
  shader::Buffer known(const shader::Binding& binding) {
    const auto found = std::find_if(kKnownBindings.begin(), kKnownBindings.end(), [&](const KnownBinding& each) {
      return binding.name.empty() ? binding.place == shader::Place(0, each.binding)
                                  : binding.name == each.variable || binding.name == each.block;
    });
    if (found == kKnownBindings.end()) {
      fail(fmt::format("{} is a buffer that raypool.glsl does not declare: say in {} what it holds", name_of(binding),
                       file_.path()));
    }
    return of_kind(found->holds);
  }
  shader::Buffer of_kind(const std::string& kind) { return kind == "materials" ? materials_ : place(contents(kind)); }
  shader::Buffer described(const JsonPlace& holds) {
    if (holds.json().is_string()) {
      std::vector<std::string> kinds = {"triangle_materials"};
      for (const KnownBinding& each : kKnownBindings) kinds.emplace_back(each.holds);
      const std::string kind = holds.text();
      if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end()) {
        holds.fail(fmt::format("is '{}', which is no buffer{}", kind,
                               did_you_mean(kind, kinds, fmt::format("buffers are {}", fmt::join(kinds, ", ")))));
      }
      return of_kind(kind);
    }
    const std::vector<std::string> keys = {"interleaved", "materials", "words", "floats", "integers"};
    holds.refuse_unknown({"interleaved", "materials", "words", "floats", "integers", "pad_to"});
    std::vector<std::string> given;
    for (const std::string& key : keys)
      if (holds.find(key.c_str())) given.push_back(key);
    if (given.size() != 1) holds.fail(fmt::format("must have one of '{}'", fmt::join(keys, "', '")));
    const JsonPlace list = holds.at(given[0].c_str());
    if (given[0] == "interleaved") {
      // Numbers among them are floats, however they are written.
      return place(elements(list, holds.find("pad_to"), surfaces_.positions.size(), vertex_fields(), "a vertex", true));
    }
    if (given[0] == "materials") {
      return place(
          elements(list, holds.find("pad_to"), surfaces_.materials.size(), material_fields(), "a material", false));
    }
    Words words;
    for (size_t i = 0; i < list.size(); ++i) {
      if (given[0] == "words")
        append_given(list.at(i), words);
      else
        words.push_back(bits_of(list.at(i), given[0] == "floats"));
    }
    if (words.empty()) list.fail("is empty; give at least one number");
    return place(words);
  }
  /// A number written with a point or an exponent is a float, others are integers; an address has two words.
  void append_given(const JsonPlace& given, Words& words) {
    if (given.json().is_object()) {
      words.push_back(address_of(given));
      words.push_back(0);
      return;
    }
    words.push_back(bits_of(given, given.json().is_number_float()));
  }

  /// What a vertex or a material has, by name: adds its words to others.
  using Fields = std::map<std::string, std::function<void(size_t, Words&)>>;
  Fields vertex_fields() const {
    return {{"position", [this](size_t i, Words& words) { append_words(words, surfaces_.positions[i]); }},
            {"normal", [this](size_t i, Words& words) { append_words(words, surfaces_.normals[i]); }},
            {"texcoord", [this](size_t i, Words& words) { append_words(words, texcoord(i)); }},
            {"color", [this](size_t i, Words& words) { append_words(words, color(i)); }}};
  }
  Fields material_fields() const {
    const auto field = [this](const auto& of) {
      return [this, of](size_t i, Words& words) { append_words(words, of(surfaces_.materials[i])); };
    };
    const auto texture = [&](std::optional<uint32_t> SurfaceMaterial::*member) {
      return field([member](const SurfaceMaterial& m) { return texture_number(m.*member); });
    };
    using Of = const SurfaceMaterial&;
    return {{"base_color", field([](Of m) { return m.base_color; })},
            {"diffuse", field([](Of m) { return rgb(m.base_color) * (1 - m.metallic); })},
            {"specular", field([](Of m) { return reflectance(m); })},
            {"emission", field([](Of m) { return m.emission; })},
            {"metallic", field([](Of m) { return m.metallic; })},
            {"roughness", field([](Of m) { return m.roughness; })},
            {"shininess", field([](Of m) { return shininess(m.roughness); })},
            {"transmission", field([](Of m) { return m.transmission; })},
            {"ior", field([](Of m) { return m.ior; })},
            {"alpha", field([](Of m) { return m.base_color[3]; })},
            {"alpha_cutoff", field([](Of m) { return m.alpha_cutoff; })},
            {"alpha_mode", field([](Of m) { return static_cast<uint32_t>(m.alpha_mode); })},
            {"illum", field([](Of m) { return illum(m); })},
            {"base_color_texture", texture(&SurfaceMaterial::base_color_texture)},
            {"emission_texture", texture(&SurfaceMaterial::emission_texture)},
            {"metallic_roughness_texture", texture(&SurfaceMaterial::metallic_roughness_texture)}};
  }
  static Vec3 rgb(const Rgba& color) { return {color[0], color[1], color[2]}; }
  /// The share of light that is mirrored where it comes straight at the surface, for each colour: of metals their base
  /// colour, of all else 0.04.
  static Vec3 reflectance(const SurfaceMaterial& m) {
    const float of_plastic = 0.04f * (1 - m.metallic);
    return rgb(m.base_color) * m.metallic + Vec3{of_plastic, of_plastic, of_plastic};
  }
  /// Of MTL, which its roughness was made of (docs/use/scenes.md).
  static float shininess(float roughness) {
    constexpr float kMost = 10000;
    const float squared = roughness * roughness;
    return std::clamp(2 / std::max(squared * squared, 1e-6f) - 2, 0.0f, kMost);
  }
  /// Of MTL: 3, a mirror; 4, transparent; 2.
  static uint32_t illum(const SurfaceMaterial& m) {
    if (m.metallic >= 0.5f && m.roughness < 0.1f) return 3;
    return m.alpha_mode == AlphaMode::Blend || m.transmission >= 0.5f ? 4 : 2;
  }

  /// One after the other, each with these fields and numbers.
  Words elements(const JsonPlace& list, const std::optional<JsonPlace>& pad_to, size_t count, const Fields& fields,
                 const char* what, bool numbers_are_floats) {
    struct Part {
      const std::function<void(size_t, Words&)>* field = nullptr;  // null: the same in all
      Words words;
    };
    std::vector<std::string> names;
    for (const auto& each : fields) names.push_back(each.first);
    std::vector<Part> parts;
    for (size_t i = 0; i < list.size(); ++i) {
      const JsonPlace part = list.at(i);
      parts.emplace_back();
      if (numbers_are_floats && part.json().is_number()) {
        parts.back().words.push_back(bits_of(part, true));
        continue;
      }
      if (!part.json().is_string()) {
        append_given(part, parts.back().words);
        continue;
      }
      const auto field = fields.find(part.text());
      if (field == fields.end()) {
        const std::string all = fmt::format("{} has {}", what, fmt::join(names, ", "));
        part.fail(
            fmt::format("is '{}', which is nothing of {}{}", part.text(), what, did_you_mean(part.text(), names, all)));
      }
      parts.back().field = &field->second;
    }
    if (parts.empty()) list.fail(fmt::format("is empty; name at least one of {}", fmt::join(names, ", ")));
    Words words;
    size_t stride = 0;
    for (size_t n = 0; n < count; ++n) {
      for (const Part& part : parts) {
        if (part.field != nullptr)
          (*part.field)(n, words);
        else
          words.insert(words.end(), part.words.begin(), part.words.end());
      }
      if (n == 0) stride = padded(words.size(), pad_to);
      words.resize((n + 1) * stride);
    }
    return words;
  }
  static size_t padded(size_t size, const std::optional<JsonPlace>& pad_to) {
    if (!pad_to) return size;
    constexpr uint64_t kMostBytes = 65536;
    const size_t bytes = pad_to->whole(4, kMostBytes);
    if (bytes % 4 != 0 || bytes < 4 * size)
      pad_to->fail(
          fmt::format("is {}; it must be a multiple of 4 and at least the {} bytes of an element", bytes, 4 * size));
    return bytes / 4;
  }

  Texcoord texcoord(size_t vertex) const {
    return surfaces_.texcoords.empty() ? Texcoord{0, 0} : surfaces_.texcoords[vertex];
  }
  Rgba color(size_t vertex) const { return surfaces_.colors.empty() ? Rgba{1, 1, 1, 1} : surfaces_.colors[vertex]; }
  Words contents(const std::string& kind) const {
    if (kind == "indices") return words_of(surfaces_.triangles);
    if (kind == "positions") return words_of(surfaces_.positions);
    if (kind == "normals") return words_of(surfaces_.normals);
    if (kind == "lights") return words_of(lights_.lights);
    if (kind == "triangle_materials") return scene_.triangle_materials;
    Words words;
    if (kind == "materials") {
      for (const SurfaceMaterial& material : surfaces_.materials) append_words(words, shader_material(material));
    }
    for (size_t vertex = 0; vertex < surfaces_.positions.size(); ++vertex) {
      if (kind == "texcoords") append_words(words, texcoord(vertex));
      if (kind == "colors") append_words(words, color(vertex));
    }
    return words;
  }
  /// As shaders count textures. Texture 0 is white: those of the surfaces begin at 1.
  static uint32_t texture_number(const std::optional<uint32_t>& of_surfaces) {
    return of_surfaces ? *of_surfaces + 1 : 0;
  }
  static ShaderMaterial shader_material(const SurfaceMaterial& material) {
    return {material.base_color,
            material.emission,
            material.metallic,
            material.roughness,
            material.transmission,
            material.ior,
            material.alpha_cutoff,
            static_cast<uint32_t>(material.alpha_mode),
            texture_number(material.base_color_texture),
            texture_number(material.emission_texture),
            texture_number(material.metallic_roughness_texture)};
  }

  // Textures.

  void add_textures(const shader::Binding& binding) {
    const std::optional<JsonPlace> entry = file_.binding(binding.place);
    const std::optional<JsonPlace> holds = entry ? entry->find("holds") : std::nullopt;
    if (entry && !holds)
      entry->fail(
          fmt::format("is for {}, which the shaders declare as textures: say what it 'holds'", name_of(binding)));
    resources_.textures[binding.place] =
        holds && !(holds->json().is_string() && holds->text() == "textures") ? own_textures(*holds) : scene_textures();
  }
  const shader::Textures& scene_textures() {
    if (!textures_) {
      const SurfaceImage white = {1, 1, Words16(4, 65535)};
      Words records = record(place_texels(white), white, {});
      std::vector<uint32_t> addresses;
      for (const SurfaceImage& image : surfaces_.images) addresses.push_back(place_texels(image));
      for (const SurfaceTexture& texture : surfaces_.textures) {
        const Words one = record(addresses[texture.image], surfaces_.images[texture.image], texture);
        records.insert(records.end(), one.begin(), one.end());
      }
      textures_ = place_records(records);
    }
    return *textures_;
  }
  /// Images in the folder of the set.
  shader::Textures own_textures(const JsonPlace& holds) {
    if (!holds.json().is_object()) holds.fail(R"(must be "textures", or images: {"images": ["wood.png"]})");
    holds.refuse_unknown({"images", "srgb"});
    const JsonPlace images = holds.at("images");
    const std::optional<JsonPlace> given = holds.find("srgb");
    const bool srgb = !given || given->flag();
    Words records;
    for (size_t i = 0; i < images.size(); ++i) {
      const std::filesystem::path name = images.at(i).text();
      if (name.empty() || name.is_absolute() || std::find(name.begin(), name.end(), "..") != name.end())
        images.at(i).fail("must be a file in the folder of this one, or below it");
      const std::string path = (std::filesystem::path(set_.folder()) / name).string();
      std::string reason;
      const std::optional<SurfaceImage> image = decode_image(read_file(path, "image"), srgb, reason);
      if (!image) throw InputError(fmt::format("{}: {}; export it again", path, reason));
      const Words one = record(place_texels(*image), *image, {});
      records.insert(records.end(), one.begin(), one.end());
    }
    if (records.empty()) images.fail("is empty; name at least one image");
    return place_records(records);
  }
  using Words16 = std::vector<uint16_t>;
  uint32_t place_texels(const SurfaceImage& image) {
    const uint32_t address = reserve(2 * uint64_t{image.texels.size()}, 64);
    for (uint32_t i = 0; i < image.texels.size(); i += 2) {
      image_.memory.store(address + 2 * i, image.texels[i] | static_cast<uint32_t>(image.texels[i + 1]) << 16);
    }
    return address;
  }
  static Words record(uint32_t address, const SurfaceImage& image, const SurfaceTexture& texture) {
    return {address, image.width, image.height,
            static_cast<uint32_t>(texture.wrap_s) * shader::kTextureWrapS |
                static_cast<uint32_t>(texture.wrap_t) << shader::kTextureWrapTShift |
                (texture.nearest ? shader::kTextureNearest : 0)};
  }
  shader::Textures place_records(const Words& records) {
    return {place(records, 32).address, static_cast<uint32_t>(4 * records.size() / shader::kTextureBytes)};
  }

  MemoryImage& image_;
  const Scene& scene_;
  const Surfaces& surfaces_;
  const shader::ShaderSet& set_;
  const ShaderFrame& frame_;
  const ShaderFile file_;
  const float diagonal_;
  const ShaderLights lights_;
  const ShaderValues values_;
  uint64_t end_;  // of what is reserved
  shader::Buffer materials_;
  std::optional<shader::Textures> textures_;   // of the scene, once they are needed
  std::map<std::string, uint32_t> addresses_;  // of buffers that others name, by what they hold
  shader::Resources resources_;
};

}  // namespace

shader::Resources build_shader_memory(MemoryImage& image, const Scene& scene, const shader::ShaderSet& set,
                                      const ShaderFrame& frame) {
  std::optional<Surfaces> flat;
  if (!scene.surfaces) flat = surfaces_of(scene);
  return ShaderMemory(image, scene, flat ? *flat : *scene.surfaces, set, frame).build();
}

}  // namespace raypool
