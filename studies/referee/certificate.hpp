// What a ray hits, in rational numbers: the certificate of a case. docs/use/referee.md defines what is right, and why.
#pragma once

#include <cstdint>
#include <vector>

#include "scene/exact_rational.hpp"
#include "scene/hit_case.hpp"

namespace raypool::referee {

/// Where in a triangle a ray passes.
enum class Passing : uint8_t { Inside, Edge, Corner };
const char* name_of(Passing passing);

/// A triangle that the ray meets, its border included, between its limits.
struct Meeting {
  uint32_t triangle = 0;
  Passing passing = Passing::Inside;
  Exact t;
  float nearest = 0;    ///< t, rounded to a float
  bool certain = true;  ///< t and the rounded t lie both between the limits; else only one of them does
};

struct Certificate {
  std::vector<Meeting> meetings;  ///< by t, at equal t by number
  std::vector<uint32_t> allowed;  ///< triangles that are a right answer, by number
  bool miss = true;               ///< so is none
  /// Of the meetings that hide what lies behind: the first t at which every ray next to this one has hit something.
  /// Where no miss is allowed.
  Exact hidden_from;

  bool allows(uint32_t triangle) const;
  const Meeting* meeting(uint32_t triangle) const;
};

Certificate certify(const HitCase& hit_case);

}  // namespace raypool::referee
