// The traverser as a machine: rays in flight, each of which does one thing after another, and the blocks that all of
// them share. A ray is prepared; then, visit for visit, the lines of a node or leaf are fetched, its tests go through
// the pipes, and its stack says where it goes on; in the end its hit is completed.
//
// What a ray visits is known when it enters (VisitList). Since it does one visit after the other, the order cannot
// depend on the other rays, and only the time is left to be found.
#pragma once

#include <cstdint>
#include <vector>

#include "config/configuration.hpp"
#include "scene/traversal.hpp"
#include "traverser/delay_line.hpp"
#include "traverser/fetch_unit.hpp"
#include "traverser/ray_stacks.hpp"
#include "traverser/ring.hpp"
#include "traverser/test_pipes.hpp"
#include "traverser/tree_memory.hpp"
#include "traverser/work.hpp"

namespace raypool::traverser {

class Core : private LookupListener {
 public:
  /// `turns` must outlive it.
  Core(const ChipConfiguration& chip, MemoryTurns& turns);

  /// A ray may enter, one in a cycle.
  bool ready() const { return !free_.empty(); }
  /// A ray enters in the cycle of the last clock(). Returns its slot.
  uint32_t push(const VisitList& visits);

  /// A cycle, after all earlier ones in which something happens: see next().
  void clock(uint64_t cycle);
  /// A ray is done in the cycle of the last clock(): its slot is free again.
  bool valid() const { return finished_; }
  uint32_t slot() const { return slot_; }

  /// The next cycle in which anything can happen, if no ray enters.
  uint64_t next() const;
  /// The first cycle after `now`, up to which it has been clocked, in which a ray can be done, if none enters.
  uint64_t earliest_done(uint64_t now) const;
  /// Cycles that a ray takes at least.
  uint64_t least_latency() const { return setup_.latency() + finish_.latency(); }

  /// Caches hold the lines of these nodes and leaves, the last of them longest. It takes no time, and is no work.
  void remember(const VisitList& places);

  TraverserWork work() const;

 private:
  /// A line that a ray wants, and what comes after it.
  struct Step {
    uint32_t line = 0;
    uint32_t rest = 0;      // cycles at least, from its lookup until the ray is done
    uint32_t node : 1;      // or a leaf's
    uint32_t taken : 31;    // from the stack, after the visit
    uint8_t tests = 0;      // that can begin with it
    uint8_t more = 0;       // lines of the visit behind it
    uint8_t all_tests = 0;  // of the visit that begins with it; 0: there are lines of the visit before it
    uint8_t pushed = 0;     // on the stack, after the visit
  };
  struct Slot {
    std::vector<Step> steps;
    uint32_t step = 0;   // the present one
    uint32_t rest = 0;   // its
    uint32_t tests = 0;  // of the visit, whose result is to come
  };

  void looked_up(uint32_t slot, uint64_t due) override;
  void take_lines();
  void take_prepared();
  void take_data(FetchUnit& fetch, TestPipes& pipes);
  void take_results(TestPipes& pipes);
  /// The ray begins its present visit, or a further line of it.
  void want(uint32_t slot);
  void visited(uint32_t slot);
  void go_on(uint32_t slot);
  void finish();
  void plan(const VisitList& visits, std::vector<Step>& steps) const;

  const uint64_t cache_latency_, box_latency_, triangle_latency_, memory_latency_;
  std::vector<Slot> slots_;
  // Apart, since all are looked at together. [slot]
  std::vector<uint64_t> earliest_;   // cycle in which its ray can be done; kNever: it has none
  std::vector<uint64_t> from_next_;  // of one that waits for a lookup: cycles from the next one on at least; else 0
  Ring<uint32_t> free_;
  uint32_t in_flight_ = 0;
  uint64_t cycle_ = 0;

  DelayLine<uint32_t> setup_;
  FetchUnit nodes_, triangles_;
  TestPipes box_pipes_, triangle_pipes_;
  RayStacks stacks_;
  TreeMemory memory_;
  Ring<uint32_t> done_;  // visited everything
  DelayLine<uint32_t> finish_;
  bool finished_ = false;
  uint32_t slot_ = 0;

  uint64_t since_ = 0;  // cycle up to which ray_cycles are counted
  TraverserWork work_;
};

}  // namespace raypool::traverser
