// rtl/chip.v in lockstep with its model while it draws frames with the real kernels, amid surroundings of chance: all
// ports of all blocks in every cycle, on machines whose corners are different ones.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "kernel/kernels.hpp"
#include "lockstep/lockstep_chip.hpp"
#include "lockstep/rtl_loader.hpp"
#include "machine/test_program.hpp"
#include "rtl/chip_surroundings.hpp"
#include "rtl/test_library.hpp"
#include "scene/native_renderer.hpp"
#include "scene/scene.hpp"

namespace raypool {
namespace {

using test::Surroundings;
using test::Traffic;

struct Machine {
  Configuration configuration;
  int units = 1;
};

/// Of everything one.
Machine smallest() {
  Machine machine;
  Configuration& c = machine.configuration;
  c.name = "chip_1w1c";
  c.warps = c.lanes = 1;
  c.instruction_cache_bytes = c.data_cache_bytes = 512;
  c.data_cache_mshrs = 1;
  c.chip.ray_pool_size = c.chip.intersection_pool_size = c.chip.held_limit = 1;
  c.chip.ray_pool_overhead = c.chip.intersection_pool_overhead = 1;
  c.chip.memory_queue = 1;
  c.chip.memory_latency = 6;
  c.chip.memory_cycles_per_beat = 1;
  c.chip.modelled_traverser_node_cache_mshrs = c.chip.modelled_traverser_triangle_cache_mshrs = 1;
  return machine;
}

/// Two units, all that a chip may have: the policy fill, culling, a traverser that shades, pipelined pools, records.
Machine full() {
  Machine machine;
  machine.units = 2;
  Configuration& c = machine.configuration;
  c.name = "chip_2w2c_full";
  c.warps = c.lanes = 2;
  c.instruction_cache_bytes = c.data_cache_bytes = 512;
  c.data_cache_mshrs = 2;
  c.kernel_overlap = true;
  c.intersection_words = 18;
  c.chip.policy = PolicyName::Fill;
  c.chip.culling = true;
  c.chip.shading = Shading::Traverser;
  c.chip.static_traverser_batch = 3;
  c.chip.traverser = TraverserName::Modelled;
  c.chip.modelled_traverser_tile_order = TileOrder::Hilbert;
  c.chip.ray_pool_size = 5;
  c.chip.ray_pool_pipelined = c.chip.intersection_pool_pipelined = true;
  c.chip.intersection_pool_size = c.chip.held_limit = 8;
  c.chip.memory_latency = 20;
  return machine;
}

/// Four units, and slow ports.
Machine slow() {
  Machine machine;
  machine.units = 4;
  Configuration& c = machine.configuration;
  c.name = "chip_1w1c_slow";
  c.warps = c.lanes = 1;
  c.instruction_cache_bytes = c.data_cache_bytes = 512;
  c.data_cache_mshrs = 2;
  c.chip.launch_ahead = c.chip.window_remedy = false;
  c.chip.thresholds_rays = 40;
  c.chip.ray_pool_size = 4;
  c.chip.ray_pool_overhead = 3;
  c.chip.ray_pool_cycles_per_beat = 2;
  c.chip.intersection_pool_size = c.chip.held_limit = 6;
  c.chip.intersection_pool_overhead = 4;
  c.chip.intersection_pool_cycles_per_beat = 2;
  c.chip.memory_latency = 40;
  c.chip.memory_cycles_per_beat = 3;
  c.chip.memory_queue = 3;
  c.chip.modelled_traverser_node_cache_mshrs = 2;
  c.chip.modelled_traverser_triangle_cache_mshrs = 1;
  return machine;
}

std::string library_of(const Machine& machine) {
  return test::verilate(
             machine.configuration.name,
             " --top chip --quick" + test::words_of(chip_verilog_parameters(machine.configuration, machine.units)),
             RAYPOOL_TEST_TREE) +
         "/libraypool_chip.so";
}

/// What is drawn.
struct Picture {
  uint32_t width, height, depth;
  bool reflections;
};

/// The ray kernels, but each stores a word a thread before it begins, so that the memory is written too.
Program storing_kernels(const Configuration& configuration, uint32_t address) {
  Program program = ray_kernel_program(KernelTarget(configuration));
  const size_t length = program.code.size();
  std::string text;
  for (size_t i = 0; i < length; ++i) text += "exit;";  // so that numbers are those of the whole
  for (auto& [name, entry] : program.entries) {
    text += fmt::format("tid r0; shl r1, r0, 2; st [r1+{}], r0; call {}, 65535;", address, entry);
    entry = size32(program.code);
    program.code.resize(program.code.size() + 4);
  }
  const std::vector<uint64_t> code = test::assembled(text);
  std::copy(code.begin() + static_cast<std::ptrdiff_t>(length), code.end(),
            program.code.begin() + static_cast<std::ptrdiff_t>(length));
  return program;
}

struct Frame {
  static constexpr uint32_t kStored = 0x8000;  // behind program and materials

  Frame(const Machine& machine, const Picture& picture) {
    const Configuration& configuration = machine.configuration;
    const Program program = storing_kernels(configuration, kStored);
    const Scene cornell = make_cornell();
    image = build_memory(program, cornell);
    EXPECT_LE(image.memory.size(), kStored);
    image.memory.grow(kStored + 64 * ((configuration.contents() + 15) / 16));
    setup.program_length = size32(program.code);
    setup.memory_limit = image.memory.size();
    setup.arguments = camera_arguments(cornell, picture.width, picture.height, configuration.contents());
    for (size_t i = 0; i < kRayKernels; ++i)
      setup.entries[static_cast<RayKernel>(i)] = program.entries.at(std::string(kRayKernelNames[i]));
    setup.width = picture.width;
    setup.height = picture.height;
    setup.depth = picture.depth;
    setup.reflections =
        secondary_kernel(static_cast<int>(picture.depth), picture.reflections) == RayKernel::CastSecondary;
    around.material_base = image.material_base;
    around.materials = size32(cornell.materials);
    around.layout = ray_record_layout(configuration);
    around.shading = configuration.chip.shading;
    around.culling = configuration.chip.culling;
    around.reflections = setup.reflections;
  }

  FrameSetup setup;
  MemoryImage image;
  Surroundings::Scene around;
};

/// What was there, over all frames.
struct Reached {
  uint64_t frames = 0, deep = 0, black = 0, held_up = 0, full = 0, frame_waited = 0, tree_lines = 0, own = 0,
           overlapped = 0;
  uint64_t launches[kRayKernels] = {};
  uint64_t of_unit[kMostUnits] = {};

  void add(const Surroundings& frame) {
    ++frames;
    deep += frame.deep;
    black += frame.black;
    held_up += frame.held_up;
    full += frame.full;
    frame_waited += frame.frame_waited;
    tree_lines += frame.tree_lines;
    own += frame.own_contributions;
    overlapped += frame.overlapped;
    for (size_t i = 0; i < kRayKernels; ++i) launches[i] += frame.launches[i];
    for (size_t u = 0; u < kMostUnits; ++u) of_unit[u] += frame.of_unit[u];
  }
};

/// Draws a frame to its end, and some cycles more; nothing may be lost.
void draw(ChipDevice& chip, const Machine& machine, const Picture& picture, const Traffic& traffic, uint32_t seed,
          Reached& reached) {
  constexpr uint64_t kMost = 1'000'000;
  Frame frame(machine, picture);
  Surroundings around(chip, machine.configuration, frame.image.memory, frame.around, seed);
  around.setup = frame.setup;
  chip.start(frame.setup);
  ASSERT_FALSE(chip.outputs().busy);
  ASSERT_NO_FATAL_FAILURE(around.cycle(traffic));
  while (chip.outputs().busy && around.cycles < kMost) {
    ASSERT_NO_FATAL_FAILURE(around.cycle(traffic));
    ASSERT_EQ(chip.outputs().device.fault.code, FaultCode::None) << "PC " << chip.outputs().device.fault.pc;
  }
  ASSERT_LT(around.cycles, kMost) << "the frame does not end";
  Traffic quiet = traffic;
  quiet.tree = 0;
  for (int i = 0; i < 3000; ++i) ASSERT_NO_FATAL_FAILURE(around.cycle(quiet));
  EXPECT_TRUE(around.empty());
  EXPECT_EQ(around.eye, picture.width * picture.height);
  EXPECT_EQ(around.rays, around.freed);
  const ChipCounts counts = chip.counts();
  EXPECT_EQ(counts.rays_taken, around.rays + around.dropped);
  EXPECT_EQ(counts.packages_taken, around.packages);
  EXPECT_EQ(around.requests, around.packages);
  EXPECT_EQ(counts.contributions, around.frame);
  EXPECT_EQ(around.frame, around.own_contributions + around.unit_contributions);
  reached.add(around);
}

class ChipLockstep : public testing::TestWithParam<Machine (*)()> {};

TEST_P(ChipLockstep, DrawsFramesWithoutADifference) {
  const Machine machine = GetParam()();
  const Configuration& c = machine.configuration;
  const std::string library = library_of(machine);
  Reached reached;
  ChipLockstepCounts counts;
  const Traffic all[] = {{0, 0, 0, 1000, 1, 1, 1},
                         {3, 2, 40, 1000, 200, 30, 1},
                         {2, 5, 9, 3, 20, 60, 1},
                         {9, 0, 0, 1000, 900, 5, 2000, 500}};
  // One pixel at a time takes long.
  const uint32_t size = c.chip.held_limit > 1 ? 2 : 1;
  const Picture pictures[] = {{5 * size, 3 * size, 1, true},
                              {7 * size, 3 * size, 3, true},
                              {1, 9 * size, 4, false},
                              {4 * size, 4 * size, 2, true}};
  uint32_t seed = 0;
  // One device for all frames: nothing of one may be left in the next.
  Frame first(machine, pictures[0]);
  const std::unique_ptr<LockstepChip> chip =
      make_lockstep_chip(c, load_rtl_chip(library, c, machine.units), first.image.memory, c.name);
  for (const Picture& picture : pictures) {
    for (const Traffic& traffic : all) {
      SCOPED_TRACE(testing::Message() << "seed " << ++seed << ", " << picture.width << " x " << picture.height);
      try {
        ASSERT_NO_FATAL_FAILURE(draw(*chip, machine, picture, traffic, seed, reached));
      } catch (const LockstepDifference& difference) {
        FAIL() << difference.what();
      }
    }
  }
  counts = chip->lockstep_counts();
  std::cout << c.name << ", " << machine.units << " units: " << to_string(counts) << "\n";
  EXPECT_EQ(counts.differences, 0u);
  EXPECT_GE(counts.counters, reached.frames);
  EXPECT_GT(reached.launches[to_underlying(RayKernel::CastEye)], 50u);
  EXPECT_GT(reached.launches[to_underlying(RayKernel::CastSecondary)], 50u);
  EXPECT_GT(reached.launches[to_underlying(RayKernel::CastSecondaryDirect)], 10u);
  EXPECT_EQ(reached.launches[to_underlying(RayKernel::Shade)] > 20, c.chip.shading == Shading::Kernel);
  EXPECT_EQ(reached.own > 20, c.chip.shading == Shading::Traverser);
  EXPECT_EQ(reached.black > 0, c.chip.culling);
  EXPECT_GT(counts.memory_writes, 1000u);
  EXPECT_GT(reached.deep, 20u);
  EXPECT_GT(reached.held_up, 20u);
  if (c.chip.intersection_pool_size == 1) {
    EXPECT_GT(reached.full, 20u);  // a larger one seldom is
  }
  if (machine.units > 2) {  // who shade together
    EXPECT_GT(reached.frame_waited, 20u);
  }
  EXPECT_GT(reached.tree_lines, 20u);
  EXPECT_EQ(reached.overlapped > 0, c.chip.launch_ahead);
  for (int unit = 0; unit < machine.units; ++unit) EXPECT_GT(reached.of_unit[unit], 50u) << unit;
}

INSTANTIATE_TEST_SUITE_P(Machines, ChipLockstep, testing::Values(smallest, full, slow),
                         [](const auto& machine) { return machine.param().configuration.name; });

TEST(ChipLibrary, IsRefusedForAnotherChip) {
  Machine machine = smallest();
  const std::string library = library_of(machine);
  machine.configuration.chip.ray_pool_size = 2;
  try {
    make_chip(ChipKind::Rtl, machine.configuration, Memory(), 1, library);
    FAIL() << "it was loaded";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("needs RAY_POOL_SIZE=2"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace raypool
