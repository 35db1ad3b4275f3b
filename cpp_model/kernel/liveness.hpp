// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Which virtual registers and predicates hold a value that is still needed, after each op.
#pragma once

#include <vector>

#include "kernel/intermediate.hpp"

namespace raypool::kernel {

/// A set of small numbers.
class NumberSet {
 public:
  explicit NumberSet(int size = 0) : words_((static_cast<size_t>(size) + 63) / 64, 0) {}
  bool has(int number) const { return (words_[index(number)] >> (number & 63) & 1) != 0; }
  void insert(int number) { words_[index(number)] |= uint64_t{1} << (number & 63); }
  void clear() { words_.assign(words_.size(), 0); }
  void erase(int number) { words_[index(number)] &= ~(uint64_t{1} << (number & 63)); }
  /// Adds the other set's numbers; true if that changed anything.
  bool merge(const NumberSet& other) {
    bool changed = false;
    for (size_t i = 0; i < words_.size(); ++i) {
      const uint64_t merged = words_[i] | other.words_[i];
      changed |= merged != words_[i];
      words_[i] = merged;
    }
    return changed;
  }
  template <typename Visit>
  void for_each(const Visit& visit) const {
    for (size_t i = 0; i < words_.size(); ++i) {
      for (uint64_t word = words_[i]; word != 0; word &= word - 1)
        visit(static_cast<int>(i * 64) + __builtin_ctzll(word));
    }
  }
  int count() const {
    int result = 0;
    for (const uint64_t word : words_) result += __builtin_popcountll(word);
    return result;
  }

 private:
  static size_t index(int number) { return static_cast<size_t>(number) / 64; }
  std::vector<uint64_t> words_;
};

struct Liveness {
  std::vector<NumberSet> registers_after;   ///< one set an op
  std::vector<NumberSet> predicates_after;  ///< one set an op
};
/// `through_reloads`: of values, wherever they are, in place of registers: a Spill::Reload neither begins nor needs
/// one.
Liveness find_liveness(const Function& function, bool through_reloads = false);

/// Ops that may follow each op.
std::vector<std::vector<size_t>> find_successors(const Function& function);

}  // namespace raypool::kernel
