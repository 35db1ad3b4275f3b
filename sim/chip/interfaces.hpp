// What the modules of the chip ask of each other: the interfaces of their ports. `raypool sim --modules` prints who is
// bound to whom. What the device looks at in every cycle is kept here, so that asking costs no call.
#pragma once

#include <cstdint>
#include <list>
#include <string>
#include <systemc>
#include <vector>

#include "chip/progress_watch.hpp"
#include "kernel/kernels.hpp"
#include "machine/compute_unit.hpp"
#include "machine/packages.hpp"
#include "machine/port_cycles.hpp"

namespace raypool::chip {

// ---- Of the device's ports

/// The memory port, for the device.
class MemoryIf : virtual public sc_core::sc_interface {
 public:
  /// Cycle from which on there is room for a request.
  uint64_t room_from() const { return room_from_; }
  /// Takes a request; there must be room.
  virtual void request(const MemoryRequest& request) = 0;
  /// Cycle of the next beat; kNever: none is on its way.
  uint64_t response_due() const { return response_due_; }
  /// The beat that is due in this cycle.
  virtual void response(MemoryResponse& response) = 0;
  /// True if nothing of compute unit `unit` is waiting or on its way.
  virtual bool quiet(uint32_t unit) const = 0;

 protected:
  uint64_t room_from_ = 0, response_due_ = kNever;
};

/// The memory port, for the traverser, whose lines take turns with the device's requests: who asks first goes first.
class MemoryTurnsIf : virtual public sc_core::sc_interface {
 public:
  /// Keeps the port for so many beats as soon as it is free, not before `cycle`: 4 for a line, 1 or 2 for quadwords
  /// that are written. Returns the first cycle. Calls come in the order of their cycles.
  virtual uint64_t turn(uint64_t cycle, uint32_t beats) = 0;
  /// After a line's turn, of this line, which could end then: the cycle of its last beat, behind those of the lines
  /// before.
  virtual uint64_t line(uint64_t end) = 0;
};

/// Who uses the memory port beside the device, and may be behind it in time.
class MemoryUserIf : virtual public sc_core::sc_interface {
 public:
  /// The device is going to make a request in this cycle: takes all turns of earlier ones.
  virtual void catch_up(uint64_t cycle) = 0;
};

/// The ray pool's port, for the device.
class RayExportIf : virtual public sc_core::sc_interface {
 public:
  /// Cycle from which on the next beat of a ray is taken; kNever: not while nobody wants to give one, or the pool is
  /// full.
  uint64_t beats_from() const { return beats_from_; }
  /// A beat is offered that is not taken in this cycle. May be said again.
  virtual void want() = 0;
  /// Takes a beat of compute unit `unit`.
  virtual void take(uint32_t unit, const Beat& beat, bool last) = 0;
  /// True if a ray that is offered waits because there has been no room since before this cycle.
  virtual bool held_up() const = 0;

 protected:
  uint64_t beats_from_ = kNever;
};

/// The intersection pool's port, for the device.
class ImportIf : virtual public sc_core::sc_interface {
 public:
  /// Cycle in which the request that waits is taken; kNever: none waits, or the pool has nothing of its kind.
  uint64_t request_due() const { return request_due_; }
  /// Compute unit `unit` shows a request for a package of `kind`, until it is taken. True if that is in this cycle.
  virtual bool request(uint32_t unit, ImportKind kind) = 0;
  /// Cycle of the next beat; kNever: none is on its way.
  uint64_t beat_due() const { return beat_due_; }
  /// The beat that is due in this cycle.
  virtual void beat(Beat& beat) = 0;

 protected:
  uint64_t request_due_ = kNever, beat_due_ = kNever;
};

/// The frame buffer's port, for the device: takes a contribution whenever there is one.
class ContributionIf : virtual public sc_core::sc_interface {
 public:
  virtual void take(uint32_t unit, const FrameContribution& contribution) = 0;
};

/// The frame buffer's port, for the traverser: units, whose phase is earlier, go first.
class DirectContributionIf : virtual public sc_core::sc_interface {
 public:
  /// False if the port has taken a contribution in this cycle already, and does not take this one.
  virtual bool offer(const FrameContribution& contribution) = 0;
};

/// The device, for who launches kernels on it.
class LaunchIf : virtual public sc_core::sc_interface {
 public:
  virtual uint32_t units() const = 0;
  /// True if launch() may be called.
  virtual bool can_launch() const = 0;
  /// The same, as it was at the beginning of this cycle; for the phase of the controller.
  virtual bool could_launch() const = 0;
  /// The unit that would get the kernel; means something while can_launch().
  virtual uint32_t next_unit() const = 0;
  /// True if the unit runs a kernel, or one has been given to it and not begun.
  virtual bool busy(uint32_t unit) const = 0;
  virtual bool idle() const = 0;
  /// UnitOutputs::exports of the unit.
  virtual uint16_t exports(uint32_t unit) const = 0;
  /// Gives next_unit() a kernel, which it sees from the next cycle on. Not in the phase of the units.
  virtual void launch(const LaunchCommand& command) = 0;
};

/// Who launches kernels: the controller of a frame, or the grid of a compute program.
class DecisionIf : virtual public sc_core::sc_interface {
 public:
  /// Something has changed that may allow a launch, or end the run.
  virtual void changed() = 0;
  /// A level of a pool has changed, for one that may decide on that alone.
  virtual void level_changed() {}
  /// A ray, or a contribution, of the unit has been taken at its port.
  virtual void ray_left(uint32_t /*unit*/, bool /*shadow*/) {}
  virtual void contribution_left(uint32_t /*unit*/) {}
};

/// Who follows what becomes of kernels. All in the phase of the units.
class KernelEventsIf : virtual public sc_core::sc_interface {
 public:
  /// The unit has accepted the kernel it was given.
  virtual void accepted(uint32_t /*unit*/) {}
  virtual void kernel_ended(uint32_t unit) = 0;
  /// The unit is idle: whatever its kernels exported has been seen.
  virtual void unit_idle(uint32_t /*unit*/) {}
  /// The shader begins or ceases to stall: no unit has a kernel, or a ray waits for room in the ray pool. It stalls at
  /// first.
  virtual void shader_stalls(bool /*stalls*/) {}
};

// ---- Of the pools

/// A ray in the pool. The traverser notes its result here while the result cannot leave.
struct PooledRay {
  Ray ray;
  uint32_t place = 0;  ///< in the pool
  bool traced = false;
  bool goes_on = false;       ///< as an intersection; meaningful when traced
  Intersection intersection;  ///< meaningful when it goes on
};

using PooledRays = std::list<PooledRay>;

/// The ray pool, for the traverser.
class RaySourceIf : virtual public sc_core::sc_interface {
 public:
  /// Oldest first.
  virtual PooledRays& rays() = 0;
  /// Frees the ray's place. Returns the next one.
  virtual PooledRays::iterator remove(PooledRays::iterator ray) = 0;
};

/// Who is told of every ray that comes into the ray pool, in the phase of the units.
class RayArrivalIf : virtual public sc_core::sc_interface {
 public:
  virtual void ray_arrived() = 0;
};

/// Who is told when the intersection pool has given a package away, in the phase of the units.
class RoomIf : virtual public sc_core::sc_interface {
 public:
  virtual void room_made(ImportKind kind) = 0;
};

/// The ray pool, for the controller.
class RayLevelIf : virtual public sc_core::sc_interface {
 public:
  virtual uint32_t size() const = 0;
  virtual uint32_t shadow_rays() const = 0;  ///< among them
};

/// The intersection pool, for the traverser.
class IntersectionSinkIf : virtual public sc_core::sc_interface {
 public:
  virtual bool full(ImportKind kind) const = 0;
  virtual void put(ImportKind kind, const Intersection& intersection) = 0;
};

/// The intersection pool, for the controller.
class IntersectionLevelIf : virtual public sc_core::sc_interface {
 public:
  virtual uint32_t size(ImportKind kind) const = 0;
  /// Packages that no launch has reserved.
  virtual uint32_t available(ImportKind kind) const = 0;
  virtual void reserve(ImportKind kind, uint32_t count) = 0;
};

// ---- Of the whole

/// The pixel ledger.
class LedgerIf : virtual public sc_core::sc_interface {
 public:
  /// A kernel is going to be launched. CastEye: `pixels` are those of its tile that lie in the image, and are held from
  /// now on.
  virtual void eye_launched(uint32_t unit, std::vector<uint32_t> pixels) = 0;
  /// Another kernel: its threads' pixels come with their packages.
  virtual void launched(uint32_t unit, RayKernel kernel, uint32_t threads) = 0;
  /// A package goes to the unit: to its oldest kernel that still misses some.
  virtual void imported(uint32_t unit, uint32_t pixel) = 0;
  /// A ray left the unit, and holds its pixel from now on if it is `kept`. Throws std::runtime_error when no kernel of
  /// the unit can have made it.
  virtual void ray_exported(uint32_t unit, const Ray& ray, bool kept) = 0;
  virtual void contribution_exported(uint32_t unit, uint32_t pixel) = 0;
  /// A ray that was kept is gone without leaving an intersection: it added to the picture, or nothing.
  virtual void ray_dropped(uint32_t pixel) = 0;

  virtual uint32_t held() const = 0;
  virtual uint64_t finished() const = 0;
  virtual uint64_t pixels() const = 0;
  /// Most rays that kernels on record may still export.
  virtual uint32_t rays_to_come() const = 0;
  virtual uint32_t shadow_rays_to_come() const = 0;
};

/// A chip, for the monitor that watches its run.
class WatchedIf : virtual public sc_core::sc_interface {
 public:
  virtual WorkDone work_done() = 0;    ///< so far, and what is due
  virtual std::string describe() = 0;  ///< who waits for what, for the error
  virtual void show_progress() = 0;
};

}  // namespace raypool::chip
