#include "scene/json_place.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "files/json_text.hpp"
#include "isa/did_you_mean.hpp"
#include "isa/input_error.hpp"

namespace raypool {

void JsonPlace::fail(const std::string& message) const { throw InputError(where_ + " " + message); }

void JsonPlace::refuse(const std::string& wanted) const {
  constexpr size_t kMost = 40;
  std::string text = json_->is_structured() ? json_->type_name() : to_text(*json_, -1);
  if (text.size() > kMost) text = text.substr(0, kMost) + "...";
  fail(fmt::format("is {}; it must be {}", text, wanted));
}

std::optional<JsonPlace> JsonPlace::find(const char* key) const {
  if (!json_->is_object()) refuse("an object, {...}");
  const auto found = json_->find(key);
  if (found == json_->end()) return std::nullopt;
  return JsonPlace(&*found, where_ + (where_.back() == ':' ? " " : ".") + key);
}

JsonPlace JsonPlace::at(const char* key) const {
  const std::optional<JsonPlace> found = find(key);
  if (!found) fail(fmt::format("has no '{}', without which it means nothing", key));
  return *found;
}

size_t JsonPlace::members() const {
  if (!json_->is_object()) refuse("an object, {...}");
  return json_->size();
}

void JsonPlace::refuse_unknown(const std::vector<std::string>& known) const {
  if (!json_->is_object()) refuse("an object, {...}");
  for (const auto& item : json_->items()) {
    if (std::find(known.begin(), known.end(), item.key()) != known.end()) continue;
    const std::string advice = fmt::format("known are {}", fmt::join(known, ", "));
    fail(fmt::format("has the unknown key '{}'{}", item.key(), did_you_mean(item.key(), known, advice)));
  }
}

size_t JsonPlace::size() const {
  if (!json_->is_array()) refuse("an array, [...]");
  return json_->size();
}

JsonPlace JsonPlace::at(size_t index) const { return {&(*json_)[index], fmt::format("{}[{}]", where_, index)}; }

JsonPlace JsonPlace::in(const JsonPlace& root, const char* key) const {
  const std::optional<JsonPlace> array = root.find(key);
  if (!array || array->size() == 0) fail(fmt::format("names one of {}, of which the file has none", key));
  return array->at(whole(0, array->size() - 1));
}

uint64_t JsonPlace::whole(uint64_t least, uint64_t largest) const {
  if (json_->is_number()) {
    const auto value = json_->get<double>();
    if (value >= static_cast<double>(least) && value <= static_cast<double>(largest) && value == std::floor(value))
      return static_cast<uint64_t>(value);
  }
  refuse(fmt::format("a whole number in {} .. {}", least, largest));
}

double JsonPlace::number(double least, double largest) const {
  if (json_->is_number()) {
    const auto value = json_->get<double>();
    if (value >= least && value <= largest) return value;
  }
  refuse(fmt::format("a number in {:g} .. {:g}", least, largest));
}

bool JsonPlace::flag() const {
  if (!json_->is_boolean()) refuse("true or false");
  return json_->get<bool>();
}

std::string JsonPlace::text() const {
  if (!json_->is_string()) refuse("a text, \"...\"");
  auto text = json_->get<std::string>();
  for (char& c : text) {
    if ((c >= 0 && c < ' ') || c == '\x7f') c = ' ';
  }
  return text;
}

}  // namespace raypool
