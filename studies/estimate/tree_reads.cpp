#include "estimate/tree_reads.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <vector>

#include "chip/tree_image.hpp"

namespace raypool::estimate {
namespace {

constexpr uint32_t kLineBytes = 64;
constexpr uint32_t kNoLine = UINT32_MAX;

/// Tags of a cache, in each set those used last first.
class Tags {
 public:
  Tags(uint32_t bytes, uint32_t ways)
      : ways_(std::min(ways, bytes / kLineBytes)),
        sets_(bytes / kLineBytes / ways_),
        tags_(static_cast<size_t>(sets_) * ways_, kNoLine) {}

  /// False: it has to be read, and has been.
  bool has(uint32_t line) {
    const auto set = tags_.begin() + static_cast<std::ptrdiff_t>(line % sets_) * ways_;
    const auto found = std::find(set, set + ways_, line);
    const bool there = found != set + ways_;
    std::rotate(set, there ? found : set + ways_ - 1, there ? found + 1 : set + ways_);
    *set = line;
    return there;
  }

 private:
  uint32_t ways_, sets_;
  std::vector<uint32_t> tags_;
};

/// Numbers of the rays in this order.
std::vector<size_t> numbers_in(const std::vector<RayKind>& order, const RayVisits& rays) {
  std::map<RayKind, std::vector<size_t>> left;  // the next one last
  for (size_t i = rays.kinds.size(); i-- > 0;) left[rays.kinds[i]].push_back(i);
  std::vector<size_t> numbers;
  const auto take = [&](std::vector<size_t>& of_kind) {
    numbers.push_back(of_kind.back());
    of_kind.pop_back();
  };
  for (const RayKind& kind : order) {
    const auto found = left.find(kind);
    if (found != left.end() && !found->second.empty()) take(found->second);
  }
  for (auto& [kind, of_kind] : left)
    while (!of_kind.empty()) take(of_kind);
  return numbers;
}

}  // namespace

TreeReads reads_a_ray(const ChipConfiguration& chip, const RayVisits& rays, const std::vector<RayKind>& in_order,
                      uint32_t in_flight) {
  Tags nodes(chip.hardware_traverser_node_cache_bytes, chip.hardware_traverser_node_cache_ways);
  Tags triangles(chip.hardware_traverser_triangle_cache_bytes, chip.hardware_traverser_triangle_cache_ways);
  const std::vector<size_t> order = numbers_in(in_order, rays);
  struct Flying {
    size_t next, end;  // in places
    bool counts;
  };
  std::vector<Flying> flying;
  size_t next = 0;
  double counted = 0;
  TreeReads reads;
  while (next < order.size() || !flying.empty()) {
    while (flying.size() < in_flight && next < order.size()) {
      const size_t ray = order[next];
      const bool counts = rays.counts[rays.kinds[ray].tile];
      flying.push_back({ray == 0 ? 0 : rays.ends[ray - 1], rays.ends[ray], counts});
      counted += counts;
      ++next;
    }
    for (size_t i = 0; i < flying.size();) {
      Flying& ray = flying[i];
      if (ray.next == ray.end) {
        ray = flying.back();
        flying.pop_back();
        continue;
      }
      const Visit& place = rays.places[ray.next++];
      const bool counts = ray.counts;
      if (place.triangles == 0) {
        reads.nodes += !nodes.has(place.place) && counts;
      } else {
        for (const uint32_t line : lines_of({place}).triangles) reads.triangles += !triangles.has(line) && counts;
      }
      ++i;
    }
  }
  if (counted == 0) return {};
  return {reads.nodes / counted, reads.triangles / counted};
}

}  // namespace raypool::estimate
