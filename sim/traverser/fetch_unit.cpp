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

void FetchUnit::clock(uint64_t cycle, LookupListener& listener) {
  uint32_t lookups = prefetch(cycle);
  size_t window = std::min<size_t>(wanted_.size(), kWindow * setup_.lookups);
  for (size_t i = 0; i < window && lookups < setup_.lookups;) {
    const Wanted wanted = wanted_[i];
    if (wanted.from > cycle) break;
    if (!bank_free(cycle, wanted.fetch.line)) {
      ++i;
      continue;
    }
    ++lookups;
    const LineCache::Answer answer = cache_.lookup(wanted.fetch, cycle + setup_.latency);
    if (answer == LineCache::Answer::Busy) {
      ++i;
      continue;
    }
    wanted_.erase(wanted_.begin() + static_cast<std::ptrdiff_t>(i));
    --window;
    if (answer == LineCache::Answer::Hit) hits_.push(cycle, wanted.fetch);
    if (answer == LineCache::Answer::Missed) {
      requests_.push_back(wanted.fetch.line);
      for (uint32_t line = 1; line <= wanted.fetch.more; ++line) ahead_.push_back(wanted.fetch.line + line);
    }
    listener.looked_up(wanted.fetch.slot,
                       answer == LineCache::Answer::Hit ? cycle + setup_.latency : cache_.promised(wanted.fetch.line));
  }
}

Fetch FetchUnit::take() {
  if (filled_.empty()) return hits_.take();
  const Fetch fetch = filled_.front();
  filled_.pop_front();
  return fetch;
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
  for (const Fetch& fetch : cache_.fill(line)) filled_.push_back(fetch);
}

uint64_t FetchUnit::next(uint64_t cycle) const {
  return wanted_.empty() && ahead_.empty() && requests_.empty() && filled_.empty() ? hits_.next() : cycle + 1;
}

}  // namespace raypool::traverser
