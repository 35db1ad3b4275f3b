// For tests: what a ray might visit, at random, with a stack that fits: nothing is taken that is not there.
#pragma once

#include <cstdint>
#include <random>

#include "scene/traversal.hpp"

namespace raypool::test {

/// At most `most` visits, and one, of nodes 0 .. nodes - 1 and of leaves among as many triangles.
inline VisitList random_visits(std::mt19937& random, uint32_t most, uint32_t nodes) {
  const auto roll = [&](uint32_t below) { return static_cast<uint32_t>(random() % below); };
  VisitList visits;
  uint32_t stack = 0;  // entries
  for (uint32_t i = 0; i < most; ++i) {
    const bool node = i == 0 || roll(3) != 0;
    visits.push_back(
        {roll(nodes), static_cast<uint8_t>(node ? 0 : 1 + roll(4)), static_cast<uint8_t>(node ? roll(5) : 0), 0});
    Visit& visit = visits.back();
    if (visit.children > 0) {
      stack += visit.children - 1u;
      continue;
    }
    visit.discarded = static_cast<uint16_t>(roll(4) == 0 ? roll(stack + 1) : 0);
    stack -= visit.discarded;
    if (stack == 0) return visits;
    --stack;
  }
  // A shadow ray's visits end where they will; so do these.
  visits.push_back({roll(nodes), 1, 0, 0});
  return visits;
}

}  // namespace raypool::test
