#include "scene/shader_values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "bits.hpp"
#include "isa/did_you_mean.hpp"
#include "isa/input_error.hpp"

namespace raypool {
namespace {

using Matrix = std::array<double, 16>;  // column by column

ShaderValue vector_value(const Vec3d& v, std::optional<double> fourth = std::nullopt) {
  return {3, 1, true, {v.x, v.y, v.z}, std::nullopt, fourth};
}
ShaderValue float_value(double value) { return {1, 1, true, {value}, std::nullopt, std::nullopt}; }
ShaderValue whole_value(uint32_t value) {
  return {1, 1, false, {static_cast<double>(value)}, std::nullopt, std::nullopt};
}
ShaderValue matrix_value(const Matrix& m) { return {4, 4, true, {m.begin(), m.end()}, std::nullopt, std::nullopt}; }

Matrix multiply(const Matrix& a, const Matrix& b) {
  Matrix result{};
  for (size_t column = 0; column < 4; ++column) {
    for (size_t row = 0; row < 4; ++row) {
      for (size_t k = 0; k < 4; ++k) result[4 * column + row] += a[4 * k + row] * b[4 * column + k];
    }
  }
  return result;
}

/// The camera as matrices. In clip space y points downwards and depth is 0 .. 1, as Vulkan has them; the camera looks
/// along -z.
struct CameraMatrices {
  Matrix view, inverse_view, projection, inverse_projection;
};
CameraMatrices camera_matrices(const ShaderFrame& frame, double far) {
  const auto get = [&](size_t first) {
    return Vec3d{frame.camera[first], frame.camera[first + 1], frame.camera[first + 2]};
  };
  const Vec3d eye = get(argument::kEye), step_x = get(argument::kStepX), step_y = get(argument::kStepY);
  const Vec3d right = normalized(step_x), up = normalized(step_y) * -1.0, back = cross(right, up);
  // The centre of the picture is at distance 1.
  const double half_width = length(step_x) * frame.width / 2, half_height = length(step_y) * frame.height / 2;
  constexpr double kNear = 1e-5;  // of the far plane's distance
  const double a = 1 / (kNear - 1), b = kNear * far / (kNear - 1);
  const auto moved = [&](const Vec3d& axis) { return -dot(axis, eye); };
  return {{right.x, up.x, back.x, 0, right.y, up.y, back.y, 0, right.z, up.z, back.z, 0, moved(right), moved(up),
           moved(back), 1},
          {right.x, right.y, right.z, 0, up.x, up.y, up.z, 0, back.x, back.y, back.z, 0, eye.x, eye.y, eye.z, 1},
          {1 / half_width, 0, 0, 0, 0, -1 / half_height, 0, 0, 0, 0, a, -1, 0, 0, b, 0},
          {half_width, 0, 0, 0, 0, -half_height, 0, 0, 0, 0, 0, 1 / b, 0, 0, -1, a / b}};
}

/// Around all triangles of which light may pass parts; the radius is 0 if there are none.
struct Sphere {
  Vec3d center;
  double radius = 0;
};
Sphere around_alpha(const Scene& scene, const Surfaces& surfaces) {
  std::vector<Vec3d> corners;
  for (uint32_t i = 0; i < scene.triangles.size(); ++i) {
    if (surfaces.materials[scene.triangle_materials[i]].alpha_mode == AlphaMode::Opaque) continue;
    for (int k = 0; k < 3; ++k) corners.push_back(scene.corner(i, k).as<double>());
  }
  if (corners.empty()) return {};
  Vec3d low = corners[0], high = corners[0];
  for (const Vec3d& corner : corners) {
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], corner[axis]);
      high[axis] = std::max(high[axis], corner[axis]);
    }
  }
  Sphere sphere{(low + high) * 0.5, 0};
  for (const Vec3d& corner : corners) sphere.radius = std::max(sphere.radius, length(corner - sphere.center));
  constexpr double kRoundings = 1 + 1e-4;  // of what shaders compute with it
  sphere.radius *= kRoundings;
  return sphere;
}

std::string plain(const std::string& name) {
  std::string text;
  for (const char c : name) {
    if (c != '_') text += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return text;
}

void put_word(const shader::Member& member, uint32_t element, uint32_t column, uint32_t row, const shader::Word& word,
              std::vector<shader::Word>& words) {
  const size_t place =
      (member.offset + element * member.element_stride + column * member.column_stride + row * member.row_stride) / 4;
  if (place >= words.size()) words.resize(place + 1);
  words[place] = word;
}

std::string shape_of(uint32_t rows, uint32_t columns, uint32_t elements) {
  std::string text = columns > 1 ? fmt::format("a matrix of {} columns and {} rows", columns, rows)
                     : rows > 1  ? fmt::format("{} numbers", rows)
                                 : "one number";
  if (elements > 1) text = fmt::format("an array of {}, each {}", elements, text);
  return text;
}

}  // namespace

ShaderValues shader_values(const Scene& scene, const Surfaces& surfaces, const ShaderLights& lights,
                           const ShaderFrame& frame, float diagonal) {
  const auto get = [&](size_t first) {
    return Vec3d{frame.camera[first], frame.camera[first + 1], frame.camera[first + 2]};
  };
  const double far = diagonal > 0 ? 2 * static_cast<double>(diagonal) : 1;
  ShaderValue sample = whole_value(0);
  sample.argument = kSampleArgument;
  const CameraMatrices matrices = camera_matrices(frame, far);
  const Sphere alpha = around_alpha(scene, surfaces);
  return {{"eye", vector_value(get(argument::kEye), 1)},
          {"corner", vector_value(get(argument::kCorner), 0)},
          {"step_x", vector_value(get(argument::kStepX), 0)},
          {"step_y", vector_value(get(argument::kStepY), 0)},
          {"light_position", vector_value(get(argument::kLight), 1)},
          {"light_color", vector_value(get(argument::kLightColor), 1)},
          {"background", vector_value(surfaces.background.as<double>(), 1)},
          {"offset", float_value(static_cast<double>(frame.offset))},
          {"width", whole_value(frame.width)},
          {"height", whole_value(frame.height)},
          {"sample", sample},
          {"samples", whole_value(frame.samples)},
          {"depth", whole_value(frame.depth)},
          {"triangles", whole_value(size32(scene.triangles))},
          {"lights", whole_value(size32(lights.lights))},
          {"total_weight", float_value(static_cast<double>(lights.total_weight))},
          {"far", float_value(far)},
          {"alpha_center", vector_value(alpha.center, 1)},
          {"alpha_radius", float_value(alpha.radius)},
          {"view", matrix_value(matrices.view)},
          {"projection", matrix_value(matrices.projection)},
          {"inverse_view", matrix_value(matrices.inverse_view)},
          {"inverse_projection", matrix_value(matrices.inverse_projection)},
          {"view_projection", matrix_value(multiply(matrices.projection, matrices.view))}};
}

std::string value_of_member(const std::string& member, const ShaderValues& values) {
  static const std::map<std::string, std::string> kOthers = {{"samplenumber", "sample"},
                                                             {"viewinverse", "inverse_view"},
                                                             {"proj", "projection"},
                                                             {"projinverse", "inverse_projection"},
                                                             {"projectioninverse", "inverse_projection"},
                                                             {"inverseproj", "inverse_projection"},
                                                             {"viewproj", "view_projection"}};
  // Of a struct inside of a block, its own name.
  const std::string name = plain(member.substr(member.rfind('.') + 1));
  const auto other = kOthers.find(name);
  if (other != kOthers.end()) return other->second;
  const auto found =
      std::find_if(values.begin(), values.end(), [&](const auto& value) { return plain(value.first) == name; });
  return found == values.end() ? "" : found->first;
}

void put_value(const shader::Member& member, const ShaderValue& value, const std::string& where,
               std::vector<shader::Word>& words) {
  const bool longer = member.rows == 4 && value.rows == 3 && value.columns == 1 && value.fourth;
  if (member.elements != 1 || member.columns != value.columns || (member.rows != value.rows && !longer)) {
    throw InputError(fmt::format("{} is {}, and the value of this name is {}; declare it so, or give it other numbers",
                                 where, shape_of(member.rows, member.columns, member.elements),
                                 shape_of(value.rows, value.columns, 1)));
  }
  if (value.is_float ? !member.is_float : member.is_float && value.argument) {
    throw InputError(fmt::format("{} is of {}, and the value of this name of {}; declare it so", where,
                                 member.is_float ? "floats" : "integers", value.is_float ? "floats" : "integers"));
  }
  for (uint32_t column = 0; column < member.columns; ++column) {
    for (uint32_t row = 0; row < member.rows; ++row) {
      shader::Word word;
      const double number = row < value.rows ? value.numbers[column * value.rows + row] : *value.fourth;
      word.bits = member.is_float ? as_bits(static_cast<float>(number)) : static_cast<uint32_t>(number);
      word.argument = value.argument;
      put_word(member, 0, column, row, word, words);
    }
  }
}

uint32_t bits_of(const JsonPlace& number, bool is_float) {
  constexpr double kLargest = 3.4028234663852886e38;
  if (is_float) return as_bits(static_cast<float>(number.number(-kLargest, kLargest)));
  if (number.json().is_boolean()) return number.flag() ? 1 : 0;
  const double value = number.number(-0x1p31, 0xffffffffp0);
  if (value != std::floor(value)) number.fail("must be a whole number: the shader declares an integer");
  return value < 0 ? static_cast<uint32_t>(static_cast<int32_t>(value)) : static_cast<uint32_t>(value);
}

std::vector<JsonPlace> leaves_of(const JsonPlace& place) {
  if (!place.json().is_array()) return {place};
  std::vector<JsonPlace> leaves;
  for (size_t i = 0; i < place.size(); ++i) {
    const std::vector<JsonPlace> its = leaves_of(place.at(i));
    leaves.insert(leaves.end(), its.begin(), its.end());
  }
  return leaves;
}

void put_numbers(const shader::Member& member, const JsonPlace& numbers, std::vector<shader::Word>& words) {
  const std::vector<JsonPlace> list = leaves_of(numbers);
  const size_t wanted = size_t{member.elements} * member.columns * member.rows;
  if (list.size() != wanted) {
    numbers.fail(fmt::format("has {} number{}; member '{}' is {}: give {}", list.size(), list.size() == 1 ? "" : "s",
                             member.name, shape_of(member.rows, member.columns, member.elements), wanted));
  }
  size_t next = 0;
  for (uint32_t element = 0; element < member.elements; ++element) {
    for (uint32_t column = 0; column < member.columns; ++column) {
      for (uint32_t row = 0; row < member.rows; ++row)
        put_word(member, element, column, row, {bits_of(list[next++], member.is_float), std::nullopt}, words);
    }
  }
}

}  // namespace raypool
