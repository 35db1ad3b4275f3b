// shaders.json in the folder of a shader set: what its bindings hold where they are not those of raypool.glsl.
// schemas/shaders.json is its JSON Schema.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "scene/json_place.hpp"
#include "shader/resources.hpp"

namespace raypool {

class ShaderFile {
 public:
  /// Of this folder; one without the file says nothing. Throws InputError naming file and place.
  explicit ShaderFile(const std::string& folder);
  ShaderFile(const ShaderFile&) = delete;
  ShaderFile& operator=(const ShaderFile&) = delete;

  const std::string& path() const { return path_; }
  /// The entry of a binding, with "holds" or "values"; none: there is none.
  std::optional<JsonPlace> binding(const shader::Place& place) const;
  /// The value of a member: of the binding, or of push constants where there is no place.
  std::optional<JsonPlace> value(const std::optional<shader::Place>& place, const std::string& member) const;
  /// Specialization constants, by constant_id: their bits.
  std::map<uint32_t, uint32_t> specialization() const;

 private:
  std::string path_;
  JsonPlace::Json json_;
  std::map<shader::Place, size_t> numbers_;  // in "bindings"
};

}  // namespace raypool
