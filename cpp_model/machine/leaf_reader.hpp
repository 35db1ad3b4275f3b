// rtl/leaf_reader.v: the leaves that a lane's rays come to. Which of their lines are wanted from the cache, and the
// triangles in them, one in a cycle.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <vector>

#include "machine/line_offers.hpp"
#include "machine/line_want.hpp"
#include "machine/ram_queue.hpp"
#include "machine/round_robin.hpp"
#include "machine/triangle_ray.hpp"

namespace raypool {

/// 64 bytes of the traverser's memory: little-endian words.
using TreeLine = std::array<uint32_t, 16>;

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
      : queues_{RamQueue<Wanted>(slots), RamQueue<Wanted>(slots), RamQueue<Wanted>(slots)},
        pending_(slots),
        lines_(kLines),
        kept_(slots) {}

  bool room() const { return held_ + (asked() ? 1 : 0) < kLines; }
  /// Of which one can be taken in the cycle, the first rather.
  LineWants wants() const {
    LineWants wants;
    for (uint32_t i = 0; i < wants.size(); ++i) {
      const Wanted* const offer = offers_.offer(i);
      if (offer != nullptr && (offer->nobody || room()))
        wants[i] = {true, offer->nobody, static_cast<uint8_t>(offer->slot), offer->leaf.line};
    }
    return wants;
  }
  /// A triangle's test can begin: test().
  bool test_valid() const { return line_ && line_->tests != 0; }
  std::optional<Test> test() const {
    if (!test_valid()) return {};
    Test test{line_->slot, line_->leaf.left == 1, line_->leaf.place, {}, 0};
    std::array<uint32_t, kKept + 16> words;
    std::copy(read_.begin(), read_.end(), words.begin());
    std::copy(line_->data.begin(), line_->data.end(), words.begin() + kKept);
    const uint32_t* const first = &words[static_cast<size_t>(line_->leaf.at + int{kKept})];
    std::memcpy(&test.triangle, first, sizeof test.triangle);
    test.material = first[kTriangleWords - 1];
    return test;
  }
  /// Lines that are offered because they will be wanted, and those that wait for what is kept of the one before.
  uint64_t looked_ahead() const { return looked_ahead_; }
  uint64_t waited_for_kept() const { return waited_for_kept_; }

  /// Before clock(): in this cycle a ray goes on with a leaf, its triangles less one in bits 30:29, the place of the
  /// first one below.
  void start(size_t source, uint32_t slot, uint32_t leaf) {
    Start& start = starts_[1 - starts_at_][source];
    start.valid = true;
    start.slot = slot;
    start.leaf = leaf;
  }
  /// The end of a cycle.
  void clock(const Inputs& inputs) {
    const bool leaves = line_ && (line_->tests == 0 || (line_->tests == 1 && inputs.triangle_taken));
    const bool missed = due_ && inputs.given == nullptr;
    const bool full = ahead_.size() == kAhead;
    const Wanted* const next = next_offer();
    held_ += (asked() ? 1 : 0) + (inputs.waited ? 1 : 0);
    held_ -= (missed ? 1 : 0) + (leaves ? 1 : 0);

    // Lines that have been looked up and were not there: those behind them are looked up at once.
    if (missed && due_->behind != 0 && !full) ahead_.push({(due_->line + 1) & kLastLine, due_->behind});
    due_.reset();
    if (const Wanted* const wanted = asked()) {
      pending_[wanted->slot] = wanted->leaf;
      due_ = Behind{wanted->leaf.line, static_cast<uint32_t>(wanted->leaf.last_word() / 16)};
    }
    offers_.clock(next, inputs.taken);

    if (come_) lines_.push(*come_);
    std::optional<Wanted> further;
    if (come_ && come_->leaf.left > come_->tests) further = Wanted{come_->slot, come_->leaf.behind(come_->tests)};
    take_line(leaves, inputs.triangle_taken);
    come_.reset();
    if (inputs.given != nullptr) come_.emplace(inputs.given->slot, pending_[inputs.given->slot], *inputs.given->line);
    for (size_t source = 0; source < kSources; ++source) {
      Start& start = starts_[starts_at_][source];
      if (start.valid) queues_[source].push({start.slot, Leaf(start.leaf)});
      start.valid = false;
    }
    starts_at_ = 1 - starts_at_;
    if (further) queues_[2].push(*further);
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
  struct Wanted {
    uint32_t slot = 0;
    Leaf leaf;
    bool nobody = false;  // it will be wanted
  };
  struct Start {
    bool valid = false;
    uint32_t slot = 0, leaf = 0;
  };
  struct Behind {
    uint32_t line = 0, behind = 0;
  };
  struct Line {
    uint32_t slot = 0;
    Leaf leaf;
    uint32_t tests = 0;  // that are to be begun
    TreeLine data{};

    Line() = default;
    Line(uint32_t of, const Leaf& from, const TreeLine& line) : slot(of), leaf(from), tests(from.tests()), data(line) {}
  };

  // What was taken in the cycle before, for a ray.
  const Wanted* asked() const {
    const Wanted* const asked = offers_.asked();
    return asked != nullptr && !asked->nobody ? asked : nullptr;
  }

  // Lines that will be wanted, then the queues' heads in rotation: null, or until something is put into a queue.
  const Wanted* next_offer() {
    if (!offers_.ready()) return nullptr;
    if (ahead_.valid()) {
      will_want_.nobody = true;
      will_want_.leaf.line = (ahead_.data().line + ahead_step_) & kLastLine;
      ++looked_ahead_;
      if (++ahead_step_ == ahead_.data().behind) {
        ahead_step_ = 0;
        ahead_.pop();
      }
      return &will_want_;
    }
    uint32_t valid = 0;
    for (uint32_t queue = 0; queue < queues_.size(); ++queue) valid |= (queues_[queue].valid() ? 1u : 0u) << queue;
    if (valid == 0) return nullptr;
    const uint32_t queue = turn_.choose(valid);
    turn_.advance(queue);
    const Wanted* const wanted = &queues_[queue].data();
    queues_[queue].pop();
    return wanted;
  }

  // The present line's triangle is begun, or the line leaves; the next one comes unless it waits for what is kept of
  // it.
  void take_line(bool leaves, bool triangle_taken) {
    const bool comes = lines_.valid() && (!line_ || (leaves && lines_.data().slot != line_->slot));
    waited_for_kept_ += lines_.valid() && leaves && !comes ? 1 : 0;
    std::array<uint32_t, kKept> read{};
    if (comes) read = kept_[lines_.data().slot];
    if (line_ && line_->tests != 0 && triangle_taken) {
      --line_->tests;
      line_->leaf.at += int{kTriangleWords};
      --line_->leaf.left;
      ++line_->leaf.place;
    }
    if (leaves) {
      if (line_->leaf.left != 0) std::copy(line_->data.end() - kKept, line_->data.end(), kept_[line_->slot].begin());
      line_.reset();
    }
    if (!comes) return;
    line_ = lines_.data();
    lines_.pop();
    read_ = read;
  }

  std::array<std::array<Start, kSources>, 2> starts_;  // of the cycle before, and of this one
  size_t starts_at_ = 0;                               // where those of the cycle before are
  std::array<RamQueue<Wanted>, 3> queues_;             // from nodes; from the stack; further lines of leaves
  RoundRobin turn_;                                    // which of them
  RamQueue<Behind> ahead_{kAhead};                     // the first of so many lines that will be wanted
  uint32_t ahead_step_ = 0;                            // of which so many have been offered
  Wanted will_want_;                                   // its line is offered
  LineOffers<Wanted> offers_;
  std::vector<Leaf> pending_;  // [slot] whose line has been looked up
  std::optional<Behind> due_;  // that was asked for two cycles ago
  std::optional<Line> come_;   // what was given in the cycle before
  RamQueue<Line> lines_;
  std::optional<Line> line_;                       // the oldest
  std::vector<std::array<uint32_t, kKept>> kept_;  // [slot] the last words of its line before
  std::array<uint32_t, kKept> read_{};
  uint32_t held_ = 0;  // without the one taken in the cycle before
  uint64_t looked_ahead_ = 0, waited_for_kept_ = 0;
};

}  // namespace raypool
