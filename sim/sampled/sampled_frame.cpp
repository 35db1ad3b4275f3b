#include "sampled/sampled_frame.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "chip/controller.hpp"
#include "sampled/sample.hpp"

namespace raypool::sampled {
namespace {

namespace count = chip::count;

constexpr uint32_t kLeastBlockTiles = 4;
constexpr uint32_t kLeastStrata = 8;  // for the variance to be known
constexpr uint32_t kPilotShare = 25;  // one of so many blocks
constexpr double kMargin = 1.15;      // more blocks than the pilot says are needed: its variance is one of a sample
// What a block costs depends a little on what is beside it, which in a sample is not what it is in the frame: this much
// of each figure, and no less than so much of a utilisation. `make intervals` prints mean errors of that size.
constexpr double kBesideError = 0.0025, kLeastShareError = 0.0005;
// Where the sample goes on elsewhere in the picture it reads lines that the frame has read before: of the memory port's
// utilisation.
constexpr double kReadAgainError = 0.025;
constexpr double kWholeFrom = 0.5;  // of the frame's tiles

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

void add(Counts& sum, const Counts& costs) {
  for (size_t i = 0; i < sum.size(); ++i) sum[i] += costs[i];
}

class SampledFrame {
 public:
  SampledFrame(const ChipOptions& chip, const std::vector<uint32_t>& rays, const Wanted& wanted)
      : chip_(chip), wanted_(wanted), rays_(chip::along_walk(chip.configuration, chip.width, chip.height, rays)) {
    figures_.tiles = size32(rays_);
    // As many pixels as may be under way at a time.
    const uint32_t tile_pixels = std::min(chip.configuration.contents(), chip.configuration.chip.held_limit);
    block_ = std::max(kLeastBlockTiles, chip.configuration.chip.held_limit / tile_pixels);
    beside_ = std::max(1u, block_ / 8);
  }

  Figures draw() {
    const uint32_t most = Sample::most_strata(figures_.tiles, block_);
    if (most < kLeastDrawn * kLeastStrata) return draw_whole();
    Sample sample(rays_, block_, std::max(kLeastStrata, figures_.tiles / block_ / kPilotShare / kLeastDrawn),
                  wanted_.seed);
    std::vector<uint32_t> pilot = sample.draw(0);
    pilot.insert(pilot.begin(), 0);
    pilot.push_back(sample.blocks() - 1);
    const auto begin = std::chrono::steady_clock::now();
    simulate(sample, pilot, 0);
    const double a_tile = seconds_since(begin) / figures_.simulated_tiles;
    const double blocks = blocks_wanted(sample, a_tile);
    // What is beside the blocks costs too.
    if (blocks * (block_ + 2 * beside_) / block_ >= kWholeFrom * sample.inner_blocks() && affordable(a_tile))
      return draw_whole();
    const std::vector<uint32_t> more = sample.draw(static_cast<uint32_t>(blocks));
    if (!more.empty()) simulate(sample, more, block_);
    conclude(estimate(sample));
    return figures_;
  }

 private:
  bool affordable(double a_tile) const { return wanted_.seconds == 0 || a_tile * figures_.tiles < wanted_.seconds; }

  /// Inner blocks to be drawn in all.
  double blocks_wanted(const Sample& sample, double a_tile) const {
    const auto drawn = static_cast<double>(sample.drawn()), all = static_cast<double>(sample.inner_blocks());
    if (wanted_.seconds > 0) {
      const double left = wanted_.seconds - a_tile * figures_.simulated_tiles;
      return std::min(all, drawn + std::max(0.0, left / (a_tile * (block_ + 2 * beside_))));
    }
    const Estimate pilot = estimate(sample);
    const double allowed = (wanted_.error - kBesideError) * pilot.total(count::kCycles).value;
    double blocks = drawn;
    while (blocks < all && pilot.half_width(count::kCycles, blocks / drawn) > allowed) blocks *= 1.05;
    return blocks == drawn ? drawn : std::min(all, kMargin * blocks);
  }

  /// These blocks in a run of the chip, the first behind so many tiles more.
  void simulate(const Sample& sample, const std::vector<uint32_t>& blocks, uint32_t lead) {
    std::map<uint32_t, bool> tiles;  // whether it counts
    const auto add_beside = [&](uint32_t from, uint32_t to) {
      for (uint32_t tile = from; tile < std::min(to, figures_.tiles); ++tile) tiles.emplace(tile, false);
    };
    for (const uint32_t block : blocks) {
      const uint32_t first = sample.begin(block), end = sample.begin(block + 1);
      add_beside(first - std::min(first, beside_ + (tiles.empty() ? lead : 0)), first);
      add_beside(end, end + beside_);
      for (uint32_t tile = first; tile < end; ++tile) tiles[tile] = true;
    }
    ChipOptions run = chip_;
    chip::TileCosts costs;
    run.tile_costs = &costs;
    for (const auto& [tile, counts] : tiles) run.tiles.push_back(tile);
    run_chip(run);
    figures_.simulated_tiles += size32(tiles);
    auto tile_costs = costs.costs().begin();
    for (const auto& [tile, counts] : tiles) {
      if (counts) add(costs_[tile / block_], *tile_costs);
      figures_.counted_tiles += counts;
      ++tile_costs;
    }
  }

  Estimate estimate(const Sample& sample) const {
    Counts always{};
    for (const uint32_t block : {0u, sample.blocks() - 1}) add(always, costs_.at(block));
    std::vector<Drawn> strata;
    for (const Stratum& stratum : sample.strata()) {
      Drawn& drawn = strata.emplace_back();
      drawn.blocks = stratum.order.size();
      for (uint32_t i = 0; i < stratum.drawn; ++i) drawn.costs.push_back(costs_.at(stratum.order[i]));
    }
    return {always, std::move(strata)};
  }

  void conclude(const Estimate& estimate) {
    figures_.cycles = estimate.total(count::kCycles);
    figures_.cycles.low -= kBesideError * figures_.cycles.value;
    figures_.cycles.high += kBesideError * figures_.cycles.value;
    const auto rays = static_cast<double>(std::accumulate(rays_.begin(), rays_.end(), uint64_t{0}));
    const auto mrays = [&](double cycles) { return 1e3 * rays / cycles; };
    figures_.mrays_per_s = {mrays(figures_.cycles.value), mrays(figures_.cycles.high), mrays(figures_.cycles.low)};
    for (size_t i = 0; i < kAluTypes; ++i) {
      const Interval unused = estimate.ratio(count::kUnused + i, count::kBusyCycles);
      const auto used = [&](double x) { return 1 - x / chip_.configuration.alus[i].count; };
      figures_.alus[i] = share({used(unused.value), used(unused.high), used(unused.low)});
    }
    figures_.ray_port = share(estimate.ratio(count::kRayPort, count::kCycles));
    figures_.intersection_port = share(estimate.ratio(count::kIntersectionPort, count::kCycles));
    figures_.memory_port = share(estimate.ratio(count::kMemoryPort, count::kCycles), kReadAgainError);
  }

  static Interval share(const Interval& x, double error = 0) {
    error += std::max(kLeastShareError, kBesideError * x.value);
    return {x.value, std::max(0.0, x.low - error), std::min(1.0, x.high + error)};
  }
  static Interval exactly(double x) { return {x, x, x}; }

  Figures draw_whole() {
    const ChipResult result = run_chip(chip_);
    figures_.whole = true;
    figures_.simulated_tiles += figures_.tiles;
    figures_.counted_tiles = figures_.tiles;
    figures_.cycles = exactly(static_cast<double>(result.cycles));
    figures_.mrays_per_s = exactly(result.mrays_per_s);
    for (size_t i = 0; i < kAluTypes; ++i) figures_.alus[i] = exactly(result.alus[i].utilisation);
    figures_.ray_port = exactly(result.ray_port_utilisation);
    figures_.intersection_port = exactly(result.intersection_port_utilisation);
    figures_.memory_port = exactly(result.memory_port_utilisation);
    return figures_;
  }

  const ChipOptions& chip_;
  Wanted wanted_;
  std::vector<uint64_t> rays_;        // of each tile, along the walk
  uint32_t block_ = 0, beside_ = 0;   // tiles of a block, and uncounted ones on each side of it
  std::map<uint32_t, Counts> costs_;  // [block]
  Figures figures_;
};

}  // namespace

Figures draw_sampled(const ChipOptions& chip, const std::vector<uint32_t>& rays, const Wanted& wanted) {
  return SampledFrame(chip, rays, wanted).draw();
}

}  // namespace raypool::sampled
