// Time of the instruction cache: rtl/instruction_cache.v, cycle by cycle, without data; docs/memory.md, section 4. The
// instructions themselves are the functional core's.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "config/configuration.hpp"

namespace raypool {

class InstructionCache {
 public:
  explicit InstructionCache(const Configuration& configuration)
      : set_mask_(static_cast<uint32_t>(configuration.instruction_cache_bytes) / 128 - 1), sets_(set_mask_ + 1) {}

  void reset() {
    sets_.assign(sets_.size(), Set{});
    fetch_ = Fetch::None;
    done_ = result_ = false;
  }
  /// Forgets all lines; only while no line is being fetched.
  void invalidate() {
    for (Set& set : sets_) set.valid = {};
  }

  // Registers, as they stand in the present cycle.
  /// The result of the lookup of the cycle before is there.
  bool result() const { return result_; }
  bool hit() const { return way_ >= 0; }  ///< of result()
  bool refill_done() const { return done_; }
  bool request_valid() const { return fetch_ == Fetch::Request; }
  uint32_t request_address() const { return fetch_line_ << 6; }
  /// False if clock() would change nothing without a lookup, request_ready or response.
  bool active() const { return result_ || done_ || fetch_ == Fetch::Settle; }

  /// `lookup`: PC that is looked up in this cycle, -1: none.
  void clock(int lookup, bool request_ready, bool last_beat) {
    // The lookup belongs to the valid bits of this cycle.
    int way = -1;
    if (lookup >= 0) {
      const uint32_t line = static_cast<uint32_t>(lookup) >> 3;
      const Set& set = sets_[line & set_mask_];
      for (int i = 0; i < 2; ++i) {
        if (set.valid[static_cast<size_t>(i)] && set.line[static_cast<size_t>(i)] == line) way = i;
      }
    }
    done_ = fetch_ == Fetch::Settle;
    Fetch next = fetch_;
    switch (fetch_) {
      case Fetch::None:
        break;
      case Fetch::Request:
        if (request_ready) next = Fetch::Beats;
        break;
      case Fetch::Beats:
        if (last_beat) {
          next = Fetch::Settle;
          Set& set = sets_[fetch_line_ & set_mask_];
          set.valid[fetch_way_] = true;
          set.line[fetch_way_] = fetch_line_;
        }
        break;
      case Fetch::Settle:
        next = Fetch::None;
        break;
    }
    if (result_) {
      Set& set = sets_[line_ & set_mask_];
      if (way_ >= 0) {
        set.older = static_cast<uint8_t>(way_ == 0);
      } else if (fetch_ == Fetch::None) {
        next = Fetch::Request;
        fetch_line_ = line_;
        fetch_way_ = set.older;
        set.valid[fetch_way_] = false;
        set.older ^= 1;
      }
    }
    fetch_ = next;
    result_ = lookup >= 0;
    way_ = way;
    line_ = static_cast<uint32_t>(lookup) >> 3;
  }

 private:
  enum class Fetch : uint8_t { None, Request, Beats, Settle };
  struct Set {
    std::array<uint32_t, 2> line{};
    std::array<bool, 2> valid{};
    uint8_t older = 0;
  };

  uint32_t set_mask_;
  std::vector<Set> sets_;
  Fetch fetch_ = Fetch::None;
  uint32_t fetch_line_ = 0;
  uint8_t fetch_way_ = 0;
  bool done_ = false;
  bool result_ = false;
  int way_ = -1;  // of the result
  uint32_t line_ = 0;
};

}  // namespace raypool
