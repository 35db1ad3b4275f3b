#include "scene/gltf_accessors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <optional>

namespace raypool {
namespace {

constexpr uint64_t kLargestBytes = uint64_t{1} << 40;
constexpr uint64_t kMostWithoutView = uint64_t{1} << 24;  // elements that take no bytes of the file

size_t component_bytes(int type) {
  return type == kByte || type == kUnsignedByte ? 1 : type == kShort || type == kUnsignedShort ? 2 : 4;
}

const char* type_of(size_t components) {
  return components == 1   ? "SCALAR"
         : components == 2 ? "VEC2"
         : components == 3 ? "VEC3"
         : components == 4 ? "VEC4"
                           : "MAT4";
}

template <typename Number>
Number number_at(const std::string& bytes, size_t index) {
  Number number;
  std::memcpy(&number, bytes.data() + index * sizeof number, sizeof number);
  return number;
}

/// Divided by the largest number of its type where it is normalized.
template <typename Number>
float float_at(const std::string& bytes, size_t index, bool normalized) {
  const double number = number_at<Number>(bytes, index);
  if (!normalized) return static_cast<float>(number);
  return static_cast<float>(std::max(number / std::numeric_limits<Number>::max(), -1.0));
}

uint32_t whole_at(const std::string& bytes, size_t index, int component) {
  return component == kUnsignedByte    ? number_at<uint8_t>(bytes, index)
         : component == kUnsignedShort ? number_at<uint16_t>(bytes, index)
                                       : number_at<uint32_t>(bytes, index);
}

uint64_t optional_bytes(const JsonPlace& place, const char* key) {
  const std::optional<JsonPlace> found = place.find(key);
  return found ? found->whole(0, kLargestBytes) : 0;
}

}  // namespace

const GltfForm kGltfPositions{
    3,
    {kFloat, kByte, kUnsignedByte, kShort, kUnsignedShort},
    "must be 5126, or 5120 to 5123 where it is quantised, and the type VEC3: it is three numbers; export it as such"};
const GltfForm kGltfNormals{
    3, {kFloat, kByte, kShort}, "must be 5126, or 5120 or 5122 where it is quantised, and the type VEC3: a direction"};
const GltfForm kGltfTexcoords{2,
                              {kFloat, kByte, kUnsignedByte, kShort, kUnsignedShort},
                              "must be 5126, or 5120 to 5123 where it is quantised, and the type VEC2: two numbers"};
const GltfForm kGltfColors{
    4, {kFloat, kUnsignedByte, kUnsignedShort}, "must be 5126, 5121 or 5123 and the type VEC3 or VEC4: a colour"};
const GltfForm kGltfOpaqueColors{
    3, {kFloat, kUnsignedByte, kUnsignedShort}, "must be 5126, 5121 or 5123 and the type VEC3 or VEC4: a colour"};
const GltfForm kGltfIndices{1,
                            {kUnsignedByte, kUnsignedShort, kUnsignedInt},
                            "must be 5121, 5123 or 5125 and the type SCALAR: indices are whole numbers"};
const GltfForm kGltfJoints{
    4, {kUnsignedByte, kUnsignedShort, kUnsignedInt}, "must be 5121, 5123 or 5125 and the type VEC4: joints' numbers"};
const GltfForm kGltfWeights{4,
                            {kFloat, kUnsignedByte, kUnsignedShort},
                            "must be 5126, 5121 or 5123 and the type VEC4: a weight for each joint"};
const GltfForm kGltfMatrices{16, {kFloat}, "must be 5126 and the type MAT4: a matrix for each joint"};
const GltfForm kGltfRotations{
    4, {kFloat, kByte, kShort}, "must be 5126, 5120 or 5122 and the type VEC4: rotations are quaternions"};

/// Of the view that `owner` names: `count` elements from its byteOffset on, without what stands between them.
std::string GltfAccessors::view_bytes(const JsonPlace& owner, uint64_t count, uint64_t size, bool may_have_gaps) {
  const JsonPlace root = file_.root(), view = owner.at("bufferView").in(root, "bufferViews");
  const JsonPlace number = view.at("buffer"), buffer = number.in(root, "buffers");
  const std::string& bytes = file_.buffer(buffer, number.whole(0, kLargestCount));
  const std::optional<JsonPlace> given = may_have_gaps ? view.find("byteStride") : std::nullopt;
  const uint64_t stride = given ? given->whole(size, 252) : size;
  const uint64_t in_view = optional_bytes(owner, "byteOffset"), offset = optional_bytes(view, "byteOffset");
  const uint64_t length = view.at("byteLength").whole(1, kLargestBytes), needed = in_view + (count - 1) * stride + size;
  if (offset + length > bytes.size()) {
    view.fail(fmt::format("goes to byte {} of a buffer of {}; export the file again", offset + length, bytes.size()));
  }
  if (needed > length) owner.fail(fmt::format("needs {} bytes of a view of {}; export the file again", needed, length));
  if (stride == size) return bytes.substr(offset + in_view, count * size);
  std::string packed;
  packed.reserve(count * size);
  for (uint64_t i = 0; i < count; ++i) packed.append(bytes, offset + in_view + i * stride, size);
  return packed;
}

/// The elements that a sparse accessor has in place of others.
void GltfAccessors::replace(const JsonPlace& sparse, uint64_t count, uint64_t size, std::string& bytes) {
  const uint64_t replaced = sparse.at("count").whole(1, count);
  const JsonPlace indices = sparse.at("indices"), type = indices.at("componentType");
  const int component = static_cast<int>(type.whole(0, 65535));
  if (std::count(kGltfIndices.types.begin(), kGltfIndices.types.end(), component) == 0)
    type.fail("must be 5121, 5123 or 5125: indices are whole numbers");
  const std::string places = view_bytes(indices, replaced, component_bytes(component), false);
  const std::string values = view_bytes(sparse.at("values"), replaced, size, false);
  for (size_t i = 0; i < replaced; ++i) {
    const uint32_t place = whole_at(places, i, component);
    if (place >= count) {
      indices.fail(fmt::format(
          "has index {}, which is out of range: the accessor has {} elements; export the file again", place, count));
    }
    bytes.replace(place * size, size, values, i * size, size);
  }
}

GltfAccessors::Elements GltfAccessors::elements(const JsonPlace& accessor, const GltfForm& form) {
  const JsonPlace type = accessor.at("componentType");
  Elements result;
  result.component = static_cast<int>(type.whole(0, 65535));
  if (std::count(form.types.begin(), form.types.end(), result.component) == 0 ||
      accessor.at("type").text() != type_of(form.components))
    type.fail(form.rule);
  if (const std::optional<JsonPlace> normalized = accessor.find("normalized")) result.normalized = normalized->flag();
  const uint64_t size = form.components * component_bytes(result.component);
  const std::optional<JsonPlace> sparse = accessor.find("sparse");
  if (accessor.find("bufferView")) {
    result.bytes = view_bytes(accessor, accessor.at("count").whole(1, kLargestCount), size, true);
  } else {
    // Zeros, of which a sparse accessor has the others.
    result.bytes.resize(accessor.at("count").whole(1, kMostWithoutView) * size);
  }
  if (sparse) replace(*sparse, result.bytes.size() / size, size, result.bytes);
  return result;
}

std::vector<float> GltfAccessors::floats(const JsonPlace& accessor, const GltfForm& form) {
  const Elements source = elements(accessor, form);
  std::vector<float> result(source.bytes.size() / component_bytes(source.component));
  if (source.component == kFloat) {
    std::memcpy(result.data(), source.bytes.data(), source.bytes.size());
    return result;
  }
  for (size_t i = 0; i < result.size(); ++i) {
    switch (source.component) {
      case kByte:
        result[i] = float_at<int8_t>(source.bytes, i, source.normalized);
        break;
      case kUnsignedByte:
        result[i] = float_at<uint8_t>(source.bytes, i, source.normalized);
        break;
      case kShort:
        result[i] = float_at<int16_t>(source.bytes, i, source.normalized);
        break;
      default:
        result[i] = float_at<uint16_t>(source.bytes, i, source.normalized);
    }
  }
  return result;
}

std::vector<uint32_t> GltfAccessors::whole_numbers(const JsonPlace& accessor, const GltfForm& form) {
  const Elements source = elements(accessor, form);
  std::vector<uint32_t> result(source.bytes.size() / component_bytes(source.component));
  for (size_t i = 0; i < result.size(); ++i) result[i] = whole_at(source.bytes, i, source.component);
  return result;
}

}  // namespace raypool
