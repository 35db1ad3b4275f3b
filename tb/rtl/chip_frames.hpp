// For tests: frames on a chip, with the real kernels, amid random surroundings.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "cosim/covering.hpp"
#include "kernel/kernels.hpp"
#include "machine/compute/test_program.hpp"
#include "rtl/chip_surroundings.hpp"
#include "rtl/test_library.hpp"
#include "scene/native_renderer.hpp"
#include "scene/scene.hpp"

namespace raypool::test {

/// Path of the library of its Verilated chip, from the Verilog of the tree `tree`.
inline std::string chip_library(const Machine& machine, const std::string& tree = RAYPOOL_TEST_TREE,
                                const std::string& units = RAYPOOL_TEST_UNITS) {
  return verilate(machine.configuration.name,
                  " --top chip --quick" + words_of(chip_verilog_parameters(machine.configuration, machine.units)), tree,
                  units) +
         "/libraypool_chip.so";
}

/// What is drawn.
struct Picture {
  uint32_t width, height, depth;
  bool reflections;
};

/// The ray kernels, but each stores a word a thread before it begins, so that the memory is written too.
inline Program storing_kernels(const Configuration& configuration, uint32_t address) {
  Program program = ray_kernel_program(KernelTarget(configuration));
  const size_t length = program.code.size();
  std::string text;
  for (size_t i = 0; i < length; ++i) text += "exit;";  // so that numbers are those of the whole
  for (auto& [name, entry] : program.entries) {
    text += fmt::format("tid r0; shl r1, r0, 2; st [r1+{}], r0; call {}, 65535;", address, entry);
    entry = size32(program.code);
    program.code.resize(program.code.size() + 4);
  }
  const std::vector<uint64_t> code = assembled(text);
  std::copy(code.begin() + static_cast<std::ptrdiff_t>(length), code.end(),
            program.code.begin() + static_cast<std::ptrdiff_t>(length));
  return program;
}

/// Gives materials and light colours that are hard to get right: rays with a weight of 0 or -0 in some channels or in
/// all, or so small that a product is a subnormal number. `mirrors`: nothing is lost in a reflection.
inline void harden(Scene& scene, uint32_t seed, bool mirrors = false) {
  Random random(seed);
  const uint32_t plain = 2 + random() % 10;  // one channel in so many is hard
  const auto channel = [&](float& value) {
    if (random() % plain != 0) return;
    constexpr std::array<float, 6> kHard = {0.0f, -0.0f, -0.0f, 0x1p-70f, 0x1p-126f, 1.0f};
    value = kHard[random() % kHard.size()];
  };
  const auto colour = [&](Vec3& value) {
    for (int axis = 0; axis < 3; ++axis) channel(value[axis]);
    if (random() % (3 * plain) == 0) value = {-0.0f, random() % 2 == 0 ? 0.0f : -0.0f, -0.0f};
  };
  for (Material& material : scene.materials) {
    colour(material.kd);
    colour(material.ks);
    if (mirrors) material.ks = {1, 1, 1};
  }
  colour(scene.light.color);
}

struct Frame {
  static constexpr uint32_t kStored = 0x8000;  // behind program and materials

  /// `hard`: seed of materials of which some have colours of 0, -0 or next to nothing; 0: they are those of the scene.
  Frame(const Machine& machine, const Picture& drawn, uint32_t hard = 0) : picture(drawn) {
    const Configuration& configuration = machine.configuration;
    const Program program = storing_kernels(configuration, kStored);
    Scene cornell = make_cornell();
    if (hard != 0) harden(cornell, hard);
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

  /// Another picture, in the memory of this one.
  void show(const Frame& next) {
    picture = next.picture;
    setup = next.setup;
    around = next.around;
  }

  Picture picture;
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

/// Draws a frame to its end, and some cycles more; nothing may be lost. `followed`: only until the chip is ready for
/// the next frame.
inline void draw(ChipDevice& chip, const Machine& machine, Frame& frame, const Traffic& traffic, uint32_t seed,
                 Reached& reached, FrameBegin begin = FrameBegin::Reset, bool followed = false) {
  constexpr uint64_t kMost = 1'000'000;
  Surroundings around(chip, machine.configuration, frame.image.memory, frame.around, seed);
  around.setup = frame.setup;
  ChipCounts before;
  if (begin == FrameBegin::Reset) {
    chip.start(frame.setup);
  } else {
    chip.start_next(frame.setup);
    before = chip.counts();
  }
  ASSERT_FALSE(chip.outputs().busy);
  ASSERT_NO_FATAL_FAILURE(around.cycle(traffic));
  while (chip.outputs().busy && around.cycles < kMost) {
    ASSERT_NO_FATAL_FAILURE(around.cycle(traffic));
    ASSERT_EQ(chip.outputs().device.fault.code, FaultCode::None) << "PC " << chip.outputs().device.fault.pc;
  }
  ASSERT_LT(around.cycles, kMost) << "the frame does not end";
  Traffic quiet = traffic;
  quiet.tree = quiet.frame = 0;
  for (int i = 0; i < 3000 && !(followed && chip.outputs().ready); ++i) ASSERT_NO_FATAL_FAILURE(around.cycle(quiet));
  EXPECT_TRUE(chip.outputs().ready);
  EXPECT_TRUE(around.empty());
  EXPECT_EQ(around.eye, frame.picture.width * frame.picture.height);
  EXPECT_EQ(around.rays, around.freed);
  const ChipCounts counts = chip.counts() - before;
  EXPECT_EQ(counts.rays_taken, around.rays + around.dropped);
  EXPECT_EQ(counts.packages_taken, around.packages);
  EXPECT_EQ(around.requests, around.packages);
  EXPECT_EQ(counts.contributions, around.frame);
  EXPECT_EQ(around.frame, around.own_contributions + around.unit_contributions);
  reached.add(around);
}

}  // namespace raypool::test
