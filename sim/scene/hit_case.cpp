#include "scene/hit_case.hpp"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <nlohmann/json.hpp>

#include "files/json_text.hpp"
#include "scene/json_place.hpp"

namespace raypool {
namespace {

using Json = nlohmann::ordered_json;

constexpr uint64_t kAnyNumber = std::numeric_limits<int64_t>::max();

float float_at(const JsonPlace& place) {
  const std::string text = place.text();
  char* end = nullptr;
  const float x = std::strtof(text.c_str(), &end);
  if (text.empty() || *end != 0) place.fail("must be a float as a text, such as \"0x1.8p+1\" or \"inf\"");
  return x;
}

Vec3 vector_at(const JsonPlace& place) {
  if (place.size() != 3) place.fail("must have three floats");
  return {float_at(place.at(size_t{0})), float_at(place.at(1)), float_at(place.at(2))};
}

std::array<Vec3, 3> corners_at(const JsonPlace& place) {
  if (place.size() != 3) place.fail("must have three corners");
  std::array<Vec3, 3> corners;
  for (size_t k = 0; k < 3; ++k) {
    corners[k] = vector_at(place.at(k));
    if (!std::isfinite(corners[k].x) || !std::isfinite(corners[k].y) || !std::isfinite(corners[k].z)) {
      place.at(k).fail("must be finite");
    }
  }
  return corners;
}

Json vector_json(const Vec3& v) { return {hex_text(v.x), hex_text(v.y), hex_text(v.z)}; }

}  // namespace

std::string hex_text(float x) {
  char text[32];
  std::snprintf(text, sizeof text, "%a", static_cast<double>(x));
  return std::isnan(x) ? "nan" : text;
}

Json to_json(const HitCase& hit_case) {
  Json json;
  json["case"] = hit_case.number;
  json["kind"] = hit_case.kind;
  json["origin"] = vector_json(hit_case.ray.origin);
  json["direction"] = vector_json(hit_case.ray.direction);
  json["limit"] = hex_text(hit_case.ray.limit);
  Json& triangles = json["triangles"] = Json::array();
  for (const auto& corners : hit_case.triangles) {
    triangles.push_back({vector_json(corners[0]), vector_json(corners[1]), vector_json(corners[2])});
  }
  return json;
}

HitCase parse_hit_case(const std::string& line, const std::string& where) {
  const Json json = parse_json(line, where);
  const JsonPlace place(json, where);
  HitCase result;
  result.number = place.at("case").whole(0, kAnyNumber);
  if (const auto kind = place.find("kind")) result.kind = kind->text();
  result.ray.origin = vector_at(place.at("origin"));
  result.ray.direction = vector_at(place.at("direction"));
  result.ray.limit = float_at(place.at("limit"));
  const JsonPlace triangles = place.at("triangles");
  for (size_t i = 0; i < triangles.size(); ++i) result.triangles.push_back(corners_at(triangles.at(i)));
  return result;
}

std::string to_line(const NumberedAnswer& answer) {
  Json json;
  json["case"] = answer.number;
  json["hit"] = answer.answer.hit;
  if (answer.answer.hit) {
    json["triangle"] = answer.answer.triangle;
    json["t"] = hex_text(answer.answer.t);
  }
  return json.dump();
}

NumberedAnswer parse_answer(const std::string& line, const std::string& where) {
  const Json json = parse_json(line, where);
  const JsonPlace place(json, where);
  NumberedAnswer result;
  result.number = place.at("case").whole(0, kAnyNumber);
  result.answer.hit = place.at("hit").flag();
  if (!result.answer.hit) return result;
  result.answer.triangle = static_cast<uint32_t>(place.at("triangle").whole(0, std::numeric_limits<uint32_t>::max()));
  result.answer.t = float_at(place.at("t"));
  return result;
}

}  // namespace raypool
