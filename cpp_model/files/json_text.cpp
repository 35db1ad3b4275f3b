#include "files/json_text.hpp"

#include <fmt/format.h>

#include <set>
#include <vector>

#include "isa/input_error.hpp"

namespace raypool {

using Json = nlohmann::ordered_json;

std::string json_reason(const std::exception& error) {
  const std::string text = error.what();
  const size_t tag = text.compare(0, 6, "[json.") == 0 ? text.find("] ") : std::string::npos;
  return tag == std::string::npos ? text : text.substr(tag + 2);
}

Json parse_json(const std::string& text, const std::string& where) {
  std::vector<std::set<std::string>> keys;  // of the objects that are open
  const auto look = [&](int, Json::parse_event_t event, const Json& value) {
    if (event == Json::parse_event_t::object_start) keys.emplace_back();
    if (event == Json::parse_event_t::object_end) keys.pop_back();
    if (event == Json::parse_event_t::key && !keys.back().insert(value.get<std::string>()).second)
      throw InputError(fmt::format("{}: the key {} stands twice in one object: keep one of them", where, value.dump()));
    return true;
  };
  try {
    return Json::parse(text, look);
  } catch (const Json::exception& error) {
    throw InputError(fmt::format("{}: not valid JSON: {}", where, json_reason(error)));
  }
}

std::string to_text(const Json& json, int indent) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace raypool
