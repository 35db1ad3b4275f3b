// Whatever the policy, the chip neither locks up nor loses a ray, and draws the same picture.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <optional>
#include <random>
#include <utility>

#include "chip/board.hpp"
#include "chip/test_frame_run.hpp"
#include "chip/test_real_frame.hpp"
#include "chip/tree_image.hpp"
#include "machine/chip/chip_model.hpp"
#include "machine/chip/kernel_policy.hpp"
#include "machine/compute/model.hpp"

namespace raypool {
namespace {

using test::FrameRun;

/// Does anything that is possible, kernels of any size or none, and keeps only to the contract of KernelPolicy.
class AnyPolicy : public KernelPolicy {
 public:
  AnyPolicy(const PolicySetup& setup, uint32_t seed) : setup_(setup), seed_(seed) {}

  Choice choose(const PolicyView& view) const override {
    std::mt19937 random(seed_ + 7 * view.rays + 1009 * view.normal + 10007 * view.shadow + 99991 * view.promised +
                        1000003 * view.rays_to_come + view.kernels);
    const std::array<Choice, 3> possible = {
        Choice{Choice::Kind::Secondary, std::min({setup_.contents, view.normal, view.secondary_room})},
        Choice{Choice::Kind::Shade, std::min(setup_.contents, view.shadow)},
        Choice{Choice::Kind::Eye, view.eye_possible ? 1u : 0u}};
    Choice choice = possible[random() % 3];
    if (choice.threads == 0 || random() % 4 == 0) choice = {};
    if (choice.threads > 0) choice.threads = 1 + static_cast<uint32_t>(random()) % choice.threads;
    const bool must = view.kernels == 0 && (!view.more_to_come || view.shadow >= setup_.intersection_capacity);
    for (size_t i = 0; i < 3 && must && choice.kind == Choice::Kind::Halt; ++i) {
      if (possible[i].threads > 0) choice = possible[i];
    }
    return choice;
  }

 private:
  PolicySetup setup_;
  uint32_t seed_;
};

/// Name of a policy, or of a random one.
struct Policy {
  const char* name;
  uint32_t seed = 0;
  PolicyName named = PolicyName::Thesis;
};

class EveryPolicy : public testing::TestWithParam<Policy> {
 protected:
  static std::unique_ptr<ChipDevice> chip_around(std::unique_ptr<ComputeUnit> device, ChipOptions& options) {
    const Policy policy = GetParam();
    options.configuration.chip.policy = policy.named;
    PolicyMaker own;
    if (policy.seed != 0)
      own = [seed = policy.seed](const PolicySetup& setup) { return std::make_unique<AnyPolicy>(setup, seed); };
    return make_chip_model(options.configuration, std::move(device), own);
  }
  static void expect_conserved(FrameRun& run) {
    const std::unique_ptr<ChipDevice> chip = chip_around(std::move(run.device), run.options);
    for (test::ScriptedUnit* unit : run.units) unit->set_world(run.world);
    test::WorldTracer tracer(run.world);
    run.options.tracer = &tracer;
    run.options.frame = &run.frame;
    run.expect_conserved(run_board(run.options, *chip));
  }
};

TEST_P(EveryPolicy, DrawsEveryImageWithoutLosingARay) {
  for (const auto& [warps, lanes] : {std::pair{1, 1}, {4, 4}, {8, 8}, {16, 16}, {32, 32}}) {
    for (const uint32_t units : {1, 2, 4}) {
      for (const auto& [width, height, depth] : {std::array{1, 1, 1}, {31, 17, 1}, {41, 33, 4}, {7, 3, 254}}) {
        SCOPED_TRACE(testing::Message() << warps << "w" << lanes << "c, " << units << " units, " << width << "x"
                                        << height << " depth " << depth);
        FrameRun run(warps, lanes, units, width, height, depth);
        expect_conserved(run);
      }
    }
  }
}

TEST_P(EveryPolicy, SurvivesFullPools) {
  // Nothing misses, everything is mirrored and lit: the most rays that can be alive.
  for (const auto& [warps, lanes] : {std::pair{2, 2}, {8, 8}, {8, 32}}) {
    for (const uint32_t units : {1, 4}) {
      for (const int packages : {512, 33, 16}) {
        for (const int rays : {512, 64, 5, 1}) {
          SCOPED_TRACE(testing::Message() << warps << "w" << lanes << "c, " << units << " units, " << packages
                                          << " intersections, " << rays << " rays");
          FrameRun run(warps, lanes, units, rays < 64 ? 11 : 31, rays < 64 ? 7 : 23, 6, 30);
          run.world.misses = run.world.blocked = 0;
          run.world.shadows = run.world.mirrors = 16;
          ChipConfiguration& around = run.options.configuration.chip;
          around.intersection_pool_size = around.held_limit = packages;
          around.ray_pool_size = rays;
          around.shading = rays == 64 || packages == 16 ? Shading::Traverser : Shading::Kernel;
          expect_conserved(run);
        }
      }
    }
  }
}

TEST_P(EveryPolicy, DrawsWithoutTheRemedyAndWithoutLaunchingAhead) {
  for (const bool remedy : {false, true}) {
    for (const bool ahead : {false, true}) {
      FrameRun run(8, 8, 2, 29, 23, 3);
      run.options.configuration.chip.window_remedy = remedy;
      run.options.configuration.chip.launch_ahead = ahead;
      expect_conserved(run);
    }
  }
}

Scene one_triangle() {
  Scene scene = make_cornell();
  scene.triangles.resize(1);
  scene.triangle_materials.resize(1);
  return scene;
}

Scene nothing_to_hit() {
  Scene scene = one_triangle();
  scene.camera.direction = {0, 1, 0};
  scene.camera.up = {1, 0, 0};
  scene.vertices.assign(scene.vertices.size(), Vec3{0, -1000, 0});
  scene.vertices[scene.triangles[0][1]] = {1, -1000, 0};
  scene.vertices[scene.triangles[0][2]] = {0, -1000, 1};
  return scene;
}

TEST_P(EveryPolicy, DrawsThePictureOfTheNativeRenderer) {
  const std::array<Scene, 3> scenes = {make_cornell(), one_triangle(), nothing_to_hit()};
  for (const Scene& scene : scenes) {
    for (const auto& [warps, lanes, units] : {std::array{8, 8, 1}, {4, 4, 4}, {16, 16, 2}}) {
      for (const auto& [width, height, depth] : {std::array{37, 29, 1}, {23, 17, 5}, {1, 1, 254}}) {
        SCOPED_TRACE(testing::Message() << scene.triangles.size() << " triangles, " << warps << "w" << lanes << "c, "
                                        << units << " units, " << width << "x" << height << " depth " << depth);
        test::RealFrame run(warps, lanes, width, height, depth, scene, false, units == 1 ? kIntersectionWords : 16);
        ChipConfiguration& chip = run.options.configuration.chip;
        chip.shading = width == 23 ? Shading::Traverser : Shading::Kernel;
        if (units != 2) chip.traverser = TraverserName::Hardware;
        if (units == 4) chip.tile_order = TileOrder::Hilbert;
        const Tracer tracer(run.scene, run.image.material_base, chip);
        std::optional<TreeImage> tree;
        if (has_traverser(chip)) {
          tree = make_tree_image(run.scene, tracer.traversal().bvh(), chip, run.image.material_base);
          run.options.tree = &*tree;
        }
        const auto model =
            chip_around(make_model(run.options.configuration, run.image.memory, units).device, run.options);
        NativeOptions native;
        native.width = width;
        native.height = height;
        native.depth = depth;
        const FrameBuffer expected = render_native(run.scene, run.image, tracer, native);
        EXPECT_GT(run_board(run.options, *model).cycles, 0u);
        EXPECT_TRUE(run.frame == expected);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Chip, EveryPolicy,
                         testing::Values(Policy{"thesis"}, Policy{"fill", 0, PolicyName::Fill}, Policy{"any1", 1},
                                         Policy{"any2", 2}, Policy{"any3", 3}),
                         [](const testing::TestParamInfo<Policy>& policy) { return policy.param.name; });

TEST(FillPolicy, IsFasterWithOneUnitAndWithFour) {
  const auto cycles = [](PolicyName policy, uint32_t units) {
    test::RealFrame run(8, 8, 96, 64, 1);
    const Configuration& configuration = run.options.configuration;
    run.options.configuration.chip.policy = policy;
    const auto chip = make_chip_model(configuration, make_model(configuration, run.image.memory, units).device);
    return run_board(run.options, *chip).cycles;
  };
  EXPECT_LT(cycles(PolicyName::Fill, 1) * 5, cycles(PolicyName::Thesis, 1) * 4);
  EXPECT_LT(cycles(PolicyName::Fill, 4), cycles(PolicyName::Thesis, 4));
}

}  // namespace
}  // namespace raypool
