// The intersection pool: intersections of normal and of shadow rays, and with chip.culling those of normal rays that
// need no reflection apart, a queue for each kind, behind one 128-bit port.
//
// A whole intersection costs the port its overhead and 6 beats: 8 cycles, as the thesis has it. There a request in
// cycle c to an idle port is taken in c+1, and the beats move in c+2 .. c+7; a compact record has fewer beats. With
// less overhead, 1, a request is taken while the beats before it end; with more it is taken later. The oldest package
// of the kind goes first. Its place is free as soon as its request is taken (the port keeps it in a register of its
// own). A pipelined port has two of these: it takes the next request while the beats of the last package move, and then
// its beats follow at once.
//
// Whoever launches a kernel reserves its packages at once, so that available() never promises the same package twice.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <systemc>

#include "chip/chip_clock.hpp"
#include "chip/interfaces.hpp"
#include "chip/statistics.hpp"
#include "config/configuration.hpp"
#include "enum_array.hpp"
#include "machine/compute_unit.hpp"
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

  bool full(ImportKind kind) const override { return queue(kind).size() >= capacity_; }
  void put(ImportKind kind, const Intersection& intersection) override;

  uint32_t available(ImportKind kind) const override { return size(kind) - reserved_[kind]; }
  void reserve(ImportKind kind, uint32_t count) override { reserved_[kind] += count; }

  uint32_t size(ImportKind kind) const override { return size32(queue(kind)); }
  uint32_t capacity() const { return capacity_; }
  uint64_t taken() const { return taken_; }  ///< packages given to units
  uint64_t busy_cycles() const { return taken_ * service_cycles_; }
  const LevelStatistics& fill(ImportKind kind) const { return fill_[kind]; }

 private:
  std::deque<Intersection>& queue(ImportKind kind) { return queues_[kind]; }
  const std::deque<Intersection>& queue(ImportKind kind) const { return queues_[kind]; }
  void give();
  /// When the request that waits will be taken, if its turn begins in this cycle or as soon as the port is free.
  uint64_t due();

  struct Leaving {
    uint64_t first_beat;                                          // its cycle
    std::array<uint32_t, kIntersectionBeats * kBeatWords> words;  // the last beat ends with zeros
  };

  size_t capacity_;  // of each kind
  RecordLayout layout_;
  size_t beats_;  // of a record
  uint64_t cycles_per_beat_;
  bool pipelined_;
  uint64_t service_cycles_;  // that a package keeps the port
  uint64_t request_cycles_;  // from a request's turn until it is taken
  EnumArray<ImportKind, std::deque<Intersection>, kImportKinds> queues_;
  EnumArray<ImportKind, uint32_t, kImportKinds> reserved_{};
  ImportKind wanting_ = ImportKind::None;  // a package of this kind
  uint32_t wanting_unit_ = 0;
  uint64_t free_from_ = 0;       // the next request can be served
  uint64_t register_from_ = 0;   // the register for the next package is free
  uint64_t beats_from_ = 0;      // its first beat may move
  std::deque<Leaving> leaving_;  // taken, and not gone
  size_t next_beat_ = 0;         // of the oldest
  uint64_t taken_ = 0;
  EnumArray<ImportKind, LevelStatistics, kImportKinds> fill_;
};

}  // namespace raypool::chip
