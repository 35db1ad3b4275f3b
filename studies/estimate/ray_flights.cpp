#include "estimate/ray_flights.hpp"

#include <algorithm>
#include <cmath>

namespace raypool::estimate {
namespace {

// Cycles of a ray that is alone and finds its lines in the caches: set-up and finish, a node, a triangle of a leaf.
constexpr double kAround = 115, kNode = 21, kTriangle = 5;
// Ways of rays differ as by a gamma distribution of this shape.
constexpr double kShape = 3;
// Of a line that is missing: cycles beside the memory's latency, and of those that wait for it the share that come
// while it is on its way.
constexpr double kMiss = 20, kJoined = 0.35;
constexpr double kLineBeats = 4;
// How sharply a resource binds (kUnitSharpness); share of the MSHRs that can be in use at once, as banks fill unevenly.
constexpr double kPipeSharpness = 3, kUsableMshrs = 0.7;
// A bank without a free MSHR holds up all lanes that want a line of it, and these the rays behind.
constexpr double kHeldUp = 3;
// Queues are computed up to this load.
constexpr double kMostLoad = 0.97;

double power(double load) { return std::pow(std::max(0.0, load), kPipeSharpness); }

}  // namespace

double RayFlights::next() const {
  return flying_.empty() ? kNoEvent : now_ + std::max(0.0, flying_.begin()->first - clock_) / rate_;
}

void RayFlights::advance(double now) {
  clock_ += (now - now_) * rate_;
  ray_cycles_ += (now - now_) * static_cast<double>(flying_.size());
  now_ = now;
}

std::optional<FlowRay> RayFlights::take_ended() {
  if (flying_.empty() || flying_.begin()->first > clock_ + kLittle) return std::nullopt;
  const FlowRay ray = flying_.begin()->second;
  flying_.erase(flying_.begin());
  share(ray, -1);
  return ray;
}

void RayFlights::begin(const FlowRay& ray, Chance& chance) {
  flying_.emplace(clock_ + chance.about(alone(ray), kShape), ray);
  share(ray, 1);
}

double RayFlights::alone(const FlowRay& ray) const {
  const TileWork& work = work_.tiles[ray.tile];
  return kAround + kNode * work.nodes + kTriangle * work.triangles;
}

void RayFlights::share(const FlowRay& ray, double sign) {
  const TileWork& work = work_.tiles[ray.tile];
  const double a_cycle = sign / alone(ray);
  nodes_ += work.nodes * a_cycle;
  triangles_ += work.triangles * a_cycle;
  nodes_read_ += work_.reads.nodes * a_cycle;
  triangles_read_ += work_.reads.triangles * a_cycle;
  set_rate();
}

// Pipes, port and MSHRs bind; lines that are missing are waited for, by their ray and by those behind a bank that is
// held up.
void RayFlights::set_rate() {
  if (flying_.empty()) return;
  const double lines = nodes_read_ + triangles_read_, beats = kLineBeats * chip_.memory_cycles_per_beat;
  const double idle_away = chip_.memory_latency + kMiss;
  const auto mshrs = [&](double read, uint32_t count) { return power(read * idle_away / (kUsableMshrs * count)); };
  const double bound = power(nodes_ / chip_.hardware_traverser_lanes) +
                       power(triangles_ / chip_.hardware_traverser_triangle_pipes) + power(lines * beats) +
                       mshrs(nodes_read_, chip_.hardware_traverser_node_cache_mshrs) +
                       mshrs(triangles_read_, chip_.hardware_traverser_triangle_cache_mshrs);
  for (int round = 0; round < 3; ++round) {
    const double port = std::min(kMostLoad, lines * beats * rate_);
    const double away = idle_away + beats * port / (1 - port) / 4;
    const double waits = bank_wait(nodes_, nodes_read_, away, chip_.hardware_traverser_node_cache_mshrs) +
                         bank_wait(triangles_, triangles_read_, away, chip_.hardware_traverser_triangle_cache_mshrs) +
                         (1 + kJoined) * lines * away;
    const double rate = std::pow(power(1 + waits / static_cast<double>(flying_.size())) + bound, -1 / kPipeSharpness);
    rate_ = (rate_ + rate) / 2;
  }
}

// Of all rays, in a cycle of their ways. Erlang's C is the share of misses that find all MSHRs of their bank taken.
double RayFlights::bank_wait(double lookups, double misses, double away, uint32_t mshrs) const {
  const double banks = chip_.hardware_traverser_cache_banks, servers = std::max(1.0, mshrs / banks);
  const double load = misses * rate_ / banks * away, share = std::min(kMostLoad, load / servers);
  double term = 1, sum = 1;
  for (int i = 1; i < static_cast<int>(servers); ++i) sum += term *= load / i;
  term *= load / servers / (1 - share);
  const double taken = term / (sum + term);
  return kHeldUp * taken * away / servers * (lookups * share / 2 + misses / (1 - share));
}

}  // namespace raypool::estimate
