// The one list of the machine's arithmetic modes: tables, plots and tests of this folder go through it.
#pragma once

#include <string>
#include <vector>

#include "arith/arith.hpp"
#include "config/configuration.hpp"

namespace raypool::numerics {

struct ArithmeticMode {
  /// "ieee-exact", ...: subnormals, slow unit, "-fma" with a fused multiply-add, "-16" with so many bits in a
  /// significand
  std::string name;
  arith::Mode mode;

  /// `base` with this arithmetic. Flt and Slw keep the stages that they have beyond what their arithmetic needs; the
  /// name gets the mode's behind it when that is not the default one.
  Configuration applied_to(const Configuration& base) const;
};

/// Every mode of the full significand, the default one first, exact before newton2, newton1, newton0; then the default
/// one with shorter significands.
const std::vector<ArithmeticMode>& arithmetic_modes();

}  // namespace raypool::numerics
