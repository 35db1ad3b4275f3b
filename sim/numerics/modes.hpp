// The one list of the machine's arithmetic modes: tables, plots and tests of this folder go through it.
#pragma once

#include <string>
#include <vector>

#include "arith/arith.hpp"
#include "config/configuration.hpp"

namespace raypool::numerics {

struct ArithmeticMode {
  std::string name;  ///< "ieee-exact", ...: subnormals, slow unit, and "-fma" with a fused multiply-add
  arith::Mode mode;

  /// `base` with this arithmetic. Flt and Slw keep the stages that they have beyond what their arithmetic needs; the
  /// name gets the mode's behind it when that is not the default one.
  Configuration applied_to(const Configuration& base) const;
};

/// Every mode, the default one first; exact before newton2, newton1, newton0.
const std::vector<ArithmeticMode>& arithmetic_modes();

}  // namespace raypool::numerics
