// The traverser: takes rays from the ray pool, finds what they hit, puts intersections into the intersection pool. A
// ray whose destination has no room stays in the ray pool. With chip.shading `traverser` a shadow ray that reaches the
// light becomes a contribution: it stays in the ray pool until the frame buffer's port takes it. What the traverser
// finds is the scene's business (RayTracer); when it happens is that of the timing model, of which a subclass of
// Traverser makes one.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <systemc>

#include "chip/chip_clock.hpp"
#include "chip/interfaces.hpp"
#include "chip/ports.hpp"
#include "chip/ray_fates.hpp"
#include "chip/traverser_counts.hpp"
#include "config/configuration.hpp"
#include "traverser/work.hpp"

namespace raypool::chip {

/// What every traverser works on.
struct Tracing {
  RayTracer& tracer;  ///< must outlive it
  const ChipConfiguration& chip;
  uint32_t units;
  uint32_t depth;    ///< the largest of a normal ray
  bool reflections;  ///< normal intersections are given to a kernel that casts some
  bool timed;        ///< the device has a notion of time
};

class Traverser : public sc_core::sc_module,
                  public KernelEventsIf,
                  public RayArrivalIf,
                  public RoomIf,
                  public MemoryUserIf {
 public:
  SC_HAS_PROCESS(Traverser);
  sc_core::sc_port<TimeIf> clock{"clock"};
  sc_core::sc_port<RaySourceIf> rays{"rays"};
  sc_core::sc_port<IntersectionSinkIf> intersections{"intersections"};
  sc_core::sc_port<DirectContributionIf> frame{"frame"};
  sc_core::sc_port<LedgerIf> ledger{"ledger"};
  sc_core::sc_port<DecisionIf> controller{"controller"};
  sc_core::sc_port<MemoryTurnsIf, 1, sc_core::SC_ZERO_OR_MORE_BOUND> memory{"memory"};
  sc_core::sc_export<KernelEventsIf> kernel_events{"kernel_events"};
  sc_core::sc_export<RayArrivalIf> arrivals{"arrivals"};
  sc_core::sc_export<RoomIf> room{"room"};
  sc_core::sc_export<MemoryUserIf> memory_user{"memory_user"};

  void ray_arrived() override {}
  void room_made(ImportKind /*kind*/) override {}
  void catch_up(uint64_t /*cycle*/) override {}

  const TraverserCounts& counts() const { return counts_; }
  /// Caches hold these places from now on, as if rays had visited them; the last of them stay longest.
  virtual void remember(const VisitList& /*places*/) {}
  /// So far, and what is due, in the present cycle. What the traverser tests is work, whether rays come and go or not.
  virtual WorkDone work_done();
  /// What its rays wait for, for an error.
  virtual std::string describe() = 0;
  /// What a traverser with a machine inside has done.
  virtual std::optional<TraverserWork> work() const { return {}; }

 protected:
  Traverser(const sc_core::sc_module_name& name, const Tracing& tracing);

  /// Traces up to `budget` rays, oldest first, and delivers or drops every traced ray that finds room. Returns how many
  /// left the pool.
  uint32_t advance(uint32_t budget);
  /// Finds what the ray hits, and what it visits on its way. It is not yet traced.
  void follow(PooledRay& ray, VisitList& visits);
  /// Delivers or drops a ray of which is known what it hits. False, if there is no room for what it becomes; else it
  /// must be removed from the pool, and left() be told.
  bool leave(const PooledRay& ray);
  /// So many rays have been removed.
  void left(uint32_t count);
  /// The result of a traced ray could leave now, if there is one; or stays until there is room.
  bool may_leave(const PooledRay& ray) const;
  /// What a traced ray that goes on becomes.
  ImportKind kind_of(const PooledRay& ray) const { return fates_.kind_of(ray.ray, ray.intersection); }
  /// The frame buffer's port, which a traced ray did not get, is free.
  virtual void deliver_traced() { advance(0); }

  TraverserCounts counts_;

 private:
  void trace(PooledRay& ray);
  bool deliver(const PooledRay& ray);
  bool contribute(const Ray& ray);
  void next_contribution();

  RayTracer& tracer_;
  RayFates fates_;
  sc_core::sc_event frame_free_;
};

/// The one that `chip.traverser` names; beside a device without time, whose cycles mean nothing, the one that takes
/// none to find them.
std::unique_ptr<Traverser> make_traverser(const Tracing& tracing);

}  // namespace raypool::chip
