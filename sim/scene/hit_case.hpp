// A ray and a few triangles, as a line of a corpus of cases (docs/use/referee.md), and an implementation's hit of the
// ray, as a line of answers: JSON, every float in hexadecimal digits, so that none is rounded.
#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "scene/hits_check.hpp"
#include "scene/prepared_ray.hpp"
#include "scene/scene.hpp"

namespace raypool {

struct HitCase {
  uint64_t number = 0;
  std::string kind;  ///< what is hard about it
  RayQuery ray;
  std::vector<std::array<Vec3, 3>> triangles;
};

/// 0x1.8p+1, -inf, nan: what std::strtof and Python's float.fromhex read.
std::string hex_text(float x);

/// The keys of the case itself, to which a certificate may be added.
nlohmann::ordered_json to_json(const HitCase& hit_case);
/// Keys that it does not know are left alone. Throws InputError, which begins with `where`: the line is no case, or a
/// corner is not finite.
HitCase parse_hit_case(const std::string& line, const std::string& where);

/// An answer to the case of a number.
struct NumberedAnswer {
  uint64_t number = 0;
  HitAnswer answer;
};
std::string to_line(const NumberedAnswer& answer);
/// Throws InputError, which begins with `where`.
NumberedAnswer parse_answer(const std::string& line, const std::string& where);

}  // namespace raypool
