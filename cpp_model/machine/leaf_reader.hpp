// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/leaf_reader.v: the leaves that a lane's rays come to. Which of their lines are wanted from the cache, and the
// triangles in them, one in a cycle.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <vector>

#include "machine/late_queue.hpp"
#include "machine/line_offers.hpp"
#include "machine/line_want.hpp"
#include "machine/ram_queue.hpp"
#include "machine/round_robin.hpp"
#include "machine/tree_lines.hpp"
#include "machine/triangle_ray.hpp"

namespace raypool {

class LeafReader {
 public:
  static constexpr uint32_t kTriangleWords = 11;
  static constexpr uint32_t kLines = 5;                  ///< that it holds, and that are on their way
  static constexpr uint32_t kLastLine = (1u << 26) - 1;  ///< a place whose line has no number has this one
  static constexpr uint32_t kAhead = 4;  ///< leaves whose lines will be wanted; further ones are forgotten

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
  bool wants_any() const { return wants_[0].valid || wants_[1].valid; }
  const LineWants& wants() const { return wants_; }
  /// A triangle's test can begin: test().
  bool test_valid() const { return present_ && lines_[oldest_].tests != 0; }
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
  void start(size_t source, uint32_t slot, uint32_t leaf) { want(source, slot, Leaf(leaf)); }
  /// The end of a cycle.
  void clock(const Inputs& inputs) {
    const bool sleeps = queued_ == 0 && !ahead_.valid() && count_ == 0 && !due_[0].valid && !due_[1].valid;
    if (!sleeps || inputs.taken != 0 || inputs.waited || inputs.given != nullptr) work(inputs);
    ++cycle_;
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

  void work(const Inputs& inputs) {
    const bool leaves =
        present_ && (lines_[oldest_].tests == 0 || (lines_[oldest_].tests == 1 && inputs.triangle_taken));
    const bool full = ahead_.size() == kAhead;
    const LineWant* const next = next_offer();
    Due& due = due_[cycle_ % due_.size()];
    const bool missed = due.valid && inputs.given == nullptr;
    held_ += inputs.waited ? 1 : 0;
    held_ -= (missed ? 1 : 0) + (leaves ? 1 : 0);

    // Lines that have been looked up and were not there: those behind them are looked up at once.
    if (missed && due.lines.behind != 0 && !full) ahead_.push({(due.lines.line + 1) & kLastLine, due.lines.behind});
    due.valid = false;
    if (inputs.taken != 0) {
      const LineWant& taken = offers_.wants()[inputs.taken >> 1];
      if (!taken.nobody) {
        due = {true, {taken.line, static_cast<uint32_t>(pending_[taken.slot].last_word() / 16)}};
        ++held_;
      }
    }
    if (next != nullptr || inputs.taken != 0) offers_.clock(next, inputs.taken);
    take_line(leaves, inputs.triangle_taken);
    if (inputs.given != nullptr) come(*inputs.given);
    for (size_t i = 0; i < wants_.size(); ++i) {
      wants_[i] = offers_.wants()[i];
      if (!room() && !wants_[i].nobody) wants_[i].valid = false;
    }
  }

  // For the ray of this slot, from the cycle behind the next one on.
  void want(size_t queue, uint32_t slot, const Leaf& leaf) {
    pending_[slot] = leaf;
    queues_[queue].push(cycle_, {true, false, static_cast<uint8_t>(slot), leaf.line});
    ++queued_;
  }

  // Lines that will be wanted, then the queues' heads in rotation: null, or until something is put into a queue.
  const LineWant* next_offer() {
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
    if (queued_ == 0) return nullptr;
    uint32_t valid = 0;
    for (uint32_t queue = 0; queue < queues_.size(); ++queue)
      valid |= (queues_[queue].valid(cycle_) ? 1u : 0u) << queue;
    if (valid == 0) return nullptr;
    const uint32_t queue = turn_.choose(valid);
    turn_.advance(queue);
    const LineWant* const wanted = &queues_[queue].data();
    queues_[queue].pop();
    --queued_;
    return wanted;
  }

  // The present line's triangle is begun, or the line leaves; the next one comes unless it waits for what is kept of
  // it.
  void take_line(bool leaves, bool triangle_taken) {
    Line& line = lines_[oldest_];
    if (present_ && line.tests != 0 && triangle_taken) {
      --line.tests;
      line.leaf.at += int{kTriangleWords};
      --line.leaf.left;
      ++line.leaf.place;
    }
    const bool waits = count_ > (present_ ? 1u : 0u);
    const Line& next = lines_[present_ ? behind(oldest_) : oldest_];
    const bool comes = waits && (!present_ || (leaves && next.slot != line.slot));
    waited_for_kept_ += waits && leaves && !comes ? 1 : 0;
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
  void come(const Given& given) {
    Line& line = lines_[(oldest_ + count_++) % lines_.size()];
    line.slot = given.slot;
    line.leaf = pending_[given.slot];
    line.tests = line.leaf.tests();
    std::copy(given.line->begin(), given.line->end(), line.words.begin() + kKept);
    if (line.leaf.left > line.tests) want(2, line.slot, line.leaf.behind(line.tests));
  }
  static uint32_t behind(uint32_t line) { return (line + 1) % kPlaces; }

  static constexpr uint32_t kPlaces = 8;  // a power of two, for kLines
  uint64_t cycle_ = 0;
  std::array<LateQueue<LineWant>, 3> queues_;  // from nodes; from the stack; further lines of leaves
  uint32_t queued_ = 0;                        // in them
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
