// For benches of the traverser's caches: which misses of a bank have collided.
#pragma once

#include <cstdint>
#include <map>

#include "bits.hpp"
#include "machine/traverser/tree_cache.hpp"

namespace raypool::bench {

/// Counts cycles in which a lookup of a bank waits and all ways of a set are promised to lines on their way. `waits`: a
/// register is free all the same. `others_freed`: a register is freed and the set stays full, so that the lookup must
/// go on waiting; `own_freed`: the set gets a way back.
class FullSets {
 public:
  explicit FullSets(const TreeCache::Sizes& sizes) : sizes_(sizes) {}

  uint64_t waits = 0, others_freed = 0, own_freed = 0;

  /// Of one cycle: the bank before its clock() and after it.
  void before(const TreeCache& bank) {
    was_busy_ = bank.busy();
    // Lanes of the lookup before may join their list first, one a cycle.
    blocked_ = bank.blocked() ? blocked_ + 1 : 0;
    full_ = blocked_ > sizes_.lanes ? full_sets(bank, was_busy_) : 0;
    waits += full_ != 0 && popcount(was_busy_) < sizes_.mshrs ? 1 : 0;
  }
  void after(const TreeCache& bank) {
    const uint32_t freed = was_busy_ & ~bank.busy();
    if (full_ == 0 || freed == 0) return;
    ++(full_sets(bank, was_busy_ & ~freed) == full_ ? others_freed : own_freed);
  }

 private:
  // How many sets have all their ways promised to these registers.
  uint32_t full_sets(const TreeCache& bank, uint32_t registers) const {
    std::map<uint32_t, uint32_t> ways;  // [set]
    uint32_t full = 0;
    for (; registers != 0; registers &= registers - 1)
      full += ++ways[bank.fill_row(lowest(registers)) / sizes_.ways] == sizes_.ways ? 1 : 0;
    return full;
  }

  TreeCache::Sizes sizes_;
  uint32_t was_busy_ = 0, blocked_ = 0, full_ = 0;
};

}  // namespace raypool::bench
