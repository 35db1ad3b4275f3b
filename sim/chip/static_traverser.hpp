// The thesis' traverser: its speed is a constant, whatever the rays. A batch of rays (64) becomes intersections at the
// end of every kernel, on whichever unit; and a batch a unit whenever the shader has stalled for so long (1000 ns),
// that is, when no unit has a kernel or a ray waits for room in the ray pool.
#pragma once

#include "chip/traverser.hpp"

namespace raypool::chip {

class StaticTraverser : public Traverser {
 public:
  SC_HAS_PROCESS(StaticTraverser);
  /// Beside a device of so many units.
  StaticTraverser(const sc_core::sc_module_name& name, const Tracing& tracing);

  void kernel_ended(uint32_t unit) override;
  void shader_stalls(bool stalls) override;
  WorkDone work_done() override;
  std::string describe() override;

 private:
  void wait_for_end_of_stall();
  void end_of_kernel();
  void end_of_stall();

  uint32_t units_;
  uint32_t batch_;  // rays
  uint64_t stall_cycles_;
  sc_core::sc_event kernel_ended_, stall_over_;
  uint32_t kernels_ = 0;  // that ended in this cycle
  bool stalling_ = true;
  uint64_t stall_until_ = 0;  // cycle of the next batch while stalling; 0: none is due
};

}  // namespace raypool::chip
