// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The signals of a compute unit that the inspection reads. sim/rtl/probes.vlt keeps them readable in the Verilated RTL.
#pragma once

#include <string>

#include "lockstep/wire.hpp"

// Instance below the compute unit, and its signals.
// clang-format off
#define RAYPOOL_UNIT_WIRES(X) \
  X(start) X(start_pc) X(start_lanes) X(active) X(threads) X(block) X(blocks) X(waiting_launch) X(busy_o) \
  X(kernel_done_o) X(fetch_request) X(fetch_first) X(fetch_grant) X(fetch_pc) X(lookup_pc) X(fetch_valid) \
  X(fetch_warp) X(instruction_hit) X(instruction_miss) X(result_warp) X(fetched) X(refill_done) \
  X(instruction_request) X(instruction_request_address) X(want) X(wanted_type) X(grant) X(predicate_x) \
  X(predicate_b) X(operand_a) X(operand_b) X(operand_c) X(ready) X(instance_grant) X(done_valid) \
  X(done_warp) X(done_data) X(done_predicate) X(data_request) X(data_request_write) X(data_request_address) \
  X(data_request_data) X(data_request_mask) X(data_request_id) X(mem_fault) X(ray_fault) X(warp_fault) \
  X(import_active) X(memory_request_valid_o) X(memory_request_write_o) X(memory_request_address_o) \
  X(memory_request_data_o) X(memory_request_mask_o) X(memory_request_id_o) X(memory_response_valid_i) \
  X(import_request_valid_o) X(export_valid_o) X(export_data_o) X(export_last_o) X(frame_valid_o) \
  X(frame_pixel_o) X(frame_color_o) X(launch_ready_o) X(fault_valid_o) X(fault_code_o) X(fault_warp_o) \
  X(fault_pc_o) X(retire_valid_o) X(retire_pc_o) X(retire_instruction_o) X(retire_mask_o) X(retire_data_o)
#define RAYPOOL_PC_STACK_WIRES(X) \
  X(step_i) X(pc_valid_o) X(pc_o) X(jump_i) X(push_i) X(push_return_i) X(pop_i) X(target_i) X(end_i) X(return_i) \
  X(overflow_o) X(underflow_o) X(top_q)
#define RAYPOOL_TASK_WIRES(X) \
  X(task_valid_o) X(task_warp_o) X(task_operation_o) X(task_mask_o) X(task_operand_a_o) X(task_operand_b_o) \
  X(task_operand_c_o) X(task_immediate_o) X(task_word_o) X(task_predicate_x_o) X(task_predicate_b_o)
#define RAYPOOL_MEM_WIRES(X) \
  X(pass_q) X(pass_warp_q) X(access_valid_q) X(access_warp_q) X(access_served_q) X(access_word_q) X(done_q) \
  X(park_q) X(end_warp_q) X(access) X(hit) X(allocates) X(refuses) X(accepts) X(quad_data) X(queue_count)
#define RAYPOOL_CACHE_WIRES(X) \
  X(quad_q) X(found) X(match) X(victim) X(push_id_o)
#define RAYPOOL_MISS_WIRES(X) \
  X(busy_q) X(filled_q) X(line_q) X(waiters_q)
#define RAYPOOL_SEQUENCER_WIRES(X) \
  X(queued_q) X(parked_q) X(loser_q) X(privilege_q) X(privilege_warp_q) X(attempt_q) X(next_valid_q) \
  X(next_kind_q) X(next_warp_q) X(next_mshr_q)
#define RAYPOOL_RAY_WIRES(X) \
  X(input_q) X(current_q) X(output_q) X(hold_q) X(step_q) X(full) X(busy) X(parked_in_q) X(parked_out_q) \
  X(import_write) X(import_set) X(import_thread) X(import_word) X(import_mask) X(import_data)
// clang-format on

namespace raypool::lockstep {

/// Signals of one instance.
struct Wires {
  std::string missing;  ///< the first that is not there
  void find(const ComputeUnit& unit, const std::string& scope, const char* name, Wire& wire) {
    wire = Wire(unit, scope, name);
    if (!wire.present() && missing.empty()) missing = scope + "." + name;
  }
};

#define RAYPOOL_MEMBER(name) Wire name;
#define RAYPOOL_FIND(name) find(unit, scope, #name, name);
#define RAYPOOL_WIRES(Name, LIST)                                                  \
  struct Name : Wires {                                                            \
    LIST(RAYPOOL_MEMBER)                                                           \
    Name(const ComputeUnit& unit, const std::string& scope) { LIST(RAYPOOL_FIND) } \
  };
RAYPOOL_WIRES(UnitWires, RAYPOOL_UNIT_WIRES)
RAYPOOL_WIRES(PcStackWires, RAYPOOL_PC_STACK_WIRES)
RAYPOOL_WIRES(TaskWires, RAYPOOL_TASK_WIRES)
RAYPOOL_WIRES(MemWires, RAYPOOL_MEM_WIRES)
RAYPOOL_WIRES(CacheWires, RAYPOOL_CACHE_WIRES)
RAYPOOL_WIRES(MissWires, RAYPOOL_MISS_WIRES)
RAYPOOL_WIRES(SequencerWires, RAYPOOL_SEQUENCER_WIRES)
RAYPOOL_WIRES(RayWires, RAYPOOL_RAY_WIRES)
#undef RAYPOOL_WIRES
#undef RAYPOOL_FIND
#undef RAYPOOL_MEMBER

}  // namespace raypool::lockstep
