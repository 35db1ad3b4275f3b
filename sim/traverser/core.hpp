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
#include "traverser/machine.hpp"
#include "traverser/ray_stacks.hpp"
#include "traverser/ring.hpp"
#include "traverser/steps.hpp"
#include "traverser/test_pipes.hpp"
#include "traverser/tree_memory.hpp"
#include "traverser/work.hpp"

namespace raypool::traverser {

class Core : public Machine, private LookupListener {
 public:
  /// `turns` must outlive it.
  Core(const ChipConfiguration& chip, MemoryTurns& turns);

  bool ready() const override { return !free_.empty(); }
  uint32_t push(const VisitList& visits) override;
  void clock(uint64_t cycle) override;
  bool valid() const override { return finished_; }
  uint32_t slot() const override { return slot_; }
  uint64_t next() const override;
  uint64_t earliest_done(uint64_t now) const override;
  uint64_t line_due() const override { return memory_.next(); }
  uint64_t least_latency() const override { return setup_.latency() + finish_.latency(); }
  uint32_t capacity() const override { return static_cast<uint32_t>(slots_.size()); }
  void remember(const VisitList& places) override;
  TraverserWork work() const override;

 private:
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

  const StepLatencies latencies_;
  const uint64_t memory_latency_;
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
