// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Runs a recorded kernel natively: a packet of threads at a time, a lane each, from intermediate code, with the bits
// that the machine gives. For kernels that exist only as intermediate code; those with a C++ source run as that
// (native.hpp).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "kernel/intermediate.hpp"
#include "kernel/kernels.hpp"

namespace raypool::kernel {

/// One kernel, decoded for running. Its threads may run on several threads of C++ at once.
class FunctionRunner {
 public:
  /// That run at a time.
  static constexpr size_t kMostThreads = 16;
  /// About so many operations a thread may take in loops.
  static constexpr uint64_t kMostOperations = 100'000'000;

  /// `function`: as it was recorded with whole intersections, or behind passes, but without triples. Throws
  /// std::logic_error for instructions that no recorder emits: triples, calls, lane and warp numbers.
  explicit FunctionRunner(const Function& function, uint64_t most_operations = kMostOperations);

  /// As run_native() runs each of 1 .. kMostThreads threads, which have the same arguments, memory and mode, and whose
  /// loads and stores are in the order of a warp's. Throws InputError, with kernel and source line of the loop, when
  /// they do not end.
  void run(NativeThread* threads, size_t count) const;
  void run(NativeThread& thread) const { run(&thread, 1); }

 private:
  struct Code {
    uint32_t code = 0;  ///< a Step
    /// Numbers of rows, masks, or an immediate: as the step has it.
    uint32_t d = 0, a = 0, b = 0, c = 0;
  };
  struct Builder;

  template <bool kPlain>
  void run_in_mode(NativeThread* threads, size_t count) const;
  [[noreturn]] void fail_endless(const Code& end) const;

  std::string name_;
  std::vector<Code> codes_;
  uint32_t predicates_ = 1, rows_ = 0;
  std::vector<uint32_t> constants_;  // in rows behind the others
  std::vector<std::string> loops_;   // [loop] place in the source
  uint64_t most_operations_;
};

}  // namespace raypool::kernel
