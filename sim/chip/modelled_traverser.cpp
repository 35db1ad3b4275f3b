#include "chip/modelled_traverser.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <stdexcept>

#include "traverser/core.hpp"
#include "traverser/lanes.hpp"

namespace raypool::chip {

namespace {

std::unique_ptr<traverser::Machine> make_machine(const ChipConfiguration& chip, traverser::MemoryTurns& turns) {
  if (chip.traverser == TraverserName::Lanes) return std::make_unique<traverser::Lanes>(chip, turns);
  return std::make_unique<traverser::Core>(chip, turns);
}

}  // namespace

ModelledTraverser::ModelledTraverser(const sc_core::sc_module_name& name, const Tracing& tracing)
    : Traverser(name, tracing), machine_(make_machine(tracing.chip, *this)), in_flight_(machine_->capacity()) {
  SC_METHOD(step);
  sensitive << step_;
  dont_initialize();
}

void ModelledTraverser::ray_arrived() {
  if (untaken_.empty()) next_ray_ = std::prev(rays->rays().end());
  untaken_.push_back(clock->cycle());
  clock->notify(step_, Phase::Traverser, machine_->least_latency());
}

void ModelledTraverser::room_made(ImportKind kind) {
  if (!held_back_[kind].empty()) clock->notify(step_, Phase::Traverser);
}

void ModelledTraverser::catch_up(uint64_t cycle) {
  if (simulate(cycle - 1)) throw std::logic_error("a ray left the traverser sooner than it could");
}

// The machine may be far behind: up to here its work is that of the present.
WorkDone ModelledTraverser::work_done() {
  catch_up(clock->cycle());
  WorkDone done = Traverser::work_done();
  done.other += machine_->work().steps();
  done.due = machine_->line_due();
  return done;
}

std::string ModelledTraverser::describe() {
  const auto held = [&](ImportKind kind) { return held_back_[kind].size(); };
  const size_t done = held(ImportKind::Normal) + held(ImportKind::Shadow) + held(ImportKind::Direct);
  return fmt::format(
      "traverser: {} rays in flight, {} wait to enter, {} are done and wait for room ({} normal, {} shadow and {} "
      "direct "
      "ones); {}",
      rays->rays().size() - untaken_.size() - done, untaken_.size(), done, held(ImportKind::Normal),
      held(ImportKind::Shadow), held(ImportKind::Direct),
      machine_->line_due() == kNever ? "none waits for a line of the memory"
                                     : fmt::format("a line of the memory comes in cycle {}", machine_->line_due()));
}

bool ModelledTraverser::simulate(uint64_t to) {
  while (now_ < to) {
    uint64_t next = machine_->next();
    if (machine_->ready() && !untaken_.empty()) next = std::min(next, untaken_.front());
    next = std::max(next, now_ + 1);
    if (next > to) break;
    now_ = next;
    machine_->clock(now_);
    const bool done = machine_->valid();
    if (done) ray_done();
    if (machine_->ready() && !untaken_.empty() && untaken_.front() <= now_) take_ray();
    if (done) return true;
  }
  now_ = std::max(now_, to);
  return false;
}

// The oldest that has not entered.
void ModelledTraverser::take_ray() {
  const auto ray = next_ray_++;
  untaken_.pop_front();
  visits_.clear();
  follow(*ray, visits_);
  in_flight_[machine_->push(visits_)] = ray;
}

// One that leaves nothing needs no room, and is of no kind.
void ModelledTraverser::ray_done() {
  const PooledRays::iterator ray = in_flight_[machine_->slot()];
  auto* const waiting = ray->goes_on ? &held_back_[kind_of(*ray)] : nullptr;
  if ((waiting != nullptr && !waiting->empty()) || !leave(*ray)) {
    waiting->push_back(ray);
    return;
  }
  rays->remove(ray);
  left(1);
}

void ModelledTraverser::deliver_traced() {
  for (const ImportKind kind : {ImportKind::Normal, ImportKind::Shadow, ImportKind::Direct}) {
    uint32_t count = 0;
    for (auto& waiting = held_back_[kind]; !waiting.empty() && leave(*waiting.front()); waiting.pop_front()) {
      ++count;
      rays->remove(waiting.front());
    }
    left(count);
  }
}

void ModelledTraverser::step() {
  clock->guard([&] {
    if (simulate(clock->cycle()) && now_ != clock->cycle())
      throw std::logic_error("a ray left the traverser sooner than it could");
    deliver_traced();
    wake_again();
  });
}

void ModelledTraverser::wake_again() {
  uint64_t next = machine_->earliest_done(now_);
  if (!untaken_.empty()) next = std::min(next, now_ + 1 + machine_->least_latency());
  if (next != kNever) clock->notify(step_, Phase::Traverser, next - now_);
}

}  // namespace raypool::chip
