// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/compute/rp_predicate_file.v: the predicates of one warp, a bit a lane. p0 reads as all ones; writes to it are
// ignored.
#pragma once

#include <array>
#include <cstdint>

#include "isa/isa.hpp"

namespace raypool {

class PredicateFile {
 public:
  /// The start of a kernel.
  void clear() {
    predicates_.fill(0);
    predicates_[0] = ~0u;
  }
  uint32_t read(uint32_t index) const { return predicates_[index]; }
  void write(uint32_t index, uint32_t data) {
    if (index != 0) predicates_[index] = data;
  }
  /// Launched lanes with a guard that holds.
  uint32_t mask(uint32_t launched, uint32_t guard, bool guard_negated) const {
    return (guard_negated ? ~predicates_[guard] : predicates_[guard]) & launched;
  }

 private:
  std::array<uint32_t, kPredicates> predicates_{};
};

}  // namespace raypool
