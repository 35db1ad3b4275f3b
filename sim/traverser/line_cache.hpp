// Tags and miss-status holding registers of a cache, read only: the least recently used line goes. Who misses waits in
// the line's register and gets the line's data when it comes, whatever becomes of the line in the cache: so nobody is
// overtaken for ever.
#pragma once

#include <cstdint>
#include <vector>

#include "traverser/work.hpp"

namespace raypool::traverser {

/// A line of the tree, for a ray.
struct Fetch {
  uint32_t slot = 0;   ///< of the ray
  uint32_t line = 0;   ///< number
  uint32_t tests = 0;  ///< that can begin with it
  uint32_t more = 0;   ///< lines of the visit behind this one
};

class LineCache {
 public:
  enum class Answer : uint8_t {
    Hit,
    Missed,  ///< the line must be requested; who asks waits
    Joined,  ///< the line is on its way; who asks waits
    Busy,    ///< a miss, and no register is free: ask again
  };

  LineCache(uint32_t lines, uint32_t ways, uint32_t mshrs);

  /// A line that comes by the cycle `by`, in which a line that is there would be read, is a hit too.
  Answer lookup(const Fetch& fetch, uint64_t by = 0);
  /// A line that somebody will ask for soon. True if it must be requested: it is not there, and a register is free.
  bool prefetch(uint32_t line);
  /// The line has come: who waited for it, oldest first.
  std::vector<Fetch> fill(uint32_t line);
  /// When it will come, once that is known.
  void promise(uint32_t line, uint64_t cycle) { find(line)->due = cycle; }
  /// kNever: not known. The line must be on its way.
  uint64_t promised(uint32_t line) { return find(line)->due; }
  const std::vector<Fetch>& waiting(uint32_t line) { return find(line)->waiting; }

  const CacheWork& work() const { return work_; }

 private:
  struct Way {
    uint32_t line;
    uint64_t used;  // 0: empty
  };
  struct Mshr {
    bool taken = false;
    uint32_t line = 0;
    uint64_t due = 0;
    std::vector<Fetch> waiting;
  };
  Mshr* find(uint32_t line);
  Way* find_way(uint32_t line);
  /// A free register takes the line. Null if there is none.
  Mshr* miss(uint32_t line);
  Way* set(uint32_t line) { return &ways_[(line & (sets_ - 1)) * ways_a_set_]; }

  uint32_t ways_a_set_, sets_;
  std::vector<Way> ways_;
  std::vector<Mshr> mshrs_;
  uint64_t lookups_ = 0;
  CacheWork work_;
};

}  // namespace raypool::traverser
