// The intersection pool: intersections of normal and of shadow rays, and with chip.culling those of normal rays that
// need no reflection apart, a queue for each kind, behind one 128-bit port.
//
// A whole intersection costs the port its overhead and 6 beats: 8 cycles, as the thesis has it. There a request in
// cycle c to an idle port is taken in c+1, and the beats move in c+2 .. c+7; a compact record has fewer beats. With
// less overhead, 1, a request is taken while the beats before it end; with more it is taken later. The oldest package
// of the kind goes first. Its place is free as soon as its request is taken (the port keeps it in a register of its
// own). A pipelined port has two of these: it takes the next request while the beats of the last package move, and then
// its beats follow at once. The cycles are those of machine/intersection_pool.hpp.
//
// Whoever launches a kernel reserves its packages at once, so that available() never promises the same package twice.
#pragma once

#include <cstdint>
#include <systemc>

#include "chip/chip_clock.hpp"
#include "chip/interfaces.hpp"
#include "chip/statistics.hpp"
#include "config/configuration.hpp"
#include "enum_array.hpp"
#include "machine/compute_unit.hpp"
#include "machine/intersection_pool.hpp"
#include "machine/packages.hpp"

namespace raypool::chip {

class IntersectionPool : public sc_core::sc_module,
                         public ImportIf,
                         public IntersectionSinkIf,
                         public IntersectionLevelIf {
 public:
  /// `layout`: of the records that leave.
  IntersectionPool(const sc_core::sc_module_name& name, const ChipConfiguration& chip, const RecordLayout& layout = {});

  sc_core::sc_port<TimeIf> clock{"clock"};
  sc_core::sc_port<LedgerIf> ledger{"ledger"};
  sc_core::sc_port<RoomIf, 0, sc_core::SC_ZERO_OR_MORE_BOUND> room{"room"};
  sc_core::sc_export<ImportIf> device{"device"};
  sc_core::sc_export<IntersectionSinkIf> traverser{"traverser"};
  sc_core::sc_export<IntersectionLevelIf> controller{"controller"};

  bool request(uint32_t unit, ImportKind kind) override;
  void beat(Beat& beat) override;

  bool full(ImportKind kind) const override { return pool_.full(kind); }
  void put(ImportKind kind, const Intersection& intersection) override;

  uint32_t available(ImportKind kind) const override { return pool_.available(kind); }
  void reserve(ImportKind kind, uint32_t count) override { pool_.reserve(kind, count); }

  uint32_t size(ImportKind kind) const override { return pool_.size(kind); }
  uint32_t capacity() const { return pool_.capacity(); }
  uint64_t taken() const { return pool_.taken(); }  ///< packages given to units
  uint64_t busy_cycles() const { return pool_.busy_cycles(); }
  const LevelStatistics& fill(ImportKind kind) const { return fill_[kind]; }

 private:
  raypool::IntersectionPool pool_;
  EnumArray<ImportKind, LevelStatistics, kImportKinds> fill_;
};

}  // namespace raypool::chip
