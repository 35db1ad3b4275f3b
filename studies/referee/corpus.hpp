// The corpus: rays and triangles that are hard to get right, each made from a seed and its number alone. All of the
// hardware's domain: coordinates below 2^59, so that no two are further apart than 1e18.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scene/hit_case.hpp"

namespace raypool::referee {

/// What is hard about cases; case n is of kind n modulo their number.
const std::vector<std::string>& kinds();
HitCase hard_case(uint64_t seed, uint64_t number);

}  // namespace raypool::referee
