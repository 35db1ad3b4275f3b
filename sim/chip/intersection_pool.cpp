#include "chip/intersection_pool.hpp"

#include <algorithm>
#include <stdexcept>

namespace raypool::chip {

IntersectionPool::IntersectionPool(const sc_core::sc_module_name& name, const ChipConfiguration& chip,
                                   const RecordLayout& layout)
    : sc_module(name),
      capacity_(chip.intersection_pool_size),
      layout_(layout),
      beats_((layout.words + kBeatWords - 1) / kBeatWords),
      cycles_per_beat_(chip.intersection_pool_cycles_per_beat),
      pipelined_(chip.intersection_pool_pipelined),
      service_cycles_(pipelined_ ? std::max<uint64_t>(chip.intersection_pool_overhead, beats_ * cycles_per_beat_)
                                 : chip.intersection_pool_overhead + beats_ * cycles_per_beat_),
      request_cycles_(std::max(2u, chip.intersection_pool_overhead) - 1) {
  device.bind(*this);
  traverser.bind(*this);
  controller.bind(*this);
}

// Only this port takes packages out: once there is one of the kind, it is known when the request will be taken.
bool IntersectionPool::request(uint32_t unit, ImportKind kind) {
  if (wanting_ == ImportKind::None) {
    wanting_ = kind;
    wanting_unit_ = unit;
    if (!queue(kind).empty()) request_due_ = due();
  }
  if (request_due_ != clock->cycle()) return false;
  give();
  return true;
}

void IntersectionPool::put(ImportKind kind, const Intersection& intersection) {
  queue(kind).push_back(intersection);
  fill_[kind].set(clock->cycle(), size(kind));
  if (wanting_ != kind || request_due_ != kNever) return;
  request_due_ = due();
}

uint64_t IntersectionPool::due() {
  free_from_ = std::max(free_from_, clock->cycle());
  return std::max(free_from_ + request_cycles_, register_from_);
}

// The package has left its queue in the cycle before.
void IntersectionPool::give() {
  const ImportKind kind = wanting_;
  const Intersection& package = queue(kind).front();
  Leaving& leaving = leaving_.emplace_back();
  const Intersection record = packed(package, layout_);
  std::copy(record.begin(), record.end(), leaving.words.begin());
  ledger->imported(wanting_unit_, package[word::kPixel]);
  queue(kind).pop_front();
  --reserved_[kind];
  ++taken_;
  fill_[kind].set(request_due_ - 1, size(kind));
  leaving.first_beat = std::max(request_due_ + 1, beats_from_);
  beats_from_ = leaving.first_beat + beats_ * cycles_per_beat_;
  register_from_ = leaving.first_beat;
  free_from_ = pipelined_ ? request_due_ + 1 : request_due_ - request_cycles_ + service_cycles_;
  if (leaving_.size() == 1) beat_due_ = leaving.first_beat;
  request_due_ = kNever;
  wanting_ = ImportKind::None;
  for (int i = 0; i < room.size(); ++i) room[i]->room_made(kind);
}

void IntersectionPool::beat(Beat& beat) {
  if (beat_due_ != clock->cycle())
    throw std::logic_error("the device was not clocked when a beat of an intersection came");
  std::copy_n(&leaving_.front().words[next_beat_ * kBeatWords], kBeatWords, beat.begin());
  if (++next_beat_ < beats_) {
    beat_due_ += cycles_per_beat_;
    return;
  }
  next_beat_ = 0;
  leaving_.pop_front();
  beat_due_ = leaving_.empty() ? kNever : leaving_.front().first_beat;
}

}  // namespace raypool::chip
