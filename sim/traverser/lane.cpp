#include "traverser/lane.hpp"

#include <algorithm>

namespace raypool::traverser {

namespace {

constexpr uint64_t kGiven = 2;  // cycles from a lookup to its line
constexpr size_t kAhead = 4;    // lines that will be wanted; further ones are forgotten

}  // namespace

Lane::Lane(const ChipConfiguration& chip, uint32_t slots, const StepLatencies& latencies)
    : latencies_(latencies),
      entries_(chip.modelled_traverser_stack_entries),
      slots_(slots),
      boxes_(chip.modelled_traverser_box_latency),
      triangles_(chip.modelled_traverser_triangle_latency) {
  for (uint32_t slot = 0; slot < slots; ++slot) free_.push_back(slot);
}

uint32_t Lane::enter(uint64_t cycle, const VisitList& visits, uint64_t setup_latency) {
  const uint32_t index = free_.front();
  free_.pop_front();
  Slot& slot = slots_[index];
  plan(visits, latencies_, slot.steps);
  slot.step = slot.tests = slot.here = slot.blocks = slot.to_take = 0;
  slot.least = 0;
  slot.earliest = cycle + setup_latency + (slot.steps.empty() ? latencies_.finish : 1 + slot.steps[0].rest);
  return index;
}

bool Lane::prepared(uint64_t cycle, uint32_t index) {
  if (stack_wants_) return false;
  stack_wants_ = true;
  if (slots_[index].steps.empty()) {
    done_.push_back(index);
  } else {
    want(cycle, index, 1);
  }
  return true;
}

uint32_t Lane::take_done(uint64_t cycle) {
  const uint32_t index = done_.front();
  done_.pop_front();
  slots_[index].earliest = cycle + latencies_.finish;
  slots_[index].least = 0;
  return index;
}

void Lane::leave(uint32_t index) {
  slots_[index].earliest = kNever;
  free_.push_back(index);
}

uint64_t Lane::earliest_done(uint64_t now) const {
  uint64_t earliest = kNever;
  for (const Slot& slot : slots_) earliest = std::min(earliest, std::max(slot.earliest, now + 1 + slot.least));
  return earliest;
}

Lane::Offers Lane::leaf_offers() const {
  Offers found = offers(leaves_, leaf_turn_, leaf_room());
  if (!ahead_.empty()) found = {&ahead_.front(), found[0]};
  return found;
}

// The first of the queues that are not empty has had its turn.
template <size_t count>
void Lane::offered(std::array<Ring<Want>, count>& queues, uint32_t& turn, const Want* taken) {
  for (uint32_t i = 0; i < count && queues[turn].empty(); ++i) turn = (turn + 1) % count;
  turn = (turn + 1) % count;
  for (Ring<Want>& queue : queues) {
    if (taken != nullptr && !queue.empty() && taken == &queue.front()) {
      queue.pop_front();
      return;
    }
  }
}

void Lane::node_offered(const Want* taken) {
  if (taken != nullptr) slots_[taken->slot].least = step(taken->slot).rest - latencies_.cache;
  offered(nodes_, node_turn_, taken);
}

void Lane::leaf_offered(uint64_t cycle, const Want* taken) {
  if (taken != nullptr && taken->prefetch) {
    const Want want = *taken;
    ahead_.pop_front();
    if (want.more > 0) ahead_.push_back({want.slot, want.line + 1, want.more - 1, true});
    taken = nullptr;
  }
  if (taken != nullptr) {
    slots_[taken->slot].least = step(taken->slot).rest - latencies_.cache;
    asked_.push_back({cycle + kGiven, *taken});
    ++lines_on_way_;
  }
  offered(leaves_, leaf_turn_, taken);
}

void Lane::node_given(uint64_t cycle, uint32_t index) {
  Slot& slot = slots_[index];
  slot.least = 0;
  slot.earliest = cycle + step(index).rest - latencies_.cache;
  boxes_.push(cycle, index);
  ++box_tests_;
}

void Lane::leaf_given(uint64_t cycle, uint32_t index) {
  --lines_on_way_;
  const Step& present = step(index);
  slots_[index].least = 0;
  slots_[index].earliest = cycle + present.rest - latencies_.cache;
  lines_.push_back({index, present.tests});
  if (!asked_.empty() && asked_.front().due == cycle && asked_.front().want.slot == index) asked_.pop_front();
  if (present.more == 0) return;
  ++slots_[index].step;
  want(cycle, index, 2);
}

void Lane::want(uint64_t cycle, uint32_t index, uint32_t source) {
  Slot& slot = slots_[index];
  const Step& present = step(index);
  slot.least = present.rest;
  slot.earliest = cycle + 1 + present.rest;
  const Want want{index, present.line, present.more, false};
  if (present.node) {
    nodes_[source].push_back(want);
  } else {
    slot.tests += present.all_tests;
    leaf_visits_ += present.all_tests != 0;
    leaves_[source].push_back(want);
  }
}

// A ray goes on with the nearest child, or with an entry of its stack.
void Lane::visited(uint64_t cycle, uint32_t index, uint32_t source) {
  Slot& slot = slots_[index];
  const Step& present = step(index);
  slot.to_take = present.taken;
  if (present.pushed > 0) {
    stack_pushed_ = true;
    slot.here += present.pushed;
    deepest_ = std::max(deepest_, slot.here + slot.blocks * kBlock);
  }
  if (present.taken > 0 || slot.step + 1 == slot.steps.size()) {
    pops_[source].push_back(index);
    return;
  }
  ++slot.step;
  if (slot.here + kLeast > entries_) {
    spills_.push_back(index);
  } else {
    want(cycle, index, 0);
  }
}

void Lane::results(uint64_t cycle) {
  if (boxes_.valid(cycle)) visited(cycle, boxes_.take(), 0);
  if (!triangles_.valid(cycle)) return;
  const uint32_t index = triangles_.take();
  if (--slots_[index].tests == 0) visited(cycle, index, 1);
}

void Lane::read_entry(uint32_t index) {
  Slot& slot = slots_[index];
  if (slot.here == 0) {
    fetches_.push_back(index);
    return;
  }
  --slot.here;
  read_ = Read::Entry;
  read_slot_ = index;
}

// What the RAM has read. True if it reads on for the same ray.
bool Lane::end_read(uint64_t cycle, Read read, uint32_t index) {
  if (read == Read::Spill) want(cycle, index, 1);
  if (read != Read::Entry) return false;
  Slot& slot = slots_[index];
  if (--slot.to_take > 0) {  // it lies behind the best hit
    read_entry(index);
    return true;
  }
  if (++slot.step == slot.steps.size()) {
    done_.push_back(index);
  } else {
    want(cycle, index, 1);
  }
  return false;
}

void Lane::next_read() {
  if (retries_) {
    retries_ = false;
    read_entry(fetching_slot_);
    return;
  }
  if (!spills_.empty() && !request_valid_) {
    read_slot_ = spills_.front();
    spills_.pop_front();
    read_ = Read::Spill;
    slots_[read_slot_].here -= kBlock;
    request_valid_ = true;
    request_ = {read_slot_, true, slots_[read_slot_].blocks++};
    ++spilled_;
    return;
  }
  for (uint32_t i = 0; i < 2; ++i) {
    Ring<uint32_t>& queue = pops_[pop_turn_ ^ i];
    if (queue.empty()) continue;
    const uint32_t slot = queue.front();
    // Its stack is empty, or it is a shadow ray that has found a blocker.
    const bool done = slots_[slot].to_take == 0;
    if (done && stack_wants_) return;
    queue.pop_front();
    pop_turn_ ^= i ^ 1;
    if (!done) {
      read_entry(slot);
    } else {
      stack_wants_ = true;
      ++slots_[slot].step;
      done_.push_back(slot);
    }
    return;
  }
}

// The stacks' RAM: what was read in the cycle before, then what is read in this one.
void Lane::stack_port(uint64_t cycle) {
  const Read read = read_;
  read_ = Read::Nothing;
  stack_wants_ = read != Read::Nothing;
  if (!end_read(cycle, read, read_slot_)) next_read();
  if (fill_waits_ && !stack_pushed_) {
    fill_waits_ = fetching_ = false;
    retries_ = true;
    slots_[fetching_slot_].here += kBlock;
  }
  if (!fetching_ && !retries_ && !request_valid_ && !fetches_.empty()) {
    fetching_ = request_valid_ = true;
    fetching_slot_ = fetches_.front();
    fetches_.pop_front();
    request_ = {fetching_slot_, false, --slots_[fetching_slot_].blocks};
    ++fetched_;
  }
}

// A triangle of the oldest line, or what is left of the line is kept.
void Lane::begin_triangle(uint64_t cycle) {
  if (lines_.empty()) return;
  waiting_ += lines_.size() - 1;
  Line& line = lines_.front();
  if (line.tests > 0) {
    triangles_.push(cycle, line.slot);
    ++triangle_tests_;
    --line.tests;
  }
  if (line.tests == 0) lines_.pop_front();
}

// Lines of leaves that have been looked up and were not there: those behind them are asked for at once.
void Lane::look_ahead(uint64_t cycle) {
  if (asked_.empty() || asked_.front().due != cycle) return;
  const Want want = asked_.front().want;
  asked_.pop_front();
  --lines_on_way_;
  if (want.more > 0 && ahead_.size() < kAhead) ahead_.push_back({want.slot, want.line + 1, want.more - 1, true});
}

void Lane::clock(uint64_t cycle) {
  stack_pushed_ = false;
  look_ahead(cycle);
  results(cycle);
  stack_port(cycle);
}

void Lane::add_to(TraverserWork& work) const {
  work.leaves += leaf_visits_;
  work.boxes.tests += box_tests_;
  work.triangles.tests += triangle_tests_;
  work.triangles.waiting += waiting_;
  work.deepest_stack = std::max(work.deepest_stack, deepest_);
  work.stack_spills += spilled_;
  work.stack_fills += fetched_;
}

}  // namespace raypool::traverser
