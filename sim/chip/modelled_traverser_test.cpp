#include "chip/modelled_traverser.hpp"

#include <gtest/gtest.h>

#include <map>

#include "chip/chip_module.hpp"
#include "chip/fixed_latency_memory.hpp"
#include "chip/simulation.hpp"
#include "chip/test_frame_run.hpp"
#include "chip/test_metronome.hpp"
#include "chip/test_real_frame.hpp"
#include "machine/cycle_unit.hpp"
#include "machine/multiprocessor.hpp"

namespace raypool::chip {
namespace {

std::unique_ptr<ComputeUnit> device_of(test::RealFrame& run, uint32_t units) {
  std::vector<std::unique_ptr<ComputeUnit>> made;
  for (uint32_t i = 0; i < units; ++i)
    made.push_back(std::make_unique<CycleUnit>(run.options.configuration, run.image.memory));
  return make_multiprocessor(std::move(made));
}

/// Notes what each ray came to.
class NotingTracer : public RayTracer {
 public:
  explicit NotingTracer(RayTracer& tracer) : tracer_(tracer) {}
  bool trace(const Ray& ray, Intersection& intersection) override {
    return note(ray, intersection, tracer_.trace(ray, intersection));
  }
  bool follow(const Ray& ray, Intersection& intersection, VisitList& visits) override {
    const bool goes_on = tracer_.follow(ray, intersection, visits);
    for (const Visit& visit : visits) {
      nodes += visit.triangles == 0;
      triangles += visit.triangles;
    }
    ended_at_blockers += !goes_on && (ray[word::kFlags] & kShadowFlag) != 0 && visits.back().triangles > 0;
    return note(ray, intersection, goes_on);
  }
  bool reflects(const Intersection& hit) const override { return tracer_.reflects(hit); }
  std::map<Ray, std::pair<bool, Intersection>> noted;
  uint64_t nodes = 0, triangles = 0, ended_at_blockers = 0;

 private:
  bool note(const Ray& ray, const Intersection& intersection, bool goes_on) {
    noted[ray] = {goes_on, goes_on ? intersection : Intersection{}};
    return goes_on;
  }
  RayTracer& tracer_;
};

struct Drawn {
  Drawn(const Scene& scene, TraverserName traverser, uint32_t units, uint32_t depth,
        const std::function<void(ChipConfiguration&)>& change = {}, bool stepped = false)
      : run(4, 4, 31, 17, depth, scene), walked(scene, run.image.material_base, configure(traverser, change)) {
    run.options.tracer = &tracer;
    run.set_device(device_of(run, units));
    Simulation simulation;
    Chip chip("chip", run.options);
    FixedLatencyMemory memory("memory", run.image.memory, run.options.configuration.chip.memory_latency);
    chip.memory.bind(memory.socket);
    std::unique_ptr<test::Metronome> metronome;
    if (stepped) metronome = std::make_unique<test::Metronome>("metronome");
    result = chip.draw();
  }
  const ChipConfiguration& configure(TraverserName traverser, const std::function<void(ChipConfiguration&)>& change) {
    ChipConfiguration& chip = run.options.configuration.chip;
    chip.traverser = traverser;
    if (change) change(chip);
    return chip;
  }
  test::RealFrame run;
  const Tracer walked;
  SceneTracer scene_tracer{walked};
  NotingTracer tracer{scene_tracer};
  ChipResult result;
};

TEST(ModelledTraverser, EveryHitAndThePictureAreThoseOfTheStaticOneWhateverTheNodes) {
  for (const Scene& scene : {make_cornell(0.3), make_room(0.02)}) {
    for (const uint32_t units : {1, 4}) {
      const Drawn fixed(scene, TraverserName::Static, units, 3);
      EXPECT_GT(fixed.tracer.noted.size(), 1000u);
      std::map<NodeFormat, TraverserWork> work;
      const Drawn lanes(scene, TraverserName::Lanes, units, 3);
      EXPECT_TRUE(fixed.run.frame == lanes.run.frame);
      EXPECT_EQ(fixed.tracer.noted, lanes.tracer.noted);
      for (const NodeFormat nodes : {NodeFormat::Compressed, NodeFormat::Exact}) {
        const Drawn modelled(scene, TraverserName::Modelled, units, 3,
                             [&](ChipConfiguration& chip) { chip.modelled_traverser_nodes = nodes; });
        EXPECT_TRUE(fixed.run.frame == modelled.run.frame);
        EXPECT_EQ(fixed.tracer.noted, modelled.tracer.noted);
        EXPECT_NE(fixed.result.cycles, modelled.result.cycles);
        work[nodes] = *modelled.result.traversal;
      }
      EXPECT_LT(work[NodeFormat::Exact].boxes.tests, work[NodeFormat::Compressed].boxes.tests);
      EXPECT_GT(work[NodeFormat::Exact].bytes(), work[NodeFormat::Compressed].bytes());
    }
  }
}

TEST(ModelledTraverser, EveryHitAndThePictureAreThoseOfTheStaticOneWithBoxesInIntegers) {
  for (const Scene& scene : {make_cornell(0.3), make_room(0.02)}) {
    const Drawn fixed(scene, TraverserName::Static, 1, 3);
    uint64_t tests = 0;
    for (const uint32_t bits : {0, 16, 8, 6}) {
      const Drawn modelled(scene, TraverserName::Modelled, 1, 3,
                           [&](ChipConfiguration& chip) { chip.modelled_traverser_box_bits = bits; });
      EXPECT_TRUE(fixed.run.frame == modelled.run.frame) << bits;
      EXPECT_EQ(fixed.tracer.noted, modelled.tracer.noted) << bits;
      EXPECT_EQ(modelled.result.traversal->boxes.tests, modelled.tracer.nodes);
      EXPECT_GT(modelled.tracer.nodes, tests) << bits;
      tests = modelled.tracer.nodes;
    }
  }
}

TEST(ModelledTraverser, MakesTheTestsOfTheRaysAndEndsBlockedOnesEarly) {
  const Drawn drawn(make_cornell(0.3), TraverserName::Modelled, 2, 4);
  ASSERT_TRUE(drawn.result.traversal);
  const TraverserWork& work = *drawn.result.traversal;
  EXPECT_EQ(work.rays, drawn.result.rays());
  EXPECT_EQ(work.boxes.tests, drawn.tracer.nodes);
  EXPECT_EQ(work.triangles.tests, drawn.tracer.triangles);
  EXPECT_EQ(drawn.tracer.ended_at_blockers, drawn.result.ray_counts.blocked());
  EXPECT_GT(drawn.tracer.ended_at_blockers, 0u);
}

void expect_the_same_stepped(uint32_t units, uint32_t pool, Shading shading,
                             TraverserName traverser = TraverserName::Modelled) {
  const auto change = [&](ChipConfiguration& chip) {
    chip.intersection_pool_size = chip.held_limit = pool;
    chip.memory_cycles_per_beat = 9;  // the memory port is fought for
    chip.modelled_traverser_node_cache_bytes = chip.modelled_traverser_triangle_cache_bytes = 1024;
    chip.shading = shading;
  };
  const Drawn ahead(make_room(0.02), traverser, units, 3, change),
      stepped(make_room(0.02), traverser, units, 3, change, true);
  EXPECT_EQ(ahead.result.cycles, stepped.result.cycles);
  EXPECT_EQ(ahead.result.instructions, stepped.result.instructions);
  EXPECT_EQ(ahead.result.memory_port_utilisation, stepped.result.memory_port_utilisation);
  EXPECT_EQ(ahead.result.rays_pool.mean, stepped.result.rays_pool.mean);
  EXPECT_EQ(ahead.result.shadow_pool.mean, stepped.result.shadow_pool.mean);
  EXPECT_EQ(ahead.result.traversal->ray_cycles, stepped.result.traversal->ray_cycles);
  EXPECT_EQ(ahead.result.traversal->row_hits, stepped.result.traversal->row_hits);
  EXPECT_EQ(ahead.result.traversal->node_cache.hits, stepped.result.traversal->node_cache.hits);
}

TEST(ModelledTraverser, TheDeviceRunsAheadWithoutChangingACycle) {
  expect_the_same_stepped(1, 512, Shading::Kernel);
  expect_the_same_stepped(4, 31, Shading::Kernel);  // rays are held back
  expect_the_same_stepped(4, 512, Shading::Traverser);
  expect_the_same_stepped(1, 512, Shading::Kernel, TraverserName::Lanes);
  expect_the_same_stepped(4, 31, Shading::Kernel, TraverserName::Lanes);
}

// The units' instructions come through the port that the traverser keeps busy.
TEST(ModelledTraverser, SharesTheMemoryPortWithTheUnits) {
  const auto cycles = [](uint32_t per_beat, TraverserName traverser) {
    const Drawn drawn(make_room(0.02), traverser, 1, 2, [&](ChipConfiguration& chip) {
      chip.memory_cycles_per_beat = per_beat;
      chip.modelled_traverser_node_cache_bytes = chip.modelled_traverser_triangle_cache_bytes = 1024;
    });
    if (traverser == TraverserName::Modelled) {
      const auto beats = drawn.result.traversal->memory_lines * 4 + drawn.result.traversal->memory_quadwords;
      const auto device = drawn.result.memory_reads * 4 + drawn.result.memory_writes;
      EXPECT_DOUBLE_EQ(drawn.result.memory_port_utilisation,
                       static_cast<double>((beats + device) * per_beat) / static_cast<double>(drawn.result.cycles));
    }
    return static_cast<double>(drawn.result.cycles);
  };
  EXPECT_GT(cycles(20, TraverserName::Modelled), 3 * cycles(2, TraverserName::Modelled));
  EXPECT_LT(cycles(20, TraverserName::Static), 1.5 * cycles(2, TraverserName::Static));
}

TEST(ModelledTraverser, BehindTilesThatAreLeftOutItRemembersWhatTheyVisited) {
  test::RealFrame run(4, 4, 64, 64, 2);
  run.options.configuration.chip.traverser = TraverserName::Modelled;
  run.set_device(device_of(run, 1));
  run.options.tiles = {0, 1, 40, 41, 42, 200};
  const auto lines_read = [&] {
    TileCosts costs;
    run.options.tile_costs = &costs;
    const uint64_t lines = run_chip(run.options).traversal->memory_lines;
    run.options.tile_costs = nullptr;
    return lines;
  };
  const uint64_t cold = lines_read();
  std::vector<uint32_t> asked;
  run.options.visited_before = [&](uint32_t tile) {
    asked.push_back(tile);
    return VisitList{};
  };
  EXPECT_EQ(lines_read(), cold);
  EXPECT_EQ(asked, (std::vector<uint32_t>{40, 200}));

  WideVisits visits(run.tracer.traversal().wide_bvh());
  visits.begin();
  NotingTracer noting(run.scene_tracer);
  run.options.tracer = &noting;
  run_chip(run.options);
  for (const auto& [ray, answer] : noting.noted) {
    Intersection hit;
    run.tracer.trace(ray, hit, visits);
  }
  VisitList places;
  run.tracer.traversal().places_of(visits, 0, places);
  run.options.visited_before = [&](uint32_t) { return places; };
  EXPECT_LT(static_cast<double>(lines_read()), 0.5 * static_cast<double>(cold));
  run.options.tiles.front() = 5;
  run.options.tiles[1] = 6;
  run.options.visited_before = [&](uint32_t tile) { return asked.push_back(tile), VisitList{}; };
  asked.clear();
  lines_read();
  EXPECT_EQ(asked, (std::vector<uint32_t>{5, 40, 200})) << "a run that begins elsewhere begins behind a gap too";
}

TEST(ModelledTraverser, DrawsAnEmptySceneAndASingleTriangle) {
  Scene empty = make_cornell(0.1);
  empty.triangles.clear();
  empty.triangle_materials.clear();
  const Drawn nothing(empty, TraverserName::Modelled, 1, 2);
  EXPECT_EQ(nothing.result.traversal->boxes.tests, 0u);
  EXPECT_EQ(nothing.result.ray_counts.missed(), 31 * 17u);

  Scene one = make_cornell(0.1);
  one.triangles.resize(1);
  one.triangle_materials.resize(1);
  const Drawn fixed(one, TraverserName::Static, 1, 2), modelled(one, TraverserName::Modelled, 1, 2);
  EXPECT_TRUE(fixed.run.frame == modelled.run.frame);
  EXPECT_EQ(modelled.result.traversal->boxes.tests, modelled.result.rays());
}

struct Scarce {
  uint32_t units, rays, packages, in_flight;
};

void expect_an_end(const Scarce& scarce, PolicyName policy, Shading shading,
                   TraverserName traverser = TraverserName::Modelled) {
  SCOPED_TRACE(testing::Message() << scarce.units << " units, " << scarce.rays << " rays, " << scarce.packages
                                  << " intersections, " << scarce.in_flight << " in flight, policy "
                                  << static_cast<int>(policy) << ", shading " << static_cast<int>(shading));
  test::FrameRun run(8, 16, scarce.units, 16, 7, 6, 30);
  run.world.misses = run.world.blocked = 0;
  run.world.shadows = run.world.mirrors = 16;
  ChipConfiguration& chip = run.options.configuration.chip;
  chip.policy = policy;
  chip.shading = shading;
  chip.traverser = traverser;
  chip.modelled_traverser_rays = scarce.in_flight;
  chip.modelled_traverser_node_cache_mshrs = chip.modelled_traverser_triangle_cache_mshrs = 1;
  chip.intersection_pool_size = chip.held_limit = scarce.packages;
  chip.ray_pool_size = scarce.rays;
  const ChipResult result = run.go();
  run.expect_conserved(result);
  EXPECT_GT(result.traversal->boxes.tests, result.rays());
}

// Every ray of the scripted world arrives: chip.md, section 4.
TEST(ModelledTraverser, NeverLocksUpWhateverIsScarce) {
  for (const uint32_t units : {1, 4}) {
    for (const uint32_t rays : {512, 5, 1}) {
      for (const uint32_t packages : {16, 40}) {
        for (const uint32_t in_flight : {128, 3, 1}) {
          for (const PolicyName policy : {PolicyName::Thesis, PolicyName::Fill})
            expect_an_end({units, rays, packages, in_flight}, policy, Shading::Kernel);
          expect_an_end({units, rays, packages, in_flight}, PolicyName::Fill, Shading::Traverser);
          expect_an_end({units, rays, packages, in_flight}, PolicyName::Fill, Shading::Traverser, TraverserName::Lanes);
        }
      }
    }
  }
}

}  // namespace
}  // namespace raypool::chip
