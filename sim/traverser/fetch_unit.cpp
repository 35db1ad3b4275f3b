#include "traverser/fetch_unit.hpp"

#include <algorithm>

namespace raypool::traverser {

namespace {

constexpr size_t kWindow = 2;  // oldest places of the queue that are looked at, for each lookup

}  // namespace

FetchUnit::FetchUnit(const Setup& setup)
    : setup_(setup), cache_(setup.bytes, setup.ways, setup.mshrs), hits_(setup.latency), banks_(setup.banks) {}

bool FetchUnit::bank_free(uint64_t cycle, uint32_t line) {
  Bank& bank = banks_[line & (setup_.banks - 1)];
  if (bank.cycle == cycle) return bank.line == line;
  bank = {cycle, line};
  return true;
}

void FetchUnit::clock(uint64_t cycle, LookupListener& listener) {
  uint32_t lookups = 0;
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
    if (answer == LineCache::Answer::Missed) requests_.push_back(wanted.fetch.line);
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
  return wanted_.empty() && requests_.empty() && filled_.empty() ? hits_.next() : cycle + 1;
}

}  // namespace raypool::traverser
