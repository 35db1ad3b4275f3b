// The way to a cache: lines that rays want, in their order, looked up so many in a cycle, as far as the cache's banks
// allow; and those that have come. A bank gives one line in a cycle, to all who want it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "traverser/delay_line.hpp"
#include "traverser/line_cache.hpp"
#include "traverser/ring.hpp"

namespace raypool::traverser {

/// Is told what a lookup came to, so that it knows how soon a ray can be done.
class LookupListener {
 public:
  virtual ~LookupListener() = default;
  /// The data comes in cycle `due`; kNever: that is not known.
  virtual void looked_up(uint32_t slot, uint64_t due) = 0;
};

class FetchUnit {
 public:
  struct Setup {
    uint32_t lookups;  ///< in a cycle
    uint32_t latency;
    uint32_t banks;
    uint32_t lines, ways, mshrs;
  };
  explicit FetchUnit(const Setup& setup);

  /// A line is wanted, from the next cycle on.
  void push(uint64_t cycle, const Fetch& fetch) {
    wanted_.push_back({cycle + 1, kNever, fetch});
    stuck_ = false;
  }
  /// Lookups; who takes the data must be ready for them.
  void clock(uint64_t cycle, LookupListener& listener) {
    if (asks()) look(cycle, listener);
  }
  size_t on_the_way() const { return hits_.size(); }

  /// Data has come.
  bool valid(uint64_t cycle) const { return !filled_.empty() || hits_.valid(cycle); }
  Fetch take() {
    if (filled_.empty()) return hits_.take();
    const Fetch fetch = filled_.front();
    filled_.pop_front();
    return fetch;
  }

  // To the memory.
  bool request_valid() const { return !requests_.empty(); }
  uint32_t take_request();
  /// The line that was requested will come then.
  void promise(uint32_t line, uint64_t cycle, LookupListener& listener);
  void fill(uint32_t line);
  void remember(uint32_t line) { cache_.remember(line); }

  /// Has something to do in the next cycle.
  bool busy() const { return asks() || !requests_.empty() || !filled_.empty(); }
  /// The next cycle in which it has, if it is not busy.
  uint64_t next() const { return hits_.next(); }
  const CacheWork& work() const { return cache_.work(); }

 private:
  struct Wanted {
    uint64_t from;
    uint64_t refused;  // found no register free when so many lines had come; kNever: not yet
    Fetch fetch;
  };
  struct Bank {
    uint64_t cycle = kNever;  // in which it gave
    uint32_t line = 0;        // this one
  };
  bool asks() const { return !stuck_ && !(wanted_.empty() && ahead_.empty()); }
  void look(uint64_t cycle, LookupListener& listener);
  bool bank_free(uint64_t cycle, uint32_t line);
  /// Looks up lines behind those that missed. Returns how many lookups that took.
  uint32_t prefetch(uint64_t cycle);
  /// Answers this one. True if it need not ask again.
  bool look_up(uint64_t cycle, Wanted& wanted, LookupListener& listener);

  Setup setup_;
  LineCache cache_;
  Ring<Wanted> wanted_;
  bool stuck_ = false;    // no lookup will come to more than in the last cycle, until a line comes or is wanted
  Ring<uint32_t> ahead_;  // lines to prefetch
  DelayLine<Fetch> hits_;
  Ring<Fetch> filled_;
  Ring<uint32_t> requests_;
  std::vector<Bank> banks_;
};

}  // namespace raypool::traverser
