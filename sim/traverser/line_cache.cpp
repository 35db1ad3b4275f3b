#include "traverser/line_cache.hpp"

#include <algorithm>
#include <utility>

#include "traverser/delay_line.hpp"

namespace raypool::traverser {

LineCache::LineCache(uint32_t lines, uint32_t ways, uint32_t mshrs)
    : ways_a_set_(ways), sets_(lines / ways), tags_(lines, kNoLine), used_(lines), mshrs_(mshrs) {
  size_t buckets = 1;
  while (buckets < 4 * mshrs_.size()) buckets *= 2;
  buckets_.resize(buckets);
  for (Mshr& mshr : mshrs_) mshr.next = std::exchange(free_, &mshr);
}

LineCache::Mshr* LineCache::find(uint32_t line) {
  Mshr* mshr = bucket(line);
  while (mshr != nullptr && mshr->line != line) mshr = mshr->next;
  return mshr;
}

size_t LineCache::find_way(uint32_t line) const {
  const size_t first = set(line);
  for (size_t way = first; way < first + ways_a_set_; ++way) {
    if (tags_[way] == line) return way;
  }
  return kNone;
}

LineCache::Mshr* LineCache::miss(uint32_t line) {
  Mshr* const mshr = free_;
  if (mshr == nullptr) return nullptr;
  free_ = mshr->next;
  mshr->next = std::exchange(bucket(line), mshr);
  mshr->line = line;
  mshr->due = kNever;
  mshr->waiting.clear();
  ++work_.misses;
  return mshr;
}

LineCache::Answer LineCache::lookup(const Fetch& fetch, uint64_t by) {
  ++lookups_;
  if (const size_t way = find_way(fetch.line); way != kNone) {
    used_[way] = lookups_;
    ++work_.hits;
    return Answer::Hit;
  }
  if (Mshr* const mshr = find(fetch.line); mshr != nullptr) {
    ++work_.joined;
    if (mshr->due <= by) return Answer::Hit;
    mshr->waiting.push_back(fetch);
    return Answer::Joined;
  }
  Mshr* const mshr = miss(fetch.line);
  if (mshr == nullptr) return Answer::Busy;
  mshr->waiting.push_back(fetch);
  return Answer::Missed;
}

bool LineCache::prefetch(uint32_t line) {
  return find_way(line) == kNone && find(line) == nullptr && miss(line) != nullptr;
}

const std::vector<Fetch>& LineCache::fill(uint32_t line) {
  ++fills_;
  Mshr** place = &bucket(line);
  while ((*place)->line != line) place = &(*place)->next;
  Mshr* const mshr = *place;
  *place = mshr->next;
  mshr->next = std::exchange(free_, mshr);
  put(line);
  return mshr->waiting;
}

void LineCache::put(uint32_t line) {
  const auto first = used_.begin() + static_cast<std::ptrdiff_t>(set(line));
  const auto oldest = std::min_element(first, first + ways_a_set_);
  *oldest = ++lookups_;
  tags_[static_cast<size_t>(oldest - used_.begin())] = line;
}

void LineCache::remember(uint32_t line) {
  if (find(line) != nullptr) return;
  if (const size_t way = find_way(line); way != kNone) {
    used_[way] = ++lookups_;
  } else {
    put(line);
  }
}

}  // namespace raypool::traverser
