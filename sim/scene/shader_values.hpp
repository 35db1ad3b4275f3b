// The values of uniform blocks and push constants that raypool knows: by their names, as words of a block's layout.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "scene/json_place.hpp"
#include "scene/shader_lights.hpp"
#include "scene/shader_memory.hpp"

namespace raypool {

/// Scalars, vectors and matrices, column by column.
struct ShaderValue {
  uint32_t rows = 1, columns = 1;
  bool is_float = true;
  std::vector<double> numbers;
  std::optional<uint32_t> argument;  ///< of the kernel, that has the value instead
  std::optional<double> fourth;      ///< of three numbers where four are wanted
};

/// By name: eye, corner, step_x ... (schemas/shaders.json lists them).
using ShaderValues = std::map<std::string, ShaderValue>;
ShaderValues shader_values(const Scene& scene, const Surfaces& surfaces, const ShaderLights& lights,
                           const ShaderFrame& frame, float diagonal);

/// The name of the value that a member of this name has without being told: "viewInverse" is "inverse_view". Empty:
/// none is known.
std::string value_of_member(const std::string& member, const ShaderValues& values);

/// Puts a known value where the member has it in `words`. Throws InputError, beginning with `where`, when it has
/// another shape.
void put_value(const shader::Member& member, const ShaderValue& value, const std::string& where,
               std::vector<shader::Word>& words);
/// The same of numbers, or of lists of them, in the order of memory: elements, of these columns, of these rows.
void put_numbers(const shader::Member& member, const JsonPlace& numbers, std::vector<shader::Word>& words);

/// The elements of a list and of lists in it; of any other value, that value.
std::vector<JsonPlace> leaves_of(const JsonPlace& place);

/// A number's bits as a float, or as an integer of 32 bits.
uint32_t bits_of(const JsonPlace& number, bool is_float);

}  // namespace raypool
