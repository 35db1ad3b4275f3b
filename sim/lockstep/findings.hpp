// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// What an inspection has found inside the RTL, in the order in which it did.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "lockstep/mismatch.hpp"

namespace raypool::lockstep {

/// The first few, each with other files.
class Findings {
 public:
  void begin_cycle(uint64_t cycle) { cycle_ = cycle; }
  void clear() { all_.clear(); }
  void add(const std::string& files, std::string text) {
    const bool same = std::any_of(all_.begin(), all_.end(), [&](const Finding& f) { return f.files == files; });
    if (all_.size() < kMost && !same) all_.push_back({cycle_, files, std::move(text)});
  }
  const std::vector<Finding>& all() const { return all_; }
  bool empty() const { return all_.empty(); }

 private:
  static constexpr size_t kMost = 2;

  uint64_t cycle_ = 0;
  std::vector<Finding> all_;
};

}  // namespace raypool::lockstep
