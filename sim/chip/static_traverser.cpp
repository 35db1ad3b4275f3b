#include "chip/static_traverser.hpp"

namespace raypool::chip {

StaticTraverser::StaticTraverser(const sc_core::sc_module_name& name, const Tracing& tracing)
    : Traverser(name, tracing),
      units_(tracing.units),
      batch_(tracing.chip.static_traverser_batch),
      stall_cycles_(tracing.chip.static_traverser_stall_cycles) {
  SC_METHOD(end_of_kernel);
  sensitive << kernel_ended_;
  dont_initialize();
  SC_METHOD(end_of_stall);
  sensitive << stall_over_;
  dont_initialize();
}

void StaticTraverser::kernel_ended(uint32_t /*unit*/) {
  ++kernels_;
  clock->notify(kernel_ended_, Phase::Traverser);
}

void StaticTraverser::shader_stalls(bool stalls) {
  if (!stalling_ && stalls) clock->notify(stall_over_, Phase::Traverser, stall_cycles_);
  if (stalling_ && !stalls) stall_over_.cancel();
  stalling_ = stalls;
}

void StaticTraverser::end_of_kernel() {
  clock->guard([&] {
    counts_.batches += kernels_;
    counts_.most_rays += batch_ * kernels_;
    advance(batch_ * kernels_);
    kernels_ = 0;
  });
}

void StaticTraverser::end_of_stall() {
  clock->guard([&] {
    counts_.most_rays += batch_ * units_;
    if (advance(batch_ * units_) > 0) ++counts_.stall_batches;
    clock->notify(stall_over_, Phase::Traverser, stall_cycles_);
  });
}

}  // namespace raypool::chip
