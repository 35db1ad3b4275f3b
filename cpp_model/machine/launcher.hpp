// rtl/launcher.v: takes launches, of which one may wait while a kernel runs, and notices the end of the kernel.
#pragma once

#include <cstdint>

#include "machine/compute_unit.hpp"

namespace raypool {

class Launcher {
 public:
  struct Registers {
    bool pending = false;  ///< a launch waits
    bool running = false;
    LaunchCommand launch;  ///< with pending: pc, threads, block, blocks, and the kind of its import
    uint32_t threads = 0;  ///< of the launch that runs or ran last
  };

  void reset() { q_ = Registers{}; }
  const Registers& registers() const { return q_; }

  // Outputs of the present cycle; `active`: warps that run.
  bool launch_ready(bool import_active) const { return !(q_.pending | import_active); }
  bool waiting() const { return q_.pending; }
  bool running() const { return q_.running; }
  bool start() const { return q_.pending && !q_.running; }
  bool kernel_done(uint32_t active) const { return q_.running && active == 0; }

  // The end of a cycle.
  void accept(const LaunchCommand& launch) {
    q_.pending = true;
    q_.launch = launch;
  }
  void begin() {
    q_.pending = false;
    q_.running = true;
    q_.threads = q_.launch.threads;
  }
  void end() { q_.running = false; }

 private:
  Registers q_;
};

}  // namespace raypool
