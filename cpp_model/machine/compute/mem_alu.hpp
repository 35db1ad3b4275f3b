// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/compute/rp_mem_alu.v, cycle by cycle, without data: the memory ALU around its cache, sequencer and request
// queue. What loads and stores do to registers and memory is the functional core's; docs/machine/memory.md
// gives the rules that both sides follow.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "config/configuration.hpp"
#include "machine/common/request_queue.hpp"
#include "machine/compute/compute_unit.hpp"
#include "machine/compute/data_cache.hpp"
#include "machine/compute/functional_core.hpp"
#include "machine/compute/memory_sequencer.hpp"

namespace raypool {

class MemAlu {
 public:
  using Kind = MemorySequencer::Kind;

  /// A quadword that lanes of a task share. They are looked up together and served together, so it is the unit of all
  /// bookkeeping: where the RTL has a set of lanes, here is one of quadwords.
  struct Quadword {
    uint32_t number;  ///< byte address / 16
    Beat data;        ///< store: what it writes
    uint8_t mask;     ///< store: bit i = word i is written
  };
  /// A load, store or inval of a warp, from its issue to its end. Quadwords stand in the order of their lowest lanes.
  struct Task {
    bool store = false;  ///< or inval
    bool inval = false;
    FaultCode fault = FaultCode::None;  ///< raised when the first quadword is looked up
    uint32_t count = 0;                 ///< quadwords
    uint32_t left = 0, refused = 0;     ///< of a parked task
    std::array<Quadword, kMaxLanes> quadwords;

    uint32_t mask() const { return count == kMaxLanes ? ~0u : (1u << count) - 1; }
  };
  struct Inputs {
    int arriving = -1;  ///< warp with a task that arrives in this cycle
    bool response_valid = false;
    uint32_t response_id = 0, response_beat = 0;
    bool request_ready = false;
  };

  struct Pass {  ///< registers of the lookup stage
    bool valid = false;
    bool first = false;  ///< no lookup of this pass yet
    Kind kind = Kind::New;
    uint32_t warp = 0, mshr = 0;
    uint32_t pending = 0;  ///< to be looked up
    uint32_t left = 0;     ///< not served before this pass
    uint32_t refused = 0;  ///< those of them that this pass does not try and that need an MSHR
  };
  struct Access {  ///< registers of the access stage
    bool valid = false;
    bool any = false;  ///< not the empty pass of an empty mask
    bool first = false, last = false, store = false, inval = false;
    Kind kind = Kind::New;
    uint32_t warp = 0, mshr = 0;
    uint32_t served = 0;
    uint32_t left = 0, refused = 0;
  };
  /// The other registers, named as in the RTL.
  struct Registers {
    Pass pass;
    Access access;
    uint32_t left = 0, refused = 0;  // gathered over the accesses of a pass
    bool allocated = false;
    bool done = false, park = false;
    uint32_t end_warp = 0;
    FaultCode fault = FaultCode::None;
    uint32_t fault_warp = 0;
  };

  explicit MemAlu(const Configuration& configuration) : tasks_(configuration.warps), cache_(configuration) {}

  void reset();
  /// Forgets all lines; only while idle.
  void invalidate() { cache_.invalidate(); }

  /// What a step of the functional core has done is the warp's task, before it arrives.
  void begin(const Step& step);

  // Outputs of the present cycle.
  bool ready() const { return sequencer_.queue_empty(); }
  /// False if clock() would change nothing: it need not be called as long as no task and no response arrives.
  bool active() const { return active_; }
  bool idle() const {
    return !q_.pass.valid && !q_.access.valid && !q_.done && !q_.park && sequencer_.idle() && cache_.idle() &&
           !requests_.valid();
  }
  uint32_t done() const { return uint32_t{q_.done} << q_.end_warp; }  ///< the warp with a task that is done, as a bit
  FaultCode fault() const { return q_.fault; }
  uint32_t fault_warp() const { return q_.fault_warp; }
  bool request_valid() const { return requests_.valid(); }
  const MemoryRequest& request() const { return requests_.data(); }
  /// The quadword that is stored in this cycle, if any.
  bool storing(StoreEvent& event) const;
  /// What becomes of the access of this cycle.
  DataCache::Outcome access() const {
    const Access& in = q_.access;
    return cache_.access({in.valid && in.any, in.store, in.inval, sequencer_.may_allocate(in.warp)});
  }

  const Registers& registers() const { return q_; }
  const DataCache& cache() const { return cache_; }
  const MemorySequencer& sequencer() const { return sequencer_; }
  const RequestQueue<MemoryRequest>& requests() const { return requests_; }

  /// Quadwords of this cycle's access, to be counted.
  struct Events {
    bool hit = false;   ///< load, served at first try
    bool miss = false;  ///< load, left over at first try
    bool store = false;
  };
  Events clock(const Inputs& inputs);

 private:
  struct Look {  // of the lookup stage in a cycle
    bool look = false, last = false;
    FaultCode illegal = FaultCode::None;
    uint32_t served = 0, pending_after = 0;
  };
  struct End {  // what a pass has gathered after the access of a cycle
    bool access_end = false;
    uint32_t left = 0, refused = 0;
    bool allocated = false;
  };

  static Quadword& quadword(Task& task, uint32_t address);
  Look look_up(bool response_valid) const;
  End gather(const DataCache::Outcome& outcome) const;
  void clock_sequencer(const Inputs& inputs, const End& end, bool start, bool take);
  void push(const DataCache::Outcome& outcome);
  void clock_cache(const Inputs& inputs, const Look& look, const DataCache::Outcome& outcome);
  void clock_end(const End& end);
  void clock_access(const Look& look);
  void take_pass(const MemorySequencer::Registers& next);
  void start_pass(uint32_t warp);

  std::vector<Task> tasks_;
  Registers q_;
  DataCache cache_;
  MemorySequencer sequencer_;
  RequestQueue<MemoryRequest> requests_;
  bool active_ = false;
};

}  // namespace raypool
