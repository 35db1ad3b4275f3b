#include "traverser/lane.hpp"

#include <algorithm>

namespace raypool::traverser {

namespace {

constexpr uint64_t kGiven = 2;  // cycles from a lookup to its line
constexpr size_t kAhead = 4;    // lines that will be wanted; further ones are forgotten

}  // namespace

Lane::Lane(const ChipConfiguration& chip, uint32_t slots, const StepLatencies& latencies)
    : latencies_(latencies),
      slots_(slots),
      boxes_(chip.modelled_traverser_box_latency),
      triangles_(chip.modelled_traverser_triangle_latency),
      stacks_({slots, chip.modelled_traverser_stack_entries}) {
  for (uint32_t slot = 0; slot < slots; ++slot) free_.push_back(slot);
}

uint32_t Lane::enter(uint64_t cycle, const VisitList& visits, uint64_t setup_latency) {
  const uint32_t index = free_.front();
  free_.pop_front();
  Slot& slot = slots_[index];
  plan(visits, latencies_, slot.steps);
  slot.step = slot.tests = 0;
  slot.least = 0;
  slot.earliest = cycle + setup_latency + (slot.steps.empty() ? latencies_.finish : 1 + slot.steps[0].rest);
  return index;
}

bool Lane::prepared(uint64_t cycle, uint32_t index) {
  if (!ray_ready_) return false;
  ray_ready_ = false;
  stacks_.begin(index);
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
void Lane::go_on(uint64_t cycle, uint32_t index, uint32_t source) {
  if (++slots_[index].step == slots_[index].steps.size()) {
    done_.push_back(index);  // the last entry that it has taken lies behind the best hit too
  } else {
    want(cycle, index, source);
  }
}

// Of the entries that are taken after the visit the last one, or the only one, does not lie behind it.
uint32_t Lane::limit(uint32_t index) const { return stacks_.depth(index) - step(index).taken; }

void Lane::node_visited(uint32_t index) {
  const Step& present = step(index);
  const bool last = slots_[index].step + 1 == slots_[index].steps.size();
  node_result_.slot = index;
  node_result_.children = present.taken > 0 || last ? 0 : present.pushed + 1u;
  node_result_.limit = limit(index);
  const uint32_t depth = stacks_.depth(index);
  for (uint32_t i = 0; i < present.pushed; ++i) node_result_.others[i].key = depth + i;
  deepest_ = std::max(deepest_, depth + present.pushed);
}

// A ray that takes no entry has none, or is a shadow ray that has found a blocker.
void Lane::leaf_visited(uint32_t index) { leaf_result_ = {index, limit(index), step(index).taken == 0}; }

Lane::StackRequest Lane::take_request() {
  request_taken_ = true;
  const LaneStacks::Request& request = stacks_.request();
  if (!request.write) fetched_block_ = request.block;
  return {request.slot, request.write, request.block};
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
  look_ahead(cycle);
  LaneStacks::Inputs inputs;
  if (boxes_.valid(cycle)) {
    node_visited(boxes_.take());
    inputs.node = &node_result_;
  }
  if (triangles_.valid(cycle)) {
    const uint32_t index = triangles_.take();
    if (--slots_[index].tests == 0) {
      leaf_visited(index);
      inputs.leaf = &leaf_result_;
    }
  }
  LaneStacks::Block block;
  if (fill_comes_) {
    for (uint32_t i = 0; i < block.size(); ++i) block[i].key = fetched_block_ * LaneStacks::kBlock + i;
    inputs.filled = &block;
  }
  inputs.request_taken = request_taken_;
  request_taken_ = fill_comes_ = false;

  const LaneStacks::Outcome outcome = stacks_.clock(inputs);
  ray_ready_ = outcome.ray_ready;
  if (outcome.node_goes_on) go_on(cycle, node_result_.slot, 0);
  if (outcome.next) go_on(cycle, outcome.slot, 1);
  if (outcome.done) done_.push_back(outcome.slot);
}

void Lane::add_to(TraverserWork& work) const {
  work.leaves += leaf_visits_;
  work.boxes.tests += box_tests_;
  work.triangles.tests += triangle_tests_;
  work.triangles.waiting += waiting_;
  work.deepest_stack = std::max(work.deepest_stack, deepest_);
  work.stack_spills += stacks_.work().spilled;
  work.stack_fills += stacks_.work().fetched;
}

}  // namespace raypool::traverser
