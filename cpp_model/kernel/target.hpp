// What a machine has, of what a kernel may use.
#pragma once

#include <array>

#include "config/configuration.hpp"

namespace raypool {

struct KernelTarget {
  bool fma = false;      ///< arithmetic.fma
  bool triples = false;  ///< triples

  KernelTarget() = default;
  KernelTarget(bool has_fma, bool has_triples) : fma(has_fma), triples(has_triples) {}
  explicit KernelTarget(const Configuration& configuration) : KernelTarget(configuration.fma, configuration.triples) {}
};

/// One program for each of them, made by `build` when it is first asked for.
template <typename Build>
const auto& program_for(const KernelTarget& target, const Build& build) {
  static const std::array kPrograms = {build(KernelTarget{false, false}), build(KernelTarget{true, false}),
                                       build(KernelTarget{false, true}), build(KernelTarget{true, true})};
  return kPrograms[(target.fma ? 1 : 0) + (target.triples ? 2 : 0)];
}

}  // namespace raypool
