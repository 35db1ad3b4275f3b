#include "chip/intersection_pool.hpp"

#include <stdexcept>

namespace raypool::chip {

IntersectionPool::IntersectionPool(const sc_core::sc_module_name& name, const ChipConfiguration& chip,
                                   const RecordLayout& layout)
    : sc_module(name), pool_(chip, layout) {
  device.bind(*this);
  traverser.bind(*this);
  controller.bind(*this);
}

// The package has left its queue in the cycle before.
bool IntersectionPool::request(uint32_t unit, ImportKind kind) {
  const bool taken = pool_.request(clock->cycle(), kind);
  request_due_ = pool_.request_due();
  if (!taken) return false;
  beat_due_ = pool_.beat_due();
  ledger->imported(unit, pool_.given()[word::kPixel]);
  fill_[kind].set(clock->cycle() - 1, size(kind));
  for (int i = 0; i < room.size(); ++i) room[i]->room_made(kind);
  return true;
}

void IntersectionPool::put(ImportKind kind, const Intersection& intersection) {
  pool_.put(clock->cycle(), kind, intersection);
  request_due_ = pool_.request_due();
  fill_[kind].set(clock->cycle(), size(kind));
}

void IntersectionPool::beat(Beat& beat) {
  if (beat_due_ != clock->cycle())
    throw std::logic_error("the device was not clocked when a beat of an intersection came");
  pool_.beat(beat);
  beat_due_ = pool_.beat_due();
}

}  // namespace raypool::chip
