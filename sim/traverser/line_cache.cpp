#include "traverser/line_cache.hpp"

#include <algorithm>
#include <utility>

#include "traverser/delay_line.hpp"

namespace raypool::traverser {

LineCache::LineCache(uint32_t lines, uint32_t ways, uint32_t mshrs)
    : ways_a_set_(ways), sets_(lines / ways), ways_(lines), mshrs_(mshrs) {}

LineCache::Mshr* LineCache::find(uint32_t line) {
  for (Mshr& mshr : mshrs_) {
    if (mshr.taken && mshr.line == line) return &mshr;
  }
  return nullptr;
}

LineCache::Way* LineCache::find_way(uint32_t line) {
  Way* const way = set(line);
  for (uint32_t i = 0; i < ways_a_set_; ++i) {
    if (way[i].used != 0 && way[i].line == line) return &way[i];
  }
  return nullptr;
}

LineCache::Mshr* LineCache::miss(uint32_t line) {
  for (Mshr& mshr : mshrs_) {
    if (mshr.taken) continue;
    mshr.taken = true;
    mshr.line = line;
    mshr.due = kNever;
    mshr.waiting.clear();
    ++work_.misses;
    return &mshr;
  }
  return nullptr;
}

LineCache::Answer LineCache::lookup(const Fetch& fetch, uint64_t by) {
  ++lookups_;
  if (Way* const way = find_way(fetch.line); way != nullptr) {
    way->used = lookups_;
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
  Mshr* const mshr = miss(fetch.line);
  if (mshr == nullptr) return Answer::Busy;
  mshr->waiting.push_back(fetch);
  return Answer::Missed;
}

bool LineCache::prefetch(uint32_t line) {
  return find_way(line) == nullptr && find(line) == nullptr && miss(line) != nullptr;
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
