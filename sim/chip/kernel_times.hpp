// How often each kernel was launched, with how many threads, and how long it ran.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <vector>

#include "chip/chip.hpp"
#include "kernel/kernels.hpp"

namespace raypool::chip {

class KernelTimes {
 public:
  /// `contents`: threads that a kernel may have.
  KernelTimes(uint32_t units, uint32_t contents) : contents_(contents), given_(units), ended_(units) {}

  /// The unit is given a kernel.
  void given(uint32_t unit, RayKernel kernel, uint32_t threads) {
    ChipResult::Kernel& count = kernels_[kernel];
    ++count.launches;
    count.threads += threads;
    given_[unit].push_back({kernel, threads, UINT64_MAX});
  }
  /// It accepts it in this cycle.
  void accepted(uint32_t unit, uint64_t cycle) { given_[unit].back().begins = cycle + 1; }
  /// Its oldest one ends.
  void ended(uint32_t unit, uint64_t cycle) {
    const GivenKernel kernel = given_[unit].front();
    given_[unit].pop_front();
    const uint64_t time = cycle - std::max(kernel.begins, ended_[unit]);
    ended_[unit] = cycle;
    kernels_[kernel.kind].cycles += time;
    thread_time_ += static_cast<double>(time) * kernel.threads;
    thread_time_launchable_ += static_cast<double>(time) * contents_;
  }

  /// Given to the unit, and not ended.
  uint32_t under_way(uint32_t unit) const { return static_cast<uint32_t>(given_[unit].size()); }
  uint32_t under_way() const {
    uint32_t sum = 0;
    for (const auto& given : given_) sum += static_cast<uint32_t>(given.size());
    return sum;
  }
  const EnumArray<RayKernel, ChipResult::Kernel, kRayKernels>& kernels() const { return kernels_; }
  /// Threads launched / threads launchable, weighted by kernel time.
  double resource_utilisation() const {
    return thread_time_launchable_ == 0 ? 0 : thread_time_ / thread_time_launchable_;
  }

 private:
  struct GivenKernel {
    RayKernel kind;
    uint32_t threads;
    uint64_t begins;  // not before this cycle
  };

  uint32_t contents_;
  std::vector<std::deque<GivenKernel>> given_;  // [unit] not ended, oldest first
  std::vector<uint64_t> ended_;                 // [unit] cycle in which the last one ended
  EnumArray<RayKernel, ChipResult::Kernel, kRayKernels> kernels_{};
  double thread_time_ = 0, thread_time_launchable_ = 0;
};

}  // namespace raypool::chip
