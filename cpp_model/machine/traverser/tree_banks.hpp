// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/traverser/rp_tree_banks.v: a cache of the traverser, of banks (machine/traverser/tree_cache.hpp). A line's last
// bits choose its bank. In a cycle each bank looks up one line, and each lane has one of its two wants looked up, or
// takes one line for which its ray has waited; so it is given one line at most.
//
// In a cycle: choose(), then what comes of it, then clock(). All other outputs are valid for the whole cycle.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "bits.hpp"
#include "machine/common/round_robin.hpp"
#include "machine/traverser/line_want.hpp"
#include "machine/traverser/tree_cache.hpp"

namespace raypool {

class TreeBanks {
 public:
  static constexpr uint32_t kMostBanks = 32, kMostLanes = TreeCache::kMostLanes;

  /// Of the whole cache; each bank has its share.
  struct Sizes {
    uint32_t lanes = 8;
    uint32_t lines = 1024, ways = 16;  ///< powers of two
    uint32_t mshrs = 64;
    uint32_t banks = 8;  ///< a power of two
  };
  using AllWants = std::array<const LineWants*, kMostLanes>;
  struct Given {
    uint8_t slot = 0;
    uint32_t row = 0;  ///< of the data, those of a bank behind those of the banks before it
  };
  /// How often: banks chose both wants of a lane; a lookup was for one more lane; two banks had lines for a lane that
  /// had waited; a lane left such a line; a bank did not take a line at once.
  struct Work {
    uint64_t both_chosen = 0, shared = 0, offered_twice = 0, left = 0, late_fills = 0;
  };
  static constexpr uint32_t kNone = UINT32_MAX;

  explicit TreeBanks(const Sizes& sizes)
      : lines_a_bank_(sizes.lines / sizes.banks),
        bank_mask_(sizes.banks - 1),
        banks_(sizes.banks, TreeCache({sizes.lanes, lines_a_bank_, sizes.ways, sizes.mshrs / sizes.banks})),
        inputs_(sizes.banks),
        lookups_(sizes.banks),
        lane_turns_(sizes.banks),
        bank_turns_(sizes.lanes) {
    ready_ = static_cast<uint32_t>((uint64_t{1} << sizes.banks) - 1);
    while (1u << bank_bits_ < sizes.banks) ++bank_bits_;
    while (1u << id_bits_ < sizes.mshrs / sizes.banks) ++id_bits_;
  }

  // ---- Lanes

  /// Lanes for which there is a line for which a ray has waited: their wants are not looked at in this cycle.
  uint32_t waited() const {
    uint32_t lanes = 0;
    for (uint32_t bits = offering_; bits != 0; bits &= bits - 1) lanes |= 1u << banks_[lowest(bits)].offer_lane();
    return lanes;
  }
  /// A cycle's decisions: of what each lane of `wanting` wants, others want nothing; of the lanes that would take a
  /// line for which they have waited; and of the request that gets its line (kNone: none).
  void choose(const AllWants& wants, uint32_t wanting, uint32_t room, uint32_t fill) {
    uint32_t filled = 0;
    if (fill != kNone) {
      const uint32_t bank = fill >> id_bits_;
      filled = 1u << bank;
      if (fill_ready(fill)) {
        inputs_[bank].fill = true;
        inputs_[bank].fill_id = fill & ((1u << id_bits_) - 1);
        called_ |= filled;
      } else {
        ++work_.late_fills;
      }
    }
    const uint32_t waited_for = waited();
    hand_on(waited_for, room);
    look_up(wants, wanting & ~waited_for, ready_ & ~filled);
  }
  /// Lanes of which a want is looked up, and which: bit i: want i; one at most.
  uint32_t taken_lanes() const { return taken_lanes_; }
  uint8_t taken(uint32_t lane) const { return static_cast<uint8_t>(taken_[lane] & (0u - (taken_lanes_ >> lane & 1))); }
  /// Lanes that are given a line, two cycles after they took it: by a hit, or because they had waited for it.
  uint32_t given_lanes() const { return given_lanes_; }
  const Given& given(uint32_t lane) const { return all_given_[now_][lane]; }

  // ---- The memory

  bool request_valid() const { return requesting_ != 0; }
  /// Mean something while request_valid(). They may change until the request is taken.
  uint32_t request_id() const { return requester() << id_bits_ | banks_[requester()].request_id(); }
  uint32_t request_line() const { return banks_[requester()].request_line() << bank_bits_ | requester(); }
  /// A line that comes for this id is taken.
  bool fill_ready(uint32_t id) const {
    const uint32_t bank = id >> id_bits_;
    return (hitting_ >> bank & 1) == 0 && banks_[bank].fill_ready();
  }

  /// True if nothing can happen until there are inputs.
  bool idle() const {
    return (hitting_ | given_lanes_) == 0 &&
           std::all_of(banks_.begin(), banks_.end(), [](const TreeCache& bank) { return bank.idle(); });
  }

  /// The end of a cycle. The request is taken; only if request_valid().
  void clock(bool request_taken) {
    if (request_taken) {
      const uint32_t bank = requester();
      inputs_[bank].request_taken = true;
      request_turn_.advance(bank);
      called_ |= 1u << bank;
    }
    given_lanes_ = std::exchange(coming_lanes_, 0);
    now_ ^= 1;
    hitting_ = 0;
    for (uint32_t bits = looking_ & ~(awake_ | called_); bits != 0; bits &= bits - 1) hit_at_once(lowest(bits));
    const uint32_t clocked = awake_ | called_ | (looking_ & ~hitting_);
    awake_ = called_ = looking_ = 0;
    offering_ &= ~clocked;
    requesting_ &= ~clocked;
    ready_ |= clocked;
    for (uint32_t bits = clocked; bits != 0; bits &= bits - 1) {
      const uint32_t number = lowest(bits);
      TreeCache& bank = banks_[number];
      bank.clock(inputs_[number]);
      inputs_[number] = {};
      take_given(number);
      offering_ |= (bank.offers() ? 1u : 0u) << number;
      requesting_ |= (bank.request_valid() ? 1u : 0u) << number;
      awake_ |= (bank.sleeps() ? 0u : 1u) << number;
      ready_ ^= (bank.ready() ? 0u : 1u) << number;
    }
  }

  // ---- For measurements

  /// As TreeCache::remember().
  uint32_t remember(uint32_t line) {
    const uint32_t bank = bank_of(line);
    uint32_t rows[2] = {TreeCache::kNone, TreeCache::kNone};  // from which a line is given, in this cycle and the next
    const auto find_row = [&](uint32_t lanes, const std::array<Given, kMostLanes>& given, uint32_t& row) {
      for (uint32_t bits = lanes; bits != 0; bits &= bits - 1)
        if (given[lowest(bits)].row / lines_a_bank_ == bank) row = given[lowest(bits)].row % lines_a_bank_;
    };
    find_row(given_lanes_, all_given_[now_], rows[0]);
    find_row(coming_lanes_, all_given_[now_ ^ 1], rows[1]);
    const uint32_t row = banks_[bank].remember(line >> bank_bits_, rows);
    return row == TreeCache::kNone ? kNone : bank * lines_a_bank_ + row;
  }
  /// Row that the line of a request goes to.
  uint32_t fill_row(uint32_t id) const {
    const uint32_t bank = id >> id_bits_;
    return bank * lines_a_bank_ + banks_[bank].fill_row(id & ((1u << id_bits_) - 1));
  }
  const std::vector<TreeCache>& banks() const { return banks_; }
  const Work& work() const { return work_; }
  CacheWork cache_work() const {
    CacheWork work;
    for (const TreeCache& bank : banks_) work += bank.work();
    work.hits -= popcount(coming_lanes_);  // in the next cycle
    return work;
  }

 private:
  uint32_t bank_of(uint32_t line) const { return line & bank_mask_; }
  uint32_t requester() const { return request_turn_.choose(requesting_); }

  // Each lane for which there are lines takes one, of its banks in rotation.
  void hand_on(uint32_t waited_for, uint32_t room) {
    for (uint32_t bits = waited_for; bits != 0; bits &= bits - 1) {
      const uint32_t lane = lowest(bits);
      uint32_t choices = 0;
      for (uint32_t banks = offering_; banks != 0; banks &= banks - 1)
        choices |= (banks_[lowest(banks)].offer_lane() == lane ? 1u : 0u) << lowest(banks);
      work_.offered_twice += (choices & (choices - 1)) != 0 ? 1 : 0;
      if ((room >> lane & 1) == 0) {
        ++work_.left;
        continue;
      }
      const uint32_t bank = bank_turns_[lane].choose(choices);
      bank_turns_[lane].advance(bank);
      inputs_[bank].offer_taken = true;
    }
  }

  // Each bank chooses a lane, and the first of its wants that go to the bank; then a lane takes the first of its wants
  // with a line that a bank has chosen, for whichever lane. A bank looks up nothing if its lane takes another one and
  // no lane takes its line.
  void look_up(const AllWants& wants, uint32_t wanting, uint32_t ready) {
    taken_lanes_ = 0;
    uint32_t asked = 0;
    for (uint32_t bits = wanting; bits != 0; bits &= bits - 1) {
      const uint32_t lane = lowest(bits);
      for (const LineWant& want : *wants[lane]) {
        const uint32_t valid = want.valid ? 1 : 0;
        asking_[bank_of(want.line)] |= valid << lane;
        asked |= valid << bank_of(want.line);
      }
    }
    uint32_t first = 0, second = 0;  // lanes of which that want is chosen
    for (; asked != 0; asked &= asked - 1) {
      const uint32_t bank = lowest(asked);
      const uint32_t asking = std::exchange(asking_[bank], 0);
      if ((ready >> bank & 1) == 0) continue;
      const uint32_t lane = lane_turns_[bank].choose(asking);
      lane_turns_[bank].advance(lane);
      const LineWants& of = *wants[lane];
      const uint32_t line = of[of[0].valid & (bank_of(of[0].line) == bank) ? 0 : 1].line;
      lookups_[bank].line = line >> bank_bits_;
      lookups_[bank].lanes = 0;
      for (uint32_t bits = asking; bits != 0; bits &= bits - 1) {
        const LineWants& other = *wants[lowest(bits)];
        first |= static_cast<uint32_t>(other[0].valid & (other[0].line == line)) << lowest(bits);
        second |= static_cast<uint32_t>(other[1].valid & (other[1].line == line)) << lowest(bits);
      }
    }
    taken_lanes_ = first | second;
    for (uint32_t bits = taken_lanes_; bits != 0; bits &= bits - 1) {
      const uint32_t lane = lowest(bits), which = ~first >> lane & 1;
      const LineWants& of = *wants[lane];
      work_.both_chosen += (first & second) >> lane & static_cast<uint32_t>(bank_of(of[0].line) != bank_of(of[1].line));
      taken_[lane] = static_cast<uint8_t>(1 + which);
      const LineWant& want = of[which];
      const uint32_t bank = bank_of(want.line);
      looking_ |= 1u << bank;
      TreeCache::Lookup& lookup = lookups_[bank];
      inputs_[bank].lookup = &lookup;
      if (want.prefetch) continue;
      work_.shared += lookup.lanes != 0 ? 1 : 0;
      lookup.lanes |= 1u << lane;
      lookup.slots[lane] = want.slot;
    }
  }

  // A bank that sleeps but for a lookup that hits need not be clocked for it: what comes of it is known.
  void hit_at_once(uint32_t number) {
    const TreeCache::Lookup& lookup = lookups_[number];
    const uint32_t row = banks_[number].hit_at_once(lookup);
    if (row == TreeCache::kNone) return;
    hitting_ |= 1u << number;
    inputs_[number].lookup = nullptr;
    coming_lanes_ |= lookup.lanes;
    for (uint32_t bits = lookup.lanes; bits != 0; bits &= bits - 1)
      all_given_[now_ ^ 1][lowest(bits)] = {lookup.slots[lowest(bits)], number * lines_a_bank_ + row};
  }
  void take_given(uint32_t number) {
    const TreeCache::Given& given = banks_[number].given();
    given_lanes_ |= given.lanes;
    for (uint32_t bits = given.lanes; bits != 0; bits &= bits - 1)
      all_given_[now_][lowest(bits)] = {given.slots[lowest(bits)], number * lines_a_bank_ + given.row};
  }

  uint32_t lines_a_bank_, bank_mask_, bank_bits_ = 0, id_bits_ = 1;
  std::vector<TreeCache> banks_;
  std::vector<TreeCache::Inputs> inputs_;   // [bank] of this cycle
  std::vector<TreeCache::Lookup> lookups_;  // [bank]
  std::vector<RoundRobin> lane_turns_;      // [bank] the lane to choose
  std::vector<RoundRobin> bank_turns_;      // [lane] the bank that offers a line that it has waited for
  RoundRobin request_turn_;
  uint32_t offering_ = 0, requesting_ = 0;     // banks
  std::array<uint32_t, kMostBanks> asking_{};  // lanes; 0 but during look_up()
  uint32_t awake_ = 0, called_ = 0;            // banks that do not sleep, and those with inputs in this cycle
  uint32_t looking_ = 0, ready_ = 0;           // banks that look up a line in this cycle, and that can in the next one
  uint32_t hitting_ = 0;                       // banks that have hit at once in the cycle before
  uint32_t taken_lanes_ = 0;
  std::array<uint8_t, kMostLanes> taken_{};
  // In this cycle, and in the next one of banks that have hit at once.
  using AllGiven = std::array<Given, kMostLanes>;
  std::array<AllGiven, 2> all_given_{};
  uint32_t now_ = 0;  // which are given in this cycle
  uint32_t given_lanes_ = 0, coming_lanes_ = 0;
  Work work_;
};

}  // namespace raypool
