// Writes schemas/configuration.json.
#include <fmt/format.h>

#include "config/parameter_table.hpp"
#include "config/reference.hpp"
#include "files/json_text.hpp"

namespace raypool {
namespace {

using Json = nlohmann::ordered_json;

Json schema_of(const Parameter& parameter) {
  const Range& range = parameter.range;
  Json schema = {{"description", parameter.meaning}};
  switch (range.form) {
    case Range::Form::Integer:
      schema.update({{"type", "integer"}, {"minimum", range.least}, {"maximum", range.greatest}});
      break;
    case Range::Form::PowerOfTwo:
      schema.update({{"type", "integer"}, {"enum", values_of(range)}});
      break;
    case Range::Form::Name:
      schema["enum"] = names_of(range);
      break;
    case Range::Form::OnOff:
      schema["type"] = "boolean";
      break;
    case Range::Form::Instructions:
      break;
  }
  schema["default"] = json_of(parameter, parameter.get(Configuration()));
  return schema;
}

Json object_schema(const std::string& description) {
  return {{"description", description},
          {"type", "object"},
          {"additionalProperties", false},
          {"properties", Json::object()}};
}

/// `key`: of the object; `section`: the one of the table that its rows name.
template <size_t count>
Json schema_of_section(std::string_view key, const Parameter (&rows)[count], std::string_view section) {
  std::string words(key);
  for (char& c : words)
    if (c == '_') c = ' ';
  Json schema = object_schema("of the " + words);
  for (const Parameter& parameter : rows)
    if (parameter.section == section) schema["properties"][std::string(parameter.key)] = schema_of(parameter);
  return schema;
}

Json schema_of_chip() {
  const std::vector<std::string_view> sections = chip_sections();
  const std::string_view chip = sections.front();
  Json schema = schema_of_section(chip, parameter::kOfChip, chip);
  for (const std::string_view section : sections) {
    if (section == chip) continue;
    const std::string_view key = section.substr(chip.size() + 1);
    schema["properties"][std::string(key)] = schema_of_section(key, parameter::kOfChip, section);
  }
  return schema;
}

Json alu_schema(AluType type) {
  Json schema = object_schema("an ALU type");
  if (alu_info(type).timed_by_events()) {
    schema["properties"]["count"] = {{"const", 1}};
    return schema;
  }
  for (const AluParameter& parameter : parameter::kOfAlu) {
    if (!applies(parameter, type)) continue;
    const Range range = range_of(parameter, type);  // in any mode; what a mode requires is in schema_of(DepthRule)
    Json& property = schema["properties"][std::string(parameter.key)] = {{"description", parameter.meaning}};
    if (range.form == Range::Form::Instructions)
      property.update({{"type", "array"}, {"items", {{"enum", names_of(range)}}}, {"uniqueItems", true}});
    else
      property.update({{"type", "integer"}, {"minimum", range.least}, {"maximum", range.greatest}});
  }
  return schema;
}

/// If the parameter has the value, the depth must be more.
Json schema_of(const DepthRule& rule) {
  const std::string section(rule.parameter->section), key(rule.parameter->key);
  Json schema, condition;
  condition["properties"][section]["properties"][key]["const"] = json_of(*rule.parameter, rule.value);
  if (rule.parameter->get(Configuration()) != rule.value) {  // what is left out has another value
    condition["required"] = {section};
    condition["properties"][section]["required"] = {key};
  }
  schema["if"] = condition;
  schema["then"]["properties"]["alus"]["properties"][std::string(alu_info(rule.type).name)]["properties"]["depth"]
        ["minimum"] = rule.least;
  return schema;
}

}  // namespace

std::string configuration_schema() {
  Json schema =
      object_schema("hardware that raypool builds, simulates and synthesises; what is left out has its default");
  Json& keys = schema["properties"];
  keys["$schema"] = {{"type", "string"}};
  keys["name"] = {{"description", "as reports name it (default: that of the file)"},
                  {"type", "string"},
                  {"pattern", fmt::format("^{}$", kNamePattern)}};
  for (const Parameter& parameter : parameter::kAll)
    if (parameter.section.empty()) keys[std::string(parameter.key)] = schema_of(parameter);
  keys["alus"] = object_schema("ALU types");
  for (const AluType type : kEveryAluType) keys["alus"]["properties"][std::string(kAluNames[type])] = alu_schema(type);
  for (const std::string_view section : sections())
    keys[std::string(section)] = schema_of_section(section, parameter::kAll, section);
  keys[std::string(chip_sections().front())] = schema_of_chip();

  for (const DepthRule& rule : depth_rules()) schema["allOf"].push_back(schema_of(rule));
  Json whole = {{"$schema", "http://json-schema.org/draft-07/schema#"}, {"title", "raypool configuration"}};
  whole.update(schema);
  return whole.dump(2) + "\n";
}

}  // namespace raypool
