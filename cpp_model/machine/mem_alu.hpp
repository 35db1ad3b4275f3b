// Time of the memory ALU, its data cache and its miss-status holding registers: rtl/mem_alu.v, cycle by cycle, without data. What
// loads and stores do to registers and memory is the functional core's; docs/memory.md gives the rules that both sides follow.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "config/configuration.hpp"
#include "machine/compute_unit.hpp"

namespace raypool {

class MemAlu {
 public:
  static constexpr int kMaxLanes = 32;

  /// A quadword that lanes of a task share. They are looked up together and served together, so it is the unit of all
  /// bookkeeping.
  struct Quadword {
    uint32_t number;  ///< byte address / 16
    Beat data;        ///< store: what it writes
    uint8_t mask;     ///< store: bit i = word i is written
  };
  /// A load or store of a warp, from its issue to its end. Quadwords stand in the order of their lowest lanes.
  struct Task {
    bool store = false;
    FaultCode fault = FaultCode::None;  ///< raised when the first quadword is looked up
    uint32_t count = 0;                 ///< quadwords
    uint32_t left = 0, refused = 0;     ///< of a parked task: bit i = quadword i
    std::array<Quadword, kMaxLanes> quadwords;
  };
  struct Inputs {
    int arriving = -1;  ///< warp whose task arrives in this cycle
    bool response_valid = false;
    uint32_t response_mshr = 0;
    uint32_t response_beat = 0;
    bool request_ready = false;
  };

  explicit MemAlu(const Configuration& configuration);

  void reset();
  /// Forgets all lines; only while idle.
  void invalidate();

  /// The warp's task, to be filled in before it arrives.
  Task& task(uint32_t warp) { return tasks_[warp]; }
  /// Adds a lane's word to the task, lanes in rising order.
  void add_load(Task& task, uint32_t address) { quadword(task, address >> 4); }
  void add_store(Task& task, uint32_t address, uint32_t value);

  // Registers, as they stand in the present cycle.
  bool ready() const { return queued_ == 0; }
  /// False if clock() would change nothing: it need not be called as long as no task and no response arrives.
  bool active() const { return active_; }
  bool idle() const {
    return !pass_.valid && !access_.valid && done_ == 0 && !parking_ && !next_.valid && (queued_ | parked_ | busy_) == 0 &&
           queue_count_ == 0;
  }
  uint32_t done() const { return done_; }  ///< the warp whose task is done in this cycle, as a bit
  FaultCode fault() const { return fault_; }
  uint32_t fault_warp() const { return fault_warp_; }
  bool request_valid() const { return queue_count_ != 0; }
  const MemoryRequest& request() const { return queue_[0]; }
  /// The quadword that is stored in this cycle, if any.
  bool storing(StoreEvent& event) const;

  /// What becomes of the access of this cycle: nothing, or hit, refuses or accepts, or it joins the register `mshr` that
  /// matches, or allocates `mshr`.
  struct Decision {
    bool access = false;
    bool found = false;  ///< its line is in the cache
    bool match = false;
    bool hit = false, allocates = false, refuses = false, accepts = false;
    uint32_t mshr = 0, way = 0;
    bool gone() const { return hit || accepts; }
  };
  Decision decide() const;

  /// Registers as the RTL names them, for reports. What belongs to a valid means something only while it is set.
  struct Registers {
    bool pass, access, park, done, next, privilege, attempt;
    uint32_t pass_warp, access_warp, access_quad, end_warp;
    uint32_t queued, parked, losers, next_kind, next_warp, next_mshr, privilege_warp;
    uint32_t busy, filled, queue_count;
  };
  Registers registers() const;
  uint32_t mshr_line(uint32_t number) const { return mshr_[number].line; }
  uint32_t mshr_waiters(uint32_t number) const { return mshr_[number].waiters; }

  void clock(const Inputs& inputs);

  uint64_t hits() const { return hits_; }
  uint64_t misses() const { return misses_; }
  uint64_t stores() const { return stores_; }
  /// Cycles in which it was not ready().
  uint64_t unready() const { return unready_; }

 private:
  enum class Kind : uint8_t { New, Filled, Loser };
  struct Pass {
    bool valid = false;
    Kind kind = Kind::New;
    uint32_t warp = 0, mshr = 0;
    bool first = false;
    uint32_t pending = 0, left = 0, refused = 0;
  };
  struct Access {
    bool valid = false, any = false, first = false, last = false, store = false;
    Kind kind = Kind::New;
    uint32_t warp = 0, mshr = 0;
    uint32_t served = 0;  // one quadword, as a bit
    uint32_t number = 0;
    int way = -1;  // that has the line, -1: none
    uint32_t left = 0, refused = 0;
  };
  struct Next {
    bool valid = false;
    Kind kind = Kind::New;
    uint32_t warp = 0, mshr = 0;
  };
  struct Refill {
    bool valid = false;
    uint32_t mshr = 0, beat = 0;
  };
  struct Mshr {
    uint32_t line = 0, waiters = 0;
    uint32_t way = 0;
  };
  struct Set {
    std::array<uint32_t, 2> line{};
    std::array<bool, 2> valid{};
    uint8_t older = 0;
  };
  Quadword& quadword(Task& task, uint32_t number);
  Set& set_of(uint32_t line) { return sets_[line & set_mask_]; }
  const Set& set_of(uint32_t line) const { return sets_[line & set_mask_]; }
  Decision access();
  void push(const MemoryRequest& request) { queue_[queue_count_++] = request; }
  void refill();
  void select(Next& next);

  uint32_t set_mask_, mshrs_;
  std::vector<Task> tasks_;
  std::vector<Set> sets_;
  std::array<Mshr, 16> mshr_{};
  uint32_t busy_ = 0, filled_ = 0;  // MSHRs, a bit each

  Pass pass_;
  Access access_;
  Next next_;
  Refill refill_;
  uint32_t left_ = 0, refused_ = 0;
  bool allocated_ = false, parking_ = false;
  uint32_t end_warp_ = 0, done_ = 0;
  FaultCode fault_ = FaultCode::None;
  uint32_t fault_warp_ = 0;

  uint32_t queued_ = 0, parked_ = 0, losers_ = 0;  // warps, a bit each
  bool privilege_ = false, attempt_ = false;
  uint32_t privilege_warp_ = 0;

  std::array<MemoryRequest, 4> queue_{};
  uint32_t queue_count_ = 0;
  bool active_ = false;
  uint64_t hits_ = 0, misses_ = 0, stores_ = 0, unready_ = 0;
};

}  // namespace raypool
