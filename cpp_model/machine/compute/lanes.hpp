// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The lanes of an instruction of one warp, with which the ALUs' models compute all at once.
#pragma once

#include <cstdint>
#include <cstring>

#include "isa/isa.hpp"

namespace raypool {

/// The operands of an instruction of one warp: a word a lane of each register.
template <int kLanes>
struct Lanes {
  static constexpr uint32_t kAll = kLanes == 32 ? 0xffffffffu : (1u << kLanes) - 1;

  uint32_t mask;
  uint32_t* rd;
  const uint32_t *a, *b, *c;

  /// rd = f(a, b) in the masked lanes. The full mask is the common case: through an array of its own, so that the
  /// compiler need not care whether rd is also a source.
  template <typename Function>
  void map(Function function) const {
    if (mask == kAll) {
      uint32_t values[kLanes];
      for (int lane = 0; lane < kLanes; ++lane) values[lane] = function(a[lane], b[lane]);
      std::memcpy(rd, values, sizeof(values));
    } else {
      for (uint32_t left = mask; left != 0; left &= left - 1) {
        const int lane = __builtin_ctz(left);
        rd[lane] = function(a[lane], b[lane]);
      }
    }
  }

  /// The same of each lane by itself. It sees its own operands only, so rd may be one of them.
  template <typename Function>
  void each(Function function) const {
    for (uint32_t lane = 0; lane < kLanes; ++lane) {
      if (mask >> lane & 1) rd[lane] = function(lane);
    }
  }

  /// rd = first, first + 1, ...
  void number(uint32_t first) const {
    each([first](uint32_t lane) { return first + lane; });
  }

  /// The lanes, masked or not, in which f(a, b) is true.
  template <typename Function>
  uint32_t test(Function function) const {
    uint32_t result = 0;
    for (int lane = 0; lane < kLanes; ++lane) result |= static_cast<uint32_t>(function(a[lane], b[lane])) << lane;
    return result;
  }
};

/// A row of the table without a case: names it and the place of the case, the ALU's header.
[[noreturn]] void not_modelled(Opcode opcode);

inline int32_t as_signed(uint32_t value) { return static_cast<int32_t>(value); }

}  // namespace raypool
