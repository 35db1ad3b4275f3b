#include "scene/shader_memory.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
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
        lights_(shader_lights(scene, surfaces, diagonal_)),
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
    put_members(std::nullopt, set_.push_constants(), "push constants", resources_.push_constants);
    resources_.specialization = file_.specialization();
    resources_.width = frame_.width;
    resources_.height = frame_.height;
    resources_.depth = frame_.depth;
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
    put_members(binding.place, binding.members, name_of(binding), words);
  }
  void put_members(const std::optional<shader::Place>& place, const std::vector<shader::Member>& members,
                   const std::string& name, std::vector<shader::Word>& words) const {
    for (const shader::Member& member : members) {
      const std::string where = fmt::format("{}: {}: member '{}'", set_.folder(), name, member.name);
      const std::optional<JsonPlace> given = file_.value(place, member.name);
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
        throw InputError(fmt::format("{} has no value: give it one, known or in numbers, in {}", where, file_.path()));
      }
      put_value(member, known->second, where, words);
    }
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
      std::vector<std::string> kinds;
      for (const KnownBinding& each : kKnownBindings) kinds.emplace_back(each.holds);
      const std::string kind = holds.text();
      if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end()) {
        holds.fail(fmt::format("is '{}', which is no buffer{}", kind,
                               did_you_mean(kind, kinds, fmt::format("buffers are {}", fmt::join(kinds, ", ")))));
      }
      return of_kind(kind);
    }
    holds.refuse_unknown({"interleaved", "pad_to", "floats", "integers"});
    const std::optional<JsonPlace> interleaved = holds.find("interleaved"), floats = holds.find("floats"),
                                   integers = holds.find("integers");
    if ((interleaved ? 1 : 0) + (floats ? 1 : 0) + (integers ? 1 : 0) != 1)
      holds.fail("must have one of 'interleaved', 'floats' and 'integers'");
    if (interleaved) return place(interleaved_words(*interleaved, holds.find("pad_to")));
    const JsonPlace& numbers = floats ? *floats : *integers;
    Words words;
    for (size_t i = 0; i < numbers.size(); ++i) words.push_back(bits_of(numbers.at(i), floats.has_value()));
    if (words.empty()) numbers.fail("is empty; give at least one number");
    return place(words);
  }
  /// Vertex after vertex: the attributes that are named, and numbers that are the same in all.
  Words interleaved_words(const JsonPlace& list, const std::optional<JsonPlace>& pad_to) const {
    struct Part {
      std::string attribute;  // empty: a number
      uint32_t bits = 0;
    };
    std::vector<Part> parts;
    for (size_t i = 0; i < list.size(); ++i) {
      const JsonPlace part = list.at(i);
      if (part.json().is_number()) {
        parts.push_back({"", bits_of(part, true)});
        continue;
      }
      const std::string name = part.text();
      const std::vector<std::string> names = {"position", "normal", "texcoord", "color"};
      if (std::find(names.begin(), names.end(), name) == names.end()) {
        part.fail(fmt::format("is '{}', which is nothing of a vertex{}", name,
                              did_you_mean(name, names, "a vertex has position, normal, texcoord and color")));
      }
      parts.push_back({name, 0});
    }
    if (parts.empty()) list.fail("is empty; name at least one of position, normal, texcoord and color");
    Words words;
    size_t stride = 0;
    for (size_t vertex = 0; vertex < surfaces_.positions.size(); ++vertex) {
      for (const Part& part : parts) {
        if (part.attribute.empty()) {
          words.push_back(part.bits);
        } else if (part.attribute == "position") {
          append_words(words, surfaces_.positions[vertex]);
        } else if (part.attribute == "normal") {
          append_words(words, surfaces_.normals[vertex]);
        } else if (part.attribute == "texcoord") {
          append_words(words, texcoord(vertex));
        } else {
          append_words(words, color(vertex));
        }
      }
      if (vertex == 0) stride = padded(words.size(), pad_to);
      words.resize((vertex + 1) * stride);
    }
    return words;
  }
  static size_t padded(size_t size, const std::optional<JsonPlace>& pad_to) {
    if (!pad_to) return size;
    constexpr uint64_t kMostBytes = 65536;
    const size_t bytes = pad_to->whole(4, kMostBytes);
    if (bytes % 4 != 0 || bytes < 4 * size)
      pad_to->fail(
          fmt::format("is {}; it must be a multiple of 4 and at least the vertex's {} bytes", bytes, 4 * size));
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
  /// Texture 0 is white: those of the surfaces begin at 1.
  static ShaderMaterial shader_material(const SurfaceMaterial& material) {
    const auto texture = [](const std::optional<uint32_t>& number) { return number ? *number + 1 : 0; };
    return {material.base_color,
            material.emission,
            material.metallic,
            material.roughness,
            material.transmission,
            material.ior,
            material.alpha_cutoff,
            static_cast<uint32_t>(material.alpha_mode),
            texture(material.base_color_texture),
            texture(material.emission_texture),
            texture(material.metallic_roughness_texture)};
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
  std::optional<shader::Textures> textures_;  // of the scene, once they are needed
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
