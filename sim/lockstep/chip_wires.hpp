// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The signals of the traverser that the inspection of a chip reads. sim/rtl/chip_probes.vlt keeps them readable in the
// Verilated RTL.
#pragma once

#include <string>

#include "lockstep/wire.hpp"

// Signals of rtl/traverser/rp_traverser.v, between its blocks, and of rtl/traverser/rp_traverser_lane.v.
// clang-format off
#define RAYPOOL_TRAVERSER_WIRES(X) \
  X(slot_valid) X(slot_of) X(enters) X(enter_grant) X(enter_slot) X(set_valid) X(set_place) X(set_depth) X(set_shadow) \
  X(set_lane) X(set_slot) X(meets) X(origin) X(padded_lower) X(padded_upper) X(inverse) X(limit) X(scale) X(backwards) \
  X(still) X(reciprocal) X(exponent) X(padding) X(limit_key) X(main_axis) X(shear) X(direction) X(node_fault) \
  X(node_fault_reason) X(node_fault_line) X(done_valid) X(done_ready) X(done_slot) X(done_hit) X(done_t) X(done_place) \
  X(node_want) X(node_want_line) X(node_want_slot) X(node_taken) X(node_given) X(node_given_slot) X(node_given_data) \
  X(leaf_want) X(leaf_prefetch) X(leaf_want_line) X(leaf_want_slot) X(leaf_taken) X(leaf_room) X(leaf_waited) \
  X(leaf_given) X(leaf_given_slot) X(leaf_given_data) X(stack_request_valid) X(stack_request_ready) \
  X(stack_request_write) X(stack_request_slot) X(stack_request_block) X(stack_request_entries) X(stack_fill_valid) \
  X(stack_fill_entries) X(test_valid) X(test_ready) X(test_tag) X(test) X(result_valid) X(result_hit) X(result_tag) \
  X(result_number) X(result_t) X(slot_free) X(slot_free_slot) X(node_request_valid) X(node_request_ready) \
  X(node_request_line) X(node_request_id) X(node_fill_valid) X(node_fill_ready) X(node_fill_id) \
  X(triangle_request_valid) X(triangle_request_ready) X(triangle_request_line) X(triangle_request_id) \
  X(triangle_fill_valid) X(triangle_fill_ready) X(triangle_fill_id) X(fill_data) X(port_fault)
#define RAYPOOL_LANE_WIRES(X) \
  X(begin_valid) X(begin_ready) X(begin_slot) X(begin_meets) X(boxes_valid) X(met) X(entry) X(node_valid_q) \
  X(node_slot_q) X(node_limit_q) X(children) X(nearest) X(others) X(goes_on) X(next_valid) X(next_slot) \
  X(next_reference) X(done) X(done_slot) X(leaf_valid) X(leaf_over) X(leaf_limit) X(best_key_valid) \
  X(best_key) X(given_q) X(given_slot_q) X(box_limit) X(test_limit) X(fill_waits)
// clang-format on

namespace raypool::lockstep {

#define RAYPOOL_MEMBER(name) Wire name;
#define RAYPOOL_FIND(name) find(chip, scope, #name, name);
#define RAYPOOL_WIRES(Name, LIST)                                                         \
  struct Name {                                                                           \
    std::string missing; /* the first that is not there */                                \
    LIST(RAYPOOL_MEMBER)                                                                  \
    template <typename Chip>                                                              \
    Name(const Chip& chip, const std::string& scope) {                                    \
      LIST(RAYPOOL_FIND)                                                                  \
    }                                                                                     \
    template <typename Chip>                                                              \
    void find(const Chip& chip, const std::string& scope, const char* name, Wire& wire) { \
      wire = Wire(chip, scope, name);                                                     \
      if (!wire.present() && missing.empty()) missing = scope + "." + name;               \
    }                                                                                     \
  };
RAYPOOL_WIRES(TraverserWires, RAYPOOL_TRAVERSER_WIRES)
RAYPOOL_WIRES(LaneWires, RAYPOOL_LANE_WIRES)
#undef RAYPOOL_WIRES
#undef RAYPOOL_FIND
#undef RAYPOOL_MEMBER

}  // namespace raypool::lockstep
