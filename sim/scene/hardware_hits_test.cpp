// What a hit is where chip.traverser is hardware: what the set-up of a ray, the triangle pipe and the finish of a ray
// make of it (cpp_model/machine/), of all triangles in turn, without the tree and without the engines' arithmetic.
#include <gtest/gtest.h>

#include <algorithm>

#include "bits.hpp"
#include "machine/traverser/ray_finish.hpp"
#include "machine/traverser/ray_setup.hpp"
#include "scene/hard_rays.hpp"
#include "scene/intersection_bench.hpp"
#include "scene/traversal.hpp"
#include "scene/tree_file.hpp"

namespace raypool {
namespace {

constexpr uint32_t kBase = 0x4000;

ChipConfiguration with(TraverserName traverser) {
  ChipConfiguration chip;
  chip.traverser = traverser;
  return chip;
}

/// The traverser's memory, with a malformed tree.
class Machine {
 public:
  explicit Machine(const Scene& scene) : tree_(make_tree_file(scene)) {
    std::copy_n(tree_.header.lower, 3, root_.lower);
    std::copy_n(tree_.header.upper, 3, root_.upper);
  }

  /// As Tracer::trace().
  bool trace(const Ray& ray, Intersection& intersection) const {
    Tracer::pass_on(ray, intersection);
    const bool shadow = (ray[word::kFlags] & kShadowFlag) != 0;
    RayWords words{};
    for (int axis = 0; axis < 3; ++axis) {
      words.origin[axis] = as_float(ray[word::kOrigin + axis]);
      words.direction[axis] = as_float(ray[word::kDirection + axis]);
    }
    words.limit = as_float(ray[word::kLimit]);
    const RaySetup setup(words, root_, 12);
    const TreeTriangle* best = nullptr;
    float best_t = INFINITY;
    for (const TreeTriangle& each : tree_.triangles) {
      float t = 0;
      if (!setup.valid || !meets_triangle(narrow_, setup.triangle, triangle_of(each), t)) continue;
      if (!triangle::within_limit(t, std::ldexp(1.0, setup.scale), setup.limit)) continue;
      if (best != nullptr && !triangle::is_nearer(t, each.number, best_t, best->number)) continue;
      best = &each;
      best_t = t;
    }
    if (shadow) return best == nullptr;
    if (best == nullptr) return false;
    const RayFinish finish(setup.triangle, triangle_of(*best), best_t, setup.scale);
    intersection[word::kDistance] = as_bits(finish.t);
    intersection[word::kBarycentric] = as_bits(finish.u);
    intersection[word::kBarycentric + 1] = as_bits(finish.v);
    for (int axis = 0; axis < 3; ++axis) intersection[word::kNormal + axis] = as_bits(finish.normal[axis]);
    intersection[word::kMaterial] = kBase + kMaterialBytes * best->material;
    intersection[word::kTriangle] = best->number;
    return true;
  }

 private:
  static Triangle triangle_of(const TreeTriangle& each) {
    Triangle triangle{{}, each.number};
    std::copy_n(&each.corners[0][0], 9, &triangle.corners[0][0]);
    return triangle;
  }

  TreeFile tree_;
  RootBox root_{};
  NarrowFloat narrow_{32};
};

Ray to_ray(const RayQuery& query, bool shadow) {
  Ray ray{};
  for (int axis = 0; axis < 3; ++axis) {
    ray[word::kOrigin + axis] = as_bits(query.origin[axis]);
    ray[word::kDirection + axis] = as_bits(query.direction[axis]);
  }
  ray[word::kLimit] = as_bits(query.limit);
  ray[word::kFlags] = shadow ? kShadowFlag : 1;
  return ray;
}

struct Compared {
  int rays = 0, going_on = 0, other = 0;  ///< other: the engines' hit has other bits
};

void compare(const Ray& ray, const Machine& machine, const Tracer& hardware, const Tracer& engine, Compared& compared) {
  Intersection expected{}, found{}, of_engine{};
  const bool goes_on = machine.trace(ray, expected);
  ASSERT_EQ(hardware.trace(ray, found), goes_on);
  TraversalCounts counts;
  ASSERT_EQ(hardware.trace(ray, of_engine, &counts), goes_on) << "whatever is asked for";
  if (goes_on) {
    ASSERT_EQ(found, expected);
    ASSERT_EQ(of_engine, expected);
    compared.other += !engine.trace(ray, of_engine) || of_engine != expected;
  }
  ++compared.rays;
  compared.going_on += goes_on;
}

TEST(HardwareHits, AreWhatTheMachineMakesOfAFramesRays) {
  for (const Scene& scene : {make_cornell(), make_room(0.1)}) {
    SCOPED_TRACE(scene.name);
    const Machine machine(scene);
    const Tracer engine(scene, kBase), hardware(scene, kBase, with(TraverserName::Hardware));
    Compared compared;
    for (const BenchRays& kind : rays_of_frame(scene, hardware, 24, 18, 3)) {
      for (const RayQuery& query : kind.rays)
        ASSERT_NO_FATAL_FAILURE(compare(to_ray(query, kind.any), machine, hardware, engine, compared));
    }
    EXPECT_GT(compared.rays, 1000);
    EXPECT_GT(compared.going_on, 500);
    EXPECT_GT(compared.other, 100) << "the definitions have become the same";
  }
}

TEST(HardwareHits, AreWhatTheMachineMakesOfHardRays) {
  const Scene scene = make_cornell();
  const Machine machine(scene);
  const Tracer engine(scene, kBase), hardware(scene, kBase, with(TraverserName::Hardware));
  Compared compared;
  for (const RayQuery& query : hard_rays(scene, 3000, 5)) {
    for (const bool shadow : {false, true})
      ASSERT_NO_FATAL_FAILURE(compare(to_ray(query, shadow), machine, hardware, engine, compared));
  }
  EXPECT_GT(compared.going_on, 1000);
}

TEST(HardwareHits, OfTheStaticTraverserAreTheEngines) {
  const Scene scene = make_cornell();
  const Tracer engine(scene, kBase), tracer(scene, kBase, with(TraverserName::Static));
  for (const BenchRays& kind : rays_of_frame(scene, engine, 24, 18, 3)) {
    for (const RayQuery& query : kind.rays) {
      const Ray ray = to_ray(query, kind.any);
      Intersection expected{}, found{};
      ASSERT_EQ(tracer.trace(ray, found), engine.trace(ray, expected));
      ASSERT_EQ(found, expected);
    }
  }
}

}  // namespace
}  // namespace raypool
