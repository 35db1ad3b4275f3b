// A lane of the traverser under rules that hardware keeps: slots for rays, a box pipe, a triangle pipe, and their
// stacks in a RAM of one read and one write in a cycle. In a cycle it offers each cache at most one line to look up, is
// given at most one line by each, has at most one result of each pipe, and takes at most one entry from a stack.
//
// What is put into a queue in a cycle leaves it in a later one, but for a slot that wants an entry of its stack: when
// nothing else does, its read begins in the cycle of its result.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "config/configuration.hpp"
#include "traverser/delay_line.hpp"
#include "traverser/ring.hpp"
#include "traverser/steps.hpp"
#include "traverser/work.hpp"

namespace raypool::traverser {

class Lane {
 public:
  Lane(const ChipConfiguration& chip, uint32_t slots, const StepLatencies& latencies);

  /// A line to look up.
  struct Want {
    uint32_t slot = 0, line = 0;
    uint32_t more = 0;      ///< lines of the leaf behind it
    bool prefetch = false;  ///< for nobody
  };
  /// To the memory: four entries of a stack.
  struct StackRequest {
    uint32_t slot;
    bool write;
    uint32_t block;  ///< of this ray
  };

  // ---- Rays

  size_t free_slots() const { return free_.size(); }
  /// A ray enters. Returns its slot.
  uint32_t enter(uint64_t cycle, const VisitList& visits, uint64_t setup_latency);
  /// It is prepared. False: not in this cycle. After clock().
  bool prepared(uint64_t cycle, uint32_t slot);
  bool done_valid() const { return !done_.empty(); }
  /// A ray that has visited everything.
  uint32_t take_done(uint64_t cycle);
  /// Its slot is free.
  void leave(uint32_t slot);
  /// The first cycle after `now` in which a ray can have left.
  uint64_t earliest_done(uint64_t now) const;

  // ---- Caches

  /// Lines that it offers, of which one can be looked up, the first rather; null: none.
  using Offers = std::array<const Want*, 2>;
  Offers node_offers() const { return offers(nodes_, node_turn_, !fill_waits_); }
  Offers leaf_offers() const;
  /// It may be given a further line of a leaf.
  bool leaf_room() const { return lines_.size() + lines_on_way_ < kLines; }
  /// The end of a cycle with offers: that which was looked up, or null.
  void node_offered(const Want* taken);
  void leaf_offered(uint64_t cycle, const Want* taken);
  /// It takes a line of a leaf for which a ray has waited.
  void leaf_taken() { ++lines_on_way_; }
  /// It is given a line, two cycles later.
  void node_given(uint64_t cycle, uint32_t slot);
  void leaf_given(uint64_t cycle, uint32_t slot);

  // ---- Stacks in the memory

  bool request_valid() const { return request_valid_; }
  StackRequest take_request() {
    request_valid_ = false;
    return request_;
  }
  /// What the slot has asked for has come.
  void filled() { fill_waits_ = true; }

  /// A triangle of the oldest line is begun: before the lane is given another.
  void begin_triangle(uint64_t cycle);
  /// A cycle, after what it is given.
  void clock(uint64_t cycle);

  void add_to(TraverserWork& work) const;

 private:
  static constexpr size_t kLines = 3;    // of leaves that it holds, and that are on their way
  static constexpr uint32_t kLeast = 3;  // entries that a stack must have room for before a node is tested
  static constexpr uint32_t kBlock = 4;  // entries that go to the memory together

  struct Slot {
    std::vector<Step> steps;
    uint32_t step = 0;           // the present one
    uint32_t tests = 0;          // whose result is to come
    uint32_t here = 0;           // entries of its stack
    uint32_t blocks = 0;         // and of kBlock that are in the memory
    uint32_t to_take = 0;        // entries
    uint64_t earliest = kNever;  // cycle in which it can be done
    uint64_t least = 0;          // of one that waits: cycles from the next one on
  };
  struct Line {
    uint32_t slot, tests;
  };
  struct Asked {
    uint64_t due;
    Want want;
  };
  // What the RAM has read in the cycle before.
  enum class Read : uint8_t { Nothing, Entry, Spill };

  // The heads of two queues, those of the others later.
  template <size_t count>
  static Offers offers(const std::array<Ring<Want>, count>& queues, uint32_t turn, bool may) {
    Offers offers{};
    size_t found = 0;
    for (uint32_t i = 0; may && i < count && found < offers.size(); ++i) {
      const Ring<Want>& queue = queues[(turn + i) % count];
      if (!queue.empty()) offers[found++] = &queue.front();
    }
    return offers;
  }
  template <size_t count>
  static void offered(std::array<Ring<Want>, count>& queues, uint32_t& turn, const Want* taken);

  const Step& step(uint32_t slot) const { return slots_[slot].steps[slots_[slot].step]; }
  void want(uint64_t cycle, uint32_t slot, uint32_t source);
  void visited(uint64_t cycle, uint32_t slot, uint32_t source);
  void results(uint64_t cycle);
  void look_ahead(uint64_t cycle);
  void stack_port(uint64_t cycle);
  bool end_read(uint64_t cycle, Read read, uint32_t slot);
  void next_read();
  void read_entry(uint32_t slot);

  StepLatencies latencies_;
  uint32_t entries_;
  std::vector<Slot> slots_;
  Ring<uint32_t> free_;

  std::array<Ring<Want>, 2> nodes_;   // from box results; from the stack, and of new rays
  std::array<Ring<Want>, 3> leaves_;  // from box results; from the stack; further lines of leaves
  uint32_t node_turn_ = 0, leaf_turn_ = 0;
  Ring<Want> ahead_;   // lines of leaves that will be wanted
  Ring<Asked> asked_;  // lines of leaves that are given in `due` if they are there
  uint32_t lines_on_way_ = 0;
  Ring<Line> lines_;  // of leaves, whose triangles are tested one in a cycle
  DelayLine<uint32_t> boxes_, triangles_;

  std::array<Ring<uint32_t>, 2> pops_;  // want an entry: after a node, after a leaf
  uint32_t pop_turn_ = 0;
  Ring<uint32_t> spills_;   // go on when four entries have gone to the memory
  Ring<uint32_t> fetches_;  // want some back
  Read read_ = Read::Nothing;
  uint32_t read_slot_ = 0;
  bool stack_pushed_ = false, stack_wants_ = false;  // in this cycle
  bool retries_ = false;                             // the slot whose entries have come back is next
  bool request_valid_ = false;
  StackRequest request_{};
  bool fetching_ = false, fill_waits_ = false;
  uint32_t fetching_slot_ = 0;
  Ring<uint32_t> done_;

  uint64_t leaf_visits_ = 0, box_tests_ = 0, triangle_tests_ = 0, waiting_ = 0, spilled_ = 0, fetched_ = 0;
  uint32_t deepest_ = 0;
};

}  // namespace raypool::traverser
