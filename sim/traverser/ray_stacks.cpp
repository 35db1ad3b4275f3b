#include "traverser/ray_stacks.hpp"

#include <algorithm>

namespace raypool::traverser {

void RayStacks::push(uint32_t slot, uint32_t entries) {
  Stack& stack = stacks_[slot];
  stack.here += entries;
  deepest_ = std::max(deepest_, stack.here + stack.blocks * kSpillEntries);
  for (; stack.here > entries_; stack.here -= kSpillEntries) {
    requests_.push_back({slot, true, stack.blocks++});
    ++spills_;
  }
}

bool RayStacks::take(Stack& stack) {
  --stack.here;
  return --stack.to_take == 0;
}

void RayStacks::fetch(uint32_t slot) {
  requests_.push_back({slot, false, --stacks_[slot].blocks});
  ++fills_;
}

bool RayStacks::pop(uint32_t slot, uint32_t entries) {
  Stack& stack = stacks_[slot];
  stack.to_take = entries;
  if (stack.here > 0 && take(stack)) return true;
  if (stack.here > 0) {
    popping_.push_back(slot);
  } else {
    fetch(slot);
  }
  return false;
}

// Only rays that wait for nothing are in popping_.
void RayStacks::clock() {
  done_.clear();
  size_t kept = 0;
  for (const uint32_t slot : popping_) {
    if (take(stacks_[slot])) {
      done_.push_back(slot);
    } else if (stacks_[slot].here > 0) {
      popping_[kept++] = slot;
    } else {
      fetch(slot);
    }
  }
  popping_.resize(kept);
}

RayStacks::Request RayStacks::take_request() {
  const Request request = requests_.front();
  requests_.pop_front();
  return request;
}

void RayStacks::filled(uint32_t slot) {
  stacks_[slot].here += kSpillEntries;
  popping_.push_back(slot);
}

}  // namespace raypool::traverser
