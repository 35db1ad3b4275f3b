// A traverser at the ports of a chip that has none inside (machine/chip/chip_device.hpp).
#pragma once

#include <cstdint>
#include <string>

#include "chip/traverser_counts.hpp"
#include "machine/chip/chip_device.hpp"

namespace raypool::chip {

/// Beats of rays come in, packages and contributions go out. A ray frees its place when what it has become has left;
/// the memory behind the chip's `tree` ports answers its requests. Each cycle is one call of offer(), then of clock().
class ExternalTraverser {
 public:
  virtual ~ExternalTraverser() = default;

  /// A frame begins. No ray is in the traverser, and counts() begin at zero.
  virtual void start(const FrameSetup& setup) = 0;
  /// Drives the traverser's side of the ports. They are registered: they depend on no output of the same cycle.
  virtual void offer(TraverserPorts& ports) = 0;
  /// The end of the cycle. `ports`: as offered. `stalls`: no unit has a kernel, or a ray waits for room in the ray
  /// pool.
  virtual void clock(const ChipOutputs& outputs, const TraverserPorts& ports, bool stalls) = 0;

  /// After clock(): cycles from the next one on in which it offers nothing and clock() does nothing but count them, if
  /// no ray comes, no kernel ends and `stalls` stays. stay() may then be called instead.
  virtual uint64_t still_for(bool /*stalls*/) const { return 0; }
  virtual void stay(uint64_t /*cycles*/, bool /*stalls*/) {}

  virtual const TraverserCounts& counts() const = 0;
  /// Cycles until it acts of its own accord; 0: it waits for the chip. For the watchdog.
  virtual uint64_t stall_left() const { return 0; }
  /// What its rays wait for, for an error.
  virtual std::string describe() const = 0;
};

}  // namespace raypool::chip
