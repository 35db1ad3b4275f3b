// Who launches kernels on the device: the controller of a frame, or the grid of a compute program.
#pragma once

namespace raypool::chip {

class Launcher {
 public:
  virtual ~Launcher() = default;
  // All in the phase of the units.
  /// The unit has accepted the kernel it was given.
  virtual void accepted(int unit) = 0;
  virtual void kernel_ended(int unit) = 0;
  /// Something has changed that may allow a launch, or end the run.
  virtual void changed() = 0;
};

}  // namespace raypool::chip
