// The intersection pool in Verilog against its class, all outputs in every cycle, under random traffic with stalls on
// every port: packages of every kind that come in gusts, launches that reserve some and then ask for them.
#include "machine/chip/intersection_pool.hpp"

#include <gtest/gtest.h>
#include <verilated.h>

#include <algorithm>
#include <deque>
#include <vector>

#include "Vintersection_pool_1_21_1_1_0_0_1.h"
#include "Vintersection_pool_1_21_2_1_1_1_1.h"
#include "Vintersection_pool_2_16_1_1_1_0_0.h"
#include "Vintersection_pool_3_12_9_2_0_1_1.h"
#include "Vintersection_pool_3_21_64_64_1_0_1.h"
#include "Vintersection_pool_512_16_2_1_1_1_0.h"
#include "Vintersection_pool_512_21_2_1_0_0_1.h"
#include "Vintersection_pool_5_21_9_1_1_1_0.h"
#include "Vintersection_pool_7_18_3_3_1_0_1.h"
#include "unit/common/clocked.hpp"

namespace raypool::bench {
namespace {

/// Its numbers are those of the class: size, words, overhead, cycles per beat, pipelined, culling; and whether there
/// are shadow packages, of which the class has none where none are brought.
template <typename Unit_, uint32_t kSize, uint32_t kWords_, uint32_t kOverhead, uint32_t kCyclesPerBeat,
          bool kPipelined, bool kCulling, bool kShadows>
struct Pool {
  using Unit = Unit_;
  static constexpr uint32_t kWords = kWords_;
  static ChipConfiguration chip() {
    ChipConfiguration chip;
    chip.intersection_pool_size = kSize;
    chip.intersection_pool_overhead = kOverhead;
    chip.intersection_pool_cycles_per_beat = kCyclesPerBeat;
    chip.intersection_pool_pipelined = kPipelined;
    chip.culling = kCulling;
    return chip;
  }
  /// That there are packages of.
  static std::vector<uint32_t> kinds() {
    std::vector<uint32_t> kinds = {1};
    if (kShadows) kinds.push_back(2);
    if (kCulling) kinds.push_back(3);
    return kinds;
  }
  /// Records arrive with their words in order.
  static RecordLayout layout() { return RecordLayout::in_order(kWords); }
};

/// What a run has shown: that it was there.
struct Seen {
  uint32_t full = 0, refused = 0, put_and_taken = 0, both_registers = 0;
  uint32_t of_kind[4] = {};
};

template <typename P>
class Bench {
 public:
  static constexpr uint32_t kBeats = (P::kWords + 3) / 4;
  explicit Bench(uint32_t seed)
      : bench_(seed),
        chip_(P::chip()),
        kinds_(P::kinds()),
        all_kinds_(chip_.culling ? 3 : 2),
        level_bits_(bits_of(chip_.intersection_pool_size)),
        pool_(chip_, P::layout()) {
    u_.put_kind_i = u_.request_kind_i = u_.reserve_kind_i = 1;
  }

  /// One in so many cycles: a package comes, one of its beats waits, a launch, the next request (0: never, of gaps
  /// always). `only`: packages of this kind.
  struct Traffic {
    uint32_t put = 1, gap = 0, launch = 1, request = 1, only = 0;
  };

  void clock(const Traffic& traffic) {
    offer_put(traffic);
    reserve(traffic);
    ask(traffic);
    u_.eval();
    ASSERT_NO_FATAL_FAILURE(check_levels()) << "cycle " << cycle_;
    ASSERT_NO_FATAL_FAILURE(check_request()) << "cycle " << cycle_;
    ASSERT_NO_FATAL_FAILURE(check_beat()) << "cycle " << cycle_;
    take_put();
    if (u_.reserve_valid_i) pool_.reserve(static_cast<ImportKind>(u_.reserve_kind_i), u_.reserve_count_i);
    bench_.clock();
    ++cycle_;
  }
  void drain() {
    for (uint32_t i = 0; i < 60000 && (put_beat_ != 0 || put_waits_ || !empty()); ++i)
      ASSERT_NO_FATAL_FAILURE(clock({0, 0, 1, 1, 0}));
    ASSERT_TRUE(empty());
    for (uint32_t i = 0; i < 1000; ++i) ASSERT_NO_FATAL_FAILURE(clock({0, 0, 0, 0, 0}));
    EXPECT_EQ(u_.taken_o, pool_.taken());
    EXPECT_EQ(gone_, came_);
    EXPECT_EQ(gone_, pool_.taken());
  }
  uint64_t packages() const { return came_; }

  Seen seen;

 private:
  uint32_t some_kind() { return kinds_[bench_.random() % kinds_.size()]; }
  static uint32_t bits_of(uint32_t size) {
    uint32_t bits = 1;
    while (size >> bits != 0) ++bits;
    return bits;
  }
  uint32_t level(uint64_t levels, uint32_t kind) const {
    return static_cast<uint32_t>(levels >> (kind - 1) * level_bits_) & ((1u << level_bits_) - 1);
  }
  bool empty() const {
    for (uint32_t kind = 1; kind <= all_kinds_; ++kind)
      if (pool_.size(static_cast<ImportKind>(kind)) != 0) return false;
    return true;
  }
  void offer_put(const Traffic& traffic) {
    if (put_waits_) return;
    if (put_beat_ == 0) {
      u_.put_valid_i = traffic.put != 0 && bench_.one_of(traffic.put);
      if (!u_.put_valid_i) return;
      put_.fill(0);
      for (uint32_t i = 0; i < P::kWords; ++i) put_[i] = static_cast<uint32_t>(bench_.random());
      u_.put_kind_i = traffic.only != 0 ? traffic.only : some_kind();
    } else {
      u_.put_valid_i = traffic.gap == 0 || !bench_.one_of(traffic.gap);
      if (!u_.put_valid_i) return;
    }
    for (uint32_t i = 0, from = put_beat_ * 4; i < 4; ++i, ++from)
      u_.put_data_i[i] = from < put_.size() ? put_[from] : 0;
  }
  // A launch reserves some of what is available, and then asks for them one by one.
  void reserve(const Traffic& traffic) {
    u_.reserve_valid_i = 0;
    if (traffic.launch == 0 || !bench_.one_of(traffic.launch)) return;
    const uint32_t kind = some_kind();
    const uint32_t available = pool_.available(static_cast<ImportKind>(kind));
    if (available == 0 || promised_.size() > 64) return;
    u_.reserve_valid_i = 1;
    u_.reserve_kind_i = kind;
    u_.reserve_count_i = bench_.one_of(3) ? available : 1 + bench_.random() % available;
    promised_.insert(promised_.end(), u_.reserve_count_i, static_cast<uint8_t>(kind));
  }
  void ask(const Traffic& traffic) {
    if (request_waits_) return;
    u_.request_valid_i = 0;
    if (traffic.request == 0 || !bench_.one_of(traffic.request)) return;
    // What is reserved in this cycle can be asked for from the next one on.
    const size_t now = promised_.size() - (u_.reserve_valid_i ? u_.reserve_count_i : 0);
    if (now == 0) return;
    u_.request_valid_i = 1;
    u_.request_kind_i = promised_.front();
    u_.request_unit_i = bench_.random() % 4;
    promised_.pop_front();
  }
  void check_levels() {
    for (uint32_t kind = 1; kind <= all_kinds_; ++kind) {
      const auto of = static_cast<ImportKind>(kind);
      ASSERT_EQ(level(u_.size_o, kind), pool_.size(of)) << kind;
      ASSERT_EQ(level(u_.available_o, kind), pool_.available(of)) << kind;
      ASSERT_EQ(u_.put_ready_o >> (kind - 1) & 1, pool_.put_ready(of)) << kind;
      seen.full += pool_.full(of);
    }
  }
  void check_request() {
    request_waits_ = false;
    taken_ = false;
    if (!u_.request_valid_i) return;
    const auto kind = static_cast<ImportKind>(u_.request_kind_i);
    taken_ = pool_.request(cycle_, kind, u_.request_unit_i);
    ASSERT_EQ(u_.request_ready_o, taken_);
    request_waits_ = !taken_;
    if (!taken_) return;
    ++gone_;
    ++seen.of_kind[u_.request_kind_i];
    ASSERT_EQ(pool_.given(), expected_[u_.request_kind_i].front()) << "not the oldest package";
    expected_[u_.request_kind_i].pop_front();
    seen.both_registers += !leaving_.empty();
    leaving_.push_back(u_.request_unit_i);
  }
  void check_beat() {
    const bool due = pool_.beat_due() == cycle_;
    ASSERT_EQ(u_.beat_valid_o, due);
    ASSERT_EQ(u_.pixel_valid_o, due && beat_ == 1);
    if (!due) return;
    ASSERT_EQ(pool_.beat_number(), beat_);
    ASSERT_EQ(pool_.beat_unit(), leaving_.front());
    Beat beat;
    pool_.beat(beat);
    for (uint32_t i = 0; i < 4; ++i) ASSERT_EQ(u_.beat_data_o[i], beat[i]) << i;
    if (beat_ == 1) {
      ASSERT_EQ(u_.pixel_unit_o, leaving_.front());
    }
    if (++beat_ < kBeats) return;
    beat_ = 0;
    leaving_.pop_front();
  }
  void take_put() {
    const bool ready = (u_.put_ready_o >> (u_.put_kind_i - 1) & 1) != 0;
    put_waits_ = u_.put_valid_i && !ready;
    seen.refused += put_waits_;
    if (!u_.put_valid_i || put_waits_) return;
    const WData* data = u_.put_data_i;
    pool_.put_beat(cycle_, static_cast<ImportKind>(u_.put_kind_i), {data[0], data[1], data[2], data[3]});
    if (++put_beat_ < kBeats) return;
    put_beat_ = 0;
    ++came_;
    seen.put_and_taken += taken_ && u_.put_kind_i == u_.request_kind_i;
    expected_[u_.put_kind_i].push_back(put_);
  }

  Clocked<typename P::Unit> bench_;
  typename P::Unit& u_ = *bench_.u;
  ChipConfiguration chip_;
  std::vector<uint32_t> kinds_;  // that there are packages of
  uint32_t all_kinds_, level_bits_;
  IntersectionPool pool_;
  uint64_t cycle_ = 1, came_ = 0, gone_ = 0;
  Intersection put_{};
  uint32_t put_beat_ = 0, beat_ = 0;
  bool put_waits_ = false, request_waits_ = false, taken_ = false;
  std::deque<uint8_t> promised_;          // kinds, in the order in which they are asked for
  std::deque<Intersection> expected_[4];  // [kind] what is in the pool
  std::deque<uint32_t> leaving_;          // units that still await packages
};

template <typename P>
class IntersectionPoolInVerilog : public testing::Test {};
using Pools = testing::Types<Pool<Vintersection_pool_1_21_1_1_0_0_1, 1, 21, 1, 1, false, false, true>,
                             Pool<Vintersection_pool_1_21_2_1_1_1_1, 1, 21, 2, 1, true, true, true>,
                             Pool<Vintersection_pool_2_16_1_1_1_0_0, 2, 16, 1, 1, true, false, false>,
                             Pool<Vintersection_pool_3_12_9_2_0_1_1, 3, 12, 9, 2, false, true, true>,
                             Pool<Vintersection_pool_3_21_64_64_1_0_1, 3, 21, 64, 64, true, false, true>,
                             Pool<Vintersection_pool_5_21_9_1_1_1_0, 5, 21, 9, 1, true, true, false>,
                             Pool<Vintersection_pool_7_18_3_3_1_0_1, 7, 18, 3, 3, true, false, true>,
                             Pool<Vintersection_pool_512_21_2_1_0_0_1, 512, 21, 2, 1, false, false, true>,
                             Pool<Vintersection_pool_512_16_2_1_1_1_0, 512, 16, 2, 1, true, true, false>>;
TYPED_TEST_SUITE(IntersectionPoolInVerilog, Pools);

TYPED_TEST(IntersectionPoolInVerilog, AgreesWithItsClassInEveryCycle) {
  Seen seen;
  uint64_t packages = 0;
  const ChipConfiguration chip = TypeParam::chip();
  const std::vector<uint32_t> kinds = TypeParam::kinds();
  const uint32_t service = chip.intersection_pool_overhead + 6 * chip.intersection_pool_cycles_per_beat;
  const uint32_t cycles = std::max(3000u, 40 * service + 24 * chip.intersection_pool_size);
  for (uint32_t seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Bench<TypeParam> bench(seed);
    for (uint32_t i = 0; i < cycles; ++i) ASSERT_NO_FATAL_FAILURE(bench.clock({1, 0, 1, 1, 0}));  // as fast as it goes
    for (uint32_t i = 0; i < cycles; ++i)
      ASSERT_NO_FATAL_FAILURE(bench.clock({1, 0, 3 * service, 4 * service, 0}));                  // full
    for (uint32_t i = 0; i < cycles; ++i) ASSERT_NO_FATAL_FAILURE(bench.clock({9, 3, 2, 3, 0}));  // now and then
    for (uint32_t i = 0; i < cycles; ++i)
      ASSERT_NO_FATAL_FAILURE(bench.clock({1, 0, i / 256 % 2, 1, kinds[i / 128 % kinds.size()]}));
    for (uint32_t i = 0; i < cycles; ++i) ASSERT_NO_FATAL_FAILURE(bench.clock({4 * service, 9, 1, 1, 0}));
    ASSERT_NO_FATAL_FAILURE(bench.drain());
    packages += bench.packages();
    seen.full += bench.seen.full;
    seen.refused += bench.seen.refused;
    seen.put_and_taken += bench.seen.put_and_taken;
    seen.both_registers += bench.seen.both_registers;
    for (const uint32_t kind : kinds) seen.of_kind[kind] += bench.seen.of_kind[kind];
  }
  EXPECT_GT(packages, 4 * 5 * cycles / (8 * service));
  EXPECT_GT(seen.full, 100u);
  EXPECT_GT(seen.refused, 100u);
  for (const uint32_t kind : kinds) EXPECT_GT(seen.of_kind[kind], 20u) << kind;
  // To a pool of one nothing comes while there is something; and where packages are long the two hardly meet.
  if (chip.intersection_pool_size > 1 && service < 64) {
    EXPECT_GT(seen.put_and_taken, 0u);
  }
  // With a longer overhead the next request is taken when the beats before it have moved.
  const uint32_t beats = (TypeParam::kWords + 3) / 4 * chip.intersection_pool_cycles_per_beat;
  EXPECT_EQ(seen.both_registers > 0, chip.intersection_pool_pipelined && chip.intersection_pool_overhead <= beats);
}

/// A request that comes before its package, which a launch never makes: the turn begins with the package's last beat.
TYPED_TEST(IntersectionPoolInVerilog, ARequestWaitsForItsPackage) {
  Clocked<typename TypeParam::Unit> bench(1);
  auto& u = *bench.u;
  IntersectionPool pool(TypeParam::chip(), TypeParam::layout());
  const uint32_t beats = (TypeParam::kWords + 3) / 4;
  Intersection package{};
  for (uint32_t i = 0; i < TypeParam::kWords; ++i) package[i] = 100 + i;
  uint32_t taken = 0, due_beats = 0;
  const uint32_t number = TypeParam::kinds().back();
  const auto kind = static_cast<ImportKind>(number);
  u.request_kind_i = u.put_kind_i = u.reserve_kind_i = number;
  u.request_valid_i = 1;
  for (uint64_t cycle = 1; cycle < 1000; ++cycle) {
    const bool comes = cycle >= 10 && cycle < 10 + beats;
    u.put_valid_i = comes;
    for (uint32_t i = 0, from = static_cast<uint32_t>(cycle - 10) * 4; comes && i < 4; ++i, ++from)
      u.put_data_i[i] = from < package.size() ? package[from] : 0;
    u.reserve_valid_i = cycle == 9 + beats;
    u.reserve_count_i = 1;
    u.eval();
    const bool ready = u.request_valid_i && pool.request(cycle, kind);
    ASSERT_EQ(u.request_ready_o, ready) << cycle;
    taken += ready;
    ASSERT_EQ(u.beat_valid_o, pool.beat_due() == cycle) << cycle;
    if (u.beat_valid_o) {
      Beat beat;
      pool.beat(beat);
      for (uint32_t i = 0; i < 4; ++i) ASSERT_EQ(u.beat_data_o[i], beat[i]);
      ++due_beats;
    }
    if (cycle == 9 + beats) pool.put(cycle, kind, package);
    if (u.reserve_valid_i) pool.reserve(kind, 1);
    bench.clock();
    if (ready) u.request_valid_i = 0;
  }
  EXPECT_EQ(taken, 1u);
  EXPECT_EQ(due_beats, beats);
}

}  // namespace
}  // namespace raypool::bench
