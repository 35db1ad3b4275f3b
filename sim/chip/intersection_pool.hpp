// The intersection pool: intersections of normal and of shadow rays, a queue for each kind, behind one 128-bit port.
//
// An intersection costs the port 8 cycles: 2 for the request, 6 beats. A request in cycle c to an idle port is taken in c+1, and
// the beats move in c+2 .. c+7. The oldest package of the kind goes first. Its place is free as soon as its request is taken (the
// port keeps it in a register of its own).
//
// Whoever launches a kernel reserves its packages at once, so that available() never promises the same package twice.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <systemc>

#include "chip/chip_clock.hpp"
#include "chip/pixel_ledger.hpp"
#include "chip/ray_pool.hpp"
#include "chip/statistics.hpp"
#include "machine/compute_unit.hpp"
#include "machine/packages.hpp"

namespace raypool::chip {

class IntersectionPool : public sc_core::sc_module {
 public:
  /// `clock` and `ledger` must outlive the pool; `capacity` packages of each kind.
  IntersectionPool(const sc_core::sc_module_name& name, ChipClock& clock, PixelLedger& ledger, int capacity);

  // For the device, in the phase of the units.
  /// True if the request is taken in this cycle.
  bool ready() const { return granted_ && clock_.cycle() == granted_at_ + 1; }
  /// Compute unit `unit` requests a package of `kind`, and the pool is not ready(). A request stays until it is taken.
  void want(uint32_t unit, ImportKind kind);
  /// True if a beat arrives in this cycle.
  bool beat(Beat& beat) const {
    if (beat_due() != clock_.cycle()) return false;
    next_beat(beat);
    return true;
  }
  /// Cycle of the next beat, the present one or later; UINT64_MAX: none is on its way.
  uint64_t beat_due() const {
    const uint64_t now = clock_.cycle();
    if (!granted_ || now >= granted_at_ + kServiceCycles) return UINT64_MAX;
    return std::max(now, granted_at_ + kPoolOverhead);
  }

  // For the traverser.
  bool full(ImportKind kind) const { return queue(kind).size() >= capacity_; }
  void put(ImportKind kind, const Intersection& intersection);

  // For the controller.
  /// Packages that no launch has reserved.
  uint32_t available(ImportKind kind) const { return size(kind) - reserved_[number(kind)]; }
  void reserve(ImportKind kind, uint32_t count) { reserved_[number(kind)] += count; }

  uint32_t size(ImportKind kind) const { return static_cast<uint32_t>(queue(kind).size()); }
  uint32_t capacity() const { return static_cast<uint32_t>(capacity_); }
  uint64_t taken() const { return taken_; }  ///< packages given to units
  uint64_t busy_cycles() const { return taken_ * kServiceCycles; }
  const LevelStatistics& fill(ImportKind kind) const { return fill_[number(kind)]; }

 private:
  static constexpr uint64_t kServiceCycles = kPoolOverhead + kIntersectionBeats;

  static size_t number(ImportKind kind) { return kind == ImportKind::Shadow ? 1 : 0; }
  std::deque<Intersection>& queue(ImportKind kind) { return queues_[number(kind)]; }
  const std::deque<Intersection>& queue(ImportKind kind) const { return queues_[number(kind)]; }
  void next_beat(Beat& beat) const;
  void serve();

  ChipClock& clock_;
  PixelLedger& ledger_;
  size_t capacity_;
  PortWork work_;
  std::array<std::deque<Intersection>, 2> queues_;
  std::array<uint32_t, 2> reserved_{};
  ImportKind wanting_ = ImportKind::None;  // a package of this kind
  uint32_t wanting_unit_ = 0;
  bool granted_ = false;  // ever
  uint64_t granted_at_ = 0, free_at_ = 0;
  Intersection leaving_{};
  uint64_t taken_ = 0;
  std::array<LevelStatistics, 2> fill_;
};

}  // namespace raypool::chip
