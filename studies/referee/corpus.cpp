#include "referee/corpus.hpp"

#include <map>

#include "referee/draw.hpp"
#include "referee/hard_kinds.hpp"

namespace raypool::referee {
namespace {

struct Kind {
  const char* name;
  DrawnCase (*draw)(Draw&);
};

constexpr Kind kKinds[] = {
    {"through a corner of a closed mesh", through_corner},
    {"through an edge of a closed mesh", through_edge},
    {"next to an edge of a closed mesh", next_to_edge},
    {"at a seam of a fine mesh", at_seam},
    {"fan around a corner", at_fan},
    {"slivers", at_slivers},
    {"needles", at_needles},
    {"coincident triangles", at_coincident},
    {"coplanar triangles", at_coplanar},
    {"triangles that cross", at_crossing},
    {"grazing", grazing},
    {"from far away", from_far},
    {"huge coordinates", huge},
    {"subnormal coordinates", subnormal},
    {"a limit at the hit", limited},
    {"from the surface", from_surface},
    {"strange direction", strange_direction},
    {"soup", in_soup},
};

}  // namespace

const std::vector<std::string>& kinds() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> made;
    for (const Kind& kind : kKinds) made.emplace_back(kind.name);
    return made;
  }();
  return names;
}

HitCase hard_case(uint64_t seed, uint64_t number) {
  const Kind& kind = kKinds[number % std::size(kKinds)];
  Draw draw(seed, number);
  DrawnCase drawn = kind.draw(draw);
  return {number, kind.name, drawn.ray, std::move(drawn.triangles)};
}

}  // namespace raypool::referee
