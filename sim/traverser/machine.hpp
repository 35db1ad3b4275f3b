// What the chip asks of a traverser with a machine inside: rays enter with what they visit, and leave when it is done.
#pragma once

#include <cstdint>

#include "scene/traversal.hpp"
#include "traverser/work.hpp"

namespace raypool::traverser {

class Machine {
 public:
  Machine() = default;
  virtual ~Machine() = default;
  Machine(const Machine&) = delete;
  Machine& operator=(const Machine&) = delete;

  /// A ray may enter, one in a cycle.
  virtual bool ready() const = 0;
  /// A ray enters in the cycle of the last clock(). Returns its slot.
  virtual uint32_t push(const VisitList& visits) = 0;

  /// A cycle, after all earlier ones in which something happens: see next().
  virtual void clock(uint64_t cycle) = 0;
  /// A ray is done in the cycle of the last clock(): its slot is free again.
  virtual bool valid() const = 0;
  virtual uint32_t slot() const = 0;

  /// The next cycle in which anything can happen, if no ray enters.
  virtual uint64_t next() const = 0;
  /// The first cycle after `now`, up to which it has been clocked, in which a ray can be done, if none enters.
  virtual uint64_t earliest_done(uint64_t now) const = 0;
  /// Cycle in which the next line comes from the memory; kNever: none is on its way.
  virtual uint64_t line_due() const = 0;
  /// Cycles that a ray takes at least.
  virtual uint64_t least_latency() const = 0;
  /// Rays that it holds at most: slots are below.
  virtual uint32_t capacity() const = 0;

  /// Caches hold the lines of these nodes and leaves, the last of them longest. It takes no time, and is no work.
  virtual void remember(const VisitList& places) = 0;

  virtual TraverserWork work() const = 0;
};

}  // namespace raypool::traverser
