// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/chip/rp_memory_port.v: the chip's memory port, which device and traverser share.
//
// The port is passed each event, with its cycle, and gives the cycle in which the next request is served and the next
// beat is handed on: so it need not be called in the others. Within a cycle the memory comes first, taking what it is
// offered, then the device, then the traverser, then the service; then beats are handed on.
//
// A memory that takes everything at once can be run ahead of time: serve() and taken() may be called as soon as there
// is a request, and the line's beats be given.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <vector>

#include "config/configuration.hpp"
#include "machine/common/memory_line.hpp"
#include "machine/common/port_cycles.hpp"
#include "machine/common/ram_queue.hpp"
#include "machine/compute/compute_unit.hpp"
#include "machine/traverser/tree_lines.hpp"

namespace raypool {

class MemoryPort {
 public:
  /// What the memory is asked.
  struct Access {
    bool traverser = false;  ///< in its memory
    MemoryRequest request;   ///< of the traverser without an id
  };
  struct Limits {
    uint32_t lines = UINT32_MAX;    ///< most on their way
    uint32_t traverser_queue = 32;  ///< requests of the traverser that wait

    /// As rtl/chip/rp_chip.v has them: lines enough for the memory's latency.
    static Limits of(const ChipConfiguration& chip) {
      const uint32_t line = MemoryLine::kBeats * chip.memory_cycles_per_beat;
      return {std::max(chip.memory_latency, line) / line + 1, tree_requests(chip)};
    }
  };

  MemoryPort(const ChipConfiguration& chip, const Limits& limits)
      : cycles_per_beat_(chip.memory_cycles_per_beat),
        limits_(limits),
        place_free_from_(chip.memory_queue),
        waiting_(chip.memory_queue + limits.traverser_queue) {}

  // ---- Requests

  /// Cycle from which on a request of the device is taken; kNever: one must be served before.
  uint64_t room_from() const { return place_free_from_[place_]; }
  /// The device's; there must be room.
  void request(uint64_t cycle, const MemoryRequest& request) {
    place_free_from_[place_] = kNever;
    place_ = behind(place_);
    ++(request.write ? writing_ : reading_)[unit_of_id(request.id)];
    waiting_.push({cycle, false, false, request, {}});
  }
  bool traverser_room() const { return traverser_waiting_ < limits_.traverser_queue; }
  /// The traverser's; there must be room.
  void request(uint64_t cycle, const TreeRequest& request) {
    ++traverser_waiting_;
    waiting_.push(
        {cycle, true, request.second, {request.write, request.address, request.data[0], 15, 0}, request.data[1]});
  }

  // ---- Service

  bool waits() const { return waiting_.valid(); }
  /// Cycle from which on the oldest request, or its second part, can be served, as things stand; kNever: none waits,
  /// the memory has not taken what it is offered, or a line must come back before. May be past.
  uint64_t start() const {
    if (!waits() || offers_ || (!oldest().write && lines_on_way_ == limits_.lines)) return kNever;
    return std::max({free_from_, taken_at_, waiting_.data().cycle});
  }
  /// Serves it. The memory is offered the access from the next cycle on.
  const Access& serve(uint64_t cycle) {
    const Waiting& waiting = waiting_.data();
    access_ = {waiting.traverser, oldest()};
    offers_ = true;
    const uint32_t beats = access_.request.write ? 1 : MemoryLine::kBeats;
    free_from_ = cycle + beats * cycles_per_beat_;
    beats_ += beats;
    if (!access_.request.write) {
      ++lines_on_way_;
      lines_.push_back({cycle, waiting.traverser, access_.request.id});
    }
    if (waiting.traverser) {
      second_part_ = waiting.second && !second_part_;
      if (second_part_) return access_;
      --traverser_waiting_;
    } else {
      ++(access_.request.write ? writes_ : reads_);
      place_free_from_[place_served_] = cycle + 1;
      place_served_ = behind(place_served_);
    }
    waiting_.pop();
    return access_;
  }

  /// The memory is offered access(), from the cycle after its service on.
  bool offers() const { return offers_; }
  const Access& access() const { return access_; }  ///< means something while offers()
  /// The memory takes it.
  void taken(uint64_t cycle) {
    offers_ = false;
    taken_at_ = cycle;
    if (access_.traverser || !access_.request.write) return;
    const uint32_t unit = unit_of_id(access_.request.id);
    --writing_[unit];
    written_[unit] = cycle;
  }

  // ---- Lines that come back

  /// A beat that the memory gives in this cycle is taken.
  bool beat_ready() const { return beats_held_ < kPlaces; }
  /// The memory gives the next beat of the oldest line that misses some. Returns the cycle in which it is handed on.
  uint64_t beat(uint64_t cycle, const Beat& data) { return hand_on(cycle + 1, data); }
  /// The same of a whole line with beats that come at the port's own pace, so that the last could be handed on in
  /// `end`. Returns the cycle in which it is.
  uint64_t line(uint64_t end, const std::array<Beat, MemoryLine::kBeats>& data) {
    uint64_t last = 0;
    for (uint32_t i = 0; i < MemoryLine::kBeats; ++i) {
      const uint64_t before = (MemoryLine::kBeats - 1 - i) * cycles_per_beat_;
      last = hand_on(end - std::min(end, before), data[i]);
    }
    return last;
  }
  /// Cycle of the next beat for the device; kNever: none has come.
  uint64_t response_due() const { return device_beats_.empty() ? kNever : device_beats_.front().due; }
  const MemoryResponse& next_response() const { return device_beats_.front().response; }
  /// Hands it on.
  MemoryResponse response() {
    const MemoryResponse response = pop(device_beats_);
    if (response.beat == MemoryLine::kBeats - 1) --reading_[unit_of_id(response.id)];
    return response;
  }
  /// The same for the traverser; the id means nothing.
  uint64_t traverser_response_due() const { return traverser_beats_.empty() ? kNever : traverser_beats_.front().due; }
  const MemoryResponse& next_traverser_response() const { return traverser_beats_.front().response; }
  MemoryResponse traverser_response() { return pop(traverser_beats_); }

  // ---- For others

  /// True if nothing of compute unit `unit` waits or is on its way when this cycle is over: reads that have not had
  /// their last beat handed on, writes that the memory has not taken.
  bool quiet(uint64_t cycle, uint32_t unit) const {
    return reading_[unit] == 0 && writing_[unit] == 0 && cycle >= written_[unit];
  }
  /// True if nothing of any client does, as things stand.
  bool idle() const { return !waits() && !offers_ && lines_on_way_ == 0; }
  uint64_t reads() const { return reads_; }    ///< lines, of the device
  uint64_t writes() const { return writes_; }  ///< quadwords, of the device
  uint64_t busy_cycles() const { return beats_ * cycles_per_beat_; }

 private:
  static constexpr uint32_t kPlaces = 2;  // of beats: one is filled while the other one leaves

  struct Waiting {
    uint64_t cycle;  // in which it came
    bool traverser, second;
    MemoryRequest request;
    Beat second_data;
  };
  struct Line {
    uint64_t start;
    bool traverser;
    uint8_t id;
  };
  struct DueBeat {
    uint64_t due;
    MemoryResponse response;
  };

  size_t behind(size_t place) const { return place + 1 == place_free_from_.size() ? 0 : place + 1; }
  /// What the oldest request asks for now.
  MemoryRequest oldest() const {
    MemoryRequest request = waiting_.data().request;
    if (!second_part_) return request;
    request.address += request.write ? MemoryLine::kQuadwordBytes : MemoryLine::kBytes;
    request.data = waiting_.data().second_data;
    return request;
  }
  // A line's first beat is apart from its service, and each from the one before, whosever it was.
  uint64_t hand_on(uint64_t from, const Beat& data) {
    const Line& line = lines_.front();
    if (next_beat_ == 0) beat_from_ = std::max(beat_from_, line.start + cycles_per_beat_);
    const uint64_t due = std::max(from, beat_from_);
    beat_from_ = due + cycles_per_beat_;
    ++beats_held_;
    (line.traverser ? traverser_beats_ : device_beats_).push_back({due, {line.id, next_beat_, data}});
    if (++next_beat_ == MemoryLine::kBeats) {
      next_beat_ = 0;
      lines_.pop_front();
    }
    return due;
  }
  MemoryResponse pop(std::deque<DueBeat>& beats) {
    const MemoryResponse response = beats.front().response;
    beats.pop_front();
    --beats_held_;
    if (response.beat == MemoryLine::kBeats - 1) --lines_on_way_;
    return response;
  }

  uint64_t cycles_per_beat_;
  Limits limits_;
  std::vector<uint64_t> place_free_from_;  // a ring: of the latest requests that may wait, the oldest at `place_`
  size_t place_ = 0, place_served_ = 0;
  RamQueue<Waiting> waiting_;
  uint32_t traverser_waiting_ = 0;
  bool second_part_ = false;  // the oldest has had its first part
  uint64_t free_from_ = 0;    // the next request can be served
  bool offers_ = false;
  Access access_;
  uint64_t taken_at_ = 0;
  std::deque<Line> lines_;  // of which a beat has not come
  uint8_t next_beat_ = 0;   // of the oldest
  uint32_t lines_on_way_ = 0;
  uint32_t beats_held_ = 0;
  uint64_t beat_from_ = 0;  // the next beat can be handed on
  std::deque<DueBeat> device_beats_, traverser_beats_;
  std::array<uint32_t, kMostUnits> reading_{}, writing_{};  // [unit]
  std::array<uint64_t, kMostUnits> written_{};              // [unit] in which the memory took the last one
  uint64_t reads_ = 0, writes_ = 0, beats_ = 0;
};

}  // namespace raypool
