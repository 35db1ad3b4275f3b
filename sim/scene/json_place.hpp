// A value of a JSON document that knows where it stands, so that what is wrong with it can be reported in one sentence.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace raypool {

/// Everything throws InputError that begins with the file and the value's place in it: "a.gltf: accessors[3].count".
/// The document must outlive its places.
class JsonPlace {
 public:
  using Json = nlohmann::ordered_json;
  JsonPlace(const Json& document, const std::string& file) : json_(&document), where_(file + ":") {}

  /// Of an object.
  std::optional<JsonPlace> find(const char* key) const;
  JsonPlace at(const char* key) const;
  size_t members() const;
  /// Refuses members other than these.
  void refuse_unknown(const std::vector<std::string>& known) const;
  /// Of an array.
  size_t size() const;
  JsonPlace at(size_t index) const;
  /// An index into the array `key` of the document `root`, as the value that it names.
  JsonPlace in(const JsonPlace& root, const char* key) const;

  uint64_t whole(uint64_t least, uint64_t largest) const;
  double number(double least, double largest) const;
  bool flag() const;
  /// Control characters, which would spoil a line of output, become blanks.
  std::string text() const;

  const std::string& where() const { return where_; }
  const Json& json() const { return *json_; }
  [[noreturn]] void fail(const std::string& message) const;

 private:
  JsonPlace(const Json* json, std::string where) : json_(json), where_(std::move(where)) {}
  [[noreturn]] void refuse(const std::string& wanted) const;

  const Json* json_;
  std::string where_;
};

}  // namespace raypool
