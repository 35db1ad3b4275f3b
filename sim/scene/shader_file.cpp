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
  root.refuse_unknown({"$schema", "bindings", "push_constants", "specialization", "ray_generation", "miss",
                       "hit_groups", "callable", "geometries"});
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
  table();
  geometries_are_materials();
}

std::optional<JsonPlace> ShaderFile::binding(const shader::Place& place) const {
  const auto found = numbers_.find(place);
  if (found == numbers_.end()) return std::nullopt;
  return JsonPlace(json_, path_).at("bindings").at(found->second);
}

bool ShaderFile::holds_nothing(const shader::Place& place) const {
  const std::optional<JsonPlace> entry = binding(place);
  const std::optional<JsonPlace> holds = entry ? entry->find("holds") : std::nullopt;
  return holds && holds->json() == "nothing";
}

std::optional<JsonPlace> ShaderFile::values(const shader::Place& place) const {
  const std::optional<JsonPlace> entry = binding(place);
  return entry ? entry->find("values") : std::nullopt;
}

std::optional<JsonPlace> ShaderFile::push_constants() const { return JsonPlace(json_, path_).find("push_constants"); }

std::optional<JsonPlace> ShaderFile::record(const shader::RecordPlace& place) const {
  static const std::map<shader::RecordStage, const char*> kKeys = {{shader::RecordStage::Miss, "miss"},
                                                                   {shader::RecordStage::HitGroup, "hit_groups"},
                                                                   {shader::RecordStage::Callable, "callable"}};
  const JsonPlace root(json_, path_);
  std::optional<JsonPlace> entry;
  if (place.first == shader::RecordStage::RayGeneration) {
    entry = root.find("ray_generation");
  } else if (const std::optional<JsonPlace> list = root.find(kKeys.at(place.first));
             list && place.second < list->size()) {
    entry = list->at(place.second);
  }
  return entry && entry->json().is_object() ? entry->find("record") : std::nullopt;
}

shader::ShaderTable ShaderFile::table() const {
  const JsonPlace root(json_, path_);
  const auto record = [](const JsonPlace& entry) {
    if (const std::optional<JsonPlace> values = entry.find("record")) values->members();
  };
  // "a.rmiss", or {"shader": "a.rmiss", "record": {...}}
  const auto shader_of = [&](const JsonPlace& entry) {
    if (!entry.json().is_object()) return entry.text();
    entry.refuse_unknown({"shader", "record"});
    record(entry);
    return entry.at("shader").text();
  };
  const auto names = [&](const char* key) {
    std::vector<std::string> all;
    if (const std::optional<JsonPlace> list = root.find(key))
      for (size_t i = 0; i < list->size(); ++i) all.push_back(shader_of(list->at(i)));
    return all;
  };
  shader::ShaderTable table;
  if (const std::optional<JsonPlace> entry = root.find("ray_generation")) table.ray_generation = shader_of(*entry);
  table.misses = names("miss");
  table.callables = names("callable");
  const std::optional<JsonPlace> groups = root.find("hit_groups");
  for (size_t i = 0; groups && i < groups->size(); ++i) {
    const JsonPlace group = groups->at(i);
    group.refuse_unknown({"closest_hit", "any_hit", "record"});
    record(group);
    const std::optional<JsonPlace> closest_hit = group.find("closest_hit"), any_hit = group.find("any_hit");
    table.hit_groups.push_back({closest_hit ? closest_hit->text() : "", any_hit ? any_hit->text() : ""});
  }
  for (const auto& [place, number] : numbers_)
    if (holds_nothing(place)) table.unseen.insert(place);
  return table;
}

bool ShaderFile::geometries_are_materials() const {
  const std::optional<JsonPlace> geometries = JsonPlace(json_, path_).find("geometries");
  if (geometries && geometries->text() != "materials")
    geometries->fail("must be \"materials\", or left out: then all triangles are of geometry 0");
  return geometries.has_value();
}

std::shared_ptr<const shader::ShaderSet> load_shaders(const std::string& folder) {
  const std::string found = shader::ShaderSet::find(folder);
  return shader::ShaderSet::load(found, ShaderFile(found).table());
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
