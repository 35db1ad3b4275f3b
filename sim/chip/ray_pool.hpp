// The ray pool: rays that units have exported and the traverser has not finished, oldest first, behind one 128-bit port.
//
// A ray costs the port 5 cycles: 2 of overhead, 3 beats. A ray offered in cycle c to an idle port moves in c+2, c+3, c+4 (later
// if there are bubbles between its beats). A full pool serves nobody.
#pragma once

#include <cstdint>
#include <systemc>
#include <vector>

#include "chip/chip_clock.hpp"
#include "chip/pixel_ledger.hpp"
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
  /// `clock` and `ledger` must outlive the pool. Normal rays deeper than `depth` are dropped when they arrive.
  RayPool(const sc_core::sc_module_name& name, ChipClock& clock, PixelLedger& ledger, int capacity, int depth);

  // For the device, in the phase of the units.
  /// True if a beat is taken in this cycle.
  bool ready() const { return granted_ && clock_.cycle() >= first_beat_; }
  /// A beat is offered, and the pool is not ready().
  void want();
  /// Takes a beat of compute unit `unit`; ready() must hold. Returns true when it completes a ray that stays in the pool.
  bool take(uint32_t unit, const Beat& beat, bool last);
  /// True if a ray that is offered waits because there has been no room since before this cycle.
  bool held_up() const { return !granted_ && full() && clock_.cycle() > kept_at_; }

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
  PortWork work_;
  bool wanting_ = false;  // a ray is offered
  bool granted_ = false;
  uint64_t granted_at_ = 0, first_beat_ = 0, free_at_ = 0, kept_at_ = 0;
  Ray arriving_{};
  size_t beats_ = 0;
  std::vector<PooledRay> rays_;
  uint32_t shadow_rays_ = 0;
  uint64_t taken_ = 0, dropped_depth_ = 0, busy_cycles_ = 0;
  LevelStatistics fill_;
};

}  // namespace raypool::chip
