#include "estimate/unit_flow.hpp"

#include <algorithm>
#include <cmath>

namespace raypool::estimate {
namespace {

// Cycles from a launch that is taken to the first instruction of a warp and to the first request of a package; from a
// package to the instruction behind rin; from a swap to the first beat that is offered.
constexpr double kStart = 8, kRequest = 5, kFilled = 3, kOffer = 5;

}  // namespace

void UnitFlow::take(Launch& launch, double now) {
  launch.taken_at = now;
  if (launch.import != ImportKind::None) importing_.push_back(&launch);
  waiting_ = &launch;
  begin_waiting(now);
}

void UnitFlow::begin_waiting(double now) {
  if (waiting_ == nullptr || running_.size() >= (configuration_.kernel_overlap ? 2 : 1)) return;
  running_.push_back(waiting_);
  // It has waited: its warps begin in the next cycle.
  if (waiting_->taken_at < now) waiting_->taken_at = std::max(waiting_->taken_at, now - kStart + 1);
  waiting_ = nullptr;
}

double UnitFlow::next() const {
  double next = kNoEvent;
  for (const Warp& warp : warps_) {
    if (warp.state == Warp::State::Starting) next = std::min(next, warp.starts_at);
    if (warp.state == Warp::State::Executing)
      next = std::min(next, now_ + std::max(0.0, warp.ends_at - clock_) / rate_);
  }
  if (!exports_.empty() && exports_.front().offered_at > now_) next = std::min(next, exports_.front().offered_at);
  return next;
}

void UnitFlow::advance(double now, std::vector<Launch*>& ended) {
  clock_ += (now - now_) * rate_;
  now_ = now;
  bool any = false;
  for (bool moved = true; moved; any |= moved) {
    moved = false;
    for (uint32_t number = 0; number < warps_.size(); ++number) moved |= move(number, ended);
  }
  if (any) set_rate();
}

/// True if the warp goes on.
bool UnitFlow::move(uint32_t number, std::vector<Launch*>& ended) {
  Warp& warp = warps_[number];
  switch (warp.state) {
    case Warp::State::Idle:
      return start(number);
    case Warp::State::Starting:
      if (warp.starts_at > now_) return false;
      execute(warp, 0);
      return true;
    case Warp::State::Executing:
      if (warp.ends_at > clock_ + kLittle) return false;
      exchange(number, ended);
      return true;
    case Warp::State::Importing:
      if (warp.full != warp.launch) return false;
      warp.full = nullptr;
      ++warp.segment;
      execute(warp, kFilled);
      return true;
    case Warp::State::Exporting:
      if (warp.exporting != 0) return false;
      export_slice(number);
      ++warp.segment;
      execute(warp, 0);
      return true;
  }
  return false;
}

void UnitFlow::execute(Warp& warp, double more) {
  warp.state = Warp::State::Executing;
  warp.ends_at = clock_ + segment(warp).serial + more;
}

/// The threads of a launch that are this warp's, if they may begin: behind those of the launch before.
bool UnitFlow::start(uint32_t number) {
  Warp& warp = warps_[number];
  const auto begun = [&](const Launch& launch) { return (launch.warps_begun >> number & 1) != 0; };
  for (Launch* launch : running_) {
    if (number >= launch->warps || begun(*launch)) continue;
    const Launch& older = *running_.front();
    if (launch != &older && number < older.warps && !begun(older)) return false;
    launch->warps_begun |= 1u << number;
    warps_of_[launch->kernel] += 1;
    warp.launch = launch;
    warp.segment = 0;
    warp.state = Warp::State::Starting;
    warp.starts_at = std::max(now_, launch->taken_at + kStart);
    return true;
  }
  return false;
}

void UnitFlow::exchange(uint32_t number, std::vector<Launch*>& ended) {
  Warp& warp = warps_[number];
  const Exchange what = kernels_[warp.launch->kernel].exchanges[warp.segment];
  if (what != Exchange::End) {
    warp.state = what == Exchange::Import ? Warp::State::Importing : Warp::State::Exporting;
    return;
  }
  Launch& launch = *warp.launch;
  warp.state = Warp::State::Idle;
  warp.launch = nullptr;
  if (++launch.warps_ended != launch.warps) return;
  kernel_cycles_ += now_ - std::max(launch.taken_at, last_end_);
  last_end_ = now_;
  launch.ended = true;
  running_.erase(std::find(running_.begin(), running_.end(), &launch));
  ended.push_back(&launch);
  begin_waiting(now_);
}

void UnitFlow::export_slice(uint32_t number) {
  Warp& warp = warps_[number];
  Launch& launch = *warp.launch;
  const uint32_t first = number * configuration_.lanes, count = std::min(configuration_.lanes, launch.threads - first);
  const std::vector<Exchange>& exchanges = kernels_[launch.kernel].exchanges;
  Export out{&launch, number, {}, count, now_ + kOffer};
  if (exchanges[warp.segment] == Exchange::ExportRays) {
    const auto behind = exchanges.begin() + static_cast<std::ptrdiff_t>(warp.segment);
    // Of the two exports of cast_secondary the first one is that of reflections.
    const bool first_export = std::count(exchanges.begin(), behind, Exchange::ExportRays) == 0;
    out.rays = exporter_(launch, first, count, launch.kernel == RayKernel::CastSecondary && first_export);
    out.left = static_cast<uint32_t>(out.rays.size());
  }
  if (out.left == 0) return;
  warp.exporting = out.left;
  launch.unexported += out.left;
  exports_.push_back(std::move(out));
}

Launch* UnitFlow::importing(double now) {
  if (importing_.empty() || imports_at() > now) return nullptr;
  Launch& launch = *importing_.front();
  return warps_[launch.received / configuration_.lanes].full == nullptr ? &launch : nullptr;
}

double UnitFlow::imports_at() const { return importing_.empty() ? kNoEvent : importing_.front()->taken_at + kRequest; }

void UnitFlow::imported() {
  Launch& launch = *importing_.front();
  ++launch.received;
  const bool last = launch.received == launch.threads;
  if (last || launch.received % configuration_.lanes == 0)
    warps_[(launch.received - 1) / configuration_.lanes].full = &launch;
  if (last) importing_.pop_front();
}

Export* UnitFlow::offered(double now) {
  return exports_.empty() || exports_.front().offered_at > now ? nullptr : &exports_.front();
}

void UnitFlow::left(uint32_t count) {
  Export& front = exports_.front();
  front.left -= count;
  front.launch->unexported -= count;
  warps_[front.warp].exporting -= count;
  if (front.left == 0) exports_.pop_front();
}

void UnitFlow::set_rate() {
  double issue = 0;
  EnumArray<AluType, double, kAluTypes> alus{};
  for (const Warp& warp : warps_) {
    if (warp.state != Warp::State::Executing || segment(warp).serial == 0) continue;
    const Segment& part = segment(warp);
    issue += part.instructions / part.serial;
    for (size_t type = 0; type < kAluTypes; ++type) alus[type] += part.busy[type] / part.serial;
  }
  double sum = std::pow(issue, kUnitSharpness);
  for (size_t type = 0; type < kAluTypes; ++type)
    sum += std::pow(alus[type] / configuration_.alus[type].count, kUnitSharpness);
  rate_ = std::pow(1 + sum, -1 / kUnitSharpness);
}

}  // namespace raypool::estimate
