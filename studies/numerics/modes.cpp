#include "numerics/modes.hpp"

#include <fmt/format.h>

#include <array>

namespace raypool::numerics {

Configuration ArithmeticMode::applied_to(const Configuration& base) const {
  Configuration changed = base;
  changed.subnormals = mode.subnormals;
  changed.slow_unit = mode.slow_unit;
  changed.fma = mode.fused;
  changed.significand = mode.significand;
  for (const AluType type : {AluType::Flt, AluType::Slw})
    changed.alus[type].depth += least_depth(changed, type) - least_depth(base, type);
  if (name != arithmetic_modes().front().name) changed.name += "-" + name;
  return changed;
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
    for (const uint32_t significand : {20, 16, 13, 11}) {
      ArithmeticMode mode = modes.front();
      mode.name += fmt::format("-{}", significand);
      mode.mode.significand = significand;
      modes.push_back(mode);
    }
    return modes;
  }();
  return kModes;
}

}  // namespace raypool::numerics
