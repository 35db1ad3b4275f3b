// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Engine `model`: rtl/compute/rp_compute_unit.v, cycle by cycle. It joins the blocks, which are called
// as in the RTL and have a file each.
//
// An instruction is executed by the functional core when it leaves the instruction buffer (a warp has one under way at
// a time, so nothing can observe this), and from then on only its time is modelled: the cycle in which an ALU will be
// done is known when it is dispatched, and sets of warps are bit masks. So a cycle in which nothing happens costs next
// to nothing, and one in which something does costs that.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

#include "config/configuration.hpp"
#include "machine/common/memory.hpp"
#include "machine/compute/compute_unit.hpp"
#include "machine/compute/dispatcher.hpp"
#include "machine/compute/fetch_arbiter.hpp"
#include "machine/compute/functional_core.hpp"
#include "machine/compute/instruction_buffer.hpp"
#include "machine/compute/instruction_cache.hpp"
#include "machine/compute/launcher.hpp"
#include "machine/compute/mem_alu.hpp"
#include "machine/compute/memory_arbiter.hpp"
#include "machine/compute/performance_counters.hpp"
#include "machine/compute/ray_alu.hpp"
#include "machine/compute/timeline.hpp"

namespace raypool {

/// What units of a model load from and store to: a copy of the host's memory, taken at the first launch after reset()
/// or set_argument(). Units see each other's stores at once; in hardware they see them later, so programs that need
/// them wait (docs/machine/memory.md, section 3).
class ModelMemory {
 public:
  /// `host` must outlive it.
  explicit ModelMemory(const Memory& host) : host_(&host) {}

  void host_may_have_written() { stale_ = true; }
  void before_launch() {
    if (stale_) memory_ = *host_;
    stale_ = false;
  }
  Memory& words() { return memory_; }

 private:
  const Memory* host_;
  Memory memory_;
  bool stale_ = true;
};

/// Stores go to the model's memory and leave through the memory port. `unit`: its number among several.
class CycleUnit final : public ComputeUnit {
 public:
  CycleUnit(const Configuration& configuration, std::shared_ptr<ModelMemory> memory, uint32_t unit = 0);
  CycleUnit(const Configuration& configuration, const Memory& host)
      : CycleUnit(configuration, std::make_shared<ModelMemory>(host)) {}

  void reset(uint32_t program_length, uint32_t memory_limit) override;
  void set_argument(uint32_t index, uint32_t value) override;
  const UnitOutputs& outputs() const override { return outputs_; }
  void clock(const UnitInputs& inputs) override;
  uint64_t run(const UnitInputs& inputs, uint64_t cycles) override;
  void trace_on() override { tracing_ = true; }
  void trace_off() override { tracing_ = false; }
  const UnitTrace& trace() const override { return trace_; }
  uint64_t counter(int number) override;
  bool timed() const override { return true; }
  std::vector<Fault> faults() const override { return raised_; }

  /// The instruction that a warp has under way or has retired last, of a triple the oldest such element, with its
  /// operands before it. Kept after trace_on() only.
  struct Issue {
    uint32_t pc = 0;
    const DecodedInstruction* instruction = nullptr;
    uint32_t mask = 0;
    /// A word a lane; operand_c: register rc of instructions that have it.
    std::vector<uint32_t> operand_a, operand_b, operand_c;
    uint32_t predicate_x = 0, predicate_b = 0;
    std::vector<uint32_t> data;  ///< result, one word a lane
    uint32_t predicate = 0;
    bool retired = true;
    uint64_t wanted = 0, issued = 0, granted = 0;  ///< cycles, as in RetireEvent; granted of Mem and Ray only
  };
  const Issue& issue(uint32_t warp) const { return issues_[warp].front(); }
  /// The one that wants its ALU from timing(warp).want_cycle on.
  const Issue& wanting(uint32_t warp) const { return issues_[warp][timings_[warp].wanting]; }
  /// The warp has been started and has not executed `exit`.
  bool warp_active(uint32_t warp) const { return (buffer_.active() >> warp & 1) != 0; }
  /// issue(warp) has not retired.
  bool instruction_under_way(uint32_t warp) const { return buffer_.under_way(warp); }
  const FunctionalCore& core() const { return core_; }

  // What goes on inside, for reports.
  uint64_t now() const { return now_; }  ///< cycles clocked
  /// When a warp's instructions get on; kept after trace_on() only.
  struct Timing {
    uint64_t fetch_cycle = 0;  ///< from which on it wants the instruction cache, unless the PC is outside the program
    uint64_t want_cycle = 0;   ///< from which on wanting() wants its ALU
    size_t wanting = 0;        ///< its place in issues_
    uint32_t fetch_pc = 0;     ///< that it wants from the instruction cache
  };
  const Timing& timing(uint32_t warp) const { return timings_[warp]; }
  const Launcher& launcher() const { return launcher_; }
  bool halted() const { return fault_.code != FaultCode::None; }  ///< by a fault
  uint32_t active_warps() const { return buffer_.active(); }
  /// Warps that go first when ALUs are given in the cycle that begins.
  uint32_t first_warps() const { return older_[1]; }
  const MemAlu& mem() const { return mem_; }
  const RayAlu& ray() const { return ray_; }
  int ray_task() const {
    return dispatcher_.task(AluType::Ray);
  }  ///< the warp with a task that arrives at the ray ALU in this cycle, or -1

 private:
  static constexpr uint64_t kAhead = InstructionBuffer::kAhead;
  struct PlannedFault {
    uint64_t cycle;
    Fault fault;
  };
  struct AluFaults {  // of a cycle
    FaultCode mem = FaultCode::None;
    uint32_t mem_warp = 0;
    bool ray = false;
    uint32_t ray_warp = 0;
  };
  struct MemoryPort {  // what the memory arbiter shows in a cycle
    bool instruction_request = false, instruction_ready = false, instruction_response = false;
    bool data_ready = false, data_response = false;
  };

  // A cycle
  void step(const UnitInputs& inputs);
  bool needs_attention() const;
  MemoryPort clock_memory_arbiter(const UnitInputs& inputs);
  void clock_launcher();
  void count_states();
  void clock_instruction_cache(const UnitInputs& inputs, const MemoryPort& port);
  void clock_mem(const UnitInputs& inputs, const MemoryPort& port);
  void clock_ray(const UnitInputs& inputs, ImportKind import, bool ready);
  void count_ray_waits();
  void count_pauses(bool running);
  uint64_t fetching() const;
  // Warps
  void start_warps(uint32_t warps, const LaunchCommand& launch);
  void plan_fetch(uint32_t warp, uint64_t cycle, bool past_current);
  void fetch(uint64_t until);
  void issue_warp(uint32_t warp);
  const Step& execute(uint32_t warp, const DecodedInstruction& instruction);
  void forget_fault();
  void want(uint32_t warp, const DecodedInstruction& instruction);
  uint32_t end_elements(uint32_t warps);
  void next_load(uint32_t warp);
  void grant_ray(bool ready);
  void retire_control(uint32_t warps);
  // Faults
  void raise(const Fault& fault);
  uint32_t raise_subnormals(uint32_t done);
  void settle_faults();
  void halt();
  // Ports
  bool quiet() const;
  uint64_t counted(int number) const;
  uint32_t signals() const;
  uint32_t signals_but_rays() const;
  void present(uint32_t now);
  void record();
  void record_next_want(uint32_t warps);
  void record_grant(AluType type);
  void record_issue(uint32_t warp, const DecodedInstruction& instruction);
  void record_result(uint32_t warp, const Step& step);

  uint32_t warps_, lanes_, counter_bits_;
  std::shared_ptr<ModelMemory> memory_;
  uint32_t program_length_ = 0;
  FunctionalCore core_;

  Launcher launcher_;
  InstructionBuffer buffer_;
  FetchArbiter fetch_arbiter_;
  InstructionCache instruction_cache_;
  Dispatcher dispatcher_;
  MemAlu mem_;
  RayAlu ray_;
  MemoryArbiter memory_arbiter_;
  PerformanceCounters counters_;

  uint64_t now_ = 0;
  Timeline timeline_;
  bool attention_ = false;    // the next cycle has more to do than warps, pipelined ALUs and the ray ALU
  uint64_t fetch_cycle_ = 0;  // up to it, not included, the fetch arbiter's grants are known
  uint64_t miss_cycle_ = 0;   // in which the latest lookup's miss is known, if it was one
  uint64_t ray_counted_ = 0;  // up to it, not included, the ray ALU's waiting warps are counted

  std::array<uint32_t, 3> older_{};  // launcher_.older() of this cycle and the two before; in front, of this
  // Warps that are counted as not launched, and as having ended.
  uint32_t not_launched_ = 0, ended_ = 0;

  bool faulty_ = false;   // an instruction has faulted since the reset
  AluFaults alu_faults_;  // of this cycle, once faulty_
  Fault fault_;
  std::vector<Fault> raised_;                        // in this cycle, or in that of fault_
  std::vector<PlannedFault> planned_faults_;         // of PCs outside the program
  std::array<FaultCode, kMostWarps> stack_fault_{};  // [warp] of the control instruction under way
  uint32_t met_subnormal_ = 0;                // warps with an instruction under way that has met a subnormal number
  std::array<uint8_t, kMostWarps> met_in_{};  // [warp] in which elements: bit 0 is the next that is done
  // Triples of Mem and Ray: warps that have one, and what is left of it behind the element that is wanted, or done.
  uint32_t triples_ = 0, followed_ = 0;
  std::array<uint8_t, kMostWarps> wants_left_{}, dones_left_{};

  UnitOutputs outputs_;
  uint32_t signals_ = 0;       // outputs_.signals()
  uint32_t rest_signals_ = 0;  // signals_but_rays()
  bool tracing_ = false;
  UnitTrace trace_;
  std::vector<std::deque<Issue>> issues_;  // [warp], the oldest in front; never empty
  std::vector<Timing> timings_;
};

}  // namespace raypool
