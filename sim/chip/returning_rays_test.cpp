// Rays that return (chip.miss_records): kernels that cast some get a package of each of them, on every engine.
#include <gtest/gtest.h>

#include <array>
#include <optional>

#include "chip/test_real_frame.hpp"
#include "chip/test_returning_kernels.hpp"
#include "chip/tree_image.hpp"
#include "machine/compute/functional_unit.hpp"
#include "machine/compute/model.hpp"
#include "scene/native_renderer.hpp"

namespace raypool {
namespace {

constexpr uint32_t kWidth = 32, kHeight = 24, kDepth = 2;

Configuration machine(TraverserName traverser, bool miss_records = true) {
  Configuration configuration;
  configuration.warps = configuration.lanes = 4;
  configuration.chip.traverser = traverser;
  configuration.chip.miss_records = miss_records;
  return configuration;
}

struct Drawn {
  FrameBuffer frame{kWidth, kHeight};
  RayCounts rays;
};

/// Packages of each kind that came back to kernels, of [any hit would do][met].
using Returned = std::array<std::array<uint32_t, 2>, 2>;

Drawn draw_natively(const Configuration& configuration, Returned& returned) {
  test::RealFrame run(configuration, test::returning_kernels(KernelTarget(configuration)), kWidth, kHeight, kDepth,
                      make_cornell());
  NativeOptions native;
  native.width = kWidth;
  native.height = kHeight;
  native.depth = kDepth;
  native.contents = configuration.contents();
  native.kernel = [&](RayKernel kernel, NativeThread& thread) {
    const uint32_t flags = thread.input[word::kFlags];
    if (kernel == RayKernel::CastSecondary && (flags & kReturnsFlag) != 0)
      ++returned[(flags & kFirstFlag) != 0 ? 1 : 0][(flags & kMetFlag) != 0 ? 1 : 0];
    test::returning_kernels(KernelTarget(configuration)).native(kernel, thread);
  };
  NativeStatistics statistics;
  Drawn drawn;
  drawn.frame = render_native(run.scene, run.image, run.tracer, native, &statistics);
  drawn.rays = statistics.ray_counts;
  return drawn;
}

Drawn draw_on_chip(const Configuration& configuration, bool functional) {
  test::RealFrame run(configuration, test::returning_kernels(KernelTarget(configuration)), kWidth, kHeight, kDepth,
                      make_cornell());
  std::optional<TreeImage> tree;
  if (has_traverser(configuration.chip)) {
    tree.emplace(make_tree_image(run.scene, run.tracer.traversal().bvh(), configuration.chip, run.image.material_base));
    run.options.tree = &*tree;
  }
  Drawn drawn;
  drawn.rays = run.draw(functional ? make_functional_unit(configuration, run.image.memory)
                                   : make_model(configuration, run.image.memory, 1).device)
                   .ray_counts;
  drawn.frame = run.frame;
  return drawn;
}

void expect_same(const Drawn& drawn, const Drawn& expected) {
  EXPECT_TRUE(drawn.frame == expected.frame);
  for (const auto kind : {&RayCounts::eye, &RayCounts::reflection, &RayCounts::shadow}) {
    EXPECT_EQ((drawn.rays.*kind).traced, (expected.rays.*kind).traced);
    EXPECT_EQ((drawn.rays.*kind).ended, (expected.rays.*kind).ended);
  }
}

TEST(ReturningRays, ComeBackOnceEachWhateverTheyMeet) {
  Returned returned{};
  const Drawn native = draw_natively(machine(TraverserName::Static), returned);
  for (const auto& of_kind : returned)
    for (const uint32_t count : of_kind) EXPECT_GT(count, 20u);
  EXPECT_EQ(native.rays.reflection.ended, 0u);
  EXPECT_EQ(native.rays.reflection.traced, native.rays.eye.traced - native.rays.eye.ended);
  EXPECT_EQ(native.rays.shadow.traced, native.rays.reflection.traced);
  EXPECT_EQ(native.rays.shadow.ended, 0u);
}

TEST(ReturningRays, DrawTheSamePictureOnEveryEngine) {
  Returned returned{};
  const Configuration at_ports = machine(TraverserName::Static), inside = machine(TraverserName::Hardware);
  const Drawn native = draw_natively(at_ports, returned);
  expect_same(draw_on_chip(at_ports, true), native);
  expect_same(draw_on_chip(at_ports, false), native);
  expect_same(draw_on_chip(inside, false), draw_natively(inside, returned));
}

TEST(ReturningRays, AreRaysLikeOthersWithoutMissRecords) {
  Returned returned{}, with{};
  const Drawn native = draw_natively(machine(TraverserName::Static, false), returned);
  EXPECT_EQ(native.rays.reflection.ended,
            draw_natively(machine(TraverserName::Static), with).rays.reflection.traced - native.rays.shadow.traced);
  EXPECT_EQ(native.rays.reflection.ended, with[0][0] + with[1][0]);
  expect_same(draw_on_chip(machine(TraverserName::Static, false), true), native);
}

// So engines that know these alone, estimate, sampled and double precision, need not know rays that return.
TEST(ReturningRays, AreNeverCastByTheBuiltInKernels) {
  const Configuration configuration = machine(TraverserName::Static);
  test::RealFrame run(configuration, kWidth, kHeight, 5, make_cornell());
  NativeOptions native;
  native.width = kWidth;
  native.height = kHeight;
  native.depth = 5;
  uint64_t rays = 0;
  native.kernel = [&](RayKernel kernel, NativeThread& thread) {
    run_native(kernel, thread);
    for (const Ray& ray : thread.rays) EXPECT_EQ(ray[word::kFlags] & ~(kShadowFlag | kDepthMask), 0u);
    rays += thread.rays.size();
  };
  render_native(run.scene, run.image, run.tracer, native);
  EXPECT_GT(rays, 1000u);
}

}  // namespace
}  // namespace raypool
