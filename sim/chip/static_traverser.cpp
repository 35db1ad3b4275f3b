#include "chip/static_traverser.hpp"

namespace raypool::chip {

StaticTraverser::StaticTraverser(const sc_core::sc_module_name& name, const TraverserSurroundings& surroundings)
    : Traverser(name, surroundings), stalling_((1u << surroundings.units) - 1) {
  SC_METHOD(end_of_kernel);
  sensitive << kernel_ended_;
  dont_initialize();
  SC_METHOD(end_of_stall);
  sensitive << stall_over_;
  dont_initialize();
}

void StaticTraverser::kernel_ended() {
  ++kernels_;
  around_.clock.notify(kernel_ended_, Phase::Traverser);
}

void StaticTraverser::unit_stalls(int unit, bool stalls) {
  const uint32_t all = (1u << around_.units) - 1;
  const uint32_t before = stalling_;
  stalling_ = stalls ? stalling_ | 1u << unit : stalling_ & ~(1u << unit);
  if (before != all && stalling_ == all) around_.clock.notify(stall_over_, Phase::Traverser, kTraverserStallCycles);
  if (before == all && stalling_ != all) stall_over_.cancel();
}

void StaticTraverser::end_of_kernel() {
  around_.clock.guard([&] {
    counts_.batches += kernels_;
    advance(kTraverserBatch * kernels_);
    kernels_ = 0;
  });
}

void StaticTraverser::end_of_stall() {
  around_.clock.guard([&] {
    if (advance(kTraverserBatch * static_cast<uint32_t>(around_.units)) > 0) ++counts_.stall_batches;
    around_.clock.notify(stall_over_, Phase::Traverser, kTraverserStallCycles);
  });
}

}  // namespace raypool::chip
