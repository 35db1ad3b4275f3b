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
// Until the rate of a traverser that is always full is steady.
constexpr int kSteadyRounds = 20;

double power(double load) { return std::pow(std::max(0.0, load), kPipeSharpness); }

/// A ray of this tile, alone.
double alone(const TileWork& work) { return kAround + kNode * work.nodes + kTriangle * work.triangles; }

// Of all rays, in a cycle of their ways, which go on at this rate. Erlang's C is the share of misses that find all
// MSHRs of their bank taken.
double bank_wait(double lookups, double misses, double away, double rate, double banks, uint32_t mshrs) {
  const double servers = std::max(1.0, mshrs / banks);
  const double load = misses * rate / banks * away, share = std::min(kMostLoad, load / servers);
  double term = 1, sum = 1;
  for (int i = 1; i < static_cast<int>(servers); ++i) sum += term *= load / i;
  term *= load / servers / (1 - share);
  const double taken = term / (sum + term);
  return kHeldUp * taken * away / servers * (lookups * share / 2 + misses / (1 - share));
}

// Pipes, port and MSHRs bind; lines that are missing are waited for, by their ray and by those behind a bank that is
// held up. The rate that follows from what was asked at the last one.
double next_rate(const ChipConfiguration& chip, const Asked& asked, size_t flying, double rate) {
  const double lines = asked.nodes_read + asked.triangles_read, beats = kLineBeats * chip.memory_cycles_per_beat;
  const double idle_away = chip.memory_latency + kMiss, banks = chip.hardware_traverser_cache_banks;
  const auto mshrs = [&](double read, uint32_t count) { return power(read * idle_away / (kUsableMshrs * count)); };
  const double bound = power(asked.nodes / chip.hardware_traverser_lanes) +
                       power(asked.triangles / chip.hardware_traverser_triangle_pipes) + power(lines * beats) +
                       mshrs(asked.nodes_read, chip.hardware_traverser_node_cache_mshrs) +
                       mshrs(asked.triangles_read, chip.hardware_traverser_triangle_cache_mshrs);
  for (int round = 0; round < 3; ++round) {
    const double port = std::min(kMostLoad, lines * beats * rate);
    const double away = idle_away + beats * port / (1 - port) / 4;
    const double waits =
        bank_wait(asked.nodes, asked.nodes_read, away, rate, banks, chip.hardware_traverser_node_cache_mshrs) +
        bank_wait(asked.triangles, asked.triangles_read, away, rate, banks,
                  chip.hardware_traverser_triangle_cache_mshrs) +
        (1 + kJoined) * lines * away;
    const double next = std::pow(power(1 + waits / static_cast<double>(flying)) + bound, -1 / kPipeSharpness);
    rate = (rate + next) / 2;
  }
  return rate;
}

/// As many more rays of this work, or fewer.
void add(Asked& asked, const TileWork& work, const TreeReads& reads, double rays) {
  const double a_cycle = rays / alone(work);
  asked.nodes += work.nodes * a_cycle;
  asked.triangles += work.triangles * a_cycle;
  asked.nodes_read += reads.nodes * a_cycle;
  asked.triangles_read += reads.triangles * a_cycle;
}

}  // namespace

double full_flight_cycles(const ChipConfiguration& chip, const Workload& work) {
  TileWork mean;
  for (const TileWork& tile : work.tiles) {
    mean.rays += tile.rays;
    mean.nodes += tile.rays * tile.nodes;
    mean.triangles += tile.rays * tile.triangles;
  }
  if (mean.rays == 0) return 0;
  mean.nodes /= mean.rays;
  mean.triangles /= mean.rays;
  Asked asked;
  add(asked, mean, work.reads, chip.hardware_traverser_rays);
  double rate = 1;
  for (int round = 0; round < kSteadyRounds; ++round) rate = next_rate(chip, asked, chip.hardware_traverser_rays, rate);
  return alone(mean) / (chip.hardware_traverser_rays * rate);
}

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
  flying_.emplace(clock_ + chance.about(alone(work_.tiles[ray.tile]), kShape), ray);
  share(ray, 1);
}

void RayFlights::share(const FlowRay& ray, double sign) {
  add(asked_, work_.tiles[ray.tile], work_.reads, sign);
  if (!flying_.empty()) rate_ = next_rate(chip_, asked_, flying_.size(), rate_);
}

}  // namespace raypool::estimate
