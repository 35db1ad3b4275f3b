// What is estimated of a frame by engines that do not simulate all of it.
#pragma once

#include "enum_array.hpp"
#include "isa/isa.hpp"

namespace raypool {

/// 95% of such intervals contain the true value.
struct Interval {
  double value = 0;
  double low = 0, high = 0;

  bool contains(double x) const { return low <= x && x <= high; }
};

struct Estimates {
  Interval cycles;
  Interval mrays_per_s;
  EnumArray<AluType, Interval, kAluTypes> alus;  ///< utilisation, of busy time, 0 .. 1
  Interval ray_port, intersection_port, memory_port;

  double error() const { return cycles.value == 0 ? 0 : (cycles.high - cycles.low) / 2 / cycles.value; }
};

}  // namespace raypool
