// The ray pool: rays that units have exported and the traverser has not finished, oldest first, behind one 128-bit
// port.
//
// A ray costs the port its overhead and 3 beats: 5 cycles, as the thesis has it. There a ray offered in cycle c to an
// idle port moves in c+2, c+3, c+4 (later if there are bubbles between its beats). A full pool serves nobody.
// A pipelined port finds the next ray's place while the last one's beats move, if there is room by then.
#pragma once

#include <cstdint>
#include <systemc>

#include "chip/chip_clock.hpp"
#include "chip/interfaces.hpp"
#include "chip/statistics.hpp"
#include "config/configuration.hpp"
#include "machine/packages.hpp"

namespace raypool::chip {

class RayPool : public sc_core::sc_module, public RayExportIf, public RaySourceIf, public RayLevelIf {
 public:
  /// Normal rays deeper than `depth` are dropped when they arrive; with chip.culling, so are rays without weight.
  RayPool(const sc_core::sc_module_name& name, const ChipConfiguration& chip, uint32_t depth);

  sc_core::sc_port<TimeIf> clock{"clock"};
  sc_core::sc_port<LedgerIf> ledger{"ledger"};
  sc_core::sc_port<RayArrivalIf, 0, sc_core::SC_ZERO_OR_MORE_BOUND> arrivals{"arrivals"};
  sc_core::sc_export<RayExportIf> device{"device"};
  sc_core::sc_export<RaySourceIf> traverser{"traverser"};
  sc_core::sc_export<RayLevelIf> controller{"controller"};

  void want() override;
  void take(uint32_t unit, const Beat& beat, bool last) override;
  bool held_up() const override { return beats_from() == kNever && full() && clock->cycle() > kept_at_; }

  PooledRays& rays() override { return rays_; }
  void removed(uint32_t shadow_rays) override;

  uint32_t size() const override { return size32(rays_); }
  uint32_t shadow_rays() const override { return shadow_rays_; }
  bool full() const { return rays_.size() >= capacity_; }
  uint32_t capacity() const { return capacity_; }
  uint64_t taken() const { return taken_; }  ///< rays transferred, dropped ones too
  uint64_t dropped_depth() const { return dropped_depth_; }
  uint64_t busy_cycles() const { return busy_cycles_; }  ///< of the port
  const LevelStatistics& fill() const { return fill_; }

 private:
  void keep(bool shadow);

  size_t capacity_;
  uint64_t overhead_, cycles_per_beat_;
  bool pipelined_;
  bool culling_;
  uint32_t depth_;
  uint64_t begun_ = 0;       // cycle in which the ray that arrives was
  uint64_t first_beat_ = 0;  // its
  bool ahead_ = false;       // its overhead has run before it was begun
  uint64_t free_from_ = 0;   // the next one may be
  bool wanting_ = false;     // a ray is offered, and there is no room
  uint64_t kept_at_ = 0;
  Ray arriving_{};
  size_t beats_ = 0;
  PooledRays rays_;
  uint32_t shadow_rays_ = 0;
  uint64_t taken_ = 0, dropped_depth_ = 0, busy_cycles_ = 0;
  LevelStatistics fill_;
};

}  // namespace raypool::chip
