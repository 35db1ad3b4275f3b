// The traverser as a machine under rules that hardware keeps: equal lanes (lane.hpp), two caches of banks of which each
// looks up one line in a cycle (machine/tree_banks.hpp), and set-up, finish and memory that all share.
//
// A cycle's decisions are made of what registers hold when it begins. Lines that are on their way are bounded by the
// banks' registers, and what waits in a lane by its slots, since a ray waits in one place at a time.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "config/configuration.hpp"
#include "machine/round_robin.hpp"
#include "machine/tree_banks.hpp"
#include "traverser/lane.hpp"
#include "traverser/machine.hpp"
#include "traverser/tree_memory.hpp"

namespace raypool::traverser {

class Lanes : public Machine {
 public:
  /// As many lanes as chip.modelled_traverser.box_pipes. `turns` must outlive it.
  Lanes(const ChipConfiguration& chip, MemoryTurns& turns);

  bool ready() const override;
  uint32_t push(const VisitList& visits) override;
  void clock(uint64_t cycle) override;
  bool valid() const override { return finished_; }
  uint32_t slot() const override { return slot_; }
  uint64_t next() const override;
  uint64_t earliest_done(uint64_t now) const override;
  uint64_t line_due() const override { return memory_.next(); }
  uint64_t least_latency() const override { return setup_.latency() + finish_.latency(); }
  uint32_t capacity() const override { return static_cast<uint32_t>(lanes_.size()) * slots_a_lane_; }
  void remember(const VisitList& places) override;
  TraverserWork work() const override;

 private:
  /// A cache, and what it is told in this cycle.
  struct Cache {
    Cache(uint32_t lines, uint32_t ways, uint32_t mshrs, uint32_t most_banks, uint32_t lanes);
    void add_to(CacheWork& work) const;

    TreeBanks banks;
    std::array<LineWants, TreeBanks::kMostLanes> wanted{};  // by each lane
    TreeBanks::AllWants wants{};                            // where they are
    std::vector<Lane::Offers> offers;                       // [lane] whose lines these are
    uint32_t fill = TreeBanks::kNone;                       // request whose line comes
    bool request_taken = false;
  };

  template <bool nodes>
  void look_up(Cache& cache);
  template <bool nodes>
  void give(Cache& cache);
  void fill();
  bool request(Cache& cache, TreeMemory::Source source);
  bool request_stacks();
  void ask_memory();
  void take_prepared();
  void finish();

  static constexpr uint32_t kEnter = 3;  // cycles of a ray's beats

  uint32_t slots_a_lane_;
  uint64_t cycle_ = 0;
  std::vector<Lane> lanes_;
  uint64_t enters_from_ = 0;
  DelayLine<uint32_t> setup_;
  Ring<uint32_t> prepared_;
  Cache nodes_, triangles_;
  TreeMemory memory_;
  uint32_t source_turn_ = 0;
  RoundRobin stack_turn_, done_turn_, enter_turn_;
  DelayLine<uint32_t> finish_;
  bool finished_ = false;
  uint32_t slot_ = 0;

  uint32_t in_flight_ = 0;
  uint64_t since_ = 0;  // cycle up to which ray_cycles are counted
  TraverserWork work_;
};

}  // namespace raypool::traverser
