#include "machine/compute/mem_alu.hpp"

#include "bits.hpp"

namespace raypool {

void MemAlu::reset() {
  q_ = Registers{};
  cache_.reset();
  sequencer_.reset();
  requests_ = {};
  active_ = false;
}

// ---- Arrival

MemAlu::Quadword& MemAlu::quadword(Task& task, uint32_t address) {
  // Neighbouring lanes mostly share the latest one.
  const uint32_t number = address >> 4;
  for (uint32_t i = task.count; i-- > 0;) {
    if (task.quadwords[i].number == number) return task.quadwords[i];
  }
  Quadword& added = task.quadwords[task.count++];
  added = {number, {}, 0};
  return added;
}

void MemAlu::begin(const Step& step) {
  Task& task = tasks_[step.warp];
  task.inval = step.instruction->opcode == Opcode::Inval;
  task.store = task.inval || step.instruction->opcode == Opcode::St;
  task.fault = step.status == Step::Status::Fault ? step.fault.code : FaultCode::None;
  task.count = 0;
  if (step.store_count != 0) {
    for (uint32_t i = 0; i < step.store_count; ++i) {
      const Step::LaneStore& store = step.stores[i];
      Quadword& quad = quadword(task, store.address);
      const uint32_t word = store.address >> 2 & 3;
      quad.data[word] = store.value;  // the highest lane comes last and wins
      quad.mask = static_cast<uint8_t>(quad.mask | 1u << word);
    }
  } else {
    for (uint32_t lanes = step.mask; lanes != 0; lanes &= lanes - 1) quadword(task, step.addresses[lowest(lanes)]);
  }
}

// ---- What follows from the registers of a cycle

MemAlu::Look MemAlu::look_up(bool response_valid) const {
  const Pass& pass = q_.pass;
  Look look;
  if (!pass.valid) return look;
  // An access cannot stall, so a lookup needs a free request entry beside that of the access of this cycle.
  const bool room = requests_.count() < 2 || (requests_.count() == 2 && !q_.access.valid);
  const bool store_access = q_.access.valid && q_.access.any && q_.access.store;
  const Task& task = tasks_[pass.warp];
  look.look = room && (task.store ? cache_.store_ready(response_valid) : cache_.load_ready(store_access));
  look.served = pass.pending & (0u - pass.pending);
  look.pending_after = pass.pending & ~look.served;
  look.last = look.look && look.pending_after == 0;
  if (look.look) look.illegal = task.fault;
  return look;
}

MemAlu::End MemAlu::gather(const DataCache::Outcome& outcome) const {
  const Access& access = q_.access;
  End end;
  if (!access.valid) return end;
  end.access_end = access.last;
  end.left = (access.first ? access.left : q_.left) & ~(outcome.gone() ? access.served : 0);
  end.refused = (access.first ? access.refused : q_.refused) | (outcome.refuse ? access.served : 0);
  end.allocated = outcome.allocate || (!access.first && q_.allocated);
  return end;
}

bool MemAlu::storing(StoreEvent& event) const {
  if (!q_.access.store || !access().stores()) return false;
  const Quadword& quad = tasks_[q_.access.warp].quadwords[lowest(q_.access.served)];
  event.warp = q_.access.warp;
  event.address = quad.number << 4;
  event.data = quad.data;
  event.mask = quad.mask;
  return true;
}

// ---- The end of a cycle

MemAlu::Events MemAlu::clock(const Inputs& inputs) {
  const MemorySequencer::Registers next = sequencer_.registers();
  const Look look = look_up(inputs.response_valid);
  const DataCache::Outcome outcome = access();
  const End end = gather(outcome);
  const bool free_after = !q_.pass.valid || look.last;
  // A pass that continues a task brings its partial result back, so no other task's may be under way.
  const bool take = next.next_valid && (next.next_kind == Kind::New ? free_after : !q_.pass.valid && !q_.access.valid);
  const bool start = inputs.arriving >= 0 && free_after && !next.next_valid && sequencer_.queue_empty();

  clock_sequencer(inputs, end, start, take);
  requests_.clock(inputs.request_ready);
  if (outcome.push()) push(outcome);
  const bool first_try = outcome.access && !q_.access.store && q_.access.kind == Kind::New;
  const Events events{first_try && outcome.hit, first_try && !outcome.hit, outcome.stores()};
  clock_cache(inputs, look, outcome);
  clock_end(end);
  clock_access(look);
  q_.fault = look.illegal;
  q_.fault_warp = q_.pass.warp;

  if (take) {
    take_pass(next);
  } else if (start) {
    start_pass(static_cast<uint32_t>(inputs.arriving));
  } else if (look.look) {
    q_.pass.first = false;
    q_.pass.pending = look.pending_after;
    if (look.last || look.illegal != FaultCode::None) q_.pass.valid = false;
  }
  active_ = q_.pass.valid || q_.access.valid || q_.done || q_.park || requests_.valid() ||
            q_.fault != FaultCode::None || cache_.active() || sequencer_.active();
  return events;
}

void MemAlu::clock_sequencer(const Inputs& inputs, const End& end, bool start, bool take) {
  MemorySequencer::Inputs in;
  in.queue = inputs.arriving >= 0 && !start;
  in.queue_warp = static_cast<uint32_t>(inputs.arriving);
  in.park = q_.park;
  in.park_warp = q_.end_warp;
  in.pass_end = end.access_end;
  in.pass_warp = q_.access.warp;
  in.pass_refused = end.refused != 0;
  in.pass_allocated = end.allocated;
  in.freed = cache_.miss_status().freed();
  in.next_take = take;
  sequencer_.clock(in, sequencer_.select(cache_.miss_status().registers()));
}

void MemAlu::push(const DataCache::Outcome& outcome) {
  MemoryRequest request;
  request.address = cache_.push_quad(outcome) << 4;
  if (outcome.stores()) {
    const Quadword& quad = tasks_[q_.access.warp].quadwords[lowest(q_.access.served)];
    request.write = true;
    request.data = quad.data;
    request.mask = quad.mask;
  } else {
    request.id = static_cast<uint8_t>(outcome.push_id);
  }
  requests_.push(request);
}

void MemAlu::clock_cache(const Inputs& inputs, const Look& look, const DataCache::Outcome& outcome) {
  DataCache::Inputs in;
  in.lookup = look.look && look.served != 0;
  if (in.lookup) in.lookup_quad = tasks_[q_.pass.warp].quadwords[lowest(look.served)].number;
  in.response_valid = inputs.response_valid;
  in.response_id = inputs.response_id;
  in.response_beat = inputs.response_beat;
  in.access_warp = in.served_warp = q_.access.warp;
  in.served = q_.access.valid && q_.access.last && q_.access.kind == Kind::Filled;
  in.served_id = q_.access.mshr;
  cache_.clock(in, outcome);
}

// Results gather over the accesses of a pass; after the last one the warp is done, or parked with what it has.
void MemAlu::clock_end(const End& end) {
  if (q_.park) {
    tasks_[q_.end_warp].left = q_.left;
    tasks_[q_.end_warp].refused = q_.refused;
  }
  q_.done = end.access_end && end.left == 0;
  q_.park = end.access_end && end.left != 0;
  if (!q_.access.valid) return;
  q_.end_warp = q_.access.warp;
  q_.left = end.left;
  q_.refused = end.refused;
  q_.allocated = end.allocated;
}

void MemAlu::clock_access(const Look& look) {
  const Pass& pass = q_.pass;
  q_.access.valid = look.look && look.illegal == FaultCode::None;
  if (!q_.access.valid) return;
  q_.access.any = pass.pending != 0;
  q_.access.first = pass.first;
  q_.access.last = look.pending_after == 0;
  q_.access.store = tasks_[pass.warp].store;
  q_.access.inval = tasks_[pass.warp].inval;
  q_.access.kind = pass.kind;
  q_.access.warp = pass.warp;
  q_.access.mshr = pass.mshr;
  q_.access.served = look.served;
  q_.access.left = pass.left;
  q_.access.refused = pass.refused;
}

void MemAlu::take_pass(const MemorySequencer::Registers& next) {
  const Task& task = tasks_[next.next_warp];
  Pass pass{true, true, next.next_kind, next.next_warp, next.next_mshr, 0, task.left, 0};
  switch (next.next_kind) {
    case Kind::New:
      pass.left = pass.pending = task.mask();
      break;
    case Kind::Filled:
      for (uint32_t bits = task.left; bits != 0; bits &= bits - 1) {
        if (task.quadwords[lowest(bits)].number >> 2 == cache_.miss_status().registers().line[next.next_mshr])
          pass.pending |= 1u << lowest(bits);
      }
      pass.refused = task.refused & ~pass.pending;
      break;
    case Kind::Loser:
      pass.pending = task.refused;
      break;
  }
  q_.pass = pass;
}

void MemAlu::start_pass(uint32_t warp) {
  const uint32_t mask = tasks_[warp].mask();
  q_.pass = {true, true, Kind::New, warp, 0, mask, mask, 0};
}

}  // namespace raypool
