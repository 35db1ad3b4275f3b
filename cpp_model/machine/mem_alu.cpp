#include "machine/mem_alu.hpp"

#include <algorithm>

#include "machine/bits.hpp"

namespace raypool {
MemAlu::MemAlu(const Configuration& configuration)
    : set_mask_(static_cast<uint32_t>(configuration.data_cache_bytes) / 128 - 1),
      mshrs_(static_cast<uint32_t>(configuration.data_cache_mshrs)),
      tasks_(static_cast<size_t>(configuration.warps)),
      sets_(set_mask_ + 1) {}

void MemAlu::reset() {
  std::fill(sets_.begin(), sets_.end(), Set{});
  busy_ = filled_ = 0;
  pass_ = Pass{};
  access_ = Access{};
  next_ = Next{};
  refill_ = Refill{};
  parking_ = false;
  done_ = 0;
  fault_ = FaultCode::None;
  queued_ = parked_ = losers_ = 0;
  privilege_ = attempt_ = false;
  privilege_warp_ = 0;
  queue_count_ = 0;
  active_ = false;
  hits_ = misses_ = stores_ = unready_ = 0;
}

void MemAlu::invalidate() {
  for (Set& set : sets_) set.valid = {};
}

MemAlu::Quadword& MemAlu::quadword(Task& task, uint32_t number) {
  // Neighbouring lanes mostly share the latest one.
  for (uint32_t i = task.count; i-- > 0;) {
    if (task.quadwords[i].number == number) return task.quadwords[i];
  }
  Quadword& added = task.quadwords[task.count++];
  added = {number, {}, 0};
  return added;
}

void MemAlu::add_store(Task& task, uint32_t address, uint32_t value) {
  Quadword& quad = quadword(task, address >> 4);
  const uint32_t word = address >> 2 & 3;
  quad.data[word] = value;  // the highest lane comes last and wins
  quad.mask = static_cast<uint8_t>(quad.mask | 1u << word);
}

bool MemAlu::storing(StoreEvent& event) const {
  if (!access_.store || !decide().accepts) return false;
  const Quadword& quad = tasks_[access_.warp].quadwords[lowest(access_.served)];
  event.warp = access_.warp;
  event.address = quad.number << 4;
  event.data = quad.data;
  event.mask = quad.mask;
  return true;
}

MemAlu::Registers MemAlu::registers() const {
  Registers r{};
  r.pass = pass_.valid;
  r.pass_warp = pass_.warp;
  r.access = access_.valid;
  r.access_warp = access_.warp;
  r.access_quad = access_.number;
  r.park = parking_;
  r.done = done_ != 0;
  r.end_warp = end_warp_;
  r.queued = queued_;
  r.parked = parked_;
  r.losers = losers_;
  r.next = next_.valid;
  r.next_kind = static_cast<uint32_t>(next_.kind);
  r.next_warp = next_.warp;
  r.next_mshr = next_.mshr;
  r.privilege = privilege_;
  r.privilege_warp = privilege_warp_;
  r.attempt = attempt_;
  r.busy = busy_;
  r.filled = filled_;
  r.queue_count = queue_count_;
  return r;
}

// What becomes of the quadword in the access stage.
MemAlu::Decision MemAlu::decide() const {
  Decision decision;
  if (!access_.valid || !access_.any) return decision;
  const uint32_t line = access_.number >> 2;
  const Set& set = set_of(line);
  decision.access = true;
  decision.found = access_.way >= 0;
  if (!access_.store && decision.found) {
    decision.hit = true;
    return decision;
  }
  uint32_t locked = 0;
  for (uint32_t bits = busy_; bits != 0; bits &= bits - 1) {
    const uint32_t number = lowest(bits);
    const Mshr& mshr = mshr_[number];
    if ((filled_ >> number & 1) == 0 && mshr.line == line) {
      decision.match = true;
      decision.mshr = number;
      return decision;
    }
    if ((mshr.line & set_mask_) == (line & set_mask_)) locked |= 1u << mshr.way;
  }
  if (access_.store) {
    decision.accepts = true;
    return decision;
  }
  const bool allowed = !privilege_ || privilege_warp_ == access_.warp;
  const uint32_t free = ~busy_ & ((1u << mshrs_) - 1);
  decision.refuses = !allowed || free == 0 || locked == 3;
  if (decision.refuses) return decision;
  decision.allocates = true;
  decision.mshr = lowest(free);
  decision.way = (locked >> set.older & 1) != 0 ? 1u - set.older : set.older;
  return decision;
}

// The access takes miss-status holding registers and pushes requests.
MemAlu::Decision MemAlu::access() {
  const Decision decision = decide();
  if (!decision.access) return decision;
  const uint32_t line = access_.number >> 2;
  const uint32_t bit = 1u << access_.warp;
  if (decision.found) set_of(line).older = static_cast<uint8_t>(access_.way == 0);
  const bool first_try = !access_.store && access_.kind == Kind::New;
  hits_ += first_try && decision.hit;
  misses_ += first_try && !decision.hit;
  stores_ += decision.accepts;
  MemoryRequest request;
  if (decision.match) {
    mshr_[decision.mshr].waiters |= bit;
  } else if (decision.accepts) {
    const Quadword& quad = tasks_[access_.warp].quadwords[lowest(access_.served)];
    request.write = true;
    request.address = quad.number << 4;
    request.data = quad.data;
    request.mask = quad.mask;
    push(request);
  } else if (decision.allocates) {
    mshr_[decision.mshr] = {line, bit, decision.way};
    busy_ |= 1u << decision.mshr;
    request.address = line << 6;
    request.id = static_cast<uint8_t>(decision.mshr);
    push(request);
  }
  return decision;
}

// The beat that waits is written.
void MemAlu::refill() {
  const Mshr& mshr = mshr_[refill_.mshr];
  Set& set = set_of(mshr.line);
  if (refill_.beat == 0) set.valid[mshr.way] = false;
  if (refill_.beat == 3) {
    set.valid[mshr.way] = true;
    set.line[mshr.way] = mshr.line;
    filled_ |= 1u << refill_.mshr;
  }
}

// The pass that is prepared next, if one can be.
void MemAlu::select(Next& next) {
  for (uint32_t bits = filled_; bits != 0; bits &= bits - 1) {
    const uint32_t waiters = mshr_[lowest(bits)].waiters & parked_;
    if (waiters == 0) continue;
    next = {true, Kind::Filled, lowest(waiters), lowest(bits)};
    return;
  }
  if (privilege_ && attempt_ && (losers_ & parked_) >> privilege_warp_ & 1) {
    next = {true, Kind::Loser, privilege_warp_, 0};
  } else if (queued_ != 0) {
    next = {true, Kind::New, lowest(queued_), 0};
  }
}

void MemAlu::clock(const Inputs& inputs) {
  unready_ += queued_ != 0;

  // Everything is worked out from the registers of this cycle; they change at its end, so what is still needed is kept first.
  const bool access_valid = access_.valid;
  const bool store_access = access_valid && access_.any && access_.store;
  const bool load_ready = !refill_.valid && !store_access;
  const bool store_ready = !refill_.valid && !inputs.response_valid;
  const bool room = queue_count_ < 2 || (queue_count_ == 2 && !access_valid);
  const bool look = pass_.valid && room && (tasks_[pass_.warp].store ? store_ready : load_ready);
  const uint32_t served = pass_.pending & (0u - pass_.pending);
  const uint32_t pending_after = pass_.pending & ~served;
  const bool look_last = look && pending_after == 0;
  const FaultCode fault = look ? tasks_[pass_.warp].fault : FaultCode::None;
  const bool free_after = !pass_.valid || look_last;
  const bool take = next_.valid && (next_.kind == Kind::New ? free_after : !pass_.valid && !access_valid);
  const bool arrives = inputs.arriving >= 0;
  const bool start = arrives && free_after && !next_.valid && queued_ == 0;
  uint32_t finished = 0;
  for (uint32_t bits = filled_; bits != 0; bits &= bits - 1) {
    if (mshr_[lowest(bits)].waiters == 0) finished |= 1u << lowest(bits);
  }
  Next selected;
  if (!next_.valid) select(selected);
  const uint32_t losers = losers_;

  // The lookup belongs to the tags of this cycle. No refill beat is written in a cycle with a lookup.
  Access lookup;
  if (look && fault == FaultCode::None) {
    lookup.valid = true;
    lookup.any = pass_.pending != 0;
    lookup.first = pass_.first;
    lookup.last = pending_after == 0;
    lookup.store = tasks_[pass_.warp].store;
    lookup.kind = pass_.kind;
    lookup.warp = pass_.warp;
    lookup.mshr = pass_.mshr;
    lookup.served = served;
    lookup.left = pass_.left;
    lookup.refused = pass_.refused;
    if (lookup.any) {
      lookup.number = tasks_[pass_.warp].quadwords[lowest(served)].number;
      const uint32_t line = lookup.number >> 2;
      const Set& set = set_of(line);
      for (int way = 0; way < 2; ++way) {
        if (set.valid[static_cast<size_t>(way)] && set.line[static_cast<size_t>(way)] == line) lookup.way = way;
      }
    }
  }

  // Requests leave before this cycle's access adds one.
  if (queue_count_ != 0 && inputs.request_ready) {
    --queue_count_;
    for (uint32_t i = 0; i < queue_count_; ++i) queue_[i] = queue_[i + 1];
  }

  // Access, and the end of a pass.
  const bool parking = parking_;
  const uint32_t parking_warp = end_warp_;
  done_ = 0;
  parking_ = false;
  bool pass_end_of_privileged = false;
  if (access_valid) {
    const Decision outcome = access();
    left_ = (access_.first ? access_.left : left_) & ~(outcome.gone() ? access_.served : 0);
    refused_ = (access_.first ? access_.refused : refused_) | (outcome.refuses ? access_.served : 0);
    allocated_ = outcome.allocates || (!access_.first && allocated_);
    end_warp_ = access_.warp;
    if (access_.last) {
      if (left_ == 0) {
        done_ = 1u << end_warp_;
      } else {
        parking_ = true;
        tasks_[end_warp_].left = left_;
        tasks_[end_warp_].refused = refused_;
      }
      losers_ = (losers_ & ~(1u << end_warp_)) | (refused_ != 0 ? 1u << end_warp_ : 0);
      if (access_.kind == Kind::Filled) mshr_[access_.mshr].waiters &= ~(1u << end_warp_);
      pass_end_of_privileged = privilege_ && end_warp_ == privilege_warp_ && allocated_;
    }
  }
  access_ = lookup;

  if (refill_.valid) refill();
  refill_ = {inputs.response_valid, inputs.response_mshr, inputs.response_beat};
  busy_ &= ~finished;
  filled_ &= ~finished;

  // Faults drop the task.
  fault_ = fault;
  fault_warp_ = pass_.warp;

  // What the lookup stage holds next.
  if (take) {
    const Task& task = tasks_[next_.warp];
    pass_.valid = pass_.first = true;
    pass_.kind = next_.kind;
    pass_.warp = next_.warp;
    pass_.mshr = next_.mshr;
    pass_.left = task.left;
    pass_.refused = 0;
    switch (next_.kind) {
      case Kind::New:
        pass_.left = pass_.pending = task.count == 32 ? ~0u : (1u << task.count) - 1;
        break;
      case Kind::Filled:
        pass_.pending = 0;
        for (uint32_t bits = task.left; bits != 0; bits &= bits - 1) {
          if (task.quadwords[lowest(bits)].number >> 2 == mshr_[next_.mshr].line) pass_.pending |= 1u << lowest(bits);
        }
        pass_.refused = task.refused & ~pass_.pending;
        break;
      default:
        pass_.pending = task.refused;
        break;
    }
    next_.valid = false;
  } else if (start) {
    const Task& task = tasks_[static_cast<size_t>(inputs.arriving)];
    const uint32_t all = task.count == 32 ? ~0u : (1u << task.count) - 1;
    pass_ = {true, Kind::New, static_cast<uint32_t>(inputs.arriving), 0, true, all, all, 0};
  } else if (look) {
    pass_.first = false;
    pass_.pending = pending_after;
    if (look_last || fault != FaultCode::None) pass_.valid = false;
  }

  // The sequencer.
  if (arrives && !start) queued_ |= 1u << inputs.arriving;
  if (parking) parked_ |= 1u << parking_warp;
  if (selected.valid) {
    next_ = selected;
    const uint32_t bit = 1u << selected.warp;
    if (selected.kind == Kind::New)
      queued_ &= ~bit;
    else
      parked_ &= ~bit;
    if (selected.kind == Kind::Loser) attempt_ = false;
  }
  if (privilege_) {
    if (finished != 0) attempt_ = true;
    if (pass_end_of_privileged || (losers >> privilege_warp_ & 1) == 0) privilege_ = false;
  } else if (losers != 0) {
    const uint32_t above = losers & ~((2u << privilege_warp_) - 1);
    privilege_ = attempt_ = true;
    privilege_warp_ = lowest(above != 0 ? above : losers);
  }
  active_ = pass_.valid || access_.valid || done_ != 0 || parking_ || refill_.valid || next_.valid || queue_count_ != 0 ||
            (queued_ | filled_ | losers_) != 0 || privilege_ || fault_ != FaultCode::None;
}

}  // namespace raypool
