// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// What the widths of a machine's numbers allow.
#pragma once

#include <cstdint>

#include "config/configuration.hpp"

namespace raypool {

/// Instructions of the longest program: the greatest PC is outside of every one.
inline uint32_t longest_program(const Configuration& configuration) { return (1u << configuration.pc_bits) - 1; }
/// Throws InputError when a program is longer.
void check_program_length(const Configuration& configuration, uint32_t instructions);

/// Cycles in which no performance counter can wrap: the fastest counts each thread in each of them.
inline uint64_t counted_cycles(const Configuration& configuration) {
  return ((uint64_t{1} << configuration.counter_bits) - 1) / configuration.contents();
}

}  // namespace raypool
