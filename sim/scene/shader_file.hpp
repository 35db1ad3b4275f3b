// shaders.json in the folder of a shader set: what its bindings hold where they are not those of raypool.glsl.
// schemas/shaders.json is its JSON Schema.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>

#include "scene/json_place.hpp"
#include "shader/resources.hpp"
#include "shader/shader_set.hpp"

namespace raypool {

/// A folder of shaders, or the name of one in shaders/, with its shaders.json.
std::shared_ptr<const shader::ShaderSet> load_shaders(const std::string& folder);

class ShaderFile {
 public:
  /// Of this folder; one without the file says nothing. Throws InputError naming file and place.
  explicit ShaderFile(const std::string& folder);
  ShaderFile(const ShaderFile&) = delete;
  ShaderFile& operator=(const ShaderFile&) = delete;

  const std::string& path() const { return path_; }
  /// The entry of a binding, with "holds" or "values"; none: there is none.
  std::optional<JsonPlace> binding(const shader::Place& place) const;
  /// Values by member: of a binding, of the push constants, of the shader record of an entry; none: there are none.
  std::optional<JsonPlace> values(const shader::Place& place) const;
  std::optional<JsonPlace> push_constants() const;
  std::optional<JsonPlace> record(const shader::RecordPlace& place) const;
  shader::ShaderTable table() const;
  /// Nothing is kept of what is stored to this picture.
  bool holds_nothing(const shader::Place& place) const;
  /// Whether each material is a geometry of its own.
  bool geometries_are_materials() const;
  /// Specialization constants, by constant_id: their bits.
  std::map<uint32_t, uint32_t> specialization() const;

 private:
  std::string path_;
  JsonPlace::Json json_;
  std::map<shader::Place, size_t> numbers_;  // in "bindings"
};

}  // namespace raypool
