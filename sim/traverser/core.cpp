#include "traverser/core.hpp"

#include <algorithm>

namespace raypool::traverser {

namespace {

constexpr uint32_t kLineBytes = 64;

// A node is a line of its cache, whose banks are as wide.
FetchUnit::Setup node_fetch(const ChipConfiguration& chip) {
  return {chip.modelled_traverser_box_pipes,
          chip.modelled_traverser_cache_latency,
          chip.modelled_traverser_cache_banks,
          chip.modelled_traverser_node_cache_bytes / node_bytes(chip.modelled_traverser_nodes),
          chip.modelled_traverser_node_cache_ways,
          chip.modelled_traverser_node_cache_mshrs};
}

FetchUnit::Setup triangle_fetch(const ChipConfiguration& chip) {
  return {chip.modelled_traverser_triangle_pipes,      chip.modelled_traverser_cache_latency,
          chip.modelled_traverser_cache_banks,         chip.modelled_traverser_triangle_cache_bytes / kLineBytes,
          chip.modelled_traverser_triangle_cache_ways, chip.modelled_traverser_triangle_cache_mshrs};
}

}  // namespace

Core::Core(const ChipConfiguration& chip, MemoryTurns& turns)
    : latencies_(chip, chip.modelled_traverser_cache_latency),
      memory_latency_(chip.memory_latency),
      slots_(chip.modelled_traverser_rays),
      earliest_(slots_.size(), kNever),
      from_next_(slots_.size()),
      setup_(chip.modelled_traverser_setup_latency),
      nodes_(node_fetch(chip)),
      triangles_(triangle_fetch(chip)),
      box_pipes_(chip.modelled_traverser_box_pipes, chip.modelled_traverser_box_latency),
      triangle_pipes_(chip.modelled_traverser_triangle_pipes, chip.modelled_traverser_triangle_latency),
      stacks_(chip.modelled_traverser_rays, chip.modelled_traverser_stack_entries),
      memory_(chip, turns),
      finish_(chip.modelled_traverser_finish_latency) {
  for (uint32_t slot = 0; slot < slots_.size(); ++slot) free_.push_back(slot);
}

uint32_t Core::push(const VisitList& visits) {
  const uint32_t index = free_.front();
  free_.pop_front();
  work_.ray_cycles += (cycle_ - since_) * in_flight_;
  since_ = cycle_;
  ++work_.rays;
  work_.most_rays = std::max(work_.most_rays, ++in_flight_);
  Slot& slot = slots_[index];
  slot.step = 0;
  plan(visits, latencies_, slot.steps);
  stacks_.clear(index);
  earliest_[index] = cycle_ + setup_.latency() + (slot.steps.empty() ? finish_.latency() : 1 + slot.steps[0].rest);
  setup_.push(cycle_, index);
  return index;
}

// The blocks from the far end on: what one gives in a cycle, the next takes in that cycle.
void Core::clock(uint64_t cycle) {
  cycle_ = cycle;
  take_lines();
  if (stacks_.pops()) {
    stacks_.clock();
    for (const uint32_t slot : stacks_.done()) go_on(slot);
  }
  take_results(box_pipes_);
  take_results(triangle_pipes_);
  take_prepared();
  take_data(nodes_, box_pipes_);
  take_data(triangles_, triangle_pipes_);
  box_pipes_.clock(cycle);
  triangle_pipes_.clock(cycle);
  if (box_pipes_.ready(nodes_.on_the_way())) nodes_.clock(cycle, *this);
  if (triangle_pipes_.ready(triangles_.on_the_way())) triangles_.clock(cycle, *this);
  memory_.clock(cycle, nodes_, triangles_, stacks_, *this);
  finish();
}

void Core::take_lines() {
  while (memory_.valid(cycle_)) {
    const TreeMemory::Returned returned = memory_.take();
    switch (returned.source) {
      case TreeMemory::Source::Nodes:
        nodes_.fill(returned.which);
        break;
      case TreeMemory::Source::Triangles:
        triangles_.fill(returned.which);
        break;
      case TreeMemory::Source::Stacks:
        stacks_.filled(returned.which);
        break;
    }
  }
}

void Core::take_prepared() {
  while (setup_.valid(cycle_)) {
    const uint32_t slot = setup_.take();
    if (slots_[slot].steps.empty()) {
      done_.push_back(slot);
    } else {
      want(slot);
    }
  }
}

void Core::take_data(FetchUnit& fetch, TestPipes& pipes) {
  while (fetch.valid(cycle_)) {
    const Fetch data = fetch.take();
    for (uint32_t i = 0; i < data.tests; ++i) pipes.push(cycle_, data.slot);
    if (data.more == 0) continue;
    ++slots_[data.slot].step;
    want(data.slot);
  }
}

void Core::take_results(TestPipes& pipes) {
  while (pipes.valid(cycle_)) {
    const uint32_t slot = pipes.take();
    if (--slots_[slot].tests == 0) visited(slot);
  }
}

// A leaf's lines are wanted one after the other: a triangle may need two.
void Core::want(uint32_t index) {
  Slot& slot = slots_[index];
  const Step& step = slot.steps[slot.step];
  slot.tests += step.all_tests;
  work_.leaves += !step.node && step.all_tests != 0;
  from_next_[index] = slot.rest = step.rest;
  earliest_[index] = cycle_ + 1 + step.rest;
  (step.node ? nodes_ : triangles_).push(cycle_, {index, step.line, step.tests, step.more});
}

// `rest` was counted from a lookup that hits.
void Core::looked_up(uint32_t index, uint64_t due) {
  from_next_[index] = 0;
  if (due == kNever) due = cycle_ + memory_latency_;
  earliest_[index] = due - latencies_.cache + slots_[index].rest;
}

void Core::visited(uint32_t index) {
  Slot& slot = slots_[index];
  const Step& step = slot.steps[slot.step];
  if (step.pushed > 0) stacks_.push(index, step.pushed);
  if (step.taken == 0 || stacks_.pop(index, step.taken)) go_on(index);
}

void Core::go_on(uint32_t index) {
  Slot& slot = slots_[index];
  if (++slot.step == slot.steps.size()) {
    done_.push_back(index);
    return;
  }
  want(index);
}

void Core::finish() {
  if (!done_.empty()) {
    finish_.push(cycle_, done_.front());
    done_.pop_front();
  }
  finished_ = finish_.valid(cycle_);
  if (!finished_) return;
  slot_ = finish_.take();
  earliest_[slot_] = kNever;
  free_.push_back(slot_);
  work_.ray_cycles += (cycle_ - since_) * in_flight_--;
  since_ = cycle_;
}

uint64_t Core::next() const {
  if (!done_.empty() || nodes_.busy() || triangles_.busy() || box_pipes_.busy() || triangle_pipes_.busy() ||
      stacks_.busy())
    return cycle_ + 1;
  return std::min({setup_.next(), nodes_.next(), triangles_.next(), box_pipes_.next(), triangle_pipes_.next(),
                   memory_.next(), finish_.next()});
}

uint64_t Core::earliest_done(uint64_t now) const {
  uint64_t earliest = kNever;
  for (size_t slot = 0; slot < earliest_.size(); ++slot)
    earliest = std::min(earliest, std::max(earliest_[slot], now + 1 + from_next_[slot]));
  return earliest;
}

void Core::remember(const VisitList& places) {
  for (const Visit& place : places) {
    if (place.triangles == 0) {
      nodes_.remember(place.place);
      continue;
    }
    const LineRange lines = lines_of(place);
    for (uint32_t line = 0; line < lines.count; ++line) triangles_.remember(lines.first + line);
  }
}

TraverserWork Core::work() const {
  TraverserWork work = work_;
  work.boxes = box_pipes_.work();
  work.triangles = triangle_pipes_.work();
  work.node_cache = nodes_.work();
  work.triangle_cache = triangles_.work();
  work.deepest_stack = stacks_.deepest();
  work.stack_spills = stacks_.spills();
  work.stack_fills = stacks_.fills();
  memory_.add_to(work);
  return work;
}

}  // namespace raypool::traverser
