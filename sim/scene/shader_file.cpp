#include "scene/shader_file.hpp"

#include <fmt/format.h>

#include <charconv>
#include <filesystem>

#include "bits.hpp"
#include "files/input_file.hpp"
#include "files/json_text.hpp"
#include "isa/input_error.hpp"
#include "scene/shader_values.hpp"

namespace raypool {
namespace {

constexpr uint64_t kLargestNumber = 0xffffffff;

}  // namespace

ShaderFile::ShaderFile(const std::string& folder)
    : path_((std::filesystem::path(folder) / "shaders.json").string()), json_(JsonPlace::Json::object()) {
  if (std::error_code none; !std::filesystem::exists(path_, none)) return;
  json_ = parse_json(read_text_file(path_, "description of shaders"), path_);
  const JsonPlace root(json_, path_);
  root.refuse_unknown({"$schema", "bindings", "push_constants", "specialization"});
  const std::optional<JsonPlace> bindings = root.find("bindings");
  for (size_t i = 0; bindings && i < bindings->size(); ++i) {
    const JsonPlace entry = bindings->at(i);
    entry.refuse_unknown({"set", "binding", "holds", "values"});
    const std::optional<JsonPlace> set = entry.find("set"), values = entry.find("values");
    const shader::Place place = {set ? static_cast<uint32_t>(set->whole(0, kLargestNumber)) : 0,
                                 static_cast<uint32_t>(entry.at("binding").whole(0, kLargestNumber))};
    if (entry.find("holds").has_value() == values.has_value())
      entry.fail("must have either 'holds' or, for a uniform block, 'values'");
    if (values) values->members();
    if (!numbers_.emplace(place, i).second)
      entry.fail(
          fmt::format("is the second one of set {}, binding {}; leave one of them out", place.first, place.second));
  }
  if (const std::optional<JsonPlace> values = root.find("push_constants")) values->members();
  specialization();
}

std::optional<JsonPlace> ShaderFile::binding(const shader::Place& place) const {
  const auto found = numbers_.find(place);
  if (found == numbers_.end()) return std::nullopt;
  return JsonPlace(json_, path_).at("bindings").at(found->second);
}

std::optional<JsonPlace> ShaderFile::value(const std::optional<shader::Place>& place, const std::string& member) const {
  const std::optional<JsonPlace> entry = place ? binding(*place) : JsonPlace(json_, path_).find("push_constants");
  const std::optional<JsonPlace> values = place && entry ? entry->find("values") : entry;
  return values ? values->find(member.c_str()) : std::nullopt;
}

std::map<uint32_t, uint32_t> ShaderFile::specialization() const {
  std::map<uint32_t, uint32_t> result;
  const std::optional<JsonPlace> constants = JsonPlace(json_, path_).find("specialization");
  if (!constants) return result;
  constants->members();
  for (const auto& item : constants->json().items()) {
    const std::string& key = item.key();
    uint32_t number = 0;
    const auto read = std::from_chars(key.data(), key.data() + key.size(), number);
    if (read.ec != std::errc() || read.ptr != key.data() + key.size())
      constants->fail(fmt::format("has the key '{}'; keys are constant_ids, such as \"0\"", key));
    const JsonPlace value = constants->at(key.c_str());
    result[number] = bits_of(value, value.json().is_number_float());
  }
  return result;
}

}  // namespace raypool
