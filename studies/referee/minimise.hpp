// The smallest case of a fault: fewest triangles, then simplest numbers.
#pragma once

#include <cstdint>
#include <functional>

#include "scene/hit_case.hpp"

namespace raypool::referee {

/// How hard a case is to read; the smaller one is the simpler one. Triangles count first, then the digits of numbers.
struct CaseSize {
  size_t triangles = 0;
  uint64_t digits = 0;

  friend bool operator<(const CaseSize& a, const CaseSize& b) {
    return a.triangles != b.triangles ? a.triangles < b.triangles : a.digits < b.digits;
  }
};
CaseSize size_of(const HitCase& hit_case);

/// Of `failing`, for which `fails` must hold: a reduced case for which it does too, after at most so many trials.
HitCase minimise(const HitCase& failing, const std::function<bool(const HitCase&)>& fails, uint32_t trials = 4000);

}  // namespace raypool::referee
