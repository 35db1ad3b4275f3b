// Tags and miss-status holding registers of a cache, read only: the least recently used line goes. Who misses waits in
// the line's register and gets the line's data when it comes, whatever becomes of the line in the cache: so nobody is
// overtaken for ever.
#pragma once

#include <cstddef>
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
  LineCache(const LineCache&) = delete;  // its registers point at each other
  LineCache& operator=(const LineCache&) = delete;

  /// A line that comes by the cycle `by`, in which a line that is there would be read, is a hit too.
  Answer lookup(const Fetch& fetch, uint64_t by = 0);
  /// A line that somebody will ask for soon. True if it must be requested: it is not there, and a register is free.
  bool prefetch(uint32_t line);
  /// The line has come: who waited for it, oldest first. Holds until the next lookup or prefetch.
  const std::vector<Fetch>& fill(uint32_t line);
  /// The line is there, as if it had just been looked up; if it is on its way, it still has to come.
  void remember(uint32_t line);
  /// When it will come, once that is known.
  void promise(uint32_t line, uint64_t cycle) { find(line)->due = cycle; }
  /// kNever: not known. The line must be on its way.
  uint64_t promised(uint32_t line) { return find(line)->due; }
  const std::vector<Fetch>& waiting(uint32_t line) { return find(line)->waiting; }

  /// Lines that have come. Who was told Busy will be told so again until there is another one.
  uint64_t fills() const { return fills_; }
  const CacheWork& work() const { return work_; }

 private:
  struct Mshr {
    uint32_t line = 0;
    uint64_t due = 0;
    Mshr* next = nullptr;  // of its bucket, or free
    std::vector<Fetch> waiting;
  };
  /// Null: no register has the line.
  Mshr* find(uint32_t line);
  /// Its place in used_, or kNone.
  size_t find_way(uint32_t line) const;
  /// A free register takes the line. Null if there is none.
  Mshr* miss(uint32_t line);
  /// Takes the place of the least recently used line of its set.
  void put(uint32_t line);
  size_t set(uint32_t line) const { return size_t{line & (sets_ - 1)} * ways_a_set_; }
  Mshr*& bucket(uint32_t line) { return buckets_[line & (buckets_.size() - 1)]; }

  static constexpr size_t kNone = SIZE_MAX;
  static constexpr uint32_t kNoLine = UINT32_MAX;  // of a way that is empty
  uint32_t ways_a_set_, sets_;
  std::vector<uint32_t> tags_;  // [set][way], apart from used_: they are searched in every lookup
  std::vector<uint64_t> used_;  // [set][way]; 0: not yet
  std::vector<Mshr> mshrs_;
  std::vector<Mshr*> buckets_;  // taken registers, by their line's last bits
  Mshr* free_ = nullptr;
  uint64_t lookups_ = 0, fills_ = 0;
  CacheWork work_;
};

}  // namespace raypool::traverser
