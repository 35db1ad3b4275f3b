// The ray pool: rays that units have exported and the traverser has not finished, oldest first, behind one 128-bit port.
//
// A ray costs the port 5 cycles: 2 to choose the unit, 3 beats. A unit that offers a ray in cycle c to an idle port transfers in
// c+2, c+3, c+4 (later if it has bubbles between its beats). Units are served round robin, ray by ray. A full pool serves nobody.
#pragma once

#include <cstdint>
#include <systemc>
#include <vector>

#include "chip/chip_clock.hpp"
#include "chip/pixel_ledger.hpp"
#include "chip/round_robin.hpp"
#include "chip/statistics.hpp"
#include "machine/packages.hpp"

namespace raypool::chip {

inline constexpr uint64_t kPoolOverhead = 2;  ///< cycles a request

/// A ray in the pool. The traverser notes its result here while the result cannot leave.
struct PooledRay {
  Ray ray;
  bool traced = false;
  bool goes_on = false;       ///< as an intersection; meaningful when traced
  Intersection intersection;  ///< meaningful when it goes on
};

class RayPool : public sc_core::sc_module {
 public:
  SC_HAS_PROCESS(RayPool);
  /// `clock` and `ledger` must outlive the pool. Normal rays deeper than `depth` are dropped when they arrive.
  RayPool(const sc_core::sc_module_name& name, ChipClock& clock, PixelLedger& ledger, int units, int capacity, int depth);

  // For unit `unit`, in the phase of the units.
  /// True if the unit's beat is taken in this cycle.
  bool ready(int unit) const { return granted_ == unit && clock_.cycle() >= first_beat_; }
  /// The unit offers a beat and is not ready().
  void want(int unit);
  /// Takes a beat; ready() must hold. Returns true when it completes a ray that stays in the pool.
  bool take(int unit, const Beat& beat, bool last);
  /// True if the unit waits because there has been no room since before this cycle.
  bool held_up(int unit) const { return granted_ != unit && full() && clock_.cycle() > kept_at_; }

  /// For the traverser: oldest first. After removing some, of which so many were shadow rays, call removed().
  std::vector<PooledRay>& rays() { return rays_; }
  const std::vector<PooledRay>& rays() const { return rays_; }
  void removed(uint32_t shadow_rays);

  uint32_t size() const { return static_cast<uint32_t>(rays_.size()); }
  uint32_t shadow_rays() const { return shadow_rays_; }  ///< among them
  bool full() const { return rays_.size() >= capacity_; }
  uint32_t capacity() const { return static_cast<uint32_t>(capacity_); }
  uint64_t taken() const { return taken_; }  ///< rays transferred, dropped ones too
  uint64_t dropped_depth() const { return dropped_depth_; }
  uint64_t busy_cycles() const { return busy_cycles_; }  ///< of the port
  const LevelStatistics& fill() const { return fill_; }

 private:
  void serve();

  ChipClock& clock_;
  PixelLedger& ledger_;
  size_t capacity_;
  uint32_t depth_;
  sc_core::sc_event work_;
  RoundRobin turn_;
  uint32_t wanting_ = 0;  // units, one bit each
  int granted_ = -1;
  uint64_t granted_at_ = 0, first_beat_ = 0, free_at_ = 0, kept_at_ = 0;
  Ray arriving_{};
  size_t beats_ = 0;
  std::vector<PooledRay> rays_;
  uint32_t shadow_rays_ = 0;
  uint64_t taken_ = 0, dropped_depth_ = 0, busy_cycles_ = 0;
  LevelStatistics fill_;
};

}  // namespace raypool::chip
