// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/chip/rp_intersection_pool.v: the intersection pool's queues, its port to the units, and its levels.
//
// It is passed each event, with its cycle, and gives the cycle in which a request is taken and a beat comes: so it need
// not be called in the others. Within a cycle the units come first, then the traverser.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>

#include "config/configuration.hpp"
#include "enum_array.hpp"
#include "machine/common/packages.hpp"
#include "machine/common/port_cycles.hpp"
#include "machine/compute/compute_unit.hpp"

namespace raypool {

class IntersectionPool {
 public:
  /// `layout`: of the records that leave.
  explicit IntersectionPool(const ChipConfiguration& chip, const RecordLayout& layout = {})
      : capacity_(chip.intersection_pool_size),
        layout_(layout),
        beats_(beats(layout.words)),
        cycles_per_beat_(chip.intersection_pool_cycles_per_beat),
        pipelined_(chip.intersection_pool_pipelined),
        service_cycles_(service_cycles(chip, layout.words)),
        request_cycles_(std::max(2u, chip.intersection_pool_overhead) - 1) {}

  /// Of a record of so many words.
  static uint32_t beats(uint32_t words) { return (words + kBeatWords - 1) / kBeatWords; }
  /// That such a record keeps the port.
  static uint64_t service_cycles(const ChipConfiguration& chip, uint32_t words) {
    const uint64_t moving = uint64_t{beats(words)} * chip.intersection_pool_cycles_per_beat;
    return chip.intersection_pool_pipelined ? std::max<uint64_t>(chip.intersection_pool_overhead, moving)
                                            : chip.intersection_pool_overhead + moving;
  }

  /// Cycle in which the request that waits is taken; kNever: none waits, or the pool has nothing of its kind.
  uint64_t request_due() const { return request_due_; }
  /// A request of `unit` for a package of `kind` is shown, until it is taken. True if that is in this cycle.
  /// Only this port takes packages out: once there is one of the kind, it is known when the request will be taken.
  bool request(uint64_t cycle, ImportKind kind, uint32_t unit = 0) {
    if (wanting_ == ImportKind::None) {
      wanting_ = kind;
      if (!queues_[kind].empty()) request_due_ = due(cycle);
    }
    if (request_due_ != cycle) return false;
    give(unit);
    return true;
  }
  /// The package of the last request that was taken.
  const Intersection& given() const { return given_; }

  /// Cycle of the next beat; kNever: none is on its way.
  uint64_t beat_due() const { return beat_due_; }
  /// Which one that is, of its package, and the unit that has asked for this.
  uint32_t beat_number() const { return next_beat_; }
  uint32_t beat_unit() const { return leaving_.front().unit; }
  /// The beat that is due.
  void beat(Beat& beat) {
    const Intersection& record = leaving_.front().record;
    for (uint32_t word = 0, from = next_beat_ * kBeatWords; word < kBeatWords; ++word, ++from)
      beat[word] = from < record.size() ? record[from] : 0;  // the last beat ends with zeros
    if (++next_beat_ < beats_) {
      beat_due_ += cycles_per_beat_;
      return;
    }
    next_beat_ = 0;
    leaving_.pop_front();
    beat_due_ = leaving_.empty() ? kNever : leaving_.front().first_beat;
  }

  /// A package has come, all of it. There must be room.
  void put(uint64_t cycle, ImportKind kind, const Intersection& intersection) {
    queues_[kind].push_back(intersection);
    ++sizes_[kind];
    if (wanting_ == kind && request_due_ == kNever) request_due_ = due(cycle);
  }

  /// The same beat by beat, as records have it; a package that has begun to come has its place.
  bool put_ready(ImportKind kind) const { return put_beats_ != 0 || !full(kind); }
  void put_beat(uint64_t cycle, ImportKind kind, const Beat& beat) {
    for (uint32_t word = 0, to = put_beats_ * kBeatWords; word < kBeatWords && to < put_.size(); ++word, ++to)
      put_[to] = beat[word];
    if (++put_beats_ < beats_) return;
    put_beats_ = 0;
    put(cycle, kind, put_);
  }

  bool full(ImportKind kind) const { return sizes_[kind] >= capacity_; }
  uint32_t size(ImportKind kind) const { return sizes_[kind]; }
  /// Packages that no launch has reserved.
  uint32_t available(ImportKind kind) const { return size(kind) - reserved_[kind]; }
  void reserve(ImportKind kind, uint32_t count) { reserved_[kind] += count; }

  uint32_t capacity() const { return capacity_; }
  uint64_t taken() const { return taken_; }  ///< packages given to units
  uint64_t busy_cycles() const { return taken_ * service_cycles_; }

 private:
  /// When the request that waits will be taken, if its turn begins in this cycle or as soon as the port is free.
  uint64_t due(uint64_t cycle) {
    free_from_ = std::max(free_from_, cycle);
    return std::max(free_from_ + request_cycles_, register_from_);
  }
  void give(uint32_t unit) {
    std::deque<Intersection>& queue = queues_[wanting_];
    given_ = queue.front();
    queue.pop_front();
    --sizes_[wanting_];
    --reserved_[wanting_];
    ++taken_;
    const uint64_t first_beat = std::max(request_due_ + 1, beats_from_);
    leaving_.push_back({first_beat, unit, packed(given_, layout_)});
    beats_from_ = first_beat + beats_ * cycles_per_beat_;
    register_from_ = first_beat;
    free_from_ = pipelined_ ? request_due_ + 1 : request_due_ - request_cycles_ + service_cycles_;
    if (leaving_.size() == 1) beat_due_ = first_beat;
    request_due_ = kNever;
    wanting_ = ImportKind::None;
  }

  struct Leaving {
    uint64_t first_beat;  // its cycle
    uint32_t unit;
    Intersection record;
  };

  uint32_t capacity_;  // of each kind
  RecordLayout layout_;
  uint32_t beats_;  // of a record
  uint64_t cycles_per_beat_;
  bool pipelined_;
  uint64_t service_cycles_;  // that a package keeps the port
  uint64_t request_cycles_;  // from a request's turn until it is taken
  EnumArray<ImportKind, std::deque<Intersection>, kImportKinds> queues_;
  EnumArray<ImportKind, uint32_t, kImportKinds> sizes_{}, reserved_{};
  ImportKind wanting_ = ImportKind::None;  // a package of this kind
  uint64_t request_due_ = kNever, beat_due_ = kNever;
  uint64_t free_from_ = 0;       // the next request can be served
  uint64_t register_from_ = 0;   // the register for the next package is free
  uint64_t beats_from_ = 0;      // its first beat may move
  std::deque<Leaving> leaving_;  // taken, and not gone
  uint32_t next_beat_ = 0;       // of the oldest
  Intersection given_{}, put_{};
  uint32_t put_beats_ = 0;  // of the package that comes
  uint64_t taken_ = 0;
};

}  // namespace raypool
