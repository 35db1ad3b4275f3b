// A chip that works for long without a transfer is not locked up; one in which nothing happens is, and reports what
// waits.
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "chip/board.hpp"
#include "chip/progress_watch.hpp"
#include "chip/test_real_frame.hpp"
#include "chip/tree_image.hpp"
#include "machine/chip/chip_model.hpp"
#include "machine/chip/kernel_policy.hpp"
#include "machine/compute/model.hpp"

namespace raypool {
namespace {

using chip::ProgressWatch;
using State = ProgressWatch::State;

// ---- What is asked now and then

TEST(ProgressWatch, GoesOnWhileSomethingIsDoneOrDue) {
  ProgressWatch watch(100, 0);
  EXPECT_EQ(watch.look(100, {5, 7, kNever}), State::GoesOn);
  EXPECT_EQ(watch.look(200, {5, 8, kNever}), State::GoesOn) << "something was transferred or tested";
  EXPECT_EQ(watch.look(300, {6, 8, kNever}), State::GoesOn) << "an instruction has ended";
  EXPECT_EQ(watch.look(400, {6, 8, 100'000}), State::GoesOn) << "an answer is due";
  EXPECT_EQ(watch.look(500, {6, 8, 500}), State::LockedUp) << "what was due has not helped";
  EXPECT_EQ(watch.look(600, {6, 8, kNever}), State::LockedUp);
  EXPECT_EQ(watch.look(700, {6, 8, chip::kFarAway}), State::LockedUp) << "that never comes";
}

TEST(ProgressWatch, IsSilentAfterItsLimitAndNeverWithoutOne) {
  ProgressWatch limited(100, 300), patient(100, 0);
  EXPECT_EQ(limited.look(100, {1, 1, kNever}), State::GoesOn);
  EXPECT_EQ(limited.look(200, {2, 1, kNever}), State::GoesOn);
  EXPECT_EQ(limited.look(300, {3, 1, kNever}), State::GoesOn);
  EXPECT_EQ(limited.look(400, {4, 1, kNever}), State::Silent);
  EXPECT_EQ(limited.silent().find("for 300 cycles instructions have ended"), 0u) << limited.silent();
  for (uint64_t i = 1; i < 1000; ++i) EXPECT_EQ(patient.look(100 * i, {i, 1, kNever}), State::GoesOn);
}

TEST(RunLimits, TakeASilentProgramForEndlessOnlyWithoutALimit) {
  EXPECT_EQ((RunLimits{0, {}}).silent(), 10'000'000u);
  EXPECT_EQ((RunLimits{100'000'000, {}}).silent(), 0u);
  EXPECT_EQ((RunLimits{100'000'000, 500}).silent(), 500u);
}

// ---- Whole chips. Periods are short, so that frames may be small.

constexpr uint64_t kPeriod = 2000;

// Triangles one behind the other, which every ray that meets one has to test.
Scene pile(uint32_t count) {
  Scene scene;
  scene.name = "pile";
  scene.materials = {{"grey", {0.5f, 0.5f, 0.5f}, {}}};
  for (uint32_t i = 0; i < count; ++i) {
    const float shift = 1e-5f * static_cast<float>(i % 7);
    for (const Vec3 corner : {Vec3{-20 + shift, -20, -5}, Vec3{20, -20 + shift, -5}, Vec3{0, 40, -5}})
      scene.vertices.push_back(corner);
    scene.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    scene.triangle_materials.push_back(0);
  }
  scene.light.position = {1, 1, 1};
  return scene;
}

// One ray at a time, and room for all of a small scene in the caches.
void one_ray(ChipConfiguration& chip) {
  chip.hardware_traverser_rays = chip.hardware_traverser_lanes = chip.hardware_traverser_triangle_pipes = 1;
  chip.hardware_traverser_node_cache_bytes = chip.hardware_traverser_triangle_cache_bytes = 1 << 18;
}
void slow_memory(ChipConfiguration& chip) {
  one_ray(chip);
  chip.hardware_traverser_cache_banks = 1;
  chip.hardware_traverser_node_cache_bytes = chip.hardware_traverser_triangle_cache_bytes = 512;
  chip.memory_latency = 10'000;
}
void long_stalls(ChipConfiguration& chip) {
  chip.static_traverser_batch = 1;
  chip.static_traverser_stall_cycles = 50 * kPeriod + 1;
}

struct DrawnFrame {
  DrawnFrame(Scene scene, TraverserName traverser, void (*change)(ChipConfiguration&), uint32_t size = 2)
      : run(4, 4, size, size, 1, std::move(scene)) {
    ChipConfiguration& chip = run.options.configuration.chip;
    chip.traverser = traverser;
    change(chip);
    run.options.watchdog_cycles = kPeriod;
  }

  FrameBuffer native() const {
    NativeOptions options;
    options.width = run.options.width;
    options.height = run.options.height;
    options.depth = 1;
    return render_native(run.scene, run.image, run.tracer, options);
  }
  void draw(const std::function<std::unique_ptr<ChipDevice>(std::unique_ptr<ChipDevice>)>& wrap = {},
            const PolicyMaker& policy = {}) {
    Configuration& configuration = run.options.configuration;
    if (has_traverser(configuration.chip)) {
      tree.emplace(
          make_tree_image(run.scene, run.tracer.traversal().bvh(), configuration.chip, run.image.material_base));
      run.options.tree = &*tree;
    }
    auto device = make_chip_model(configuration, make_model(configuration, run.image.memory, 1).device, policy);
    if (wrap) device = wrap(std::move(device));
    run_board(run.options, *device);
  }

  test::RealFrame run;
  std::optional<TreeImage> tree;
};

std::string error_of(const std::function<void()>& draw) {
  try {
    draw();
  } catch (const ChipStalled& stalled) {
    return stalled.what();
  }
  return "";
}

void expect_parts(const std::string& text, std::initializer_list<const char*> parts) {
  for (const char* part : parts) EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
}

// Hides what the caches in the chip give.
struct PortsAlone : ChipDevice {
  explicit PortsAlone(std::unique_ptr<ChipDevice> inner) : chip(std::move(inner)) {}
  uint32_t units() const override { return chip->units(); }
  void start(const FrameSetup& setup) override {
    chip->start(setup);
    look();
  }
  void start_next(const FrameSetup& setup) override {
    chip->start_next(setup);
    look();
  }
  const ChipOutputs& outputs() const override { return out; }
  void clock(const ChipInputs& inputs) override {
    chip->clock(inputs);
    look();
  }
  ChipCounts counts() override { return chip->counts(); }
  uint64_t counter(int number) override { return chip->counter(number); }
  virtual void look() {
    out = chip->outputs();
    out.nodes_given = out.leaves_given = given;
  }

  std::unique_ptr<ChipDevice> chip;
  ChipOutputs out;
  uint32_t given = 0;
};

TEST(Progress, ARayThatTestsForLongIsNoLockUp) {
  const auto draw = [](std::optional<uint32_t> given) {
    DrawnFrame frame(pile(2000), TraverserName::Hardware, one_ray);
    std::string error = error_of([&] {
      frame.draw([&](std::unique_ptr<ChipDevice> chip) -> std::unique_ptr<ChipDevice> {
        if (!given) return chip;
        auto hiding = std::make_unique<PortsAlone>(std::move(chip));
        hiding->given = *given;
        return hiding;
      });
    });
    EXPECT_EQ(error.empty(), frame.run.frame == frame.native());
    return error;
  };
  EXPECT_EQ(draw({}), "");
  EXPECT_EQ(draw(ChipOutputs::kNotSeen), "") << "as of a netlist, of which only ports can be seen";
  EXPECT_NE(draw(0), "") << "the frame is too small: its rays have passed ports all the time";
}

TEST(Progress, AWaitForTheMemoryIsNoLockUp) {
  for (const TraverserName traverser : {TraverserName::Static, TraverserName::Hardware}) {
    DrawnFrame frame(pile(20), traverser, slow_memory);
    EXPECT_EQ(error_of([&] { frame.draw(); }), "");
    EXPECT_TRUE(frame.run.frame == frame.native());
  }
}

TEST(Progress, AStallOfTheShaderIsNoLockUp) {
  DrawnFrame frame(pile(1), TraverserName::Static, long_stalls);
  EXPECT_EQ(error_of([&] { frame.draw(); }), "");
  EXPECT_TRUE(frame.run.frame == frame.native());
}

// ---- Chips that are locked up

/// Casts so many tiles, and nothing afterwards.
struct GivesUp : KernelPolicy {
  explicit GivesUp(uint32_t tiles) : left(tiles) {}
  Choice choose(const PolicyView& view) const override {
    if (!view.eye_possible || left == 0) return {};
    --left;
    return {Choice::Kind::Eye, 0};
  }
  mutable uint32_t left;
};

TEST(Progress, APolicyThatNeverLaunchesIsALockUp) {
  for (const TraverserName traverser : {TraverserName::Static, TraverserName::Hardware}) {
    for (const uint32_t tiles : {0u, 1u}) {
      DrawnFrame frame(pile(20), traverser, one_ray, 8);
      frame.run.options.limits.cycles = 100 * kPeriod;
      const std::string error =
          error_of([&] { frame.draw({}, [&](const PolicySetup&) { return std::make_unique<GivesUp>(tiles); }); });
      expect_parts(error, {"the chip is locked up: for 2000 cycles no instruction has ended",
                           "the controller launches nothing, though unit 0 could take a kernel",
                           tiles == 0 ? "0 pixels of 8x8 have been cast" : "16 pixels of 8x8 have been cast"});
    }
  }
}

/// Shows the board a memory port that asks for nothing, and takes what it asks for.
struct DeafMemory : PortsAlone {
  using PortsAlone::PortsAlone;
  void clock(const ChipInputs& inputs) override {
    ChipInputs in = inputs;
    in.memory_request_ready = true;
    chip->clock(in);
    look();
  }
  void look() override {
    out = chip->outputs();
    out.memory_request_valid = false;
  }
};

TEST(Progress, ABoardThatCannotReachItsMemoryIsLockedUp) {
  for (const TraverserName traverser : {TraverserName::Static, TraverserName::Hardware}) {
    DrawnFrame frame(pile(20), traverser, one_ray);
    frame.run.options.limits.cycles = 100 * kPeriod;
    const std::string error = error_of([&] {
      frame.draw([](std::unique_ptr<ChipDevice> chip) { return std::make_unique<DeafMemory>(std::move(chip)); });
    });
    expect_parts(error, {"the chip is locked up", "unit 0 runs a kernel and waits for the memory port",
                         "a unit waits for 1 lines of the memory, since cycle "});
  }
}

/// Full of rays, of which the traverser takes none.
struct Standstill : PortsAlone {
  using PortsAlone::PortsAlone;
  void look() override {
    out = {};
    out.busy = out.ray_valid = true;
    out.rays = 512;
    out.quiet = 1;
    out.device.unit_idle = 1;
    out.device.export_valid = true;
  }
};

TEST(Progress, ARayThatIsOfferedAndNeverTakenIsALockUp) {
  DrawnFrame frame(pile(20), TraverserName::Hardware, one_ray);
  frame.run.options.limits.cycles = 100 * kPeriod;
  const std::string error = error_of([&] {
    frame.draw([](std::unique_ptr<ChipDevice> chip) { return std::make_unique<Standstill>(std::move(chip)); });
  });
  expect_parts(error, {"the chip is locked up", "a ray waits for the traverser to take it",
                       "unit 0 waits for the ray pool to take a ray", "ray pool 512 of 512 rays, which is full"});
}

}  // namespace
}  // namespace raypool
