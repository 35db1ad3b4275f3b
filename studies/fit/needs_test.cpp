#include "fit/needs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "bits.hpp"
#include "config/limits.hpp"
#include "isa/encoding.hpp"
#include "kernel/kernel_report.hpp"

namespace raypool::fit {
namespace {

using Kernels = std::vector<RayKernel>;

const Kernels kKernels = {RayKernel::CastEye, RayKernel::CastSecondary, RayKernel::Shade};

Frame frame_of(int depth, bool reflections) {
  Frame frame;
  frame.depth = depth;
  frame.reflections = reflections;
  frame.materials = 7;
  return frame;
}

const Program& program_of(const Configuration& machine) { return ray_kernel_program(KernelTarget(machine)); }

bool has(const Configuration& configuration, const Kernels& kernels, Opcode opcode) {
  return (operations_of(program_of(configuration), kernels)[alu_of(opcode)] >> operation_of(opcode) & 1) != 0;
}

TEST(Needs, OperationsAreThoseOfTheKernelsProgram) {
  Configuration machine;
  EXPECT_TRUE(has(machine, {RayKernel::Shade}, Opcode::Rfb));
  EXPECT_FALSE(has(machine, {RayKernel::Shade}, Opcode::Fmul));
  EXPECT_TRUE(has(machine, {RayKernel::Shade, RayKernel::CastEye}, Opcode::Fmul));
  EXPECT_FALSE(has(machine, {RayKernel::CastEye}, Opcode::Ffma));
  machine.fma = true;  // another program
  EXPECT_TRUE(has(machine, {RayKernel::CastEye}, Opcode::Ffma));
}

TEST(Needs, WhatNoKernelHasIsLeftOutAndNothingElse) {
  Configuration machine;
  const Frame frame = frame_of(3, false);
  for (const Part& part : parts_of(frame))
    for (const Cut& cut : part(machine))
      if (cut.value.is_array()) machine = with(machine, cut);
  const Kernels kernels = kernels_of(machine.chip, 3, false);
  size_t left_out = 0;
  for (const InstructionInfo& info : kInstructions) {
    if (info.needs != Feature::Optional) continue;
    EXPECT_EQ(machine.has(info), has(machine, kernels, info.opcode)) << info.mnemonic;
    left_out += machine.has(info) ? 0 : 1;
  }
  EXPECT_GT(left_out, 0u);
}

TEST(Needs, AKernelForReflectionsIsLeftOutWhereNothingReflects) {
  for (const auto& [depth, reflections, why] : {std::tuple(3, true, ""), std::tuple(3, false, "no material reflects"),
                                                std::tuple(1, false, "depth 1 casts none")}) {
    std::string found;
    for (const Part& part : parts_of(frame_of(depth, reflections)))
      for (const Cut& cut : part(Configuration()))
        if (cut.field == "chip.reflections") found = cut.why;
    EXPECT_EQ(found, why) << depth;
  }
}

TEST(Needs, CodeIsThatOfAllKernelsTogether) {
  const Program& program = program_of(Configuration());
  const Kernels all = {RayKernel::CastEye, RayKernel::CastSecondary, RayKernel::CastSecondaryDirect, RayKernel::Shade};
  EXPECT_EQ(code_bytes(program, all), 8 * program.code.size());
  EXPECT_EQ(code_bytes(program, {}), 0u);
  EXPECT_LT(code_bytes(program, {RayKernel::Shade}), code_bytes(program, {RayKernel::CastEye}));
}

TEST(Needs, OneWordOfAnIntersectionLessWouldNotDo) {
  Configuration machine;
  const uint32_t words = least_intersection_words(machine);
  machine.intersection_words = words;
  EXPECT_NO_THROW(ray_record_layout(machine));
  --machine.intersection_words;
  EXPECT_THROW(ray_record_layout(machine), InputError);
}

TEST(Needs, SubnormalNumbersAreLeftOutUnlessTheSceneHasOne) {
  for (const bool in_scene : {false, true}) {
    Frame frame = frame_of(3, true);
    frame.subnormal_words = in_scene;
    bool tried = false;
    for (const Part& part : parts_of(frame))
      for (const Cut& cut : part(Configuration()))
        if (cut.field == "arithmetic.subnormals") tried = cut.value == "none";
    EXPECT_EQ(tried, !in_scene);
  }
}

TEST(Needs, NumbersAreTheFewestWithWhichTheKernelsAreAccepted) {
  Configuration machine;
  std::set<std::string> found;
  for (const Part& part : parts_of(frame_of(3, true))) {
    const std::vector<Cut> cuts = part(machine);
    if (cuts.empty() ||
        (cuts.front().field != "registers" && cuts.front().field != "predicates" && cuts.front().field != "arguments"))
      continue;
    const std::string field = cuts.front().field;
    found.insert(field);
    const Configuration least = with(machine, cuts.front());
    const Program& program = program_of(machine);
    EXPECT_NO_THROW(check_instructions(program, "cast_secondary", least)) << field;
    EXPECT_NO_THROW(check_instructions(program, "cast_eye", least)) << field;
    const auto fewer = cuts.front().value.get<int>() - 1;
    if (fewer < (field == "registers" ? 8 : field == "predicates" ? 2 : 4)) continue;
    const Configuration too_few = with(machine, {field, fewer, ""});
    EXPECT_ANY_THROW(for (const char* kernel
                          : {"cast_eye", "cast_secondary"}) check_instructions(program, kernel, too_few))
        << field;
  }
  EXPECT_EQ(found.size(), 3u);
}

TEST(Needs, PcsHoldTheProgramAndCountersALongerFrame) {
  Frame frame = frame_of(3, true);
  frame.drawn.cycles = 100'000;
  for (const Part& part : parts_of(frame)) {
    for (const Cut& cut : part(Configuration())) {
      const Configuration machine = with(Configuration(), cut);
      if (cut.field == "pc_bits") {
        EXPECT_NO_THROW(check_program_length(machine, size32(program_of(machine).code)));
      }
      if (cut.field == "counter_bits") {
        EXPECT_GE(counted_cycles(machine), 64u * 100'000);
      }
    }
  }
  Configuration short_pcs;
  short_pcs.pc_bits = 8;
  EXPECT_THROW(check_program_length(short_pcs, 256), InputError);
  EXPECT_NO_THROW(check_program_length(short_pcs, 255));
}

TEST(Needs, CutsAreLessThanTheMachineHas) {
  Configuration machine;
  machine.lanes = 4;
  for (const Part& part : parts_of(frame_of(3, true))) {
    for (const Cut& cut : part(machine)) {
      EXPECT_NE(to_json(with(machine, cut)), to_json(machine)) << cut.field;
      EXPECT_FALSE(cut.why.empty()) << cut.field;
      EXPECT_TRUE(cut.field != "slow_lanes" || cut.value.get<uint32_t>() < machine.lanes);
    }
  }
}

TEST(Needs, OfAMachineThatHasTheLeastNothingIsTried) {
  Configuration machine;
  machine.stack_depth = 2;
  machine.slow_lanes = 1;
  machine.intersection_words = least_intersection_words(machine);
  machine.instruction_cache_bytes = 512;
  machine.data_cache_bytes = 512;
  machine.data_cache_mshrs = 1;
  machine.subnormals = Subnormals::None;
  machine.counter_bits = 16;
  machine.pc_bits = 9;
  for (const Part& part : parts_of(frame_of(3, true)))
    for (const Cut& cut : part(machine))
      if (cut.field == "registers" || cut.field == "predicates" || cut.field == "arguments") {
        machine = with(machine, cut);
        break;
      }
  for (const AluType type : kEveryAluType)
    machine.alus[type].without = optional_operations(type) & ~operations_of(program_of(machine), kKernels)[type];
  for (const Part& part : parts_of(frame_of(3, true))) {
    const std::vector<Cut> cuts = part(machine);
    EXPECT_TRUE(cuts.empty()) << cuts.front().field;
  }
}

}  // namespace
}  // namespace raypool::fit
