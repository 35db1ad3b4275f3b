// The memory ALU with its cache, miss-status holding registers, sequencer and request queue: register by register as
// the model has them, and what the access stage makes of them.
#include <fmt/format.h>

#include "bits.hpp"
#include "lockstep/inspection.hpp"

namespace raypool::lockstep {

void UnitInspection::check_memory_alu() {
  constexpr const char* kAlu = "rtl/compute/rp_mem_alu.v";
  const MemAlu& mem = model_->mem();
  // What is idle on both sides needs no closer look.
  if (!mem.active() && (mem_.pass_q.value() | mem_.access_valid_q.value() | sequencer_.next_valid_q.value()) == 0) {
    expect(w_.data_request.value(), 0, kAlu, "memory ALU, request");
    expect(w_.mem_fault.value(), 0, kAlu, "memory ALU, fault");
    return;
  }
  const MemAlu::Registers& r = mem.registers();
  expect(w_.mem_fault.value(), mem.fault() != FaultCode::None, kAlu, "memory ALU, fault");
  check_access();
  check_miss_status();
  check_sequencer();
  expect(mem_.pass_q.value(), r.pass.valid, kAlu, "memory ALU, a pass is looked up");
  if (r.pass.valid) expect(mem_.pass_warp_q.value(), r.pass.warp, kAlu, "memory ALU, warp of the pass");
  expect(mem_.done_q.value(), r.done, kAlu, "memory ALU, done");
  expect(mem_.park_q.value(), r.park, kAlu, "memory ALU, parks a warp");
  if (r.done || r.park) expect(mem_.end_warp_q.value(), r.end_warp, kAlu, "memory ALU, warp at the end of a pass");
  expect(mem_.queue_count.value(), mem.requests().count(),
         "rtl/common/rp_request_queue.v, rtl/compute/rp_memory_arbiter.v, rtl/compute/rp_mem_alu.v",
         "memory ALU, requests that wait");
  if (!mem.request_valid()) return;
  const MemoryRequest& request = mem.request();
  bool same =
      (w_.data_request_write.value() != 0) == request.write && w_.data_request_address.value() == request.address;
  if (request.write) {
    same = same && w_.data_request_mask.value() == request.mask;
    for (uint32_t i = 0; i < kBeatWords; ++i) {
      if ((request.mask >> i & 1) != 0) same = same && w_.data_request_data.word(i) == request.data[i];
    }
  } else {
    same = same && w_.data_request_id.value() == request.id;
  }
  if (!same)
    find("rtl/compute/rp_mem_alu.v, rtl/common/rp_request_queue.v, rtl/compute/rp_data_cache.v",
         "memory ALU: the request is another one");
}

// The access stage: its registers, and the answers of the cache and its miss-status holding registers.
void UnitInspection::check_access() {
  constexpr const char* kAlu = "rtl/compute/rp_mem_alu.v";
  const MemAlu::Access& r = model_->mem().registers().access;
  const DataCache::Outcome outcome = model_->mem().access();
  expect(mem_.access_valid_q.value(), r.valid, kAlu, "memory ALU, an access");
  if (r.valid) expect(mem_.access_warp_q.value(), r.warp, kAlu, "memory ALU, warp of the access");
  expect(mem_.access.value(), outcome.access, kAlu, "memory ALU, an access with lanes");
  if (!outcome.access || mem_.access.value() == 0) return;
  expect(cache_.quad_q.value(), model_->mem().cache().registers().quad, kAlu, "memory ALU, quadword of the access");
  // A line that is still there was perhaps never to be forgotten; one that is missing went elsewhere.
  const bool stays = argument_written_ && cache_.found.value() != 0;
  const char* cache = stays ? "rtl/compute/rp_data_cache.v, rtl/compute/rp_compute_unit.v"
                            : "rtl/compute/rp_data_cache.v, rtl/compute/rp_miss_status.v";
  expect(cache_.found.value(), outcome.found, cache, "data cache, the line is in it");
  if (!outcome.hit)
    expect(cache_.match.value(), outcome.match, "rtl/compute/rp_miss_status.v, rtl/compute/rp_data_cache.v",
           "the line is being fetched");
  if (!findings_.empty()) return;  // what follows is made from these
  const char* status = "rtl/compute/rp_data_cache.v, rtl/compute/rp_miss_status.v";
  expect(mem_.hit.value(), outcome.hit, cache, "data cache, hit");
  expect(mem_.accepts.value(), outcome.accept, status, "data cache, accepts the store");
  expect(mem_.allocates.value(), outcome.allocate, status, "data cache, takes a miss-status holding register");
  expect(mem_.refuses.value(), outcome.refuse, status, "data cache, refuses");
  if (outcome.allocate) {
    expect(cache_.push_id_o.value(), outcome.push_id, "rtl/compute/rp_miss_status.v, rtl/compute/rp_data_cache.v",
           "number of the free register");
    expect(cache_.victim.value(), outcome.victim, status, "way for the line");
  }
  if (outcome.hit) check_loaded(r.warp);
}

// The words that the lanes of a load get from the cache.
void UnitInspection::check_loaded(uint32_t warp) {
  const CycleUnit::Issue& issue = model_->issue(warp);
  if (issue.instruction == nullptr || !issue.instruction->writes_register) return;
  for (uint32_t lanes = mem_.access_served_q.value() & issue.mask; lanes != 0; lanes &= lanes - 1) {
    const uint32_t lane = lowest(lanes);
    const uint32_t word = (issue.operand_a[lane] + issue.instruction->immediate) >> 2 & 3;
    if (mem_.access_word_q.bits(lane * 2, 2) != word)
      return find("rtl/compute/rp_mem_alu.v",
                  fmt::format("memory ALU: lane {} takes another word of the quadword than its address names", lane));
    if (mem_.quad_data.word(word) != issue.data[lane])
      return find("rtl/compute/rp_data_cache.v, rtl/compute/rp_mem_alu.v",
                  fmt::format("data cache: {:08x} for lane {}, memory has {:08x}", mem_.quad_data.word(word), lane,
                              issue.data[lane]));
  }
}

void UnitInspection::check_miss_status() {
  constexpr const char* kFiles = "rtl/compute/rp_miss_status.v, rtl/compute/rp_data_cache.v";
  const MissStatus::Registers& r = model_->mem().cache().miss_status().registers();
  expect(miss_.busy_q.value(), r.busy, kFiles, "miss-status holding registers that are busy");
  expect(miss_.filled_q.value(), r.filled, kFiles, "miss-status holding registers that have their line");
  for (uint32_t busy = r.busy; busy != 0; busy &= busy - 1) {
    const uint32_t number = lowest(busy);
    expect(miss_.line_q.bits(number * 26, 26), r.line[number], kFiles, "miss-status holding register, line");
    expect(miss_.waiters_q.bits(number * warps_, warps_), r.waiters[number], kFiles,
           "miss-status holding register, waiters");
  }
}

void UnitInspection::check_sequencer() {
  constexpr const char* kFiles = "rtl/compute/rp_memory_sequencer.v, rtl/compute/rp_mem_alu.v";
  const MemorySequencer::Registers& r = model_->mem().sequencer().registers();
  expect(sequencer_.queued_q.value(), r.queued, kFiles, "memory sequencer, new tasks");
  expect(sequencer_.parked_q.value(), r.parked, kFiles, "memory sequencer, parked warps");
  expect(sequencer_.loser_q.value(), r.loser, kFiles, "memory sequencer, losers");
  expect(sequencer_.next_valid_q.value(), r.next_valid, kFiles, "memory sequencer, a pass is prepared");
  if (r.next_valid) {
    expect(sequencer_.next_kind_q.value(), static_cast<uint32_t>(r.next_kind), kFiles,
           "memory sequencer, kind of the pass");
    expect(sequencer_.next_warp_q.value(), r.next_warp, kFiles, "memory sequencer, warp of the pass");
    if (r.next_kind == MemorySequencer::Kind::Filled)
      expect(sequencer_.next_mshr_q.value(), r.next_mshr, kFiles, "memory sequencer, register of the pass");
  }
  expect(sequencer_.privilege_q.value(), r.privilege, kFiles, "memory sequencer, privilege");
  if (!r.privilege) return;
  expect(sequencer_.privilege_warp_q.value(), r.privilege_warp, kFiles, "memory sequencer, warp with the privilege");
  expect(sequencer_.attempt_q.value(), r.attempt, kFiles, "memory sequencer, attempt of the privileged warp");
}

}  // namespace raypool::lockstep
