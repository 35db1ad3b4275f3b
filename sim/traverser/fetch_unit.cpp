#include "traverser/fetch_unit.hpp"

#include <algorithm>

namespace raypool::traverser {

namespace {

constexpr size_t kWindow = 2;  // oldest places of the queue that are looked at, for each lookup

}  // namespace

FetchUnit::FetchUnit(const Setup& setup)
    : setup_(setup), cache_(setup.lines, setup.ways, setup.mshrs), hits_(setup.latency), banks_(setup.banks) {}

bool FetchUnit::bank_free(uint64_t cycle, uint32_t line) {
  Bank& bank = banks_[line & (setup_.banks - 1)];
  if (bank.cycle == cycle) return bank.line == line;
  bank = {cycle, line};
  return true;
}

// They go first: the ray that needs them is the one that has waited longest. One for which no register is free is
// dropped; the ray will ask for it.
uint32_t FetchUnit::prefetch(uint64_t cycle) {
  uint32_t lookups = 0;
  for (; lookups < setup_.lookups && !ahead_.empty() && bank_free(cycle, ahead_.front()); ++lookups) {
    if (cache_.prefetch(ahead_.front())) requests_.push_back(ahead_.front());
    ahead_.pop_front();
  }
  return lookups;
}

bool FetchUnit::look_up(uint64_t cycle, Wanted& wanted, LookupListener& listener) {
  if (wanted.refused == cache_.fills()) return false;
  const Fetch& fetch = wanted.fetch;
  const LineCache::Answer answer = cache_.lookup(fetch, cycle + setup_.latency);
  if (answer == LineCache::Answer::Busy) {
    wanted.refused = cache_.fills();
    return false;
  }
  if (answer == LineCache::Answer::Hit) hits_.push(cycle, fetch);
  if (answer == LineCache::Answer::Missed) {
    requests_.push_back(fetch.line);
    for (uint32_t line = 1; line <= fetch.more; ++line) ahead_.push_back(fetch.line + line);
  }
  listener.looked_up(fetch.slot,
                     answer == LineCache::Answer::Hit ? cycle + setup_.latency : cache_.promised(fetch.line));
  return true;
}

void FetchUnit::look(uint64_t cycle, LookupListener& listener) {
  uint32_t lookups = ahead_.empty() ? 0 : prefetch(cycle);
  stuck_ = lookups == 0;
  const size_t window = std::min<size_t>(wanted_.size(), kWindow * setup_.lookups);
  size_t kept = 0, place = 0;
  for (; place < window && lookups < setup_.lookups; ++place) {
    Wanted& wanted = wanted_[place];
    if (wanted.from > cycle) {
      stuck_ = false;
      break;
    }
    if (bank_free(cycle, wanted.fetch.line)) {
      ++lookups;
      if (look_up(cycle, wanted, listener)) continue;
    }
    if (kept != place) wanted_[kept] = wanted;
    ++kept;
  }
  if (kept == place) return;
  stuck_ = false;
  // Those that stay, of those that were looked at, stand at the front: they move up to the others.
  const size_t gone = place - kept;
  while (kept-- > 0) wanted_[kept + gone] = wanted_[kept];
  wanted_.pop_front(gone);
}

uint32_t FetchUnit::take_request() {
  const uint32_t line = requests_.front();
  requests_.pop_front();
  return line;
}

void FetchUnit::promise(uint32_t line, uint64_t cycle, LookupListener& listener) {
  cache_.promise(line, cycle);
  for (const Fetch& fetch : cache_.waiting(line)) listener.looked_up(fetch.slot, cycle);
}

void FetchUnit::fill(uint32_t line) {
  stuck_ = false;
  for (const Fetch& fetch : cache_.fill(line)) filled_.push_back(fetch);
}

}  // namespace raypool::traverser
