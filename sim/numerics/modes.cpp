#include "numerics/modes.hpp"

#include <algorithm>
#include <array>

namespace raypool::numerics {

Configuration ArithmeticMode::applied_to(Configuration base) const {
  base.subnormals = mode.subnormals;
  base.slow_unit = mode.slow_unit;
  base.fma = mode.fused;
  if (base.fma) {
    // What a fused unit needs at least; the check of configurations has the same number.
    int& depth = base.alus[static_cast<size_t>(Unit::Flt)].depth;
    depth = std::max(depth, 5);
  }
  if (name != arithmetic_modes().front().name) base.name += "-" + name;
  return base;
}

const std::vector<ArithmeticMode>& arithmetic_modes() {
  static const std::vector<ArithmeticMode> kModes = [] {
    constexpr std::array<const char*, 2> kSubnormals = {"ieee", "flush"};
    constexpr std::array<const char*, 4> kSlowUnits = {"exact", "newton2", "newton1", "newton0"};
    std::vector<ArithmeticMode> modes;
    for (const bool fused : {false, true}) {
      for (size_t s = 0; s < kSubnormals.size(); ++s) {
        for (size_t u = 0; u < kSlowUnits.size(); ++u) {
          ArithmeticMode mode;
          mode.name = std::string(kSubnormals[s]) + "-" + kSlowUnits[u] + (fused ? "-fma" : "");
          mode.mode.subnormals = static_cast<Subnormals>(s);
          mode.mode.slow_unit = static_cast<SlowUnit>(u);
          mode.mode.fused = fused;
          modes.push_back(mode);
        }
      }
    }
    return modes;
  }();
  return kModes;
}

}  // namespace raypool::numerics
