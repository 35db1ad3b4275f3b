// For tests: chips with the traverser in Verilog inside, small random scenes and trees, and frames of them on a board
// with memories and a frame buffer that do not always take or give.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "chip/board.hpp"
#include "chip/test_returning_kernels.hpp"
#include "chip/tree_image.hpp"
#include "random.hpp"
#include "rtl/chip_frames.hpp"
#include "rtl/strange_numbers.hpp"
#include "scene/hard_rays.hpp"
#include "scene/image.hpp"
#include "scene/mesh_builder.hpp"
#include "scene/native_renderer.hpp"
#include "scene/test_traversal.hpp"
#include "scene/traversal.hpp"

namespace raypool::test {

/// Of everything one, and caches as small as can be.
inline Machine smallest_inside() {
  Machine machine;
  Configuration& c = machine.configuration;
  c.name = "chip_traverser_1w1c";
  c.warps = c.lanes = 1;
  c.instruction_cache_bytes = c.data_cache_bytes = 512;
  c.data_cache_mshrs = 1;
  ChipConfiguration& chip = c.chip;
  chip.ray_pool_size = 1;
  chip.intersection_pool_size = chip.held_limit = 1;
  chip.memory_latency = 20;
  chip.memory_queue = 1;
  chip.traverser = TraverserName::Hardware;
  chip.hardware_traverser_lanes = chip.hardware_traverser_rays = chip.hardware_traverser_triangle_pipes = 1;
  chip.hardware_traverser_stack_entries = 8;
  chip.hardware_traverser_cache_banks = 1;
  chip.hardware_traverser_node_cache_bytes = chip.hardware_traverser_triangle_cache_bytes = 512;
  chip.hardware_traverser_node_cache_ways = chip.hardware_traverser_triangle_cache_ways = 2;
  chip.hardware_traverser_node_cache_mshrs = chip.hardware_traverser_triangle_cache_mshrs = 1;
  return machine;
}

/// Two units and two lanes that share a triangle pipe; a traverser that shades, culling, records, banks.
inline Machine full_inside() {
  Machine machine = smallest_inside();
  machine.units = 2;
  Configuration& c = machine.configuration;
  c.name = "chip_traverser_2w1c_full";
  c.warps = 2;
  c.kernel_overlap = true;
  c.intersection_words = 18;
  ChipConfiguration& chip = c.chip;
  chip.policy = PolicyName::Fill;
  chip.culling = true;
  chip.shading = Shading::Traverser;
  chip.ray_pool_size = 9;
  chip.ray_pool_pipelined = chip.intersection_pool_pipelined = true;
  chip.intersection_pool_size = chip.held_limit = 4;
  chip.memory_cycles_per_beat = 1;
  chip.memory_queue = 8;
  chip.tile_order = TileOrder::Hilbert;
  chip.hardware_traverser_lanes = 2;
  chip.hardware_traverser_rays = 6;
  chip.hardware_traverser_box_bits = 6;
  chip.hardware_traverser_cache_banks = 2;
  chip.hardware_traverser_node_cache_bytes = chip.hardware_traverser_triangle_cache_bytes = 1024;
  chip.hardware_traverser_node_cache_mshrs = 2;
  chip.hardware_traverser_triangle_cache_mshrs = 4;
  return machine;
}

/// More rays in the pool than the traverser has slots, and more slots than the pool has places for what they become.
inline Machine crowded_inside() {
  Machine machine = smallest_inside();
  Configuration& c = machine.configuration;
  c.name = "chip_traverser_1w2c_crowded";
  c.lanes = 2;
  ChipConfiguration& chip = c.chip;
  chip.culling = true;
  chip.ray_pool_size = 13;
  chip.intersection_pool_size = chip.held_limit = 2;
  chip.memory_latency = 9;
  chip.memory_cycles_per_beat = 1;
  chip.memory_queue = 2;
  chip.hardware_traverser_lanes = 2;
  chip.hardware_traverser_triangle_pipes = 2;
  chip.hardware_traverser_rays = 8;
  chip.hardware_traverser_box_bits = 16;
  chip.hardware_traverser_triangle_cache_ways = 4;
  chip.hardware_traverser_triangle_cache_mshrs = 3;
  return machine;
}

/// Rays return, some of which wait while others are finished.
inline Machine returning_inside() {
  Machine machine = crowded_inside();
  machine.configuration.name = "chip_traverser_1w2c_returning";
  machine.configuration.chip.culling = false;
  machine.configuration.chip.miss_records = true;
  return machine;
}

/// The machines of `make chip-frames` that have it inside: these, and every pair of values of what such a chip has.
inline std::vector<Machine> inside_machines() {
  std::vector<Machine> machines = {smallest_inside(), full_inside(), crowded_inside(), returning_inside()};
  for (Machine& machine : covering_inside()) machines.push_back(std::move(machine));
  return machines;
}

/// A soup of so many triangles, or a few more, with random materials, camera and light; at times all of it is one
/// triangle many times. Half of them are in a closed box, with the camera, so that every ray hits something.
/// `mirrors`: in a closed box of mirrors, so that rays are reflected as often as they may be.
inline Scene random_scene(uint32_t seed, uint32_t triangles, bool mirrors = false) {
  Random random(seed);
  const auto share = [&random] { return static_cast<float>(random() % 1001) / 1000; };
  const auto near = [&](float distance) {
    return Vec3{distance * (2 * share() - 1), distance * (2 * share() - 1), distance * (2 * share() - 1)};
  };
  // Some are next to nothing, or as large as can be.
  const int ordinary = static_cast<int>(random() % 20) - 10, tiny = -60 - static_cast<int>(random() % 60);
  const float scale = std::ldexp(1.0f, random() % 8 != 0 ? ordinary : random() % 3 == 0 ? 22 : tiny);
  const Vec3 at = random() % 2 == 0 ? Vec3{0, 0, 0} : near(20 * scale);
  Scene scene = soup(random(), static_cast<int>(triangles), scale, at);
  if (random() % 8 == 0) {  // nearly flat
    const auto axis = static_cast<int>(random() % 3);
    const float thin = std::ldexp(1.0f, -static_cast<int>(random() % 50));
    for (Vec3& vertex : scene.vertices) vertex[axis] = at[axis] + (vertex[axis] - at[axis]) * thin;
  }
  if (random() % 16 == 0)
    for (size_t vertex = 3; vertex < scene.vertices.size(); ++vertex)
      scene.vertices[vertex] = scene.vertices[vertex % 3];
  const bool closed = random() % 2 == 0 || mirrors;
  if (closed) {
    const Vec3 half{2 * scale, 2 * scale, 2 * scale};
    MeshBuilder mesh(scene, 1);
    mesh.use(0);
    mesh.box((at - half).as<double>(), (at + half).as<double>());
  }
  scene.name = "random";
  scene.materials.clear();
  for (uint32_t material = 1 + random() % 4; material > 0; --material) {
    const Vec3 kd = random() % 4 == 0 ? Vec3{0, 0, 0} : Vec3{share(), share(), share()};
    scene.materials.push_back({"", kd, random() % 2 == 0 ? Vec3{0, 0, 0} : Vec3{share(), share(), 1}});
  }
  for (uint32_t& material : scene.triangle_materials) material = random() % size32(scene.materials);
  scene.camera.eye = at + near((closed ? 1.9f : 3) * scale);
  scene.camera.direction = scene.vertices[random() % scene.vertices.size()] + near(0.1f * scale) - scene.camera.eye;
  scene.camera.up = near(1) + Vec3{0, 2, 0};
  scene.camera.fov = 2 + 60 * share();
  scene.light = {at + near((closed ? 1.9f : 4) * scale), {share(), 1, share()}};
  harden(scene, seed + 1, mirrors);
  check_scene(scene, "a random scene");
  return scene;
}

/// Half of the triangles reflect nothing, so that rays are soon reflected no more.
inline void make_dull(Scene& scene, uint32_t seed) {
  Random random(seed + 2);
  scene.materials.push_back({"", {0.5f, 0.25f, 0.75f}, {}});
  for (uint32_t& material : scene.triangle_materials)
    if (random() % 2 == 0) material = size32(scene.materials) - 1;
}

/// Those that its machines draw with.
inline const RayProgram& kernels_for(const Configuration& configuration) {
  const KernelTarget target(configuration);
  return configuration.chip.miss_records ? returning_kernels(target) : built_in_ray_program(target);
}

/// A picture of a scene, and what it takes to draw it on a chip.
class Drawing {
 public:
  /// `tree`: of a bad tree, which the traverser has in place of the native engine's; 0: it has the same. `spoilt`: of
  /// what is wrong in the memory that holds it, so that it may be none; 0: nothing. `strange`: of numbers that are not
  /// the scene's (strange_numbers.hpp), so that no other engine draws the picture; 0: none.
  Drawing(const Machine& machine, const Picture& picture, Scene scene, uint32_t tree = 0, uint32_t spoilt = 0,
          uint32_t strange = 0)
      : configuration_(machine.configuration),
        scene_(std::move(scene)),
        kernels_(kernels_for(configuration_)),
        program_(kernels_.program),
        image_(build_memory(program_, scene_)),
        tracer_(scene_, image_.material_base, configuration_.chip),
        frame_(static_cast<int>(picture.width), static_cast<int>(picture.height)),
        sink_(frame_),
        tree_(make_tree_image(scene_, tree_of(tracer_.traversal().bvh(), tree), configuration_.chip,
                              image_.material_base)) {
    options_.configuration = configuration_;
    options_.layout = record_layout(kernels_, configuration_);
    options_.memory = &image_.memory;
    options_.tree = &tree_;
    options_.program_length = size32(program_.code);
    for (size_t i = 0; i < kRayKernels; ++i) options_.entries[i] = program_.entries.at(std::string(kRayKernelNames[i]));
    options_.arguments =
        camera_arguments(scene_, picture.width, picture.height, configuration_.contents(), configuration_.significand);
    options_.width = picture.width;
    options_.height = picture.height;
    options_.depth = picture.depth;
    options_.reflections = picture.reflections;
    options_.frame = &sink_;
    if (spoilt != 0) spoil(spoilt);
    if (strange == 0) return;
    StrangeNumbers numbers(strange);
    numbers.put(options_.arguments, tree_.memory, tree_.setup);
    numbers.put(tree_.memory, tree_.setup);
  }

  Memory& memory() { return image_.memory; }
  const ChipOptions& options() const { return options_; }
  TreeImage& tree() { return tree_; }
  /// It stands in the memory of a chip that has drawn other pictures: as large, and overwritten with this one's.
  void stand_in(Memory& memory) {
    image_.memory.grow(memory.size());
    ASSERT_EQ(memory.size(), image_.memory.size());
    memory = image_.memory;
    options_.memory = &memory;
  }
  /// `followed`: until the chip is ready for the next frame.
  ChipResult draw_on(ChipDevice& chip, FrameBegin begin = FrameBegin::Reset, bool followed = false) {
    if (!followed) return run_board(options_, chip, begin);
    chip::FixedLatencyStore store(*options_.memory, &tree_.memory, configuration_.chip);
    chip::Board board(options_, chip, store, begin);
    while (!board.may_be_followed()) board.clock();
    return board.result();
  }
  /// From a reset until `enough` returns true, or the picture is drawn.
  template <typename Enough>
  void draw_until(ChipDevice& chip, const Enough& enough) {
    chip::FixedLatencyStore store(*options_.memory, &tree_.memory, configuration_.chip);
    chip::Board board(options_, chip, store, FrameBegin::Reset);
    while (!enough() && !board.may_be_followed()) board.clock();
  }

  /// What has been drawn, and reported of it, is what the native engine draws and reports.
  void expect_native(const ChipResult& result) const {
    NativeOptions native;
    native.width = static_cast<int>(options_.width);
    native.height = static_cast<int>(options_.height);
    native.depth = static_cast<int>(options_.depth);
    native.reflections = options_.reflections;
    native.culling = configuration_.chip.culling;
    native.kernel = kernels_.native;
    NativeStatistics statistics;
    EXPECT_TRUE(frame_ == render_native(scene_, image_, tracer_, native, &statistics));
    for (const auto kind : {&RayCounts::eye, &RayCounts::reflection, &RayCounts::shadow}) {
      EXPECT_EQ((result.ray_counts.*kind).traced, (statistics.ray_counts.*kind).traced);
      EXPECT_EQ((result.ray_counts.*kind).ended, (statistics.ray_counts.*kind).ended);
      EXPECT_EQ((result.ray_counts.*kind).weightless, (statistics.ray_counts.*kind).weightless);
      EXPECT_EQ((result.ray_counts.*kind).futile, (statistics.ray_counts.*kind).futile);
      EXPECT_EQ((result.ray_counts.*kind).left_out, (statistics.ray_counts.*kind).left_out);
    }
    EXPECT_EQ(result.dropped_depth, statistics.dropped_rays);
    EXPECT_EQ(result.contributions, statistics.contributions);
  }

 private:
  static Bvh tree_of(const Bvh& good, uint32_t seed) {
    return seed == 0 || good.nodes.empty() ? good : random_tree(good, seed, static_cast<TreeShape>(seed % 4));
  }
  // Some bits of the nodes' children, or of where nodes and triangles end. Their boxes and the triangles stay: they may
  // be anything anyhow.
  void spoil(uint32_t seed) {
    Random random(seed);
    TreeSetup& setup = tree_.setup;
    for (uint32_t times = 1 + random() % 4; times > 0; --times) {
      // Rays come to the first node.
      const uint32_t node = random() % 2 == 0 ? 0 : random() % std::max(1u, setup.triangles_line) * 64;
      const uint32_t child = node + 40 + random() % 4 * 4, number = node / 64;
      const auto put = [this](uint32_t address, uint32_t word) { tree_.memory.store(address, word); };
      switch (random() % 12) {
        case 0:
          put(node + 12, (tree_.memory.load(node + 12) & 0xffffff) | random() % 8 << 24);
          break;
        case 1:
          put(child, number);
          break;
        case 2:
          put(child, number + 1 + random() % 3);
          break;
        case 3:
          put(child, setup.triangles_line - 1 + random() % 3);
          break;
        case 4:
          put(child, kLeafBit | (setup.triangle_lines * 16 / 11 - 3 + random() % 6) | random() % 4 << 29);
          break;
        case 5:  // its last bits are a leaf's
          put(child, kLeafBit | random() % 4 << 29 | (tree_.memory.load(child) & 15) | 1u << (4 + random() % 25));
          break;
        case 6:
          setup.triangle_lines -= std::min(setup.triangle_lines, static_cast<uint32_t>(random() % 3));
          break;
        case 7:  // a line that no address reaches, or nearly
          put(child,
              leaf_word(static_cast<uint32_t>(((uint64_t{1} << 26) - random() % (setup.triangles_line + 2)) * 16 / 11),
                        1 + random() % 4));
          break;
        case 8:
          share_children();
          break;
        default:
          put(child, tree_.memory.load(child) ^ 1u << random() % 32);
      }
    }
  }

  // All children of a node are the next one, so that a ray comes to nodes more often than there are any.
  void share_children() {
    for (uint32_t node = 0; node + 1 < tree_.setup.triangles_line; ++node)
      for (uint32_t child = 0; child < kBvhWidth; ++child) tree_.memory.store(node * 64 + 40 + child * 4, node + 1);
  }

  const Configuration configuration_;
  const Scene scene_;
  const RayProgram& kernels_;
  const Program& program_;
  MemoryImage image_;
  const Tracer tracer_;
  FrameBuffer frame_;
  FrameBufferSink sink_;
  TreeImage tree_;
  ChipOptions options_;
};

/// A chip in front of which some transfers wait, one in so many cycles (0: none): a request to the memories, a beat of
/// theirs, a contribution to the frame buffer. With `shut` the memories' ports are shut for so many cycles, then open
/// for as many, and the frame buffer's for ten times as many.
class WaitingChip : public ChipDevice {
 public:
  struct Waits {
    uint32_t request = 0, beat = 0, frame = 0, shut = 0;
  };

  /// `chip` must outlive it.
  WaitingChip(ChipDevice& chip, const Waits& waits, uint32_t seed) : chip_(chip), waits_(waits), random_(seed) {}

  uint32_t units() const override { return chip_.units(); }
  void start(const FrameSetup& setup) override {
    chip_.start(setup);
    decide();
  }
  void start_next(const FrameSetup& setup) override {
    chip_.start_next(setup);
    decide();
  }
  const ChipOutputs& outputs() const override { return out_; }
  void clock(const ChipInputs& inputs) override {
    ChipInputs given = inputs;
    given.memory_request_ready &= !request_waits_;
    given.memory_beat_valid &= !beat_waits_;
    given.frame_ready &= !frame_waits_;
    given.start |= !chip_.outputs().ready && hasty_() % 16 == 0;  // which is refused
    const ChipOutputs::Outcome& outcome = chip_.outputs().outcome;
    deep += outcome.valid && outcome.deep;
    black += outcome.valid && !outcome.kept && !outcome.deep;
    chip_.clock(given);
    decide();
  }
  ChipCounts counts() override { return chip_.counts(); }
  uint64_t counter(int number) override { return chip_.counter(number); }

  uint64_t deep = 0, black = 0;  ///< rays that left the units and were dropped

 private:
  // What is around the chip sees nothing of a transfer that waits.
  void decide() {
    const auto one_of = [this](uint32_t number) { return number != 0 && random_() % number == 0; };
    ++cycle_;
    request_waits_ = one_of(waits_.request) || is_shut(waits_.shut, cycle_, 0);
    beat_waits_ = one_of(waits_.beat) || is_shut(waits_.shut, cycle_, 1);
    frame_waits_ = one_of(waits_.frame) || is_shut(10 * waits_.shut, cycle_, 2);
    out_ = chip_.outputs();
    out_.memory_request_valid &= !request_waits_;
    out_.memory_beat_ready &= !beat_waits_;
    out_.frame_valid &= !frame_waits_;
  }

  ChipDevice& chip_;
  Random hasty_{1};  // a host that asks for frames while one is drawn
  Waits waits_;
  Random random_;
  uint64_t cycle_ = 0;
  bool request_waits_ = false, beat_waits_ = false, frame_waits_ = false;
  ChipOutputs out_;
};

}  // namespace raypool::test
