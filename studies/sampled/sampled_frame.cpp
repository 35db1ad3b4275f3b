#include "sampled/sampled_frame.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <map>
#include <memory>
#include <numeric>
#include <utility>

#include "bits.hpp"
#include "chip/board.hpp"
#include "chip/frame_setup.hpp"
#include "machine/chip/chip_model.hpp"
#include "machine/compute/model.hpp"
#include "sampled/estimate.hpp"
#include "sampled/processes.hpp"
#include "sampled/sample.hpp"

namespace raypool::sampled {
namespace {

namespace count = chip::count;

constexpr uint32_t kLeastBlockTiles = 4;
constexpr uint32_t kManyBlocks = 256;  // of which there may be half as many
constexpr uint32_t kLeastStrata = 8;   // for the variance to be known
constexpr uint32_t kPilotShare = 25;   // one of so many blocks
constexpr uint32_t kBlocksTimed = 3;   // to know how long a frame takes
constexpr double kMargin = 1.1;        // more blocks than seem to be needed: a variance that is known is a sample's
constexpr double kGrowth = 2;          // of the sample at a time, at most
// A process begins with a block that is not counted: each has several to simulate.
constexpr uint32_t kLeastGroup = 8, kMostGroups = 64;
// What a block costs depends a little on what is beside it, which in a sample is not what it is in the frame: this much
// of each figure, and no less than so much of a utilisation. `make intervals` prints mean errors of that size.
constexpr double kBesideError = 0.0025, kLeastShareError = 0.0005;
constexpr double kBesideCachesError = 0.005;  // the same where a traverser has caches
// What caches are filled with behind tiles that are left out is not quite what they would hold: of the memory port's
// utilisation.
constexpr double kRememberedError = 0.01;
// Places of the tree that caches are filled with before a block: so many times what they hold, as neighbours visit the
// same.
constexpr size_t kCacheFuls = 8;
constexpr double kWholeFrom = 0.75;  // of the frame's tiles: a sample's are simulated on several cores

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

void add(Counts& sum, const Counts& costs) {
  for (size_t i = 0; i < sum.size(); ++i) sum[i] += costs[i];
}

/// As many pixels as may be under way at a time.
uint32_t tiles_under_way(const Configuration& configuration) {
  const uint32_t held = configuration.chip.held_limit;
  return std::max(kLeastBlockTiles, held / std::min(configuration.contents(), held));
}

/// Of a picture of so many tiles. The larger a block, the less of its cost is its neighbours', of which caches need
/// more.
uint32_t block_tiles(const Configuration& configuration, uint64_t tiles) {
  const uint32_t under_way = tiles_under_way(configuration);
  const uint32_t block = has_traverser(configuration.chip) ? 2 * under_way : under_way;
  return tiles >= uint64_t{2} * under_way * kManyBlocks ? 2 * block : block;
}

/// Tiles that are simulated beside a block and not counted. With caches, before it what is under way when it begins;
/// and behind it more than that: where tiles are left out, caches are filled for those that come, and what is under way
/// loses its lines.
struct Beside {
  explicit Beside(const Configuration& configuration) {
    const uint32_t under_way = tiles_under_way(configuration);
    const bool caches = has_traverser(configuration.chip);
    before = caches ? under_way : under_way / 4;
    behind = caches ? 2 * under_way : under_way / 4;
  }
  uint32_t before, behind;
};

/// Inner blocks of the pilot, in so many strata.
uint32_t pilot_strata(uint32_t tiles, uint32_t block) {
  return std::max(kLeastStrata, tiles / block / kPilotShare / kLeastDrawn);
}

/// A picture of fewer blocks has no sample.
bool has_pilot(uint32_t tiles, uint32_t block) {
  return Sample::most_strata(tiles, block) >= kLeastDrawn * kLeastStrata;
}

/// Instructions of each kernel, from its first to that of the next one.
EnumArray<RayKernel, double, kRayKernels> kernel_lengths(const ChipOptions& chip) {
  EnumArray<RayKernel, double, kRayKernels> lengths{};
  for (size_t kernel = 0; kernel < kRayKernels; ++kernel) {
    uint32_t end = chip.program_length;
    for (size_t other = 0; other < kRayKernels; ++other)
      if (chip.entries[other] > chip.entries[kernel]) end = std::min(end, chip.entries[other]);
    lengths[kernel] = end - chip.entries[kernel];
  }
  if (chip.configuration.chip.shading == Shading::Traverser) lengths[RayKernel::Shade] = 0;  // which adds the colour
  return lengths;
}

/// What predicts a block's cycles: instructions that its threads execute, rays, nodes and triangles that they visit,
/// and how much of the tree that is, which caches must read.
std::vector<Known> known_of(const ChipOptions& chip, const std::vector<NativeWork>& work) {
  const auto lengths = kernel_lengths(chip);
  std::vector<Known> known;
  for (const NativeWork& block : work) {
    double instructions = 0;
    for (size_t i = 0; i < kRayKernels; ++i) instructions += lengths[i] * static_cast<double>(block.kernel_threads[i]);
    known.push_back({instructions});
    for (const uint64_t number : {block.rays, block.nodes, block.triangles, block.places})
      known.back().push_back(static_cast<double>(number));
  }
  return known;
}

/// All that is known of each block as one number, a mean share each.
std::vector<double> sizes_of(const std::vector<Known>& known) {
  Known sum(known.front().size());
  for (const Known& block : known)
    for (size_t i = 0; i < sum.size(); ++i) sum[i] += block[i];
  std::vector<double> sizes;
  for (const Known& block : known) {
    sizes.push_back(0);
    for (size_t i = 0; i < sum.size(); ++i) sizes.back() += sum[i] == 0 ? 0 : block[i] / sum[i];
  }
  return sizes;
}

class SampledFrame {
 public:
  SampledFrame(const ChipOptions& chip, uint32_t units, const std::vector<NativeWork>& work, const Wanted& wanted)
      : chip_(chip),
        units_(units),
        work_(work),
        wanted_(wanted),
        figures_(nothing_of(size32(chip::along_walk(chip.configuration, chip.width, chip.height)))),
        block_(block_tiles(chip.configuration, figures_.tiles)),
        beside_(chip.configuration),
        beside_error_(has_traverser(chip.configuration.chip) ? kBesideCachesError : kBesideError) {
    if (work.size() != Sample::blocks_of(figures_.tiles, block_))
      throw std::logic_error("not the work of each block of the sample");
    known_ = known_of(chip, work);
    sizes_ = sizes_of(known_);
    for (const NativeWork& block : work) rays_ += static_cast<double>(block.rays);
  }

  Figures draw() {
    if (!has_pilot(figures_.tiles, block_)) return draw_whole();
    Sample sample(figures_.tiles, block_, sizes_, pilot_strata(figures_.tiles, block_), wanted_.seed);
    std::vector<uint32_t> pilot = sample.draw(0);
    pilot.insert(pilot.begin(), 0);
    pilot.push_back(sample.blocks() - 1);
    const auto begin = std::chrono::steady_clock::now();
    for (std::vector<uint32_t> more = pilot; !more.empty();) {
      simulate(sample, more);
      const double seconds = seconds_since(begin), a_tile = seconds / figures_.simulated_tiles;
      // What a small sample predicts of the size of a much larger one is worth little.
      const double blocks = std::min(blocks_wanted(sample, seconds, a_tile), kGrowth * sample.drawn());
      // What is beside the blocks costs too.
      const bool all = blocks * with_beside() / block_ >= kWholeFrom * sample.inner_blocks();
      if (all && (wanted_.seconds == 0 || seconds + a_tile * figures_.tiles < wanted_.seconds)) return draw_whole();
      more = sample.draw(static_cast<uint32_t>(blocks));
    }
    conclude(estimate(sample));
    return figures_;
  }

  /// Of the whole frame, as a few blocks in different places of it take.
  double seconds() {
    Group group;
    double size = 0;
    const auto blocks = size32(work_);
    for (uint32_t place = 1; place < 2 * kBlocksTimed; place += 2) {
      const uint32_t block = place * blocks / (2 * kBlocksTimed);
      const uint32_t first = block * block_, end = std::min(first + block_, figures_.tiles);
      if (!group.emplace(first, true).second) continue;
      for (uint32_t tile = first; tile < end; ++tile) group[tile] = true;
      size += sizes_[block];
    }
    // That the frame does not take.
    fills_caches_ = false;
    const auto begin = std::chrono::steady_clock::now();
    in_processes(1, 1, [&](size_t) { return simulate(group); });
    return seconds_since(begin) * std::accumulate(sizes_.begin(), sizes_.end(), 0.0) / size;
  }

 private:
  static Figures nothing_of(uint32_t tiles) {
    Figures figures;
    figures.tiles = tiles;
    return figures;
  }

  /// Tiles that are simulated for a block.
  uint32_t with_beside() const { return beside_.before + block_ + beside_.behind; }
  /// Inner blocks to be drawn in all; as many as are drawn, if that is enough. A few more pay for no further run.
  double blocks_wanted(const Sample& sample, double seconds, double a_tile) const {
    const auto drawn = static_cast<double>(sample.drawn()), all = static_cast<double>(sample.inner_blocks());
    if (wanted_.seconds > 0) {
      const double more = (wanted_.seconds - seconds) / (a_tile * with_beside());
      return more < kLeastGroup ? drawn : std::min(all, drawn + more);
    }
    const Estimate now = estimate(sample);
    const double allowed = (wanted_.error - beside_error_) * now.total(count::kCycles).value;
    double blocks = drawn;
    while (blocks < all && now.half_width(count::kCycles, blocks / drawn) > allowed) blocks *= 1.05;
    return blocks == drawn ? drawn : std::min(all, std::max(kMargin * blocks, drawn + kLeastGroup));
  }

  /// Tiles that are simulated together, ascending, and whether each counts.
  using Group = std::map<uint32_t, bool>;

  /// These blocks, of which a process simulates so many, neighbours, that all have about as much to do. How many groups
  /// there are does not depend on the machine, nor do figures then.
  std::vector<Group> groups_of(const Sample& sample, const std::vector<uint32_t>& blocks) const {
    uint32_t count = 1;
    while (count < kMostGroups && 2 * count * kLeastGroup <= blocks.size()) count *= 2;
    double all = 0, before = 0;
    for (const uint32_t block : blocks) all += sizes_[block];
    std::vector<Group> groups(count);
    for (const uint32_t block : blocks) {
      Group& group = groups[std::min<size_t>(count - 1, static_cast<size_t>(before / all * count))];
      before += sizes_[block];
      const auto add_beside = [&](uint32_t from, uint32_t to) {
        for (uint32_t tile = from; tile < std::min(to, figures_.tiles); ++tile) group.emplace(tile, false);
      };
      const uint32_t first = sample.begin(block), end = sample.begin(block + 1);
      // A chip that has just begun is filled first.
      add_beside(first - std::min(first, beside_.before + (group.empty() ? block_ / 2 : 0)), first);
      add_beside(end, end + beside_.behind);
      for (uint32_t tile = first; tile < end; ++tile) group[tile] = true;
    }
    groups.erase(std::remove_if(groups.begin(), groups.end(), [](const Group& group) { return group.empty(); }),
                 groups.end());
    return groups;
  }

  /// These blocks, each group of them in a process.
  void simulate(const Sample& sample, const std::vector<uint32_t>& blocks) {
    const std::vector<Group> groups = groups_of(sample, blocks);
    size_t tiles = 0, ended = 0;
    for (const Group& group : groups) tiles += group.size();
    const auto costs_of = [](const std::string& bytes) {
      std::vector<Counts> costs(bytes.size() / sizeof(Counts));
      std::memcpy(costs.data(), bytes.data(), costs.size() * sizeof(Counts));
      return costs;
    };
    Counts seen{};
    const auto progress = [&](size_t group, const std::string& bytes) {
      if (!chip_.progress) return;
      ended += groups[group].size();
      for (const Counts& costs : costs_of(bytes)) add(seen, costs);
      chip_.progress(
          {static_cast<double>(ended) / static_cast<double>(tiles), static_cast<uint64_t>(seen[count::kCycles]),
           static_cast<uint64_t>(seen[count::kEyeRays] + seen[count::kReflectionRays] + seen[count::kShadowRays])});
    };
    const std::vector<std::string> results = in_processes(
        groups.size(), wanted_.processes, [&](size_t group) { return simulate(groups[group]); }, progress);
    for (size_t group = 0; group < groups.size(); ++group) {
      const std::vector<Counts> costs = costs_of(results[group]);
      if (costs.size() != groups[group].size()) throw std::logic_error("not the costs of each tile of a group");
      figures_.simulated_tiles += size32(costs);
      auto tile_costs = costs.begin();
      for (const auto& [tile, counts] : groups[group]) {
        if (counts) {
          add(costs_[tile / block_], *tile_costs);
          ++figures_.counted_tiles;
        }
        ++tile_costs;
      }
    }
  }

  ChipResult run_on_model(const ChipOptions& run) const {
    const std::unique_ptr<ChipDevice> model =
        make_chip_model(run.configuration, make_model(run.configuration, *run.memory, units_).device);
    return run_board(run, *model);
  }

  /// A run of the chip. The bytes of what each tile costs.
  std::string simulate(const Group& group) const {
    ChipOptions run = chip_;
    run.progress = {};
    chip::TileCosts costs;
    run.tile_costs = &costs;
    if (fills_caches_) run.visited_before = [this](uint32_t tile) { return visited_before(tile); };
    for (const auto& [tile, counts] : group) run.tiles.push_back(tile);
    run_on_model(run);
    return {reinterpret_cast<const char*>(costs.costs().data()), costs.costs().size() * sizeof(Counts)};
  }

  /// What native visited in the tiles before this one, from the last of them back until caches are full of it.
  VisitList visited_before(uint32_t tile) const {
    const ChipConfiguration& chip = chip_.configuration.chip;
    const size_t enough =
        kCacheFuls * (chip.hardware_traverser_node_cache_bytes + chip.hardware_traverser_triangle_cache_bytes) / 64;
    // Of the block that the tile is in, those of the tiles before it.
    const uint32_t own = tile / block_;
    const size_t of_own = tile % block_ == 0 ? 0 : work_[own].tile_ends.at(tile % block_ - 1);
    uint32_t first = own;
    for (size_t places = of_own; first > 0 && places < enough;) places += work_[--first].chip_places.size();
    VisitList visited;
    for (uint32_t block = first; block < own; ++block)
      visited.insert(visited.end(), work_[block].chip_places.begin(), work_[block].chip_places.end());
    visited.insert(visited.end(), work_[own].chip_places.begin(),
                   work_[own].chip_places.begin() + static_cast<std::ptrdiff_t>(of_own));
    return visited;
  }

  Estimate estimate(const Sample& sample) const {
    Counts always{};
    for (const uint32_t block : {0u, sample.blocks() - 1}) add(always, costs_.at(block));
    std::vector<Drawn> strata;
    for (const Stratum& stratum : sample.strata()) {
      Drawn& drawn = strata.emplace_back();
      for (const uint32_t block : stratum.order) drawn.known.push_back(known_[block]);
      for (uint32_t i = 0; i < stratum.drawn; ++i) drawn.costs.push_back(costs_.at(stratum.order[i]));
    }
    return {always, std::move(strata)};
  }

  void conclude(const Estimate& estimate) {
    figures_.cycles = estimate.total(count::kCycles);
    figures_.cycles.low -= beside_error_ * figures_.cycles.value;
    figures_.cycles.high += beside_error_ * figures_.cycles.value;
    const auto share = [&](const Interval& x, double error = 0) {
      error += std::max(kLeastShareError, beside_error_ * x.value);
      return Interval{x.value, std::max(0.0, x.low - error), std::min(1.0, x.high + error)};
    };
    const auto mrays = [&](double cycles) { return 1e3 * rays_ / cycles; };
    figures_.mrays_per_s = {mrays(figures_.cycles.value), mrays(figures_.cycles.high), mrays(figures_.cycles.low)};
    for (size_t i = 0; i < kAluTypes; ++i) {
      const Interval unused = estimate.ratio(count::kUnused + i, count::kBusyCycles);
      const auto used = [&](double x) { return 1 - x / chip_.configuration.alus[i].count; };
      figures_.alus[i] = share({used(unused.value), used(unused.high), used(unused.low)});
    }
    figures_.ray_port = share(estimate.ratio(count::kRayPort, count::kCycles));
    figures_.intersection_port = share(estimate.ratio(count::kIntersectionPort, count::kCycles));
    figures_.memory_port = share(estimate.ratio(count::kMemoryPort, count::kCycles), kRememberedError);
  }

  static Interval exactly(double x) { return {x, x, x}; }

  Figures draw_whole() {
    const ChipResult result = run_on_model(chip_);
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
  uint32_t units_;
  const std::vector<NativeWork>& work_;  // [block]
  Wanted wanted_;
  Figures figures_;
  uint32_t block_;  // tiles
  Beside beside_;
  double beside_error_;               // a share of each figure
  std::vector<Known> known_;          // [block]
  std::vector<double> sizes_;         // [block] a share of the frame's work, times what is known
  bool fills_caches_ = true;          // before a block, behind tiles that are left out
  double rays_ = 0;                   // of the frame
  std::map<uint32_t, Counts> costs_;  // [block]
};

}  // namespace

std::vector<std::vector<PixelTile>> blocks_of(const Configuration& configuration, uint32_t width, uint32_t height) {
  const std::vector<PixelTile> walk = chip::along_walk(configuration, width, height);
  const uint32_t tiles = block_tiles(configuration, walk.size());
  std::vector<std::vector<PixelTile>> blocks;
  for (const PixelTile& tile : walk) {
    if (blocks.empty() || blocks.back().size() == tiles) blocks.emplace_back();
    blocks.back().push_back(tile);
  }
  return blocks;
}

double least_share(const Configuration& configuration, uint32_t width, uint32_t height) {
  const auto tiles = size32(chip::along_walk(configuration, width, height));
  const uint32_t block = block_tiles(configuration, tiles);
  if (!has_pilot(tiles, block)) return 1;
  const Beside beside(configuration);
  const uint32_t blocks = kLeastDrawn * pilot_strata(tiles, block) + 2;
  return std::min(1.0, static_cast<double>(blocks) * (beside.before + block + beside.behind) / tiles);
}

double seconds_of_frame(const ChipOptions& chip, uint32_t units, const std::vector<NativeWork>& work) {
  return SampledFrame(chip, units, work, {}).seconds();
}

Figures draw_sampled(const ChipOptions& chip, uint32_t units, const std::vector<NativeWork>& work,
                     const Wanted& wanted) {
  return SampledFrame(chip, units, work, wanted).draw();
}

}  // namespace raypool::sampled
