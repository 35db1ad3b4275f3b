#include "chip/static_traverser.hpp"

#include <fmt/format.h>

#include <algorithm>

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
  if (!stalling_ && stalls) wait_for_end_of_stall();
  if (stalling_ && !stalls) {
    stall_over_.cancel();
    stall_until_ = 0;
  }
  stalling_ = stalls;
}

void StaticTraverser::wait_for_end_of_stall() {
  stall_until_ = clock->cycle() + stall_cycles_;
  clock->notify(stall_over_, Phase::Traverser, stall_cycles_);
}

// The end of a stall moves something only if a ray is there that can be traced, or leave.
WorkDone StaticTraverser::work_done() {
  WorkDone done = Traverser::work_done();
  const PooledRays& pool = rays->rays();
  if (stall_until_ != 0 &&
      std::any_of(pool.begin(), pool.end(), [&](const PooledRay& ray) { return !ray.traced || may_leave(ray); }))
    done.due = stall_until_;
  return done;
}

std::string StaticTraverser::describe() {
  uint32_t untraced = 0, without_room = 0;
  for (const PooledRay& ray : rays->rays()) {
    untraced += !ray.traced;
    without_room += ray.traced && !may_leave(ray);
  }
  return fmt::format(
      "traverser: {} rays wait to be traced, until a kernel ends or the shader has stalled for {} cycles; {} traced "
      "ones "
      "wait for room in the intersection pool",
      untraced, stall_cycles_, without_room);
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
    wait_for_end_of_stall();
  });
}

}  // namespace raypool::chip
