// The traverser in Verilog against its class, all outputs in every cycle, over trees and rays that are hard, between
// pools and a memory that stall; and both against a walk of each tree: what becomes of every ray. Also over malformed
// trees: rays end, or the fault comes that a walk comes to.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>

#ifdef RAYPOOL_LARGE
#include "Vtraverser_1_1_8_6_1_4_2_1_1_4_2_1_1_1_21_0_0.h"
#include "Vtraverser_5_24_16_12_1_64_4_16_8_32_2_5_1_160_20_0_1.h"
#else
#include "Vtraverser_2_3_8_8_1_16_2_4_2_16_2_2_1_24_21_0_0_1.h"
#include "Vtraverser_3_4_9_10_2_16_2_4_2_32_4_6_2_9_16_1_1.h"
#endif
#include "unit/traverser/garbage_trees.hpp"
#include "unit/traverser/traverser_bench.hpp"
#include "unit/traverser/tree_case.hpp"

namespace raypool::bench {
namespace {

/// The scene, its tree or a bad one, and what its rays must become.
template <typename P>
class Case {
 public:
  TreeCase what;
  std::vector<typename TraverserBench<P>::Asked> rays;

  /// `change`: of the tree, before it is walked.
  Case(const Scene& scene, int count, uint32_t seed, const std::function<void(LaneTree&)>& change = {}) {
    const Traversal engine(scene);
    const Bvh& bvh = engine.bvh();
    what.tree = LaneTree(scene, seed % 2 == 0 && !bvh.nodes.empty() ? test::random_tree(bvh, seed) : bvh);
    if (change) change(what.tree);
    std::mt19937 random(seed);
    const Scene aims = scene.triangles.empty() ? test::ball({0, 0, 0}, 4) : scene;
    for (RayQuery query : hard_rays(aims, count, seed)) {
      if (random() % 24 == 0) query.limit = random() % 2 == 0 ? 0 : NAN;
      const bool shadow = random() % 3 == 0;
      what.rays.push_back(words(query, shadow, random));
    }
    rays = asked_of<P>(what);
  }

  /// Moves the limits of some rays to what they hit, or a last place before or behind it.
  void limit_at_hits(std::mt19937& random) {
    for (size_t i = 0; i < rays.size(); ++i) {
      const auto& hit = rays[i].walk.hit;
      if (hit.hit && random() % 4 == 0)
        what.rays[i][word::kLimit] = as_bits(std::ldexp(hit.t, rays[i].scale)) + random() % 3 - 1;
    }
    rays = asked_of<P>(what);
  }

 private:
  // The first colour is the ray's number.
  Ray words(const RayQuery& query, bool shadow, std::mt19937& random) const {
    Ray ray{};
    for (int axis = 0; axis < 3; ++axis) {
      ray[word::kOrigin + axis] = as_bits(query.origin[axis]);
      ray[word::kDirection + axis] = as_bits(query.direction[axis]);
    }
    ray[word::kLimit] = as_bits(query.limit);
    ray[word::kPixel] = random();
    ray[word::kColor] = static_cast<uint32_t>(what.rays.size());
    ray[word::kColor + 1] = random();
    ray[word::kColor + 2] = random();
    ray[word::kFlags] = (shadow ? kShadowFlag : 0) | (random() & 0x7fffff00) | random() % 256;
    return ray;
  }
};

template <typename P>
class TraverserTest : public testing::Test {};
#ifdef RAYPOOL_LARGE  // traverser_large_test, of make test-long
using All = testing::Types<TraverserParameters<Vtraverser_5_24_16_12_1_64_4_16_8_32_2_5_1_160_20_0_1, 5, 24, 16, 12, 1,
                                               Cache<64, 4, 16, 8>, Cache<32, 2, 5, 1>, 160, 20, false, true>,
                           TraverserParameters<Vtraverser_1_1_8_6_1_4_2_1_1_4_2_1_1_1_21_0_0, 1, 1, 8, 6, 1,
                                               Cache<4, 2, 1, 1>, Cache<4, 2, 1, 1>, 1, 21, false, false>>;
#else
using All = testing::Types<TraverserParameters<Vtraverser_3_4_9_10_2_16_2_4_2_32_4_6_2_9_16_1_1, 3, 4, 9, 10, 2,
                                               Cache<16, 2, 4, 2>, Cache<32, 4, 6, 2>, 9, 16, true, true>,
                           TraverserParameters<Vtraverser_2_3_8_8_1_16_2_4_2_16_2_2_1_24_21_0_0_1, 2, 3, 8, 8, 1,
                                               Cache<16, 2, 4, 2>, Cache<16, 2, 2, 1>, 24, 21, false, false, true>>;
#endif
TYPED_TEST_SUITE(TraverserTest, All);

TYPED_TEST(TraverserTest, AgreesWithItsClassInEveryCycleAndEveryRayBecomesWhatItMust) {
  TraverserBench<TypeParam> bench(1);
  std::mt19937 random(7);
  const TraverserTraffic traffics[] = {
      {}, {0, 2, 1, 0, 0, 0}, {3, 0, 9, 4, 3, 3}, {0, 3, 40, 0, 2, 9}, {40, 0, 1, 2, 0, 0}, {0, 0, 12, 0, 40, 2}};
  for (uint32_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const Case<TypeParam> test(any_scene(random), 120, seed);
    ASSERT_NO_FATAL_FAILURE(bench.trace(test.what.tree, test.rays, traffics[random() % std::size(traffics)]));
  }
  const TraverserSeen& seen = bench.seen;
  const Traverser::Sizes sizes = TypeParam::sizes();
  EXPECT_EQ(seen.rays, 20u * 120);
  EXPECT_GT(seen.normal + seen.direct, 250u);
  if (sizes.culling) {
    EXPECT_GT(seen.direct, 100u);
  }
  EXPECT_EQ(seen.shadow == 0, sizes.contributes);
  EXPECT_GT(seen.shadow + seen.contributions, 50u);
  EXPECT_GT(seen.dropped, sizes.miss_records ? 150u : 300u);
  for (const uint64_t plain : seen.plain) EXPECT_TRUE(sizes.miss_records ? plain > 50 : plain == 0) << plain;
  EXPECT_GT(seen.reads, 1000u);
  if (sizes.stack_entries < 16) {
    EXPECT_GT(seen.spills, 20u);
    EXPECT_GT(seen.stack_reads, 5u);
  }
  EXPECT_EQ(seen.spills == 0, seen.stack_reads == 0);
  EXPECT_LE(seen.stack_reads, seen.spills);
}

TYPED_TEST(TraverserTest, AgreesInLargeScenesAndWhereALimitIsAtAHit) {
  TraverserBench<TypeParam> bench(11);
  std::mt19937 random(12);
  const int rays = TypeParam::kPool == 1 ? 20 : 160;  // one at a time takes long
  for (uint32_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const float scale = std::ldexp(1.0f, static_cast<int>(3 * seed));
    const Vec3 at = seed % 2 == 0 ? Vec3{0, 0, 0} : Vec3{70, -800, 3};
    Case<TypeParam> test(soup(random(), 600, scale, at), rays, seed);
    test.limit_at_hits(random);
    ASSERT_NO_FATAL_FAILURE(bench.trace(test.what.tree, test.rays, {}));
  }
  EXPECT_EQ(bench.seen.rays, 12u * static_cast<uint32_t>(rays));
}

TYPED_TEST(TraverserTest, RaysThatWaitForRoomHoldUpNoOthers) {
  TraverserBench<TypeParam> bench(2);
  std::mt19937 random(9);
  for (uint32_t seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const Case<TypeParam> test(small_scene(random), 4 * int{TypeParam::kPool} + 50, 2 * seed);
    ASSERT_NO_FATAL_FAILURE(bench.trace_without_room(test.what.tree, test.rays));
  }
  EXPECT_GT(bench.seen.full, 0u);
}

TYPED_TEST(TraverserTest, ManyRaysWaitForOneLine) {
  TraverserBench<TypeParam> bench(3);
  for (const size_t triangles : {1, 3, 100, 60, 100}) {
    SCOPED_TRACE(testing::Message() << triangles << " triangles");
    const std::array<Vec3, 3> one{Vec3{0, 0, 1}, Vec3{5, 0, 2}, Vec3{0, 5, 1}};
    const Case<TypeParam> test(scene_of(std::vector<std::array<Vec3, 3>>(triangles, one)), 150,
                               static_cast<uint32_t>(triangles));
    ASSERT_NO_FATAL_FAILURE(bench.trace(test.what.tree, test.rays, {0, 0, triangles < 10 ? 600u : 60u, 0, 0, 0}));
  }
  if (TypeParam::sizes().slots > LeafReader::kLines) {
    EXPECT_GT(bench.seen.left, 100u);
  }
}

// Each reason for a fault, and the line that it names.
TYPED_TEST(TraverserTest, EachFaultIsNamed) {
  TraverserBench<TypeParam> bench(4);
  for (const GarbageCase& garbage : kGarbageCases) {
    SCOPED_TRACE(garbage.name);
    const uint64_t before = bench.seen.faults[to_underlying(garbage.code)];
    const Case<TypeParam> test(soup(5, 60, 1, {0, 0, 0}), 60, 1, garbage.make);
    ASSERT_NO_FATAL_FAILURE(bench.trace_or_fault(test.what.tree, test.rays, {}));
    EXPECT_EQ(bench.seen.faults[to_underlying(garbage.code)], before + 1);
  }
}

// Of two faults in one cycle, or in two that follow, which is the first.
TYPED_TEST(TraverserTest, FaultsThatComeTogether) {
  std::mt19937 random(11);
  std::array<uint64_t, 7> faults{};
  for (uint32_t seed = 1; seed <= 180; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    TraverserBench<TypeParam> bench(seed);
    const Case<TypeParam> test(soup(seed, 12, 1, {0, 0, 0}), 24, seed, seed <= 60 ? make_both : make_two_ladders);
    const TraverserTraffic traffic{0, 0, 1 + static_cast<uint32_t>(random() % 40), 0, 0, 0};
    ASSERT_NO_FATAL_FAILURE(bench.trace_or_fault(test.what.tree, test.rays, traffic));
    for (size_t code = 0; code < faults.size(); ++code) faults[code] += bench.seen.faults[code];
  }
  EXPECT_GT(faults[to_underlying(TreeFaultCode::NodeBeyond)] + faults[to_underlying(TreeFaultCode::Children)], 20u);
  EXPECT_GT(faults[to_underlying(TreeFaultCode::Visits)], 20u);
}

// A tree as deep as stacks bear, and one that is deeper by a node.
TYPED_TEST(TraverserTest, StacksBearWhatTheyHaveRoomFor) {
  TraverserBench<TypeParam> bench(5);
  // With three entries more in each node, one block is written for four of them, and 127 have room.
  const uint32_t entries = TypeParam::sizes().stack_entries;
  uint32_t depth = 1;
  for (uint32_t here = 0, blocks = 0;; ++depth) {
    here += LaneStacks::kLeast;
    if (here + LaneStacks::kLeast <= entries) continue;
    here -= LaneStacks::kBlock;
    if (++blocks == 128) break;
  }
  for (const uint32_t nodes : {depth - 1, depth}) {
    SCOPED_TRACE(testing::Message() << nodes << " nodes");
    const Case<TypeParam> test(soup(5, 60, 1, {0, 0, 0}), 20, 1, [nodes](LaneTree& tree) { make_chain(tree, nodes); });
    ASSERT_NO_FATAL_FAILURE(bench.trace_or_fault(test.what.tree, test.rays, {}));
    EXPECT_EQ(bench.seen.faults[to_underlying(TreeFaultCode::StackFull)], nodes == depth ? 1u : 0u);
  }
}

uint32_t number_from(const char* variable, uint32_t otherwise) {
  const char* const text = std::getenv(variable);
  return text == nullptr ? otherwise : static_cast<uint32_t>(std::strtoul(text, nullptr, 10));
}

// RAYPOOL_TREES trees from that of RAYPOOL_SEED on.
TYPED_TEST(TraverserTest, RandomTrees) {
  if (runs_case_of_file<TypeParam>()) return;
  const uint32_t first = number_from("RAYPOOL_SEED", 1), count = number_from("RAYPOOL_TREES", 30);
  uint64_t rays = 0, cycles = 0;
  for (uint32_t seed = first; seed < first + count; ++seed) {
    std::mt19937 random(seed);
    const auto of_bench = static_cast<uint32_t>(random());
    TraverserBench<TypeParam> bench(of_bench);
    const auto rare = [&](uint32_t most) { return random() % 2 == 0 ? 0 : 2 + static_cast<uint32_t>(random()) % most; };
    const TraverserTraffic traffic{rare(20), rare(9), 1 + rare(60), rare(9), rare(40), rare(20)};
    Case<TypeParam> test(small_scene(random), 1 + static_cast<int>(random() % 30), seed);
    test.what.seed = of_bench;
    test.what.traffic = traffic;
    run_case(bench, test.what);
    if (testing::Test::HasFailure()) minimise_and_report<TypeParam>(test.what, "*RandomTrees");
    ASSERT_FALSE(testing::Test::HasFailure())
        << "tree of seed " << seed << ": RAYPOOL_SEED=" << seed << " RAYPOOL_TREES=1 draws it alone";
    rays += bench.seen.rays;
    cycles += bench.seen.cycles;
    if (count > 1000 && (seed - first + 1) % 1000 == 0)
      std::fprintf(stderr, "%u trees, %llu rays, %llu cycles: 0 differences\n", seed - first + 1,
                   static_cast<unsigned long long>(rays), static_cast<unsigned long long>(cycles));
  }
  EXPECT_GT(rays, count);
  std::printf("%u trees, %llu rays, %llu cycles: 0 differences\n", count, static_cast<unsigned long long>(rays),
              static_cast<unsigned long long>(cycles));
}

// Two rays may have equal records. Garbage of seed 20096 had two that are alike, and the bench took one for the other.
TYPED_TEST(TraverserTest, RaysThatAreAlikeLeaveInAnyOrder) {
  TraverserBench<TypeParam> bench(5);
  for (uint32_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Case<TypeParam> test(soup(3, 20, 1, {0, 0, 0}), 6, seed);
    for (size_t i = 0; i < 18; ++i) {
      Ray ray = test.what.rays[i];
      ray[word::kColor] = static_cast<uint32_t>(test.what.rays.size());
      test.what.rays.push_back(ray);
    }
    test.rays = asked_of<TypeParam>(test.what);
    ASSERT_NO_FATAL_FAILURE(bench.trace(test.what.tree, test.rays, {0, 2, 20, 0, 3, 0}));
  }
  EXPECT_EQ(bench.seen.rays, 40u * 24);
  if (TypeParam::sizes().lanes > 1) {
    EXPECT_GT(bench.seen.exchanged, 0u);
  }
}

// A failing case is minimised: with a bit of a corner flipped for the Verilog alone, to one ray and one triangle.
TYPED_TEST(TraverserTest, FailingCasesAreMinimised) {
  Case<TypeParam> test(soup(3, 40, 1, {0, 0, 0}), 24, 3);
  test.what.traffic = {0, 2, 30, 3, 0, 0};
  const auto hits = [](const auto& asked) {
    const bool any = TypeParam::sizes().miss_records && returns_first(asked.ray);
    return asked.walk.hit.hit && !is_shadow(asked.ray) && !any;
  };
  const auto ray = std::find_if(test.rays.begin(), test.rays.end(), hits);
  ASSERT_NE(ray, test.rays.end());
  const uint32_t word = as_bits(test.what.tree.triangle(ray->walk.hit.place).corners[0][0]);
  ASSERT_FALSE(wrong_with<TypeParam>(test.what));
  ASSERT_TRUE(wrong_with<TypeParam>(test.what, word));
  TreeMinimiser minimiser(test.what,
                          [word](const TreeCase& cut) { return wrong_with<TypeParam>(cut, word).has_value(); });
  const TreeCase small = case_of(to_json<TypeParam>(minimiser.run()));
  EXPECT_TRUE(wrong_with<TypeParam>(small, word));
  EXPECT_FALSE(wrong_with<TypeParam>(small));
  EXPECT_EQ(size_of(small), "1 rays, 0 nodes, 1 triangles");
  const TraverserTraffic& traffic = small.traffic;
  EXPECT_EQ(traffic.leave_request + traffic.late_beat, 0u);
  EXPECT_EQ(traffic.line, 1u);
}

// As many malformed trees: flipped bits, ways that lead back or together, what lies beyond, any bytes; and memories
// that lose stacks.
TYPED_TEST(TraverserTest, RandomGarbage) {
  const uint32_t first = number_from("RAYPOOL_SEED", 1), count = number_from("RAYPOOL_TREES", 60);
  uint64_t rays = 0, cycles = 0, spoilt = 0;
  std::array<uint64_t, 7> faults{};
  for (uint32_t seed = first; seed < first + count; ++seed) {
    std::mt19937 random(seed);
    const auto of_bench = static_cast<uint32_t>(random());
    TraverserBench<TypeParam> bench(of_bench);
    const auto rare = [&](uint32_t most) { return random() % 2 == 0 ? 0 : 2 + static_cast<uint32_t>(random()) % most; };
    const TraverserTraffic traffic{rare(20), rare(9), 1 + rare(60), rare(9), rare(40), rare(20)};
    const auto stacks = static_cast<StackMemory>(random() % 8 < 6 ? 0 : 1 + random() % 2);
    const Scene scene = stacks == StackMemory::Keeps ? small_scene(random) : soup(seed, 150, 1, {0, 0, 0});
    Case<TypeParam> test(scene, 1 + static_cast<int>(random() % 30), seed, [&](LaneTree& tree) {
      if (stacks == StackMemory::Keeps) make_garbage(tree, random);
    });
    test.what.seed = of_bench;
    test.what.traffic = traffic;
    test.what.stacks = stacks;
    test.what.is_tree = false;
    run_case(bench, test.what);
    if (testing::Test::HasFailure()) minimise_and_report<TypeParam>(test.what, "*RandomTrees");
    ASSERT_FALSE(testing::Test::HasFailure())
        << "garbage of seed " << seed << ": RAYPOOL_SEED=" << seed << " RAYPOOL_TREES=1 draws it alone";
    rays += bench.seen.rays;
    cycles += bench.seen.cycles;
    spoilt += bench.seen.spoilt;
    for (size_t code = 0; code < faults.size(); ++code) faults[code] += bench.seen.faults[code];
    if (count > 1000 && (seed - first + 1) % 1000 == 0)
      std::fprintf(stderr, "%u pieces of garbage, %llu cycles: 0 differences\n", seed - first + 1,
                   static_cast<unsigned long long>(cycles));
  }
  const auto of = [&](TreeFaultCode code) { return static_cast<unsigned long long>(faults[to_underlying(code)]); };
  std::printf(
      "%u pieces of garbage, %llu rays done, %llu cycles: 0 differences; faults: %llu nodes and %llu triangles beyond "
      "the "
      "tree, %llu full stacks, %llu nodes of no number of children, %llu with a way back, %llu visits too many\n",
      count, static_cast<unsigned long long>(rays), static_cast<unsigned long long>(cycles),
      of(TreeFaultCode::NodeBeyond), of(TreeFaultCode::TriangleBeyond), of(TreeFaultCode::StackFull),
      of(TreeFaultCode::Children), of(TreeFaultCode::Order), of(TreeFaultCode::Visits));
  if (count < 60) return;
  EXPECT_GT(rays, 100u);
  for (const TreeFaultCode code : {TreeFaultCode::NodeBeyond, TreeFaultCode::TriangleBeyond, TreeFaultCode::Children,
                                   TreeFaultCode::Order, TreeFaultCode::Visits})
    EXPECT_GT(of(code), 0u) << int{to_underlying(code)};
  if (TypeParam::sizes().stack_entries < 16) {
    EXPECT_GT(spoilt, 0u);
  }
}

}  // namespace
}  // namespace raypool::bench
