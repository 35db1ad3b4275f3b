// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/compute/rp_data_cache.v, cycle by cycle, without data: 2-way, least recently used, write-through, no
// write-allocate, loads that miss do not block. docs/machine/memory.md gives the rules that both sides follow.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "config/configuration.hpp"
#include "machine/compute/miss_status.hpp"

namespace raypool {

class DataCache {
 public:
  struct Registers {
    bool refill = false;  ///< a beat waits to be written
    uint32_t refill_id = 0, refill_beat = 0;
    uint32_t quad = 0;                  ///< of the latest lookup: byte address / 16
    bool hit_0 = false, hit_1 = false;  ///< its line is in this way
  };
  /// The access of a cycle, to the quadword that was looked up in the cycle before.
  struct Access {
    bool valid = false, store = false;
    bool inval = false;         ///< with store: an inval, which writes nothing
    bool may_allocate = false;  ///< a miss may take an MSHR
  };
  /// What becomes of it: nothing without an access, or one of hit, allocate, refuse and accept,
  /// or it joins the fetch that matches.
  struct Outcome {
    bool access = false;
    bool found = false;  ///< its line is in the cache
    bool match = false;  ///< ... is being fetched
    bool hit = false, allocate = false, refuse = false, accept = false;
    bool inval = false;  ///< with accept: the line is removed
    uint32_t match_id = 0;
    uint32_t push_id = 0;  ///< with allocate: the MSHR
    uint32_t victim = 0;   ///< with allocate: the way
    bool gone() const { return hit || accept; }
    bool push() const { return stores() || allocate; }
    bool stores() const { return accept && !inval; }
  };
  struct Inputs {
    bool lookup = false;
    uint32_t lookup_quad = 0;
    bool response_valid = false;
    uint32_t response_id = 0, response_beat = 0;
    uint32_t access_warp = 0;
    bool served = false;  ///< the warp has got everything it waited for in this MSHR
    uint32_t served_id = 0, served_warp = 0;
  };

  explicit DataCache(const Configuration& configuration)
      : set_mask_(configuration.data_cache_bytes / 128 - 1),
        sets_(set_mask_ + 1),
        miss_status_(configuration, set_mask_) {}

  void reset() {
    sets_.assign(sets_.size(), Set{});
    q_ = Registers{};
    miss_status_.reset();
  }
  /// Forgets all lines; only while idle.
  void invalidate() {
    for (Set& set : sets_) set.valid = {};
  }

  const Registers& registers() const { return q_; }
  const MissStatus& miss_status() const { return miss_status_; }
  bool idle() const { return miss_status_.idle(); }
  /// Something is to be done without a lookup, an access or a response.
  bool active() const { return q_.refill || miss_status_.registers().filled != 0; }

  // The access of a store writes the data memories, so nothing else may need them then.
  bool load_ready(bool store_access) const { return !q_.refill && !store_access; }
  bool store_ready(bool response_valid) const { return !q_.refill && !response_valid; }

  Outcome access(const Access& in) const {
    Outcome out;
    if (!in.valid) return out;
    out.access = true;
    out.found = q_.hit_0 || q_.hit_1;
    out.hit = !in.store && out.found;
    if (out.hit) return out;
    const MissStatus::Answer answer = miss_status_.access(line());
    if (in.inval) {
      // Waiters are still to be served from a line that has come, or comes.
      out.match = answer.match;
      out.refuse = answer.match || (q_.hit_0 && (answer.locked & 1) != 0) || (q_.hit_1 && (answer.locked & 2) != 0);
      out.inval = out.accept = !out.refuse;
      return out;
    }
    out.match = answer.match;
    out.match_id = answer.match_id;
    out.accept = in.store && !out.match;
    if (in.store || out.match) return out;
    const uint32_t older = sets_[line() & set_mask_].older;
    out.victim = (answer.locked >> older & 1) != 0 ? 1 - older : older;
    out.push_id = answer.available_id;
    out.allocate = in.may_allocate && answer.available && answer.locked != 3;
    out.refuse = !out.allocate;
    return out;
  }
  /// Byte address / 16 of the request of this cycle's access.
  uint32_t push_quad(const Outcome& out) const { return out.accept ? q_.quad : q_.quad & ~3u; }

  void clock(const Inputs& in, const Outcome& out) {
    const uint32_t finished = miss_status_.finished();
    Set& accessed = sets_[line() & set_mask_];
    if (out.found) accessed.older = out.inval ? q_.hit_1 : q_.hit_0;
    const std::array<bool, 2> removed{out.inval && q_.hit_0, out.inval && q_.hit_1};
    if (out.match && !out.refuse) miss_status_.join(out.match_id, in.access_warp);
    if (out.allocate) miss_status_.allocate(out.push_id, line(), out.victim, in.access_warp);
    if (in.served) miss_status_.served(in.served_id, in.served_warp);
    // A cycle with a refill beat has no lookup.
    if (q_.refill) refill();
    if (in.lookup) lookup(in.lookup_quad);
    // A lookup of the same cycle still sees the line.
    for (size_t way = 0; way < removed.size(); ++way)
      if (removed[way]) accessed.valid[way] = false;
    q_.refill = in.response_valid;
    q_.refill_id = in.response_id;
    q_.refill_beat = in.response_beat;
    miss_status_.free(finished);
  }

 private:
  struct Set {
    std::array<uint32_t, 2> line{};
    std::array<bool, 2> valid{};
    uint8_t older = 0;  ///< the way that was used less recently
  };

  uint32_t line() const { return q_.quad >> 2; }

  void lookup(uint32_t quad) {
    const Set& set = sets_[quad >> 2 & set_mask_];
    q_.quad = quad;
    q_.hit_0 = set.valid[0] && set.line[0] == quad >> 2;
    q_.hit_1 = set.valid[1] && set.line[1] == quad >> 2;
  }
  // The way that is filled is invalid from the first beat to the last.
  void refill() {
    const uint32_t line = miss_status_.fill_line(q_.refill_id), way = miss_status_.fill_way(q_.refill_id);
    Set& set = sets_[line & set_mask_];
    if (q_.refill_beat == 0) set.valid[way] = false;
    if (q_.refill_beat != 3) return;
    set.valid[way] = true;
    set.line[way] = line;
    miss_status_.fill_last(q_.refill_id);
  }

  uint32_t set_mask_;
  std::vector<Set> sets_;
  Registers q_;
  MissStatus miss_status_;
};

}  // namespace raypool
