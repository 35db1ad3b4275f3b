// Whether an answer to a case is right, by its certificate.
#pragma once

#include <array>
#include <cstdint>

#include "referee/certificate.hpp"

namespace raypool::referee {

enum class Fault : uint8_t {
  FalseHit,       ///< a hit where the ray must miss
  LostHit,        ///< a miss where the ray must hit
  WrongTriangle,  ///< a hit of a triangle that is not allowed, where others are
  Crack,          ///< of the last two: it lets the ray through, though all rays beside it are stopped
};
inline constexpr size_t kFaults = 4;
inline constexpr Fault kAllFaults[kFaults] = {Fault::FalseHit, Fault::LostHit, Fault::WrongTriangle, Fault::Crack};
const char* name_of(Fault fault);

struct Verdict {
  std::array<bool, kFaults> faults{};
  bool right = true;   ///< no fault at all
  bool timed = false;  ///< a right hit, so that there is an
  double error = 0;    ///< of t in units of the last place of the exact t, rounded to a float

  bool has(Fault fault) const { return faults[static_cast<size_t>(fault)]; }
};

/// `certificate`: of the case.
Verdict judge(const HitCase& hit_case, const Certificate& certificate, const HitAnswer& answer);

/// Rays beside the case's, on all sides, 2^-20 of the largest coordinate away: each must hit something before t.
bool stops_rays_beside(const HitCase& hit_case, const Exact& t);

/// How far t is from that of the meeting, in units of the last place.
double error_of(float t, const Meeting& meeting);

}  // namespace raypool::referee
