// The thesis' traverser: its speed is a constant, whatever the rays. 64 rays become intersections at the end of every
// kernel, on whichever unit; and 64 a unit after every 1000 ns in which the shader stalls, that is, in which no unit
// has a kernel or a ray waits for room in the ray pool.
#pragma once

#include "chip/traverser.hpp"

namespace raypool::chip {

inline constexpr uint32_t kTraverserBatch = 64;  ///< rays
inline constexpr uint64_t kTraverserStallCycles = 1000;

class StaticTraverser : public Traverser {
 public:
  SC_HAS_PROCESS(StaticTraverser);
  /// Beside a device of so many units.
  StaticTraverser(const sc_core::sc_module_name& name, RayTracer& tracer, int units);

  void kernel_ended(int unit) override;
  void shader_stalls(bool stalls) override;

 private:
  void end_of_kernel();
  void end_of_stall();

  uint32_t units_;
  sc_core::sc_event kernel_ended_, stall_over_;
  uint32_t kernels_ = 0;  // that ended in this cycle
  bool stalling_ = true;
};

}  // namespace raypool::chip
