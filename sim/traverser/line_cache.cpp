#include "traverser/line_cache.hpp"

#include <algorithm>
#include <utility>

#include "traverser/delay_line.hpp"

namespace raypool::traverser {

namespace {

constexpr uint32_t kLineBytes = 64;

}  // namespace

LineCache::LineCache(uint32_t bytes, uint32_t ways, uint32_t mshrs)
    : ways_a_set_(ways), sets_(bytes / (kLineBytes * ways)), ways_(bytes / kLineBytes), mshrs_(mshrs) {}

LineCache::Mshr* LineCache::find(uint32_t line) {
  for (Mshr& mshr : mshrs_) {
    if (mshr.taken && mshr.line == line) return &mshr;
  }
  return nullptr;
}

LineCache::Answer LineCache::lookup(const Fetch& fetch, uint64_t by) {
  ++lookups_;
  Way* const way = set(fetch.line);
  for (uint32_t i = 0; i < ways_a_set_; ++i) {
    if (way[i].used == 0 || way[i].line != fetch.line) continue;
    way[i].used = lookups_;
    ++work_.hits;
    return Answer::Hit;
  }
  if (Mshr* const mshr = find(fetch.line); mshr != nullptr) {
    if (mshr->due <= by) {
      ++work_.joined;
      return Answer::Hit;
    }
    mshr->waiting.push_back(fetch);
    ++work_.joined;
    return Answer::Joined;
  }
  for (Mshr& mshr : mshrs_) {
    if (mshr.taken) continue;
    mshr.taken = true;
    mshr.line = fetch.line;
    mshr.due = kNever;
    mshr.waiting.assign(1, fetch);
    ++work_.misses;
    return Answer::Missed;
  }
  return Answer::Busy;
}

std::vector<Fetch> LineCache::fill(uint32_t line) {
  Mshr& mshr = *find(line);
  mshr.taken = false;
  Way* const way = set(line);
  Way* const oldest =
      std::min_element(way, way + ways_a_set_, [](const Way& a, const Way& b) { return a.used < b.used; });
  *oldest = {line, ++lookups_};
  return std::exchange(mshr.waiting, {});
}

}  // namespace raypool::traverser
