// The ray pool in Verilog against its class, all outputs in every cycle, under random traffic with stalls on every
// port: rays that come in gusts, a traverser that takes them when it likes and frees their places in any order.
#include "machine/chip/ray_pool.hpp"

#include <gtest/gtest.h>
#include <verilated.h>

#include <algorithm>
#include <deque>
#include <vector>

#include "Vray_pool_16_3_2_0_1.h"
#include "Vray_pool_1_1_1_0_0.h"
#include "Vray_pool_1_2_1_1_0.h"
#include "Vray_pool_2_1_1_1_1.h"
#include "Vray_pool_3_64_64_1_0.h"
#include "Vray_pool_512_2_1_0_0.h"
#include "Vray_pool_512_2_1_1_1.h"
#include "Vray_pool_5_9_3_1_1.h"
#include "Vray_pool_7_2_1_0_1.h"
#include "unit/common/clocked.hpp"

namespace raypool::bench {
namespace {

/// Its numbers are those of the class: size, overhead, cycles per beat, pipelined, culling.
template <typename Unit_, uint32_t kSize, uint32_t kOverhead, uint32_t kCyclesPerBeat, bool kPipelined, bool kCulling>
struct Pool {
  using Unit = Unit_;
  static ChipConfiguration chip() {
    ChipConfiguration chip;
    chip.ray_pool_size = kSize;
    chip.ray_pool_overhead = kOverhead;
    chip.ray_pool_cycles_per_beat = kCyclesPerBeat;
    chip.ray_pool_pipelined = kPipelined;
    chip.culling = kCulling;
    return chip;
  }
};

constexpr uint32_t kDepthLimit = 5;

/// What a run has shown: that it was there.
struct Seen {
  uint32_t deep = 0, black = 0, shadow = 0, full = 0;
  uint32_t freed_for_a_ray_that_waits = 0, freed_and_kept = 0, out_of_order = 0;
};

template <typename P>
class Bench {
 public:
  explicit Bench(uint32_t seed)
      : bench_(seed), chip_(P::chip()), pool_(chip_, kDepthLimit), reader_(chip_.ray_pool_size) {
    u_.depth_limit_i = kDepthLimit;
  }

  /// One in so many cycles: a ray comes, a beat waits, the traverser does not take a beat, frees a place (0: never).
  struct Traffic {
    uint32_t ray = 1, gap = 0, stall = 0, free = 1;
  };

  void clock(const Traffic& traffic) {
    offer(traffic);
    free_place(traffic);
    u_.ray_ready_i = traffic.stall == 0 || !bench_.one_of(traffic.stall);
    u_.eval();
    ASSERT_NO_FATAL_FAILURE(check_state()) << "cycle " << cycle_;
    const bool full = pool_.full();
    bool kept = false;
    outcome_shown_ = false;
    if (u_.export_valid_i) {
      const bool ready = pool_.beats_from() <= cycle_;
      ASSERT_EQ(u_.export_ready_o, ready) << "cycle " << cycle_;
      if (ready) {
        kept = take();
      } else {
        pool_.want(cycle_);
        ASSERT_EQ(u_.held_up_o, pool_.held_up(cycle_)) << "cycle " << cycle_;
        seen.freed_for_a_ray_that_waits += full && u_.free_valid_i;
      }
    }
    seen.full += full;
    seen.freed_and_kept += kept && u_.free_valid_i;
    if (u_.free_valid_i) pool_.free(cycle_, u_.free_place_i, u_.free_shadow_i);
    move_out();
    if (kept) reader_.push(pool_.outcome().place, pool_.ray());
    bench_.clock();
    ++cycle_;
  }
  /// Nothing more comes, and everything leaves.
  void drain() {
    for (uint32_t i = 0; i < 4000 && (beat_ != 0 || waits_ || pool_.size() != 0); ++i) {
      ASSERT_NO_FATAL_FAILURE(clock({0, 0, 0, 1}));
    }
    ASSERT_EQ(pool_.size(), 0u);
    ASSERT_EQ(expected_.size(), 0u) << "rays that the traverser never had";
    for (uint32_t i = 0; i < 200; ++i) ASSERT_NO_FATAL_FAILURE(clock({0, 0, 0, 0}));
    EXPECT_EQ(u_.taken_o, pool_.taken());
    EXPECT_EQ(u_.busy_cycles_o, pool_.busy_cycles());
    EXPECT_EQ(came_, pool_.taken());
  }
  uint64_t rays() const { return came_; }
  uint32_t capacity() const { return pool_.capacity(); }

  Seen seen;

 private:
  void offer(const Traffic& traffic) {
    if (waits_) return;
    if (beat_ == 0) {
      u_.export_valid_i = traffic.ray != 0 && bench_.one_of(traffic.ray);
      if (!u_.export_valid_i) return;
      make_ray();
    } else {
      u_.export_valid_i = traffic.gap == 0 || !bench_.one_of(traffic.gap);
      if (!u_.export_valid_i) return;
    }
    for (uint32_t i = 0; i < 4; ++i) u_.export_data_i[i] = ray_[beat_ * 4 + i];
    u_.export_last_i = beat_ == 2;
    u_.export_unit_i = unit_;
  }
  void make_ray() {
    for (uint32_t& word : ray_) word = static_cast<uint32_t>(bench_.random());
    unit_ = bench_.random() % 4;
    if (bench_.one_of(2)) ray_[word::kFlags] = 1 + bench_.random() % 7 + (bench_.one_of(4) ? kShadowFlag : 0);
    if (bench_.one_of(3)) {
      for (uint32_t i = 0; i < 3; ++i) ray_[word::kColor + i] = bench_.one_of(3) ? 0x80000000u : 0;
      // A weight of one bit is none to be dropped.
      if (bench_.one_of(2)) ray_[word::kColor + bench_.random() % 3] = 1u << bench_.random() % 31;
    }
  }
  // Rays leave the traverser in any order.
  void free_place(const Traffic& traffic) {
    u_.free_valid_i = !inside_.empty() && traffic.free != 0 && bench_.one_of(traffic.free);
    if (!u_.free_valid_i) return;
    const size_t which = bench_.random() % inside_.size();
    seen.out_of_order += which != 0;
    u_.free_place_i = inside_[which].place;
    u_.free_shadow_i = inside_[which].shadow;
    inside_.erase(inside_.begin() + static_cast<std::ptrdiff_t>(which));
  }
  void check_state() {
    ASSERT_EQ(u_.rays_o, pool_.size());
    ASSERT_EQ(u_.shadow_rays_o, pool_.shadow_rays());
    ASSERT_EQ(u_.outcome_valid_o, outcome_shown_);
    if (outcome_shown_) {
      const RayPool::Outcome& outcome = pool_.outcome();
      const Ray& ray = pool_.ray();
      ASSERT_EQ(u_.outcome_kept_o, outcome.kept);
      ASSERT_EQ(u_.outcome_deep_o, outcome.deep);
      ASSERT_EQ(u_.outcome_shadow_o, outcome.shadow);
      ASSERT_EQ(u_.outcome_eye_o, !outcome.shadow && (ray[word::kFlags] & kDepthMask) == 1);
      ASSERT_EQ(u_.outcome_pixel_o, outcome_pixel_);
      ASSERT_EQ(u_.outcome_unit_o, outcome_unit_);
    }
    ASSERT_EQ(u_.ray_valid_o, reader_.valid());
    if (!reader_.valid()) return;
    const Beat beat = reader_.data();
    for (uint32_t i = 0; i < 4; ++i) ASSERT_EQ(u_.ray_data_o[i], beat[i]);
    ASSERT_EQ(u_.ray_last_o, reader_.last());
    ASSERT_EQ(u_.ray_place_o, reader_.place());
  }
  // The device's beat is taken. True if it completes a ray that stays.
  bool take() {
    Beat beat;
    std::copy_n(&ray_[beat_ * 4], 4, beat.begin());
    const bool complete = pool_.take(cycle_, beat);
    beat_ = complete ? 0 : beat_ + 1;
    waits_ = false;
    if (!complete) return false;
    ++came_;
    const RayPool::Outcome& outcome = pool_.outcome();
    outcome_shown_ = true;
    outcome_pixel_ = ray_[word::kPixel];
    outcome_unit_ = unit_;
    seen.deep += outcome.deep;
    seen.black += !outcome.deep && !outcome.kept;
    seen.shadow += outcome.shadow && outcome.kept;
    if (outcome.kept) expected_.push_back(ray_);
    return outcome.kept;
  }
  // The traverser takes a beat.
  void move_out() {
    waits_ = u_.export_valid_i && !u_.export_ready_o;
    if (u_.ray_valid_o && u_.ray_ready_i) {
      const Beat beat = reader_.data();
      std::copy(beat.begin(), beat.end(), &leaving_[leaving_beat_ * 4]);
      ++leaving_beat_;
      if (reader_.last()) {
        leaving_beat_ = 0;
        ASSERT_FALSE(expected_.empty());
        ASSERT_EQ(leaving_, expected_.front()) << "not the oldest ray";
        expected_.pop_front();
        for (const Inside& other : inside_) ASSERT_NE(other.place, reader_.place()) << "two rays in one place";
        inside_.push_back({reader_.place(), (leaving_[word::kFlags] & kShadowFlag) != 0});
      }
    }
    reader_.clock(u_.ray_ready_i);
  }

  struct Inside {
    uint32_t place;
    bool shadow;
  };
  Clocked<typename P::Unit> bench_;
  typename P::Unit& u_ = *bench_.u;
  ChipConfiguration chip_;
  RayPool pool_;
  RayReader reader_;
  uint64_t cycle_ = 1, came_ = 0;
  Ray ray_{}, leaving_{};
  uint32_t beat_ = 0, unit_ = 0, leaving_beat_ = 0;
  bool waits_ = false, outcome_shown_ = false;
  uint32_t outcome_pixel_ = 0, outcome_unit_ = 0;
  std::deque<Ray> expected_;  // by the traverser
  std::vector<Inside> inside_;
};

template <typename P>
class RayPoolInVerilog : public testing::Test {};
using Pools =
    testing::Types<Pool<Vray_pool_1_1_1_0_0, 1, 1, 1, false, false>, Pool<Vray_pool_1_2_1_1_0, 1, 2, 1, true, false>,
                   Pool<Vray_pool_2_1_1_1_1, 2, 1, 1, true, true>, Pool<Vray_pool_7_2_1_0_1, 7, 2, 1, false, true>,
                   Pool<Vray_pool_5_9_3_1_1, 5, 9, 3, true, true>, Pool<Vray_pool_16_3_2_0_1, 16, 3, 2, false, true>,
                   Pool<Vray_pool_3_64_64_1_0, 3, 64, 64, true, false>,
                   Pool<Vray_pool_512_2_1_0_0, 512, 2, 1, false, false>,
                   Pool<Vray_pool_512_2_1_1_1, 512, 2, 1, true, true>>;
TYPED_TEST_SUITE(RayPoolInVerilog, Pools);

TYPED_TEST(RayPoolInVerilog, AgreesWithItsClassInEveryCycle) {
  Seen seen;
  uint64_t rays = 0;
  const ChipConfiguration chip = TypeParam::chip();
  const uint32_t service = chip.ray_pool_overhead + 3 * chip.ray_pool_cycles_per_beat;
  const uint32_t cycles = std::max(3000u, 40 * service + 24 * chip.ray_pool_size);
  for (uint32_t seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Bench<TypeParam> bench(seed);
    for (uint32_t i = 0; i < cycles; ++i) ASSERT_NO_FATAL_FAILURE(bench.clock({1, 0, 0, 1}));  // as fast as it goes
    for (uint32_t i = 0; i < cycles; ++i) ASSERT_NO_FATAL_FAILURE(bench.clock({1, 0, 2, 4 * service}));  // full
    for (uint32_t i = 0; i < cycles; ++i) ASSERT_NO_FATAL_FAILURE(bench.clock({7, 3, 3, 2}));            // now and then
    for (uint32_t i = 0; i < cycles; ++i) ASSERT_NO_FATAL_FAILURE(bench.clock({3, 4, 8, i / 64 % 2}));
    for (uint32_t i = 0; i < cycles; ++i) ASSERT_NO_FATAL_FAILURE(bench.clock({2, 9, 2, 3 * service}));
    ASSERT_NO_FATAL_FAILURE(bench.drain());
    rays += bench.rays();
    seen.deep += bench.seen.deep;
    seen.black += bench.seen.black;
    seen.shadow += bench.seen.shadow;
    seen.full += bench.seen.full;
    seen.freed_for_a_ray_that_waits += bench.seen.freed_for_a_ray_that_waits;
    seen.freed_and_kept += bench.seen.freed_and_kept;
    seen.out_of_order += bench.seen.out_of_order;
  }
  EXPECT_GT(rays, 6 * 5 * cycles / (8 * service));
  EXPECT_GT(seen.deep, 20u);
  EXPECT_EQ(seen.black > 20, chip.culling);
  EXPECT_GT(seen.shadow, 20u);
  EXPECT_GT(seen.full, 100u);
  EXPECT_GT(seen.freed_for_a_ray_that_waits, 5u);
  // The only ray there is cannot leave while another one comes; and where rays are long the two hardly meet.
  if (chip.ray_pool_size > 1 && service < 64) {
    EXPECT_GT(seen.freed_and_kept, 0u);
  }
  EXPECT_EQ(seen.out_of_order > 0, chip.ray_pool_size > 1);
}

}  // namespace
}  // namespace raypool::bench
