// A lane of the traverser under rules that hardware keeps: slots for rays, a box pipe, a triangle pipe, and their
// stacks in RAMs of one read and one write in a cycle (machine/lane_stacks.hpp). In a cycle it offers each cache at
// most one line to look up, is given at most one line by each, has at most one result of each pipe, and takes at most
// one entry from a stack.
//
// What is put into a queue in a cycle leaves it in a later one, but for a slot that wants an entry of its stack: when
// nothing else does, its read begins in the cycle of its result.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "config/configuration.hpp"
#include "machine/lane_stacks.hpp"
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
  Offers node_offers() const { return offers(nodes_, node_turn_, !fill_comes_ && !stacks_.fill_waits()); }
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

  bool request_valid() const { return stacks_.request_valid() && !request_taken_; }
  StackRequest take_request();
  /// What the slot has asked for has come.
  void filled() { fill_comes_ = true; }

  /// A triangle of the oldest line is begun: before the lane is given another.
  void begin_triangle(uint64_t cycle);
  /// A cycle, after what it is given.
  void clock(uint64_t cycle);

  void add_to(TraverserWork& work) const;

 private:
  static constexpr size_t kLines = 3;  // of leaves that it holds, and that are on their way

  struct Slot {
    std::vector<Step> steps;
    uint32_t step = 0;           // the present one
    uint32_t tests = 0;          // whose result is to come
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
  void go_on(uint64_t cycle, uint32_t slot, uint32_t source);
  uint32_t limit(uint32_t slot) const;
  void node_visited(uint32_t slot);
  void leaf_visited(uint32_t slot);
  void look_ahead(uint64_t cycle);

  StepLatencies latencies_;
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

  // The key of an entry is its place in the stack: so a limit says how many are taken.
  LaneStacks stacks_;
  LaneStacks::NodeResult node_result_;
  LaneStacks::LeafResult leaf_result_;
  bool request_taken_ = false, fill_comes_ = false;  // told to the stacks with the next cycle's results
  uint32_t fetched_block_ = 0;
  bool ray_ready_ = false;
  Ring<uint32_t> done_;

  uint64_t leaf_visits_ = 0, box_tests_ = 0, triangle_tests_ = 0, waiting_ = 0;
  uint32_t deepest_ = 0;
};

}  // namespace raypool::traverser
