#include "chip/port_traverser.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "bits.hpp"
#include "machine/chip/intersection_pool.hpp"
#include "machine/common/port_cycles.hpp"

namespace raypool::chip {

PortTraverser::PortTraverser(RayTracer& tracer, const ChipConfiguration& chip, uint32_t units,
                             const RecordLayout& layout)
    : tracer_(tracer),
      chip_(chip),
      layout_(layout),
      beats_(raypool::IntersectionPool::beats(layout.words)),
      capacity_(chip.intersection_pool_size),
      batch_(chip.static_traverser_batch),
      stall_cycles_(chip.static_traverser_stall_cycles),
      units_(units) {}

void PortTraverser::start(const FrameSetup& setup) {
  fates_.emplace(tracer_, chip_, setup.depth, setup.reflections);
  next_beat_in_ = next_beat_out_ = 0;
  rays_.clear();
  results_ = {};
  waiting_ = 0;
  contributions_.clear();
  freed_.clear();
  leaving_.reset();
  number_ = stalled_for_ = 0;
  counts_ = {};
}

void PortTraverser::offer(TraverserPorts& ports) {
  ports.ray_ready = true;
  ports.free_valid = !freed_.empty();
  if (ports.free_valid) {
    ports.free_place = freed_.front().place;
    ports.free_shadow = freed_.front().shadow;
  }
  ports.put_valid = leaving_.has_value();
  if (ports.put_valid) {
    ports.put_kind = leaving_->kind;
    const uint32_t from = next_beat_out_ * kBeatWords;
    for (uint32_t i = 0; i < kBeatWords; ++i)
      ports.put_data[i] = from + i < leaving_->record.size() ? leaving_->record[from + i] : 0;
  }
  ports.contribution_valid = !contributions_.empty();
  if (ports.contribution_valid) ports.contribution = contributions_.front().contribution;
  ports.tree_request_valid = false;
}

void PortTraverser::clock(const ChipOutputs& outputs, const TraverserPorts& ports, bool stalls) {
  const ImportKind put = move(outputs, ports);
  const uint64_t ended = popcount(outputs.device.kernel_done);
  counts_.batches += ended;
  uint64_t budget = batch_ * ended;
  stalled_for_ = stalls ? stalled_for_ + 1 : 0;
  const bool stall_over = stalled_for_ != 0 && stalled_for_ % stall_cycles_ == 0;
  if (stall_over) budget += batch_ * units_;
  counts_.most_rays += budget;
  if (budget != 0 && trace(budget) != 0 && stall_over) ++counts_.stall_batches;
  if (outputs.ray_valid) read(outputs);
  if (!leaving_ && waiting_ != 0) choose(outputs, put);
}

uint64_t PortTraverser::still_for(bool stalls) const {
  if (!freed_.empty() || !contributions_.empty() || leaving_ || waiting_ != 0) return 0;
  return stalls ? stall_cycles_ - stalled_for_ % stall_cycles_ - 1 : kNever;
}

void PortTraverser::read(const ChipOutputs& outputs) {
  std::copy(outputs.ray_data.begin(), outputs.ray_data.end(), &coming_.ray[next_beat_in_ * kBeatWords]);
  ++next_beat_in_;
  if (!outputs.ray_last) return;
  next_beat_in_ = 0;
  coming_.place = outputs.ray_place;
  rays_.push_back(coming_);
}

uint32_t PortTraverser::trace(uint64_t rays) {
  uint32_t count = 0;
  for (; rays > 0 && !rays_.empty(); --rays, ++count) {
    trace(rays_.front());
    rays_.pop_front();
  }
  return count;
}

void PortTraverser::trace(const PlacedRay& ray) {
  Result result{ray.place, is_shadow(ray.ray), ImportKind::None, {}, {}, number_++};
  Intersection hit;
  const bool goes_on = tracer_.trace(ray.ray, hit);
  counts_.rays.count(ray.ray, goes_on);
  if (!goes_on) {
    freed_.push_back({result.place, result.shadow});
    return;
  }
  result.kind = fates_->kind_of(ray.ray, hit);
  counts_.deepest += fates_->deepest(ray.ray, result.kind);
  if (fates_->contributes(result.kind)) {
    result.contribution = contribution_of(ray.ray);
    contributions_.push_back(result);
  } else {
    result.record = packed(hit, layout_);
    results_[result.kind].push_back(result);
    ++waiting_;
  }
}

std::string PortTraverser::describe() const {
  const auto waiting = [&](ImportKind kind) {
    return results_[kind].size() + (leaving_ && leaving_->kind == kind ? 1 : 0);
  };
  return fmt::format(
      "traverser: {} rays wait to be traced, until a kernel ends or the shader has stalled for {} cycles; {} normal, "
      "{} "
      "shadow and {} direct intersections wait for the intersection pool",
      rays_.size(), stall_cycles_, waiting(ImportKind::Normal), waiting(ImportKind::Shadow),
      waiting(ImportKind::Direct));
}

// What was offered in this cycle, and has been taken. The kind of which an intersection is put with it.
ImportKind PortTraverser::move(const ChipOutputs& outputs, const TraverserPorts& ports) {
  if (ports.free_valid) freed_.pop_front();
  if (ports.contribution_valid && outputs.contribution_ready) {
    freed_.push_back({contributions_.front().place, true});
    contributions_.pop_front();
    ++counts_.delivered;
  }
  if (ports.put_valid && (outputs.put_ready >> to_underlying(ports.put_kind) & 1) != 0 && ++next_beat_out_ == beats_) {
    next_beat_out_ = 0;
    freed_.push_back({leaving_->place, leaving_->shadow});
    const ImportKind put = leaving_->kind;
    leaving_.reset();
    ++counts_.delivered;
    return put;
  }
  return ImportKind::None;
}

// The oldest of those with room for their kind: others do not wait for it. With a package's last beat the pool is ready
// for whatever comes, and does not count the package yet.
void PortTraverser::choose(const ChipOutputs& outputs, ImportKind put) {
  std::deque<Result>* oldest = nullptr;
  for (size_t kind = 0; kind < kImportKinds; ++kind) {
    std::deque<Result>& queue = results_[kind];
    const uint32_t size = outputs.size[kind] + (kind == to_underlying(put) ? 1 : 0);
    if (queue.empty() || size >= capacity_) continue;
    if (oldest == nullptr || queue.front().number < oldest->front().number) oldest = &queue;
  }
  if (oldest == nullptr) return;
  leaving_ = oldest->front();
  oldest->pop_front();
  --waiting_;
}

}  // namespace raypool::chip
