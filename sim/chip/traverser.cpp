#include "chip/traverser.hpp"

#include <stdexcept>

#include "chip/modelled_traverser.hpp"
#include "chip/static_traverser.hpp"

namespace raypool::chip {

Traverser::Traverser(const sc_core::sc_module_name& name, const Tracing& tracing)
    : sc_module(name),
      tracer_(tracing.tracer),
      fates_(tracing.tracer, tracing.chip, tracing.depth, tracing.reflections) {
  kernel_events.bind(*this);
  arrivals.bind(*this);
  room.bind(*this);
  memory_user.bind(*this);
  SC_METHOD(next_contribution);
  sensitive << frame_free_;
  dont_initialize();
}

void Traverser::trace(PooledRay& ray) {
  ray.traced = true;
  ray.goes_on = tracer_.trace(ray.ray, ray.intersection);
  counts_.rays.count(ray.ray, ray.goes_on);
}

void Traverser::follow(PooledRay& ray, VisitList& visits) {
  ray.goes_on = tracer_.follow(ray.ray, ray.intersection, visits);
  counts_.rays.count(ray.ray, ray.goes_on);
}

// True if the result of the ray, which goes on, has left.
bool Traverser::deliver(const PooledRay& ray) {
  const ImportKind kind = kind_of(ray);
  if (fates_.contributes(kind)) return contribute(ray.ray);
  if (intersections->full(kind)) return false;
  counts_.deepest += fates_.deepest(ray.ray, kind);
  intersections->put(kind, ray.intersection);
  return true;
}

bool Traverser::contribute(const Ray& ray) {
  const FrameContribution contribution = contribution_of(ray);
  if (!frame->offer(contribution)) {
    clock->notify(frame_free_, Phase::Traverser, 1);
    return false;
  }
  ledger->ray_dropped(contribution.pixel);
  return true;
}

void Traverser::next_contribution() {
  clock->guard([&] { deliver_traced(); });
}

bool Traverser::leave(const PooledRay& ray) {
  if (ray.goes_on) {
    const bool delivered = deliver(ray);
    counts_.delivered += delivered;
    return delivered;
  }
  ledger->ray_dropped(ray.ray[word::kPixel]);
  return true;
}

bool Traverser::may_leave(const PooledRay& ray) const {
  return !ray.goes_on || fates_.contributes(kind_of(ray)) || !intersections->full(kind_of(ray));
}

WorkDone Traverser::work_done() { return {0, counts_.rays.traced() + counts_.delivered, kNever}; }

void Traverser::left(uint32_t count) {
  if (count != 0) controller->changed();
}

uint32_t Traverser::advance(uint32_t budget) {
  PooledRays& pool = rays->rays();
  uint32_t count = 0;
  for (auto ray = pool.begin(); ray != pool.end();) {
    if (!ray->traced && budget > 0) {
      --budget;
      trace(*ray);
    }
    if (ray->traced && leave(*ray)) {
      ++count;
      ray = rays->remove(ray);
    } else {
      ++ray;
    }
  }
  left(count);
  return count;
}

std::unique_ptr<Traverser> make_traverser(const Tracing& tracing) {
  switch (tracing.timed ? tracing.chip.traverser : TraverserName::Static) {
    case TraverserName::Static:
      return std::make_unique<StaticTraverser>("traverser", tracing);
    case TraverserName::Modelled:
    case TraverserName::Lanes:
      return std::make_unique<ModelledTraverser>("traverser", tracing);
    case TraverserName::Hardware:
      throw std::logic_error("the traverser of the hardware is in no chip of SystemC");
  }
  throw std::logic_error("a traverser without a class");
}

}  // namespace raypool::chip
