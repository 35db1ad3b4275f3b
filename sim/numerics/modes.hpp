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

  /// `base` with this arithmetic. Its Flt ALU becomes as deep as a fused unit needs, its name gets the mode's behind it when that
  /// is not the default one.
  Configuration applied_to(Configuration base) const;
};

/// Every mode, the default one first; exact before newton2, newton1, newton0.
const std::vector<ArithmeticMode>& arithmetic_modes();

}  // namespace raypool::numerics
