// Each ray's stack of nodes and leaves to be visited: its youngest entries, and how many older ones are in the memory.
// An entry is taken in a cycle. When entries do not fit, the four oldest go to the memory; they come back when there is
// nothing else to take. Which entry it is that is taken, whoever visits knows.
#pragma once

#include <cstdint>
#include <vector>

#include "traverser/delay_line.hpp"
#include "traverser/ring.hpp"

namespace raypool::traverser {

inline constexpr uint32_t kSpillEntries = 4;  ///< of 8 bytes each

class RayStacks {
 public:
  /// For so many rays; of so many entries each, at least twice kSpillEntries.
  RayStacks(uint32_t rays, uint32_t entries) : entries_(entries), stacks_(rays) {}

  /// A ray enters.
  void clear(uint32_t slot) { stacks_[slot] = {}; }
  void push(uint32_t slot, uint32_t entries);
  /// So many are taken, one in a cycle, the first in this one. True if that is all; else done() tells when it is.
  bool pop(uint32_t slot, uint32_t entries);
  /// Entries are being taken, one in a cycle.
  bool pops() const { return !popping_.empty(); }
  void clock();
  /// Rays whose entries have been taken in the cycle of the clock() before.
  const std::vector<uint32_t>& done() const { return done_; }

  // To the memory.
  struct Request {
    uint32_t slot;
    bool write;
    uint32_t block;  ///< of kSpillEntries, of this ray
  };
  bool request_valid() const { return !requests_.empty(); }
  Request take_request();
  void filled(uint32_t slot);

  /// Has something to do in the next cycle.
  bool busy() const { return pops() || request_valid(); }
  uint64_t spills() const { return spills_; }
  uint64_t fills() const { return fills_; }
  uint32_t deepest() const { return deepest_; }

 private:
  struct Stack {
    uint32_t here = 0;     // entries
    uint32_t blocks = 0;   // of kSpillEntries, in the memory
    uint32_t to_take = 0;  // entries
  };
  /// Takes one. True if it was the last.
  static bool take(Stack& stack);
  void fetch(uint32_t slot);

  uint32_t entries_;
  std::vector<Stack> stacks_;
  std::vector<uint32_t> popping_, done_;
  Ring<Request> requests_;
  uint64_t spills_ = 0, fills_ = 0;
  uint32_t deepest_ = 0;
};

}  // namespace raypool::traverser
