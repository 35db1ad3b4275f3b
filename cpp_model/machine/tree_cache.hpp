// rtl/tree_cache.v: a bank of a cache of the traverser. Tags, registers of the lines that are on their way (MSHRs), and
// who waits for them. Of the data it says in which row it stands: it moves as the tags do, and only hardware needs it.
//
// All that is said before clock() holds in a whole cycle, and depends on that cycle's inputs only where it takes them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "bits.hpp"
#include "machine/round_robin.hpp"

namespace raypool {

class TreeCache {
 public:
  static constexpr uint32_t kMostLanes = 32, kMostMshrs = 32, kMostWays = 16;

  struct Sizes {
    uint32_t lanes = 8;
    uint32_t lines = 128, ways = 16;  ///< powers of two
    uint32_t mshrs = 8;
  };
  /// A line for all lanes that ask for it, with the slots of their rays; for none: nobody waits for it yet.
  struct Lookup {
    uint32_t line = 0;
    uint32_t lanes = 0;  ///< a bit each
    std::array<uint8_t, kMostLanes> slots{};
  };
  /// What happens in a cycle besides what the bank decides.
  struct Inputs {
    const Lookup* lookup = nullptr;  ///< taken; only if ready()
    bool fill = false;               ///< a line has come, for register `fill_id`
    uint32_t fill_id = 0;
    bool offer_taken = false;    ///< by the lane to whom offer() is made
    bool request_taken = false;  ///< by the memory; only if request_valid()
  };
  /// What a lane is given.
  struct Given {
    uint32_t lanes = 0;  ///< 0: nothing
    std::array<uint8_t, kMostLanes> slots{};
    uint32_t row = 0;  ///< of the data
  };
  struct Work {
    uint64_t hits = 0, misses = 0, joined = 0;  ///< of lanes; a miss is a line that is read
  };

  explicit TreeCache(const Sizes& sizes)
      : sizes_(sizes),
        all_ways_((1u << sizes.ways) - 1),
        sets_(sizes.lines / sizes.ways),
        tags_(sizes.lines),
        valid_(sizes.lines),
        order_(sets_),
        next_(kMostLanes << 8) {}

  // ---- Lookups

  /// A lookup is taken, unless a line comes in this cycle.
  bool ready() const {
    return serving_ == Serving::Nobody && (filled_ & waited_for_) == 0 && (!looks_ || answer().done);
  }
  /// Two cycles after a hit, or after an offer was taken: who gets the row that is there.
  const Given& given() const { return given_; }

  // ---- Who has waited

  /// A lane is offered a line for which its ray has waited.
  bool offers() const { return serving_ == Serving::Offered; }
  uint32_t offer_lane() const { return mshrs_[serve_id_].head.lane; }  ///< mean something while offers()
  uint32_t offer_slot() const { return mshrs_[serve_id_].head.slot; }

  // ---- The memory

  bool request_valid() const { return request_count_ != 0; }
  uint32_t request_id() const { return requests_[request_head_]; }  ///< mean something while request_valid()
  uint32_t request_line() const { return mshrs_[request_id()].line; }
  /// A line that comes in this cycle is taken; it is in the next one at the latest.
  bool fill_ready() const { return !(looks_ && answer().hit); }

  /// True if nothing can happen until there are inputs.
  bool idle() const { return !looks_ && read_.lanes == 0 && given_.lanes == 0 && busy_ == 0; }

  /// The end of a cycle.
  void clock(const Inputs& inputs) {
    const Answer now = looks_ ? answer() : Answer{};
    const bool fill = inputs.fill && !now.hit;
    given_ = read_;
    read_.lanes = 0;
    const uint32_t freed = filled_ & ~waited_for_;  // nobody joins one of these

    // Of the registers that are as they were before this cycle.
    const uint32_t served = filled_ & waited_for_;
    if (serving_ == Serving::Nobody) {
      if (served != 0) {
        serve_id_ = turn_.choose(served);
        turn_.advance(serve_id_);
        serving_ = now.join ? Serving::Chosen : Serving::Offered;
      }
    } else if (serving_ == Serving::Chosen) {
      if (!now.join) serving_ = Serving::Offered;
    } else if (inputs.offer_taken) {
      hand_on();
    }

    if (now.hit) {
      given_ = {lookup_.lanes, lookup_.slots, row(set(lookup_.line), now.way)};
      touch(set(lookup_.line), now.way);
      work_.hits += popcount(lookup_.lanes);
    } else if (now.allocate) {
      allocate(now);
    } else if (now.join) {
      join(now.id);
    }
    if (looks_ && !now.blocked) {
      lookup_.lanes = now.done ? 0 : lookup_.lanes & (lookup_.lanes - 1);
      looks_ = !now.done;
    }
    if (fill) {
      Mshr& mshr = mshrs_[inputs.fill_id];
      tags_[row(set(mshr.line), mshr.way)] = mshr.line;
      valid_[row(set(mshr.line), mshr.way)] = true;
      filled_ |= 1u << inputs.fill_id;
    }
    busy_ &= ~freed;
    filled_ &= ~freed;

    if (inputs.request_taken) {
      request_head_ = request_head_ + 1 == sizes_.mshrs ? 0 : request_head_ + 1;
      --request_count_;
    }
    found_ = kNone;
    if (inputs.lookup != nullptr) {
      found_ = find(inputs.lookup->line);
      lookup_ = *inputs.lookup;
      looks_ = true;
    }
  }

  // ---- For measurements

  /// The line is there, as if it had just been looked up. Takes no time; nothing may be under way.
  void remember(uint32_t line) {
    const uint32_t in = set(line);
    uint32_t way = find(line);
    if (way == kNone) {
      way = victim(in, 0);
      tags_[row(in, way)] = line;
      valid_[row(in, way)] = true;
    }
    touch(in, way);
  }
  /// Row that the line of register `id` goes to.
  uint32_t fill_row(uint32_t id) const { return row(set(mshrs_[id].line), mshrs_[id].way); }
  uint32_t busy() const { return busy_; }  ///< registers
  bool blocked() const { return looks_ && answer().blocked; }
  const Work& work() const { return work_; }

 private:
  static constexpr uint32_t kNone = UINT32_MAX;
  enum class Serving : uint8_t { Nobody, Chosen, Offered };

  struct Waiter {
    uint8_t lane = 0, slot = 0;
    bool operator==(const Waiter& other) const { return lane == other.lane && slot == other.slot; }
  };
  struct Mshr {
    uint32_t line = 0, way = 0;
    Waiter head, tail;  // who waits longest, and shortest
  };
  struct Answer {
    bool hit = false, join = false, allocate = false;
    bool blocked = false;  // no register is free, or no way of the set
    bool done = false;     // for the last lane
    uint32_t way = 0;      // of the hit, or that the line will have
    uint32_t id = 0;       // of the register
  };

  uint32_t set(uint32_t line) const { return line & (sets_ - 1); }
  uint32_t row(uint32_t in, uint32_t way) const { return in * sizes_.ways + way; }
  uint32_t find(uint32_t line) const {
    const uint32_t first = row(set(line), 0);
    for (uint32_t way = 0; way < sizes_.ways; ++way) {
      if (tags_[first + way] == line && valid_[first + way]) return way;
    }
    return kNone;
  }
  uint32_t& next(Waiter waiter) { return next_[waiter.lane << 8 | waiter.slot]; }

  // Of the registers and of what has been looked up alone.
  Answer answer() const {
    Answer now;
    now.way = found_;
    now.hit = now.way != kNone;
    const bool last = (lookup_.lanes & (lookup_.lanes - 1)) == 0;
    if (now.hit) {
      now.done = true;
      return now;
    }
    uint32_t locked = 0;
    for (uint32_t bits = busy_; bits != 0; bits &= bits - 1) {
      const Mshr& mshr = mshrs_[lowest(bits)];
      if (mshr.line == lookup_.line) {
        now.join = lookup_.lanes != 0;
        now.id = lowest(bits);
        now.done = last;
        return now;
      }
      if (set(mshr.line) == set(lookup_.line)) locked |= 1u << mshr.way;
    }
    const uint32_t free = ~busy_ & static_cast<uint32_t>((uint64_t{1} << sizes_.mshrs) - 1);
    now.allocate = free != 0 && locked != all_ways_;
    now.blocked = !now.allocate && lookup_.lanes != 0;  // what nobody waits for is dropped
    now.done = !now.blocked && last;
    if (!now.allocate) return now;
    now.id = lowest(free);
    now.way = victim(set(lookup_.line), locked);
    return now;
  }

  // A tree of bits, of which each says in which half a way was used less recently; ways that are promised are left out.
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
  void touch(uint32_t in, uint32_t way) {
    for (uint32_t node = sizes_.ways + way; node > 1; node /= 2)
      order_[in] = (order_[in] & ~(1u << node / 2)) | (~node & 1) << node / 2;
  }

  Waiter asking() const {
    const uint32_t lane = lowest(lookup_.lanes);
    return {static_cast<uint8_t>(lane), lookup_.slots[lane]};
  }
  void allocate(const Answer& now) {
    Mshr& mshr = mshrs_[now.id];
    mshr.line = lookup_.line;
    mshr.way = now.way;
    busy_ |= 1u << now.id;
    waited_for_ &= ~(1u << now.id);
    touch(set(lookup_.line), now.way);
    if (lookup_.lanes != 0) {
      mshr.head = mshr.tail = asking();
      waited_for_ |= 1u << now.id;
    }
    requests_[(request_head_ + request_count_++) % sizes_.mshrs] = static_cast<uint8_t>(now.id);
    ++work_.misses;
  }
  void join(uint32_t id) {
    Mshr& mshr = mshrs_[id];
    const Waiter waiter = asking();
    if ((waited_for_ >> id & 1) == 0) {
      mshr.head = waiter;
      waited_for_ |= 1u << id;
    } else {
      next(mshr.tail) = waiter.lane << 8 | waiter.slot;
    }
    mshr.tail = waiter;
    ++work_.joined;
  }
  // The waiter that was offered its line has it.
  void hand_on() {
    Mshr& mshr = mshrs_[serve_id_];
    read_.lanes = 1u << mshr.head.lane;
    read_.slots[mshr.head.lane] = mshr.head.slot;
    read_.row = fill_row(serve_id_);
    if (mshr.head == mshr.tail) {
      waited_for_ &= ~(1u << serve_id_);
      serving_ = Serving::Nobody;
    } else {
      const uint32_t waiter = next(mshr.head);
      mshr.head = {static_cast<uint8_t>(waiter >> 8), static_cast<uint8_t>(waiter)};
      serving_ = Serving::Chosen;
    }
  }

  Sizes sizes_;
  uint32_t all_ways_, sets_;
  std::vector<uint32_t> tags_;   // [set][way] lines
  std::vector<uint8_t> valid_;   // [set][way]
  std::vector<uint32_t> order_;  // [set] bits 1 .. ways - 1
  bool looks_ = false;
  Lookup lookup_;                                    // whose tags have been read; lanes that are left of it
  uint32_t found_ = kNone;                           // way in which the line was, if that was in the cycle before
  uint32_t busy_ = 0, filled_ = 0, waited_for_ = 0;  // sets of registers
  std::array<Mshr, kMostMshrs> mshrs_{};             //
  std::vector<uint32_t> next_;                       // [waiter] who waits behind it
  std::array<uint8_t, kMostMshrs> requests_{};       // registers whose line is to be asked for
  uint32_t request_head_ = 0, request_count_ = 0;
  Serving serving_ = Serving::Nobody;
  uint32_t serve_id_ = 0;
  RoundRobin turn_;
  Given read_, given_;
  Work work_;
};

}  // namespace raypool
