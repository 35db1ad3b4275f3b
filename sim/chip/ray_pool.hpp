// The ray pool: rays that units have exported and the traverser has not finished, oldest first, behind one 128-bit
// port, whose cycles are those of machine/ray_pool.hpp.
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
#include "machine/ray_pool.hpp"

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
  bool held_up() const override { return pool_.held_up(clock->cycle()); }

  PooledRays& rays() override { return rays_; }
  PooledRays::iterator remove(PooledRays::iterator ray) override;

  uint32_t size() const override { return pool_.size(); }
  uint32_t shadow_rays() const override { return pool_.shadow_rays(); }
  uint32_t capacity() const { return pool_.capacity(); }
  uint64_t taken() const { return pool_.taken(); }  ///< rays transferred, dropped ones too
  uint64_t dropped_depth() const { return dropped_depth_; }
  uint64_t busy_cycles() const { return pool_.busy_cycles(); }  ///< of the port
  const LevelStatistics& fill() const { return fill_; }

 private:
  raypool::RayPool pool_;
  int beats_ = 0;  // of the ray that arrives
  PooledRays rays_;
  uint64_t dropped_depth_ = 0;
  LevelStatistics fill_;
};

}  // namespace raypool::chip
