// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// What a machine has, of what a kernel may use.
#pragma once

#include <array>
#include <cstddef>

#include "config/configuration.hpp"
#include "machine/common/packages.hpp"

namespace raypool {

struct KernelTarget {
  bool fma = false;      ///< arithmetic.fma
  bool triples = false;  ///< triples
  bool culling = false;  ///< chip.culling
  bool compact = false;  ///< intersections lack the words that no kernel needs

  KernelTarget() = default;
  KernelTarget(bool has_fma, bool has_triples, bool culls = false, bool is_compact = false)
      : fma(has_fma), triples(has_triples), culling(culls), compact(is_compact) {}
  explicit KernelTarget(const Configuration& configuration)
      : KernelTarget(configuration.fma, configuration.triples, configuration.chip.culling,
                     configuration.intersection_words < kIntersectionWords) {}
};

/// One program for each of them, made by `build` when the first is asked for.
template <typename Build>
const auto& program_for(const KernelTarget& target, const Build& build) {
  const auto made = [&](size_t number) {
    return build(KernelTarget{number % 2 != 0, number / 2 % 2 != 0, number / 4 % 2 != 0, number > 7});
  };
  static const std::array kPrograms = {made(0), made(1), made(2),  made(3),  made(4),  made(5),  made(6),  made(7),
                                       made(8), made(9), made(10), made(11), made(12), made(13), made(14), made(15)};
  return kPrograms[(target.fma ? 1 : 0) + (target.triples ? 2 : 0) + (target.culling ? 4 : 0) +
                   (target.compact ? 8 : 0)];
}

}  // namespace raypool
