// Engine `model`: a compute unit that agrees with rtl/compute_unit.v in every cycle: retirements, port transfers, counters,
// faults.
//
// An instruction is executed by the functional core when it leaves the instruction buffer (a warp has one under way at a time, so
// nobody can tell), and from then on only its time is modelled: the cycle in which an ALU will be done is known when it is
// dispatched, and sets of warps are bit masks. So a cycle in which nothing happens costs next to nothing, and one in which
// something does costs that.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "config/configuration.hpp"
#include "machine/compute_unit.hpp"
#include "machine/functional_core.hpp"
#include "machine/instruction_cache.hpp"
#include "machine/mem_alu.hpp"
#include "machine/memory.hpp"
#include "machine/ray_alu.hpp"

namespace raypool {

/// Works on a copy of `memory`, which must outlive it: taken at the first launch after reset() or set_argument(). Its stores go
/// to the copy and leave through the memory port.
class CycleUnit final : public ComputeUnit {
 public:
  CycleUnit(const Configuration& configuration, const Memory& memory);

  void reset(uint32_t program_length, uint32_t memory_limit) override;
  void set_argument(int index, uint32_t value) override;
  const UnitOutputs& outputs() const override { return outputs_; }
  void clock(const UnitInputs& inputs) override;
  uint64_t run(const UnitInputs& inputs, uint64_t cycles) override;
  void trace_on() override { tracing_ = true; }
  const UnitTrace& trace() const override { return trace_; }
  uint64_t counter(int number) override;
  bool timed() const override { return true; }
  std::vector<Fault> faults() const override { return raised_; }

  /// The instruction that a warp has under way or has retired last, with its operands before it. Kept after trace_on() only.
  struct Issue {
    uint32_t pc = 0;
    const DecodedInstruction* instruction = nullptr;
    uint32_t mask = 0;
    std::vector<uint32_t> a, b, c;  ///< one word a lane; c: register rc of instructions that have it
    uint32_t px = 0, pb = 0;
    std::vector<uint32_t> data;  ///< result, one word a lane
    uint32_t predicate = 0;
  };
  const Issue& issue(uint32_t warp) const { return issues_[warp]; }
  /// The warp has been started and has not executed `exit`.
  bool warp_active(uint32_t warp) const { return (active_ >> warp & 1) != 0; }
  /// issue(warp) has not retired.
  bool instruction_under_way(uint32_t warp) const { return (idle_ >> warp & 1) == 0; }
  const FunctionalCore& core() const { return core_; }

  // What goes on inside, for reports.
  uint64_t now() const { return now_; }  ///< cycles clocked
  /// When a warp's instructions get on; kept after trace_on() only.
  struct Timing {
    uint64_t fetch_cycle = 0;  ///< from which on it wants the instruction cache, unless the PC is outside the program
    uint64_t want_cycle = 0;   ///< from which on issue() wants its ALU
    uint32_t fetch_pc = 0;     ///< that it wants from the instruction cache
  };
  const Timing& timing(uint32_t warp) const { return timings_[warp]; }
  bool launch_waits() const { return waiting_; }
  uint32_t active_warps() const { return active_; }
  const MemAlu& mem() const { return mem_; }
  const RayAlu& ray() const { return ray_; }
  int ray_task() const { return ray_task_; }  ///< the warp whose task arrives at the ray ALU in this cycle, or -1

 private:
  static constexpr uint64_t kAhead = 2;  // cycles from IBuf to Dispatch, and from IBuf to IArb
  static constexpr uint32_t kRing = 64;  // cycles ahead for which something can be planned; the deepest ALU has 32 stages
  struct Planned {
    uint32_t retired = 0;    // warps whose instruction is done in this cycle
    uint32_t fetches = 0;    // ... that want the instruction cache from this cycle on
    uint32_t full = 0;       // ... whose next instruction is in the buffer from this cycle on
    uint32_t mem_wants = 0;  // ... that want the memory ALU from this cycle on
    uint32_t ray_wants = 0;
    bool any() const { return (retired | fetches | full | mem_wants | ray_wants) != 0; }
  };
  struct Slots {  // the ALU instances of a type
    uint32_t count = 1, latency = 1, depth = 1;
    std::array<uint64_t, 4> free_at{};  // cycle from which a task may be granted
    uint64_t unready = 0;               // sum over instances of the busy cycles in which they could not take a task
  };
  struct PlannedFault {
    uint64_t cycle;
    Fault fault;
  };

  Planned& planned(uint64_t cycle) { return ring_[cycle % kRing]; }
  void step(const UnitInputs& inputs);
  void step_all(const UnitInputs& inputs);
  void advance_warps(uint32_t retired);
  void advance_rays(const UnitInputs& inputs, ImportKind import);
  uint32_t signals() const;
  void present(uint32_t now);
  void record();
  bool quiet() const;
  void fetch(uint64_t until);
  void dispatch_ahead();
  void dispatch(uint32_t& wants, bool ready, int& task, AluType type);
  void issue_warp(uint32_t warp);
  void begin_memory(uint32_t warp, const Step& step);
  void record_issue(uint32_t warp, const DecodedInstruction& instruction);
  void record_result(uint32_t warp, const Step& step);
  void retire_control(uint32_t warps);
  void plan_fetch(uint32_t warp, uint64_t cycle, bool past_current);
  void take_package_beat(const Beat& beat);
  void start_kernel();
  void raise(const Fault& fault);
  void settle_faults(FaultCode mem_fault, uint32_t mem_warp, bool ray_fault, uint32_t ray_warp);
  void halt();
  void run_changes(bool running);

  static constexpr size_t kWarps = 32;

  int lanes_;
  const Memory* host_memory_;
  Memory memory_;
  bool memory_stale_ = true;
  uint32_t program_length_ = 0;
  FunctionalCore core_;
  MemAlu mem_;
  RayAlu ray_;
  InstructionCache instruction_cache_;

  uint64_t now_ = 0;
  bool attention_ = false;  // the next cycle has more to do than warps, pipelined ALUs and the ray ALU
  bool faulty_ = false;     // an instruction has faulted since the reset
  std::array<Planned, kRing> ring_{};

  // Instruction routine. Sets of warps, a bit each.
  uint32_t active_ = 0;       // started and not yet exited
  uint32_t fetching_ = 0;     // stage IArb
  uint32_t behind_ = ~0u;     // behind the warp that was granted last
  uint32_t first_ = 0;        // granted before all others in the next cycle whose grants become known
  uint64_t fetch_cycle_ = 0;  // up to it, not included, the fetch arbiter's grants are known
  uint64_t miss_cycle_ = 0;   // in which the latest lookup's miss is known, if it was one
  uint32_t lookup_warp_ = 0;
  uint32_t missed_ = 0;  // wait for a line
  uint32_t full_ = 0;    // the next instruction is in the buffer
  std::array<uint32_t, kWarps> fetch_pc_{};

  // Data routine
  uint32_t idle_ = ~0u;                      // no instruction under way
  uint32_t control_ = 0;                     // the instruction under way is a control instruction
  uint32_t want_types_ = 0;                  // pipelined types that warps want
  std::array<uint32_t, kAluTypes> wants_{};  // [type] those warps
  uint32_t mem_wants_ = 0, ray_wants_ = 0;   // warps in stage Dispatch
  std::array<uint32_t, kWarps> pc_{};
  std::array<FaultCode, kWarps> stack_fault_{};  // [warp] of the control instruction under way
  std::array<Slots, kAluTypes> slots_{};
  int mem_task_ = -1, ray_task_ = -1;  // warps whose tasks arrive in this cycle

  // Memory arbiter
  bool request_valid_ = false;
  MemoryRequest request_;

  // Launch
  bool waiting_ = false, running_ = false;
  LaunchCommand waiting_launch_;
  std::array<Beat, kIntersectionBeats> package_{};
  uint32_t package_beats_ = 0;

  Fault fault_;
  std::vector<Fault> raised_;  // in this cycle, or in that of fault_
  std::vector<PlannedFault> planned_faults_;

  uint64_t busy_cycles_ = 0, instructions_ = 0, thread_instructions_ = 0, hits_ = 0, misses_ = 0;
  std::array<uint64_t, kAluTypes> waited_{}, issued_{};
  UnitOutputs outputs_;
  uint32_t signals_ = 0;  // outputs_.signals()
  bool tracing_ = false;
  UnitTrace trace_;
  std::vector<Issue> issues_;
  std::vector<Timing> timings_;
};

}  // namespace raypool
