// The controller in Verilog against its class, all outputs in every cycle, while it draws frames on random units, pools
// and a random traverser: kernels that export as much as they may or less, in their order and mixed with those of the
// next one, packages that wait in their unit, rays that are dropped. Every frame must come to its end.
#include "machine/chip/controller.hpp"

#include <gtest/gtest.h>
#include <verilated.h>

#include <algorithm>
#include <deque>
#include <vector>

#include "machine/chip/timed_tiles.hpp"
#include "unit/chip/controller_machines.hpp"
#include "unit/common/clocked.hpp"

namespace raypool::bench {
namespace {

/// A package that a unit has made, and of which launch.
enum class Package : uint8_t { Normal, Shadow, Contribution };

/// A random compute unit.
struct RandomUnit {
  struct Kernel {
    uint32_t imports = 0;  // left
    ImportKind import = ImportKind::None;
    std::vector<Package> exports;  // to be made, the next one last
  };
  std::deque<Kernel> kernels;  // oldest first; the last one waits, if `waits`
  bool waits = false;
  std::deque<Package> leaving;  // made, and still in the unit
  uint16_t exports = 0;
  uint64_t made = 0;  // the same, not modulo 2^16

  size_t running() const { return kernels.size() - waits; }
};

/// Pools, units and a traverser that do what they may, each at random times.
class RandomChip {
 public:
  RandomChip(const ChipConfiguration& chip, uint32_t units, bool reflections, std::mt19937& random, uint32_t pace)
      : chip_(chip), reflections_(reflections), random_(random), pace_(pace), units_(units) {}

  void next(bool reflections) { reflections_ = reflections; }

  /// What happens in a cycle.
  struct Events {
    bool ray = false, shadow = false, contribution = false;
    uint32_t ray_unit = 0, contribution_unit = 0;
    uint32_t done = 0;  // mask
  };

  bool ready() const {
    return std::any_of(units_.begin(), units_.end(), [](const RandomUnit& unit) { return !unit.waits; });
  }
  const RandomUnit& unit(uint32_t number) const { return units_[number]; }
  const Controller::Levels& levels() const { return levels_; }

  /// The unit that takes a launch: one without a kernel if there is one.
  uint32_t next_unit() {
    std::vector<uint32_t> free, ready;
    for (uint32_t u = 0; u < units_.size(); ++u) {
      if (units_[u].kernels.empty()) free.push_back(u);
      if (!units_[u].waits) ready.push_back(u);
    }
    const std::vector<uint32_t>& choice = free.empty() ? ready : free;
    return choice[random_() % choice.size()];
  }
  /// Rays of a kind that kernels will still make, or that wait in their units.
  uint32_t to_come(Package package) const {
    uint32_t sum = 0;
    for (const RandomUnit& unit : units_) {
      sum += static_cast<uint32_t>(std::count(unit.leaving.begin(), unit.leaving.end(), package));
      for (const RandomUnit::Kernel& kernel : unit.kernels)
        sum += static_cast<uint32_t>(std::count(kernel.exports.begin(), kernel.exports.end(), package));
    }
    return sum;
  }
  void reserve(ImportKind kind, uint32_t count) { levels_.available[kind] -= count; }
  void accept(uint32_t number, const Controller::Launch& launch) {
    RandomUnit::Kernel kernel;
    kernel.import = launch.import;
    kernel.imports = launch.import == ImportKind::None ? 0 : launch.threads;
    const bool eye = launch.choice.kind == Choice::Kind::Eye;
    // Eye rays come all; of others some may be left out.
    const uint32_t share = random_() % 3;
    for (uint32_t i = 0; i < launch.normal; ++i)
      if (eye || share == 0 || random_() % 2 == 0) kernel.exports.push_back(Package::Normal);
    for (uint32_t i = 0; i < launch.shadow; ++i)
      if (share == 0 || random_() % 3 == 0) kernel.exports.push_back(Package::Shadow);
    for (uint32_t i = 0; launch.choice.kind == Choice::Kind::Shade && i < launch.threads; ++i)
      kernel.exports.push_back(Package::Contribution);
    std::shuffle(kernel.exports.begin(), kernel.exports.end(), random_);
    units_[number].kernels.push_back(std::move(kernel));
    units_[number].waits = true;
  }

  Events step(uint64_t cycle) {
    Events events;
    trace();
    for (uint32_t number = 0; number < units_.size(); ++number) {
      RandomUnit& unit = units_[number];
      if (unit.waits && unit.running() < 2 && some()) unit.waits = false;
      if (unit.running() == 0) continue;
      make(unit);
      if (end(unit)) events.done |= 1u << number;
    }
    export_some(cycle, events);
    return events;
  }

  uint64_t overlapped = 0, left_out = 0, dropped = 0, late = 0, both = 0;

 private:
  bool some() { return random_() % pace_ == 0; }

  void trace() {
    if (levels_.rays == 0 || !some()) return;
    const bool shadow = random_() % levels_.rays < levels_.shadow_rays;
    ImportKind kind = shadow ? ImportKind::Shadow : ImportKind::Normal;
    if (!shadow && chip_.culling && reflections_ && random_() % 3 == 0) kind = ImportKind::Direct;
    const bool stays = random_() % 4 != 0 && !(shadow && chip_.shading == Shading::Traverser);
    if (stays && levels_.size[kind] >= chip_.intersection_pool_size) return;
    --levels_.rays;
    levels_.shadow_rays -= shadow;
    levels_.size[kind] += stays;
    levels_.available[kind] += stays;
  }

  // A kernel imports before it exports; the newer one of two may run ahead.
  void make(RandomUnit& unit) {
    overlapped += unit.running() == 2;
    for (size_t k = 0; k < unit.running(); ++k) {
      RandomUnit::Kernel& kernel = unit.kernels[k];
      if (!some()) continue;
      if (kernel.imports != 0) {
        --kernel.imports;
        --levels_.size[kernel.import];
      } else if (!kernel.exports.empty() && unit.leaving.size() < 100) {
        unit.leaving.push_back(kernel.exports.back());
        kernel.exports.pop_back();
        ++unit.exports;
        ++unit.made;
      }
    }
  }
  bool end(RandomUnit& unit) {
    const RandomUnit::Kernel& kernel = unit.kernels.front();
    if (kernel.imports != 0 || !kernel.exports.empty() || !some()) return false;
    unit.kernels.pop_front();
    late += !unit.leaving.empty();
    return true;
  }

  // A ray takes the port for three cycles at least.
  void export_some(uint64_t cycle, Events& events) {
    const uint32_t first = random_() % units_.size();
    for (uint32_t i = 0; i < units_.size(); ++i) {
      const uint32_t number = (first + i) % units_.size();
      std::deque<Package>& leaving = units_[number].leaving;
      if (leaving.empty() || !some()) continue;
      const Package package = leaving.front();
      if (package == Package::Contribution) {
        if (events.contribution) continue;
        events.contribution = true;
        events.contribution_unit = number;
      } else {
        if (events.ray || cycle < port_free_ || levels_.rays >= chip_.ray_pool_size) continue;
        events.ray = true;
        events.ray_unit = number;
        events.shadow = package == Package::Shadow;
        port_free_ = cycle + 3;
        const bool stays = random_() % 8 != 0;
        dropped += !stays;
        levels_.rays += stays;
        levels_.shadow_rays += stays && events.shadow;
      }
      leaving.pop_front();
    }
    both += events.contribution && events.ray;
  }

  const ChipConfiguration chip_;
  bool reflections_;
  std::mt19937& random_;
  uint32_t pace_;
  std::vector<RandomUnit> units_;
  Controller::Levels levels_;
  uint64_t port_free_ = 0;
};

struct Reached {
  uint64_t frames = 0, cycles = 0, eye = 0, secondary = 0, reflecting = 0, direct = 0, shade = 0, ahead = 0;
  uint64_t overlapped = 0, dropped = 0, late = 0, both = 0;
  uint64_t wrapped = 0;  ///< times that a unit's count of exports wrapped
};

/// Frames that the class draws on such a chip, one after the other.
template <typename M>
struct Frame {
  const ChipConfiguration around = M::chip();
  RandomChip chip;
  Controller controller;
  TimedTiles tiles;
  Controller::Launch launch;  ///< that is offered in cycle launch_at
  uint64_t begun_at = 0, launch_at = 0, decide_from = 0, ended_at = UINT64_MAX;
  uint32_t pixels = 0;  ///< that have been cast

  Frame(uint32_t width, uint32_t height, bool reflections, uint32_t pace, std::mt19937& random)
      : chip(around, M::kUnits, reflections, random, pace),
        controller(around, M::kContents, M::kUnits, reflections, M::walk().tile_width() * M::walk().tile_height(),
                   M::policy(reflections)),
        tiles(M::walk(), width, height) {}

  /// The next one begins in this cycle, without a reset.
  void begin_next(uint64_t cycle, uint32_t width, uint32_t height, bool reflections) {
    chip.next(reflections);
    controller.begin(reflections, M::policy(reflections));
    tiles = TimedTiles(M::walk(), width, height, cycle);
    begun_at = decide_from = cycle;
    ended_at = UINT64_MAX;
    pixels = 0;
  }
  bool ended() const { return ended_at != UINT64_MAX; }
  void take_launch(uint64_t cycle, uint32_t unit) {
    if (launch.import != ImportKind::None) chip.reserve(launch.import, launch.threads);
    chip.accept(unit, launch);
    controller.launched(cycle, unit, launch);
    if (launch.choice.kind == Choice::Kind::Eye) pixels += tiles.take(cycle).pixels;
    launch = {};
  }
  void report(uint64_t cycle, const RandomChip::Events& events) {
    if (events.ray) controller.ray_left(cycle, events.ray_unit, events.shadow);
    if (events.contribution) controller.contribution_left(cycle, events.contribution_unit);
    for (uint32_t unit = 0; unit < M::kUnits; ++unit)
      if ((events.done >> unit & 1) != 0) controller.kernel_ended(cycle, unit, chip.unit(unit).exports);
    controller.settle(cycle);
  }
  void decide(uint64_t cycle, bool ready) {
    if (cycle < decide_from || ended()) return;
    Controller::Levels levels = chip.levels();
    levels.ready = ready;
    const Controller::Tiles order = tiles.in(cycle + 2);
    if (controller.ended(levels, order)) {
      ended_at = cycle + Controller::kCycles + 1;
    } else if (const Controller::Launch decided = controller.decide(levels, order)) {
      launch = decided;
      launch_at = cycle + Controller::kCycles + 1;
      decide_from = launch_at + 1;
    }
  }
  /// What is counted is never too little, and the rules hold.
  void expect_rules() const {
    const Controller::Levels& levels = chip.levels();
    const uint32_t shadow = controller.shadow_rays_to_come();
    ASSERT_GE(shadow, chip.to_come(Package::Shadow));
    ASSERT_GE(controller.rays_to_come() - shadow, chip.to_come(Package::Normal));
    ASSERT_LE(controller.held(levels), around.held_limit);
    if (around.shading == Shading::Traverser) return;
    ASSERT_LT(levels.shadow_rays + shadow + levels.available[ImportKind::Shadow],
              around.ray_pool_size + around.intersection_pool_size);
  }
};

template <typename M>
class Bench {
  using Frame = bench::Frame<M>;

 public:
  explicit Bench(uint32_t seed) : bench_(seed) {}

  struct Size {
    uint32_t width, height;
    bool reflections;
  };
  /// Draws a frame. `pace`: each part of the chip does something once in so many cycles on average.
  void draw(uint32_t width, uint32_t height, bool reflections, uint32_t pace) {
    draw({{width, height, reflections}}, pace);
  }
  /// The first one after a reset, the others without.
  void draw(const std::vector<Size>& sizes, uint32_t pace) {
    const Size& first = sizes.front();
    Frame frame(first.width, first.height, first.reflections, pace, bench_.random);
    reset();
    uint64_t cycle = 0;
    for (const Size& size : sizes) {
      if (cycle != 0) frame.begin_next(cycle, size.width, size.height, size.reflections);
      const uint64_t begun = cycle;
      ASSERT_NO_FATAL_FAILURE(draw(frame, size, cycle));
      ++reached.frames;
      reached.cycles += cycle - begun;
    }
    count(frame.chip);
  }
  uint32_t below(uint32_t limit) { return static_cast<uint32_t>(bench_.random()) % limit; }

  Reached reached;

 private:
  void draw(Frame& frame, const Size& size, uint64_t& cycle) {
    show(size);
    RandomChip::Events before;  // in the cycle before
    const uint64_t most = cycle + 2'000'000;
    const uint32_t after = 3 + below(20);  // cycles until the next one begins
    for (; cycle < most && (!frame.ended() || cycle < frame.ended_at + after); ++cycle) {
      const bool ready = frame.chip.ready();
      const uint32_t unit = ready ? frame.chip.next_unit() : 0;
      const bool offered = frame.launch && cycle == frame.launch_at;
      show(frame.chip, before, ready, unit);
      u_.start_i = cycle == frame.begun_at;
      const bool busy = cycle > frame.begun_at && cycle < frame.ended_at;
      ASSERT_NO_FATAL_FAILURE(compare(cycle, offered ? &frame.launch : nullptr, frame.tiles, busy));
      const RandomChip::Events events = frame.chip.step(cycle);
      ASSERT_TRUE(ready || !offered);
      if (offered) {
        count(frame.launch, !frame.chip.unit(unit).kernels.empty());
        frame.take_launch(cycle, unit);
      }
      frame.report(cycle, events);
      frame.decide(cycle, ready);
      ASSERT_NO_FATAL_FAILURE(frame.expect_rules());
      before = events;
      clock(events, frame.chip);
    }
    ASSERT_LT(cycle, most) << "the frame does not end";
    EXPECT_EQ(frame.pixels, size.width * size.height);
    EXPECT_EQ(frame.controller.rays_to_come(), 0u);
  }
  void reset() {
    u_.rst_ni = 0;
    u_.start_i = 0;
    u_.kernel_done_i = 0;
    u_.outcome_valid_i = u_.exported_valid_i = 0;
    bench_.clock();
    u_.rst_ni = 1;
  }
  void show(const Size& size) {
    u_.width_i = size.width;
    u_.height_i = size.height;
    u_.reflections_i = size.reflections;
    u_.eye_pc_i = kEyePc;
    u_.secondary_pc_i = kSecondaryPc;
    u_.direct_pc_i = kDirectPc;
    u_.shade_pc_i = kShadePc;
  }

  // Levels and what has left are those of the cycle before.
  void show(const RandomChip& chip, const RandomChip::Events& before, bool ready, uint32_t unit) {
    u_.launch_ready_i = ready;
    u_.launch_unit_i = unit;
    u_.rays_i = chip.levels().rays;
    u_.shadow_rays_i = chip.levels().shadow_rays;
    u_.outcome_valid_i = before.ray;
    u_.outcome_unit_i = before.ray ? before.ray_unit : below(4);
    u_.outcome_shadow_i = before.ray ? before.shadow : below(2);
    u_.exported_valid_i = before.contribution;
    u_.exported_unit_i = before.contribution ? before.contribution_unit : below(4);
    show_intersections<M>(u_, chip.levels());
  }

  void compare(uint64_t cycle, const Controller::Launch* launch, TimedTiles& tiles, bool busy) {
    u_.eval();
    SCOPED_TRACE(testing::Message() << "cycle " << cycle);
    ASSERT_EQ(u_.busy_o, busy);
    ASSERT_EQ(u_.launch_valid_o, launch != nullptr);
    const bool reserves = launch != nullptr && launch->import != ImportKind::None;
    ASSERT_EQ(u_.reserve_valid_o, reserves);
    if (launch == nullptr) return;
    ASSERT_EQ(u_.launch_threads_o, launch->threads);
    ASSERT_EQ(u_.launch_import_o, static_cast<uint32_t>(launch->import));
    switch (launch->choice.kind) {
      case Choice::Kind::Eye:
        ASSERT_EQ(u_.launch_pc_o, kEyePc);
        ASSERT_EQ(u_.launch_block_o, tiles.in(cycle).offered->block());
        break;
      case Choice::Kind::Secondary:
        ASSERT_EQ(u_.launch_pc_o, launch->reflects ? kSecondaryPc : kDirectPc);
        break;
      default:
        ASSERT_EQ(u_.launch_pc_o, kShadePc);
    }
    if (!reserves) return;
    ASSERT_EQ(u_.reserve_kind_o, static_cast<uint32_t>(launch->import));
    ASSERT_EQ(u_.reserve_count_o, launch->threads);
  }

  // What ends in this cycle is seen in it.
  void clock(const RandomChip::Events& events, const RandomChip& chip) {
    u_.kernel_done_i = events.done;
    set(u_.exports_i, exports_port<M>([&](uint32_t unit) { return chip.unit(unit).exports; }));
    bench_.clock();
  }

  void count(const RandomChip& chip) {
    reached.overlapped += chip.overlapped;
    reached.dropped += chip.dropped;
    reached.late += chip.late;
    reached.both += chip.both;
    for (uint32_t u = 0; u < M::kUnits; ++u) reached.wrapped += chip.unit(u).made >> M::kExportBits;
  }
  void count(const Controller::Launch& launch, bool ahead) {
    reached.ahead += ahead;
    reached.eye += launch.choice.kind == Choice::Kind::Eye;
    reached.secondary += launch.choice.kind == Choice::Kind::Secondary;
    reached.reflecting += launch.reflects;
    reached.direct += launch.import == ImportKind::Direct;
    reached.shade += launch.choice.kind == Choice::Kind::Shade;
  }

  Clocked<typename M::Unit> bench_;
  typename M::Unit& u_ = *bench_.u;
};

template <typename M>
class ControllerInVerilog : public testing::Test {};
TYPED_TEST_SUITE(ControllerInVerilog, Machines);

TYPED_TEST(ControllerInVerilog, AgreesWithItsClassInEveryCycle) {
  constexpr uint32_t kFrames = 60;
  Bench<TypeParam> bench(3);
  const ChipConfiguration chip = TypeParam::chip();
  for (uint32_t frame = 0; frame < kFrames; ++frame) {
    const uint32_t width = 1 + bench.below(frame % 5 == 0 ? 100 : 20), height = 1 + bench.below(20);
    const bool reflections = bench.below(3) != 0;
    const uint32_t pace = 1 + bench.below(4) * bench.below(4);
    SCOPED_TRACE(testing::Message() << "frame " << frame << ", " << width << " x " << height << ", pace " << pace);
    ASSERT_NO_FATAL_FAILURE(bench.draw(width, height, reflections, pace));
  }
  const Reached& reached = bench.reached;
  EXPECT_EQ(reached.frames, kFrames);
  EXPECT_GT(reached.eye, 100u);
  EXPECT_GT(reached.secondary, 500u);
  EXPECT_GT(reached.reflecting, 100u);
  EXPECT_GT(reached.secondary, reached.reflecting);
  EXPECT_GT(reached.late, 50u);
  EXPECT_GT(reached.dropped, 100u);
  if (TypeParam::kUnits > 1 && chip.shading == Shading::Kernel) {
    EXPECT_GT(reached.both, 20u);
  }
  if (chip.policy == PolicyName::Fill) {  // the other one seldom launches ahead
    EXPECT_GT(reached.overlapped, 100u);
    EXPECT_GT(reached.ahead, 20u);
  }
  if (chip.culling) {
    EXPECT_GT(reached.direct, 50u);
  }
  if (chip.shading == Shading::Kernel) {
    EXPECT_GT(reached.shade, 100u);
  }
}

TYPED_TEST(ControllerInVerilog, DrawsFrameAfterFrameWithoutAReset) {
  Bench<TypeParam> bench(5);
  for (uint32_t run = 0; run < 12; ++run) {
    SCOPED_TRACE(testing::Message() << "run " << run);
    std::vector<typename Bench<TypeParam>::Size> sizes;
    for (uint32_t frame = 0; frame < 5; ++frame)
      sizes.push_back({1 + bench.below(20), 1 + bench.below(20), bench.below(3) != 0});
    ASSERT_NO_FATAL_FAILURE(bench.draw(sizes, 1 + run % 4));
  }
  EXPECT_EQ(bench.reached.frames, 60u);
}

// As many packages of each unit as it takes: the narrower the count the smaller the picture.
TYPED_TEST(ControllerInVerilog, EndsAFrameInWhichTheCountsOfExportsWrap) {
  Bench<TypeParam> bench(4);
  const uint32_t side = TypeParam::kExportBits == 16 ? 240 : 60;
  ASSERT_NO_FATAL_FAILURE(bench.draw(side, side, true, 1));
  EXPECT_GE(bench.reached.wrapped, TypeParam::kUnits);
}

}  // namespace
}  // namespace raypool::bench
