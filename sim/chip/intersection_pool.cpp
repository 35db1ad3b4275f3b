#include "chip/intersection_pool.hpp"

namespace raypool::chip {

IntersectionPool::IntersectionPool(const sc_core::sc_module_name& name, ChipClock& clock, PixelLedger& ledger, int capacity)
    : sc_module(name), clock_(clock), ledger_(ledger), capacity_(static_cast<size_t>(capacity)), work_(clock, [this] {
        serve();
      }) {}

void IntersectionPool::want(uint32_t unit, ImportKind kind) {
  wanting_ = kind;
  wanting_unit_ = unit;
  const uint64_t now = clock_.cycle();
  work_.ask(free_at_ > now ? free_at_ - now : 0);
}

void IntersectionPool::next_beat(Beat& beat) const {
  const uint64_t now = clock_.cycle();
  const auto first = static_cast<size_t>(now - granted_at_ - kPoolOverhead) * kBeatWords;
  for (size_t i = 0; i < kBeatWords; ++i) beat[i] = first + i < kIntersectionWords ? leaving_[first + i] : 0;
}

void IntersectionPool::put(ImportKind kind, const Intersection& intersection) {
  queue(kind).push_back(intersection);
  fill_[number(kind)].set(clock_.cycle(), size(kind));
}

void IntersectionPool::serve() {
  const uint64_t now = clock_.cycle();
  if (now < free_at_) return work_.ask(free_at_ - now);
  const ImportKind kind = wanting_;
  if (kind == ImportKind::None || queue(kind).empty()) return;
  wanting_ = ImportKind::None;
  granted_ = true;
  granted_at_ = now;
  free_at_ = now + kServiceCycles;
  leaving_ = queue(kind).front();
  queue(kind).pop_front();
  --reserved_[number(kind)];
  ++taken_;
  fill_[number(kind)].set(now, size(kind));
  ledger_.imported(static_cast<int>(wanting_unit_), leaving_[word::kPixel]);
}

}  // namespace raypool::chip
