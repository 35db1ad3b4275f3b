// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Looks inside the RTL, block by block, so that a report can name the file to look at: each block of a compute unit
// must do with its inputs, which are the RTL's own, what its rule or the model does. It never fails a run by itself:
// what a user sees of the machine is what must agree, and what differs inside first only shows where to look.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "config/configuration.hpp"
#include "lockstep/mismatch.hpp"
#include "lockstep/pc_stack_rule.hpp"
#include "lockstep/unit_wires.hpp"
#include "machine/compute/block_scheduler.hpp"
#include "machine/compute/compute_unit.hpp"
#include "machine/compute/cycle_unit.hpp"
#include "machine/compute/import_arbiter.hpp"
#include "machine/compute/instruction_cache.hpp"
#include "machine/compute/port_arbiter.hpp"
#include "machine/compute/unit_memory_arbiter.hpp"

namespace raypool::lockstep {

/// What a unit is given at its ports at the end of a cycle.
struct UnitTransfers {
  bool launch = false;
  LaunchCommand command;
  bool request_ready = false;
  bool response = false;
  uint32_t response_id = 0, response_beat = 0;
  bool import_beat = false;
  Beat beat{};
};

/// Number of the first ALU instance of a type: they stand by type, in the order of the types' numbers.
uint32_t first_instance(const Configuration& configuration, AluType type);

/// One compute unit.
class UnitInspection {
 public:
  /// `rtl` and `model` must outlive it. Inactive if the RTL lacks a signal.
  UnitInspection(const Configuration& configuration, const ComputeUnit& rtl, const CycleUnit& model, uint32_t unit);

  bool active() const { return missing_.empty(); }
  const std::string& missing() const { return missing_; }  ///< the signal that the RTL lacks
  const UnitWires& wires() const { return w_; }

  void reset(uint32_t program_length);
  void argument_written();
  /// The end of a cycle, before RTL and model are clocked.
  void advance(const UnitTransfers& given);
  /// The cycle after it. At most three findings, all of the first cycle that has any.
  void check();
  const std::vector<Finding>& findings() const { return findings_; }

 private:
  static constexpr size_t kMostFindings = 3;
  static constexpr uint32_t kRing = 64;  // more cycles than the deepest ALU has stages
  struct Instance {
    uint32_t type = 0;
    bool piped = false;  // done a fixed number of cycles after its task
    uint32_t latency = 1, depth = 1;
    uint64_t ready_from = 0;                  // cycle
    uint32_t task = 0;                        // warp with its task in the task register
    const CycleUnit::Issue* issue = nullptr;  // that task
    std::array<uint8_t, kRing> under_way{};   // [cycle % kRing] warp that is to be done
  };
  struct Port {  // what the memory port is to show
    bool valid = false, write = false;
    uint32_t address = 0, id = 0, mask = 0;
    Beat data{};
  };

  void find(const char* files, std::string text);
  /// A finding unless the two are equal.
  void expect(uint32_t rtl, uint32_t expected, const char* files, const char* what);
  uint32_t warp_field(const Wire& wire, uint32_t index) const { return wire.bits(index * warp_bits_, warp_bits_); }

  void advance_fetch(const UnitTransfers& given);
  void advance_memory_port(const UnitTransfers& given);
  void advance_instances();
  void advance_pc_stacks();
  void check_pc_stacks();
  void check_launch();
  void check_memory_port();
  void check_faults();
  std::string subnormal_files(uint32_t warp) const;
  void check_instruction_cache();
  void check_fetch();
  void check_fetch_arbiter();
  void check_wants();
  void check_operands(uint32_t warp);
  void check_tasks();
  void check_task(uint32_t instance, uint32_t warp, const CycleUnit::Issue& issue);
  void check_ready();
  void check_dispatch();
  void check_done();
  void check_result(uint32_t instance, uint32_t warp);
  void check_retired();
  void check_memory_alu();
  void check_access();
  void check_sequencer();
  void check_miss_status();
  void check_loaded(uint32_t warp);
  void check_ray_alu();
  void check_import();
  void check_ray_ports();

  const CycleUnit* model_;
  Configuration configuration_;
  uint32_t warps_, lanes_, warp_bits_, mshrs_;
  UnitWires w_;
  std::vector<PcStackRule> stacks_;  // [warp]
  std::vector<TaskWires> task_;      // [instance] its task register
  MemWires mem_;
  CacheWires cache_;
  MissWires miss_;
  SequencerWires sequencer_;
  RayWires ray_;
  std::string missing_;
  std::vector<Finding> findings_;
  bool stopped_ = false;  // by a finding or a fault: what follows is its consequence
  bool argument_written_ = false;
  uint64_t now_ = 0;
  uint32_t program_length_ = 0;

  // What is to be in this cycle.
  RoundRobin fetch_turn_;
  InstructionCache instruction_cache_;
  uint32_t requests_ = 0, missed_ = 0, first_ = 0, wants_ = 0;
  uint32_t refilled_ = 0;             // warps that got their line in the cycle before
  uint32_t yielded_ = 0;              // warps of which the instruction buffer has got a PC in the cycle before
  std::vector<uint32_t> yielded_pc_;  // [warp] the last one
  bool lookup_ = false, lookup_hit_ = false;
  uint32_t lookup_warp_ = 0, lookup_pc_ = 0;
  Port port_;
  std::vector<Instance> instances_;
  uint32_t piped_ = 0, paused_ = 0;     // instances that are pipelined; that need a pause between tasks
  uint32_t tasks_ = 0;                  // instances with a task register that is to be valid
  std::array<uint32_t, kRing> done_{};  // [cycle % kRing] instances that are to be done
  uint32_t parked_ = 0;
  uint32_t warp_faults_ = 0;  // of the cycle before
  bool alu_fault_ = false;
  UnitTransfers before_;  // what was given in the cycle before
};

/// The device: its units, and the arbiters around several of them.
class Inspection {
 public:
  Inspection(const Configuration& configuration, const ComputeUnit& rtl, const std::vector<CycleUnit*>& models);

  bool active() const { return units_.front().active(); }
  const std::string& missing() const { return units_.front().missing(); }

  void reset(uint32_t program_length);
  void argument_written();
  void advance(const UnitInputs& inputs);
  void check();
  /// Of the device's arbiters and then of the units; all of one cycle.
  std::vector<Finding> findings() const;

 private:
  void check_arbiters();
  void find(const char* files, const char* text);

  const ComputeUnit* rtl_;
  const std::vector<CycleUnit*>* models_;
  std::vector<UnitInspection> units_;
  std::vector<Finding> findings_;
  BlockScheduler block_scheduler_;
  UnitMemoryArbiter memory_;
  PortArbiter exports_, frames_;
  int intersection_beats_;
  ImportArbiter imports_;
  UnitInputs before_;
};

}  // namespace raypool::lockstep
