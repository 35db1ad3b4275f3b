// What a machine has, of what a kernel may use.
#pragma once

#include <array>
#include <cstddef>

#include "config/configuration.hpp"

namespace raypool {

struct KernelTarget {
  bool fma = false;      ///< arithmetic.fma
  bool triples = false;  ///< triples
  bool culling = false;  ///< chip.culling

  KernelTarget() = default;
  KernelTarget(bool has_fma, bool has_triples, bool culls = false)
      : fma(has_fma), triples(has_triples), culling(culls) {}
  explicit KernelTarget(const Configuration& configuration)
      : KernelTarget(configuration.fma, configuration.triples, configuration.chip.culling) {}
};

/// One program for each of them, made by `build` when it is first asked for.
template <typename Build>
const auto& program_for(const KernelTarget& target, const Build& build) {
  const auto made = [&](size_t number) {
    return build(KernelTarget{number % 2 != 0, number / 2 % 2 != 0, number > 3});
  };
  static const std::array kPrograms = {made(0), made(1), made(2), made(3), made(4), made(5), made(6), made(7)};
  return kPrograms[(target.fma ? 1 : 0) + (target.triples ? 2 : 0) + (target.culling ? 4 : 0)];
}

}  // namespace raypool
