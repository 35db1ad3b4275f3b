// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// What is in a pipe that begins one thing a cycle at most: whether a stage has something is a bit, and these move;
// what it has, which was known when it began, stays where it is.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace raypool {

/// `kStages`: the most that are asked for.
template <typename Item, uint32_t kStages>
class PipeItems {
 public:
  /// What began so many cycles ago, 1 .. kStages; null: nothing did.
  const Item* at(uint32_t ago) const { return there(ago) ? &items_[place(ago)] : nullptr; }
  Item* at(uint32_t ago) { return there(ago) ? &items_[place(ago)] : nullptr; }
  bool there(uint32_t ago) const { return (there_ >> ago & 1) != 0; }

  /// One begins in this cycle: its place, with what has been in it.
  Item& begin() {
    there_ |= 1;
    return items_[place(0)];
  }
  /// The end of a cycle.
  void clock() { pass(1); }
  /// The end of so many cycles; only in the first of them something began.
  void pass(uint64_t cycles) {
    there_ = cycles < 8 * sizeof there_ ? there_ << cycles : 0;
    cycle_ += cycles;
  }

 private:
  using Bits = std::conditional_t<(kStages < 64), uint64_t, unsigned __int128>;
  static constexpr size_t places() {
    size_t count = 1;
    while (count < kStages + 1) count *= 2;
    return count;
  }
  size_t place(size_t ago) const { return (cycle_ - ago) % places(); }

  Bits there_ = 0;  // bit i: i cycles ago
  size_t cycle_ = 0;
  std::array<Item, places()> items_{};
};

}  // namespace raypool
