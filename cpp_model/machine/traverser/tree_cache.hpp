// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/traverser/rp_tree_cache.v: a bank of a cache of the traverser. Tags, registers of the lines that are on their way
// (MSHRs), and the slots that wait for them. Of the data it knows in which row it stands: it moves as the tags do, and
// only hardware needs it.
//
// Outputs, read before clock(), are valid for the whole cycle; only those that take that cycle's inputs depend on them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "bits.hpp"
#include "machine/common/round_robin.hpp"
#include "machine/traverser/traverser_work.hpp"

namespace raypool {

class TreeCache {
 public:
  static constexpr uint32_t kMostLanes = 32, kMostMshrs = 32, kMostWays = 16;

  struct Sizes {
    uint32_t lanes = 8;
    uint32_t lines = 128, ways = 16;  ///< powers of two
    uint32_t mshrs = 8;
  };
  using Slots = std::array<uint8_t, kMostLanes>;  ///< [lane]
  /// A line for all lanes that ask for it, with the slots of their rays; for none: a prefetch.
  struct Lookup {
    uint32_t line = 0;
    uint32_t lanes = 0;  ///< a bit each
    Slots slots{};
  };
  /// What happens in a cycle besides what the bank decides.
  struct Inputs {
    const Lookup* lookup = nullptr;  ///< taken; only if ready()
    bool fill = false;               ///< a line has come, for register `fill_id`
    uint32_t fill_id = 0;
    bool offer_taken = false;    ///< by the lane to which offer() is made
    bool request_taken = false;  ///< by the memory; only if request_valid()
  };
  /// What a lane is given.
  struct Given {
    uint32_t lanes = 0;  ///< 0: nothing
    Slots slots{};
    uint32_t row = 0;  ///< of the data
  };
  using Work = CacheWork;  ///< of lanes; a miss is a line that is read

  explicit TreeCache(const Sizes& sizes)
      : sizes_(sizes),
        all_ways_((1u << sizes.ways) - 1),
        sets_(sizes.lines / sizes.ways),
        tags_(sizes.lines, kNone),
        order_(sets_),
        next_(kMostLanes << 8) {
    for (uint32_t way = 0; way < sizes.ways; ++way) {
      for (uint32_t node = sizes.ways + way; node > 1; node /= 2) {
        touches_[way].bits |= 1u << node / 2;
        touches_[way].set |= (~node & 1) << node / 2;
      }
    }
  }

  // ---- Lookups

  /// A lookup is taken, unless a line comes in this cycle. Whether the one before hits is not asked.
  bool ready() const {
    return serving_ == Serving::Idle && (filled_ & waited_for_) == 0 && !(looks_ && (waits_ || stuck()));
  }
  /// Two cycles after a hit, or after an offer was taken: the slots that get the row that is there.
  const Given& given() const { return given_; }

  // ---- Serving those that have waited

  /// A lane is offered a line for which its ray has waited.
  bool offers() const { return serving_ == Serving::Offered; }
  uint32_t offer_lane() const { return mshrs_[serve_id_].head.lane; }  ///< mean something while offers()
  uint32_t offer_slot() const { return mshrs_[serve_id_].head.slot; }

  // ---- The memory

  bool request_valid() const { return request_count_ != 0; }
  uint32_t request_id() const { return requests_[request_head_]; }  ///< mean something while request_valid()
  uint32_t request_line() const { return mshrs_[request_id()].line; }
  /// A line that comes in this cycle is taken; it is in the next one at the latest.
  bool fill_ready() const { return !hit(); }

  /// True if nothing can happen until there are inputs.
  bool sleeps() const {
    return looks_ == waits_ && (read_.lanes | given_.lanes | joins_.lanes | filled_) == 0 && serving_ == Serving::Idle;
  }
  /// True if nothing is under way either.
  bool idle() const { return sleeps() && !looks_ && busy_ == 0; }

  /// The end of a cycle.
  void clock(const Inputs& inputs) {
    const bool hits = hit(), joins = joins_.lanes != 0;
    Miss now;
    if (waits_) now.stuck = true;
    if (looks_ && !waits_ && !hits) now = miss();
    const bool fill = inputs.fill && !hits;
    give(read_.lanes, read_.slots, read_.row);
    read_.lanes = 0;
    // A lookup from before the line came may wait for lanes that join another list, and then joins that of the line.
    const uint32_t late = now.known && !fresh_ ? 1u << now.id : 0;
    const uint32_t freed = filled_ & ~waited_for_ & ~late & ~(joins ? 1u << joins_.id : 0);

    serve(joins, inputs.offer_taken);
    if (joins) join();
    if (hits) {
      give(lookup_.lanes, lookup_.slots, row(set(lookup_.line), found_));
      touch(set(lookup_.line), found_);
      work_.hits += popcount(lookup_.lanes);
    } else if (looks_ && !now.stuck) {
      if (now.allocate) allocate(now);
      work_.joined += popcount(now.allocate ? lookup_.lanes & (lookup_.lanes - 1) : lookup_.lanes);
      if (lookup_.lanes != 0) {
        joins_.lanes = lookup_.lanes;
        joins_.id = now.id;
        copy(lookup_.lanes, lookup_.slots, joins_.slots);
      }
    }
    looks_ = looks_ && now.stuck;
    waits_ = looks_ && !joins && freed == 0;
    if (fill) {
      Mshr& mshr = mshrs_[inputs.fill_id];
      tags_[row(set(mshr.line), mshr.way)] = mshr.line;
      filled_ |= 1u << inputs.fill_id;
    }
    busy_ &= ~freed;
    filled_ &= ~freed;

    if (inputs.request_taken) {
      request_head_ = request_head_ + 1 == sizes_.mshrs ? 0 : request_head_ + 1;
      --request_count_;
    }
    fresh_ = inputs.lookup != nullptr;
    if (fresh_) {
      found_ = find(inputs.lookup->line);
      lookup_.line = inputs.lookup->line;
      lookup_.lanes = inputs.lookup->lanes;
      copy(lookup_.lanes, inputs.lookup->slots, lookup_.slots);
      looks_ = true;
    }
  }

  static constexpr uint32_t kNone = UINT32_MAX;
  /// In place of clock(), while sleeps() and ready(), of a lookup without other inputs: all that two cycles make of it,
  /// if it hits and the bank stays ready() in between. Row from which its lanes are given the line two cycles later, in
  /// the first of which no line that comes is taken; kNone: clock() must be called.
  uint32_t hit_at_once(const Lookup& lookup) {
    const uint64_t busy = popcount(busy_);
    if (busy >= sizes_.mshrs || busy >= sizes_.ways) return kNone;
    const uint32_t way = find(lookup.line);
    if (way == kNone) return kNone;
    touch(set(lookup.line), way);
    work_.hits += popcount(lookup.lanes);
    return row(set(lookup.line), way);
  }

  // ---- For measurements

  /// The line is there from now on, as if it had just been looked up. Takes no time. Returns the row that its data must
  /// be put into before the next cycle; kNone: it was there, is on its way, or every way of its set is in use. `given`:
  /// rows that are in use after hit_at_once(), or kNone.
  uint32_t remember(uint32_t line, const uint32_t (&given)[2]) {
    const uint32_t in = set(line), found = find(line);
    if (found != kNone) {
      touch(in, found);
      return kNone;
    }
    uint32_t used = 0;  // ways with a line that a lane waits for, or is about to get
    const auto uses = [&](uint32_t of) { used |= of / sizes_.ways == in ? 1u << of % sizes_.ways : 0; };
    for (uint32_t bits = busy_; bits != 0; bits &= bits - 1) {
      const uint32_t id = lowest(bits);
      if (mshrs_[id].line == line) return kNone;
      uses(fill_row(id));
    }
    if (hit()) uses(row(set(lookup_.line), found_));
    if (read_.lanes != 0) uses(read_.row);
    if (given_.lanes != 0) uses(given_.row);
    for (const uint32_t of : given)
      if (of != kNone) uses(of);
    if (used == all_ways_ || (looks_ && lookup_.line == line)) return kNone;
    const uint32_t way = victim(in, used);
    tags_[row(in, way)] = line;
    touch(in, way);
    return row(in, way);
  }
  /// Row that the line of register `id` goes to.
  uint32_t fill_row(uint32_t id) const { return row(set(mshrs_[id].line), mshrs_[id].way); }
  uint32_t busy() const { return busy_; }  ///< registers
  bool blocked() const { return looks_ && !hit() && miss().stuck; }
  const Work& work() const { return work_; }

 private:
  enum class Serving : uint8_t { Idle, Chosen, Offered };

  struct Waiter {
    uint8_t lane = 0, slot = 0;
    bool operator==(const Waiter& other) const { return lane == other.lane && slot == other.slot; }
  };
  struct Mshr {
    uint32_t line = 0, way = 0;
    Waiter head, tail;  // of the list: longest and shortest wait
  };
  // What a lookup comes to if it is a miss.
  struct Miss {
    bool known = false, allocate = false;
    bool stuck = false;  // it waits: others join a list, or no register is free, or no way of the set
    uint32_t way = 0;    // that the line will have, if allocate
    uint32_t id = 0;     // of the register
  };
  // Of a set's order: bits that a use of a way changes, and those of them that are set then.
  struct Touch {
    uint32_t bits = 0, set = 0;
  };
  // Lanes that join a register's list, one a cycle.
  struct Joins {
    uint32_t lanes = 0;
    Slots slots{};
    uint32_t id = 0;
  };

  // One by one: few lanes look at the same line, and a wide load would wait for what has just been written.
  static void copy(uint32_t lanes, const Slots& from, Slots& to) {
    for (uint32_t bits = lanes; bits != 0; bits &= bits - 1) to[lowest(bits)] = from[lowest(bits)];
  }
  void give(uint32_t lanes, const Slots& slots, uint32_t row) {
    given_.lanes = lanes;
    given_.row = row;
    copy(lanes, slots, given_.slots);
  }

  uint32_t set(uint32_t line) const { return line & (sets_ - 1); }
  uint32_t row(uint32_t in, uint32_t way) const { return in * sizes_.ways + way; }
  uint32_t find(uint32_t line) const {
    const uint32_t* const tags = &tags_[row(set(line), 0)];
    uint32_t ways = 0;
    for (uint32_t way = 0; way < sizes_.ways; ++way) ways |= (tags[way] == line ? 1u : 0u) << way;
    return ways != 0 ? lowest(ways) : kNone;
  }
  uint32_t& next(Waiter waiter) { return next_[waiter.lane << 8 | waiter.slot]; }

  bool hit() const { return looks_ & fresh_ & (found_ != kNone); }
  bool others_join() const { return (joins_.lanes & (joins_.lanes - 1)) != 0; }  // in the next cycle, too
  // A lookup that waits if it is a miss. As long as there are fewer lines on their way than ways, no set is locked.
  bool stuck() const {
    if (lookup_.lanes == 0) return false;
    if (others_join()) return true;
    const uint64_t busy = popcount(busy_);
    return (busy >= sizes_.mshrs || busy >= sizes_.ways) && miss().stuck;
  }
  // Of the registers and of what has been looked up alone.
  Miss miss() const {
    Miss now;
    uint32_t locked = 0;
    for (uint32_t bits = busy_; bits != 0; bits &= bits - 1) {
      const Mshr& mshr = mshrs_[lowest(bits)];
      if (mshr.line == lookup_.line) {
        now.known = true;
        now.id = lowest(bits);
      }
      if (set(mshr.line) == set(lookup_.line)) locked |= 1u << mshr.way;
    }
    const uint32_t free = ~busy_ & static_cast<uint32_t>((uint64_t{1} << sizes_.mshrs) - 1);
    const bool room = free != 0 && locked != all_ways_;
    now.stuck = lookup_.lanes != 0 && (others_join() || !(now.known || room));  // a prefetch is dropped
    now.allocate = !now.stuck && !now.known && room;
    if (!now.allocate) return now;
    now.id = lowest(free);
    now.way = victim(set(lookup_.line), locked);
    return now;
  }

  // A tree of bits, each of which points to the half that was used less recently; ways that are promised are left out.
  uint32_t victim(uint32_t in, uint32_t locked) const {
    uint32_t node = 1;
    for (uint32_t half = sizes_.ways / 2; half != 0; half /= 2) {
      uint32_t side = order_[in] >> node & 1;
      const uint32_t first = (2 * node + side) * half - sizes_.ways;
      const uint32_t ways = ((1u << half) - 1) << first;
      if ((ways & ~locked) == 0) side ^= 1;
      node = 2 * node + side;
    }
    return node - sizes_.ways;
  }
  void touch(uint32_t in, uint32_t way) { order_[in] = (order_[in] & ~touches_[way].bits) | touches_[way].set; }

  void allocate(const Miss& now) {
    Mshr& mshr = mshrs_[now.id];
    mshr.line = lookup_.line;
    mshr.way = now.way;
    busy_ |= 1u << now.id;
    touch(set(lookup_.line), now.way);
    requests_[(request_head_ + request_count_++) % sizes_.mshrs] = static_cast<uint8_t>(now.id);
    ++work_.misses;
  }
  void join() {
    Mshr& mshr = mshrs_[joins_.id];
    const uint32_t lane = lowest(joins_.lanes);
    const Waiter waiter{static_cast<uint8_t>(lane), joins_.slots[lane]};
    if ((waited_for_ >> joins_.id & 1) == 0) {
      mshr.head = waiter;
      waited_for_ |= 1u << joins_.id;
    } else {
      next(mshr.tail) = waiter.lane << 8 | waiter.slot;
    }
    mshr.tail = waiter;
    joins_.lanes &= joins_.lanes - 1;
  }
  // Of the registers that are as they were before this cycle.
  void serve(bool joins, bool offer_taken) {
    const uint32_t served = filled_ & waited_for_;
    if (serving_ == Serving::Idle) {
      if (served != 0) {
        serve_id_ = turn_.choose(served);
        turn_.advance(serve_id_);
        serving_ = joins ? Serving::Chosen : Serving::Offered;
      }
    } else if (serving_ == Serving::Chosen) {
      if (!joins) serving_ = Serving::Offered;
    } else if (offer_taken) {
      hand_on();
    }
  }
  // The waiter that was offered its line has it.
  void hand_on() {
    Mshr& mshr = mshrs_[serve_id_];
    read_.lanes = 1u << mshr.head.lane;
    read_.slots[mshr.head.lane] = mshr.head.slot;
    read_.row = fill_row(serve_id_);
    if (mshr.head == mshr.tail) {
      waited_for_ &= ~(1u << serve_id_);
      serving_ = Serving::Idle;
    } else {
      const uint32_t waiter = next(mshr.head);
      mshr.head = {static_cast<uint8_t>(waiter >> 8), static_cast<uint8_t>(waiter)};
      serving_ = Serving::Chosen;
    }
  }

  Sizes sizes_;
  uint32_t all_ways_, sets_;
  std::vector<uint32_t> tags_;              // [set][way] lines, or kNone
  std::vector<uint32_t> order_;             // [set] bits 1 .. ways - 1
  std::array<Touch, kMostWays> touches_{};  // [way]
  bool looks_ = false;
  bool waits_ = false;                               // what is looked up is stuck until a register is free
  Lookup lookup_;                                    // its tags have been read
  bool fresh_ = false;                               // they have, in the cycle before: later they may be out of date
  uint32_t found_ = kNone;                           // way in which the line was
  Joins joins_;                                      // of a lookup that has missed
  uint32_t busy_ = 0, filled_ = 0, waited_for_ = 0;  // sets of registers
  std::array<Mshr, kMostMshrs> mshrs_{};             //
  std::vector<uint32_t> next_;                       // [waiter] the one behind it
  std::array<uint8_t, kMostMshrs> requests_{};       // registers with a line to be asked for
  uint32_t request_head_ = 0, request_count_ = 0;
  Serving serving_ = Serving::Idle;
  uint32_t serve_id_ = 0;
  RoundRobin turn_;
  Given read_, given_;
  Work work_;
};

}  // namespace raypool
