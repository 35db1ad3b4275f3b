// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/traverser/rp_lane_stacks.v: the stacks of a lane of the traverser. Of each slot's ray the youngest entries, and
// how many blocks of four older ones are in the memory; the slots that wait for an entry, for room or for a block; and
// what goes to the memory.
//
// Request and fill_waits() hold in a whole cycle. clock() is given what comes in the cycle, and returns what else
// leaves it.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "machine/common/ram_queue.hpp"

namespace raypool {

class LaneStacks {
 public:
  static constexpr uint32_t kBlock = 4;  ///< entries that go to the memory together
  static constexpr uint32_t kLeast = 3;  ///< that there must be room for before a node is tested

  struct Sizes {
    uint32_t slots = 24;
    uint32_t entries = 16;  ///< of a slot, in the RAM; 8 at least
  };
  struct Entry {
    uint32_t key = 0;  ///< of the time at which its box is entered
    uint32_t reference = 0;
  };
  using Block = std::array<Entry, kBlock>;  ///< the oldest first

  /// A node has been tested.
  struct NodeResult {
    uint32_t slot = 0;
    uint32_t children = 0;             ///< that the ray meets
    uint32_t nearest = 0;              ///< reference
    std::array<Entry, kLeast> others;  ///< in the order in which they are put on the stack
    uint32_t limit = 0;                ///< of the key of an entry, when no child is met
  };
  /// All triangles of a leaf have been.
  struct LeafResult {
    uint32_t slot = 0, limit = 0;
    bool over = false;  ///< the ray is done, whatever its stack has
  };
  struct Inputs {
    const NodeResult* node = nullptr;
    const LeafResult* leaf = nullptr;
    bool request_taken = false;     ///< only if request_valid()
    const Block* filled = nullptr;  ///< what was asked for has come
  };
  struct Outcome {
    bool node_goes_on = false;  ///< the node's ray, with the nearest child
    bool next = false;          ///< a ray goes on with `reference`
    bool done = false;          ///< a ray is
    bool ray_ready = true;      ///< a ray may begin
    uint32_t slot = 0;          ///< of next or done
    uint32_t reference = 0;     ///< of next
  };
  struct Request {
    bool write = false;
    uint32_t slot = 0, block = 0;
    Block entries;  ///< of one that writes
  };
  struct Work {
    uint32_t deepest = 0;               ///< entries of a slot, those in the memory too
    uint64_t spilled = 0, fetched = 0;  ///< blocks
    uint64_t dropped = 0;               ///< entries that lay behind the limit
    std::array<uint64_t, 2> popped{};   ///< slots that wanted an entry, after nodes and after leaves
    uint64_t late_fills = 0, late_retries = 0, late_spills = 0;  ///< cycles that one has waited
  };

  explicit LaneStacks(const Sizes& sizes)
      : entries_(sizes.entries),
        capacity_((sizes.entries + kBlock - 1) / kBlock * kBlock),
        ram_(sizes.slots * capacity_),
        stacks_(sizes.slots),
        pops_{RamQueue<Pop>(sizes.slots), RamQueue<Pop>(sizes.slots)},
        spills_(sizes.slots),
        fetches_(sizes.slots) {}

  bool request_valid() const { return request_valid_; }
  const Request& request() const { return request_; }  ///< means something while request_valid()
  bool fill_waits() const { return fill_waits_; }
  const Outcome& outcome() const { return outcome_; }  ///< of the last clock()
  /// Until something comes nothing happens.
  bool sleeps() const {
    const bool fetches = fetches_.valid() & !(fetching_ | request_valid_);
    const uint32_t waiting = pops_[0].size() | pops_[1].size() | spills_.size();
    return (read_.kind == Read::Kind::Nothing) & (waiting == 0) & !(fetches | retry_ | fill_waits_);
  }

  /// A cycle; what it returns stays until the next one.
  const Outcome& clock(const Inputs& inputs) {
    Outcome& now = outcome_;
    now.node_goes_on = now.next = now.done = false;
    now.ray_ready = true;
    if (inputs.request_taken) request_valid_ = false;
    go_on(inputs, now);
    return now;
  }
  /// A ray begins in the cycle of the last clock(), if that was ray_ready: its stack is empty.
  void begin(uint32_t slot) { stacks_[slot] = {}; }

  /// Entries of a slot, those in the memory too.
  uint32_t depth(uint32_t slot) const { return stacks_[slot].here + stacks_[slot].blocks * kBlock; }
  const Work& work() const { return work_; }

 private:
  struct Stack {
    uint32_t here = 0, blocks = 0;  // entries in the RAM; blocks in the memory
  };
  struct Pop {
    uint32_t slot = 0, limit = 0;
    bool over = false;
  };
  struct Spill {
    uint32_t slot = 0, nearest = 0;
  };
  // What the RAM has read in the cycle before.
  struct Read {
    enum class Kind : uint8_t { Nothing, Entry, Spill };
    Kind kind = Kind::Nothing;
    uint32_t slot = 0, limit = 0, nearest = 0;
    Entry entry;
  };

  // A place of a slot's stack, the first one that has ever been in use being 0.
  Entry& entry(uint32_t slot, uint32_t place) {
    while (place >= capacity_) place -= capacity_;
    return ram_[slot * capacity_ + place];
  }

  void go_on(const Inputs& inputs, Outcome& now) {
    pushed_ = false;
    if (inputs.node != nullptr) take_node(*inputs.node, now);
    if (inputs.leaf != nullptr) pops_[1].push({inputs.leaf->slot, inputs.leaf->limit, inputs.leaf->over});

    const Read read = read_;
    read_.kind = Read::Kind::Nothing;
    now.ray_ready = read.kind == Read::Kind::Nothing;
    if (!end_read(read, now)) {
      next_read(now);
    } else {
      work_.late_retries += retry_ ? 1 : 0;
    }
    if (inputs.filled != nullptr) {
      fill_ = *inputs.filled;
      fill_waits_ = true;
    }
    if (fill_waits_ && !pushed_) {
      write_block();
    } else if (fill_waits_) {
      ++work_.late_fills;
    }
    if (!fetching_ && !retry_ && !request_valid_ && fetches_.valid()) begin_fetch();
  }

  void take_node(const NodeResult& node, Outcome& now) {
    if (node.children == 0) {
      pops_[0].push({node.slot, node.limit, false});
      return;
    }
    // There is room for kLeast: what is above those that are put there means nothing.
    pushed_ = node.children > 1;
    Stack& stack = stacks_[node.slot];
    for (uint32_t i = 0; i < kLeast; ++i) entry(node.slot, depth(node.slot) + i) = node.others[i];
    stack.here += node.children - 1;
    work_.deepest = std::max(work_.deepest, depth(node.slot));
    now.node_goes_on = stack.here + kLeast <= entries_;
    if (!now.node_goes_on) spills_.push({node.slot, node.nearest});
  }

  // What the RAM has read. True if the same ray wants another entry.
  bool end_read(const Read& read, Outcome& now) {
    if (read.kind == Read::Kind::Nothing) return false;
    now.slot = read.slot;
    if (read.kind == Read::Kind::Spill) {
      now.next = true;
      now.reference = read.nearest;
      return false;
    }
    if (read.entry.key <= read.limit) {
      now.next = true;
      now.reference = read.entry.reference;
      return false;
    }
    ++work_.dropped;
    if (depth(read.slot) == 0) {
      now.done = true;
      return false;
    }
    read_entry(read.slot, read.limit);
    return true;
  }

  void read_entry(uint32_t slot, uint32_t limit) {
    if (stacks_[slot].here == 0) {
      fetches_.push({slot, limit, false});
      return;
    }
    read_ = {Read::Kind::Entry, slot, limit, 0, entry(slot, depth(slot) - 1)};
    --stacks_[slot].here;
  }

  // A block that has come, a stack that spills, or a slot that wants an entry.
  void next_read(Outcome& now) {
    if (retry_) {
      retry_ = false;
      read_entry(fetch_.slot, fetch_.limit);
      return;
    }
    if (spills_.valid() && !request_valid_) {
      spill(spills_.data());
      spills_.pop();
      return;
    }
    work_.late_spills += spills_.valid() ? 1 : 0;
    const uint32_t from = pops_[pop_turn_].valid() ? pop_turn_ : pop_turn_ ^ 1;
    if (!pops_[from].valid()) return;
    const Pop pop = pops_[from].data();
    const bool ends = pop.over || depth(pop.slot) == 0;
    if (ends && !now.ray_ready) return;
    pops_[from].pop();
    ++work_.popped[from];
    pop_turn_ = from ^ 1;
    if (!ends) {
      read_entry(pop.slot, pop.limit);
      return;
    }
    now.done = true;
    now.slot = pop.slot;
    now.ray_ready = false;
  }

  void spill(const Spill& next) {
    Stack& stack = stacks_[next.slot];
    request_.write = true;
    request_.slot = next.slot;
    request_.block = stack.blocks;
    for (uint32_t i = 0; i < kBlock; ++i) request_.entries[i] = entry(next.slot, stack.blocks * kBlock + i);
    request_valid_ = true;
    ++stack.blocks;
    stack.here -= kBlock;
    read_ = {Read::Kind::Spill, next.slot, 0, next.nearest, {}};
    ++work_.spilled;
  }

  void begin_fetch() {
    fetch_ = fetches_.data();
    fetches_.pop();
    fetching_ = request_valid_ = true;
    request_.write = false;
    request_.slot = fetch_.slot;
    request_.block = --stacks_[fetch_.slot].blocks;
    ++work_.fetched;
  }
  void write_block() {
    Stack& stack = stacks_[fetch_.slot];
    for (uint32_t i = 0; i < kBlock; ++i) entry(fetch_.slot, stack.blocks * kBlock + i) = fill_[i];
    stack.here = kBlock;
    fill_waits_ = fetching_ = false;
    retry_ = true;
  }

  uint32_t entries_, capacity_;
  std::vector<Entry> ram_;     // [slot][place]
  std::vector<Stack> stacks_;  // [slot]
  std::array<RamQueue<Pop>, 2> pops_;
  uint32_t pop_turn_ = 0;
  RamQueue<Spill> spills_;
  RamQueue<Pop> fetches_;
  Read read_;
  Outcome outcome_;
  bool pushed_ = false;  // in this cycle
  Pop fetch_;            // has asked for a block, or got it
  bool fetching_ = false, retry_ = false;
  Block fill_{};
  bool fill_waits_ = false;
  bool request_valid_ = false;
  Request request_;
  Work work_;
};

}  // namespace raypool
