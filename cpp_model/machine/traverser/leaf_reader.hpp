// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/traverser/rp_leaf_reader.v: the leaves that a lane's rays come to. Which of their lines are wanted from the
// cache, and the triangles in them, one in a cycle.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <vector>

#include "machine/common/late_queue.hpp"
#include "machine/common/ram_queue.hpp"
#include "machine/common/round_robin.hpp"
#include "machine/traverser/line_offers.hpp"
#include "machine/traverser/line_want.hpp"
#include "machine/traverser/tree_lines.hpp"
#include "machine/traverser/triangle_ray.hpp"

namespace raypool {

/// Its owner counts the cycles.
class LeafReader {
 public:
  static constexpr uint32_t kTriangleWords = 11;
  static constexpr uint32_t kLines = 5;                  ///< that it holds, and that are on their way
  static constexpr uint32_t kLastLine = (1u << 26) - 1;  ///< line of a place that lies beyond all lines
  static constexpr uint32_t kAhead = 4;  ///< leaves with lines that will be wanted; further ones are forgotten

  static constexpr size_t kSources = 2;  ///< of starts: nodes; stacks, and a ray's first leaf

  /// Refers to the line, which stays for the cycle.
  struct Given {
    uint32_t slot;
    const TreeLine* line;
  };
  struct Inputs {
    uint32_t taken = 0;            ///< bit i: want i; only if it is there
    bool waited = false;           ///< a line is taken for which a ray has waited; only if room()
    const Given* given = nullptr;  ///< two cycles after its lookup, if the cache has it
    bool triangle_taken = false;   ///< only if there is one

    bool any() const { return (taken != 0) | waited | (given != nullptr) | triangle_taken; }
  };
  struct Test {
    uint32_t slot = 0;
    bool last = false;   ///< of its leaf
    uint32_t place = 0;  ///< of the triangle in the tree
    Triangle triangle{};
    uint32_t material = 0;  ///< the word behind the triangle's number
  };

  explicit LeafReader(uint32_t slots)
      : queues_{LateQueue<LineWant>(slots), LateQueue<LineWant>(slots), LateQueue<LineWant>(slots)},
        pending_(slots),
        kept_(slots) {}

  bool room() const { return held_ < kLines; }
  /// Lines that it wants, if it wants any, of which one can be taken in the cycle, the first rather. They stay where
  /// they are.
  bool wants_any() const { return wants_[0].valid | wants_[1].valid; }
  const LineWants& wants() const { return wants_; }
  /// A triangle's test can begin: test().
  bool test_valid() const { return present_ & (lines_[oldest_].tests != 0); }
  std::optional<Test> test() const {
    if (!test_valid()) return {};
    const Line& line = lines_[oldest_];
    Test test{line.slot, line.leaf.left == 1, line.leaf.place, {}, 0};
    const uint32_t* const first = &line.words[static_cast<size_t>(line.leaf.at + int{kKept})];
    std::memcpy(&test.triangle, first, sizeof test.triangle);
    test.material = first[kTriangleWords - 1];
    return test;
  }
  /// Lines that are offered because they will be wanted, and those that wait for what is kept of the one before.
  uint64_t looked_ahead() const { return looked_ahead_; }
  uint64_t waited_for_kept() const { return waited_for_kept_; }

  /// Before clock(): in this cycle a ray goes on with a leaf, its triangles less one in bits 30:29, the place of the
  /// first one below.
  void start(uint64_t cycle, size_t source, uint32_t slot, uint32_t leaf) { want(cycle, source, slot, Leaf(leaf)); }
  /// The end of a cycle.
  void clock(uint64_t cycle, const Inputs& inputs) {
    if (inputs.any() | (due_[cycle % due_.size()].valid | goes_on(cycle))) work(cycle, inputs);
  }
  /// The same, in which something may happen: of inputs, goes_on(), or what was taken, started or given two cycles ago.
  void work(uint64_t cycle, const Inputs& inputs) {
    const bool leaves = present_ & (lines_[oldest_].tests == static_cast<uint32_t>(inputs.triangle_taken));
    const bool full = ahead_.size() == kAhead;
    const LineWant* const next = next_offer(cycle);
    Due& due = due_[cycle % due_.size()];
    const bool missed = due.valid & (inputs.given == nullptr);
    held_ += uint32_t{inputs.waited} - uint32_t{missed} - uint32_t{leaves};

    // Lines that have been looked up and were not there: those behind them are looked up at once.
    if (missed && due.lines.behind != 0 && !full) ahead_.push({(due.lines.line + 1) & kLastLine, due.lines.behind});
    due.valid = false;
    if (inputs.taken != 0) {
      const LineWant& taken = offers_.wants()[inputs.taken >> 1];
      if (!taken.prefetch) {
        due = {true, {taken.line, static_cast<uint32_t>(pending_[taken.slot].last_word() / 16)}};
        ++held_;
      }
    }
    if (next != nullptr || inputs.taken != 0) offers_.clock(next, inputs.taken);
    take_line(leaves, inputs.triangle_taken);
    if (inputs.given != nullptr) come(cycle, *inputs.given);
    wants_ = offers_.wants();
    for (LineWant& want : wants_) want.valid &= room() | want.prefetch;
  }
  /// Something happens in this cycle, whatever comes.
  bool goes_on(uint64_t cycle) const {
    const bool queued = queues_[0].valid(cycle) | queues_[1].valid(cycle) | queues_[2].valid(cycle);
    const bool waits = test_valid() | (count_ == 0);
    return static_cast<bool>(!waits) | (offers_.ready() & (queued | ahead_.valid()));
  }

 private:
  static constexpr uint32_t kKept = 10;  // last words of a line, that a triangle may begin in

  // What is still to be read of a leaf.
  struct Leaf {
    uint32_t line = 0;   // the next one
    int at = 0;          // where in it the next triangle begins, in words; less than 0: before it
    uint32_t left = 0;   // triangles
    uint32_t place = 0;  // of the first one

    Leaf() = default;
    explicit Leaf(uint32_t leaf) : left((leaf >> 29 & 3) + 1), place(leaf & 0x1fffffff) {
      const uint64_t word = uint64_t{place} * kTriangleWords;
      line = static_cast<uint32_t>(std::min<uint64_t>(word / 16, kLastLine));
      at = static_cast<int>(word % 16);
    }
    int last_word() const { return at + static_cast<int>(kTriangleWords * left) - 1; }
    uint32_t tests() const { return std::min(left, static_cast<uint32_t>(16 - at) / kTriangleWords); }
    Leaf behind(uint32_t tests) const {
      Leaf behind = *this;
      behind.line = (line + 1) & kLastLine;
      behind.at += static_cast<int>(kTriangleWords * tests) - 16;
      behind.left -= tests;
      behind.place += tests;
      return behind;
    }
  };
  struct Behind {
    uint32_t line = 0, behind = 0;
  };
  struct Due {
    bool valid = false;
    Behind lines;
  };
  struct Line {
    uint32_t slot = 0;
    uint32_t tests = 0;  // that are to be begun
    Leaf leaf;
    std::array<uint32_t, kKept + 16> words{};  // what is kept of the line before, once the line is the oldest; its own
  };

  // For the ray of this slot, from the cycle behind the next one on.
  void want(uint64_t cycle, size_t queue, uint32_t slot, const Leaf& leaf) {
    pending_[slot] = leaf;
    queues_[queue].push(cycle, {true, false, static_cast<uint8_t>(slot), leaf.line});
  }

  // Lines that will be wanted, then the queues' heads in rotation: null, or until something is put into a queue.
  const LineWant* next_offer(uint64_t cycle) {
    if (!offers_.ready()) return nullptr;
    if (ahead_.valid()) {
      will_want_ = {true, true, 0, (ahead_.data().line + ahead_step_) & kLastLine};
      ++looked_ahead_;
      if (++ahead_step_ == ahead_.data().behind) {
        ahead_step_ = 0;
        ahead_.pop();
      }
      return &will_want_;
    }
    uint32_t valid = 0;
    for (uint32_t queue = 0; queue < queues_.size(); ++queue) valid |= (queues_[queue].valid(cycle) ? 1u : 0u) << queue;
    if (valid == 0) return nullptr;
    const uint32_t queue = turn_.choose(valid);
    turn_.advance(queue);
    const LineWant* const wanted = &queues_[queue].data();
    queues_[queue].pop();
    return wanted;
  }

  // The present line's triangle is begun, or the line leaves; the next one comes unless it waits for what is kept of
  // it.
  void take_line(bool leaves, bool triangle_taken) {
    Line& line = lines_[oldest_];
    const auto taken = static_cast<uint32_t>(triangle_taken), present = static_cast<uint32_t>(present_);
    line.tests -= taken;
    line.leaf.at += static_cast<int>(kTriangleWords * taken);
    line.leaf.left -= taken;
    line.leaf.place += taken;
    const bool waits = count_ > present;
    const Line& next = lines_[(oldest_ + present) % kPlaces];
    const bool comes = waits & ((present == 0) | (leaves & (next.slot != line.slot)));
    waited_for_kept_ += static_cast<uint64_t>(waits & leaves & !comes);
    if (leaves) {
      if (line.leaf.left != 0) std::copy(line.words.end() - kKept, line.words.end(), kept_[line.slot].begin());
      present_ = false;
      oldest_ = behind(oldest_);
      --count_;
    }
    if (!comes) return;
    present_ = true;
    Line& came = lines_[oldest_];
    std::copy(kept_[came.slot].begin(), kept_[came.slot].end(), came.words.begin());
  }

  // A line that is given comes behind those that are there; the one behind it in memory is wanted if its leaf goes on.
  void come(uint64_t cycle, const Given& given) {
    Line& line = lines_[(oldest_ + count_++) % lines_.size()];
    line.slot = given.slot;
    line.leaf = pending_[given.slot];
    line.tests = line.leaf.tests();
    std::copy(given.line->begin(), given.line->end(), line.words.begin() + kKept);
    if (line.leaf.left > line.tests) want(cycle, 2, line.slot, line.leaf.behind(line.tests));
  }
  static uint32_t behind(uint32_t line) { return (line + 1) % kPlaces; }

  static constexpr uint32_t kPlaces = 8;       // a power of two, for kLines
  std::array<LateQueue<LineWant>, 3> queues_;  // from nodes; from the stack; further lines of leaves
  RoundRobin turn_;                            // which of them
  RamQueue<Behind> ahead_{kAhead};             // the first of so many lines that will be wanted
  uint32_t ahead_step_ = 0;                    // of which so many have been offered
  LineWant will_want_;                         // its line is offered
  LineOffers offers_;
  LineWants wants_{};          // those of them for which there is room
  std::vector<Leaf> pending_;  // [slot] of which a line is wanted, or on its way
  std::array<Due, 2> due_;     // [cycle] in turn: asked for two cycles ago, or one
  std::array<Line, kPlaces> lines_;
  uint32_t oldest_ = 0, count_ = 0;                // of them
  bool present_ = false;                           // the oldest one's triangles are tested
  std::vector<std::array<uint32_t, kKept>> kept_;  // [slot] the last words of its line before
  uint32_t held_ = 0;
  uint64_t looked_ahead_ = 0, waited_for_kept_ = 0;
};

}  // namespace raypool
