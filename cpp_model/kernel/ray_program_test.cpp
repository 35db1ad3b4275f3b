#include "kernel/ray_program.hpp"

#include <gtest/gtest.h>

#include "isa/input_error.hpp"
#include "kernel/kernel.hpp"
#include "kernel/ray_kernels.hpp"
#include "kernel/record_layout.hpp"

namespace raypool::kernel {
namespace {

std::vector<KernelTarget> every_target() {
  std::vector<KernelTarget> targets;
  for (const bool compact : {false, true})
    for (const bool culls : {false, true})
      for (const bool triples : {false, true})
        for (const bool fma : {false, true}) targets.emplace_back(fma, triples, culls, compact);
  return targets;
}

/// Recorded with the words where the layout has them.
Program recorded_in_place(const KernelTarget& target, const RecordLayout& layout) {
  Program program;
  const auto add = [&](RayKernel which, const auto& body) {
    add_kernel(program, std::string(kRayKernelNames[which]), body, target, layout);
  };
  add(RayKernel::CastEye, [](auto& k) { cast_eye(k); });
  add(RayKernel::CastSecondary, [&](auto& k) { cast_secondary(k, target.compact); });
  add(RayKernel::CastSecondaryDirect, [](auto& k) { cast_secondary_direct(k); });
  add(RayKernel::Shade, [](auto& k) { shade(k); });
  return program;
}

TEST(RayProgram, HasTheInstructionsOfKernelsThatAreRecordedWithTheirWordsInPlace) {
  for (const KernelTarget& target : every_target()) {
    const RayProgram& built_in = built_in_ray_program(target);
    const Program expected = recorded_in_place(target, built_in.layout);
    EXPECT_EQ(built_in.program.code, expected.code);
    EXPECT_EQ(built_in.program.entries, expected.entries);
    EXPECT_EQ(ray_kernel_program(target).code, expected.code);
  }
}

TEST(RayProgram, OfTheBuiltInFunctionsIsTheBuiltInOne) {
  for (const KernelTarget& target : every_target()) {
    const RayProgram& built_in = built_in_ray_program(target);
    const RayProgram again = make_ray_program(built_in.functions, target);
    EXPECT_EQ(again.program.code, built_in.program.code);
    EXPECT_EQ(again.program.entries, built_in.program.entries);
    EXPECT_EQ(again.layout.place, built_in.layout.place);
    EXPECT_EQ(again.layout.words, built_in.layout.words);
  }
}

TEST(RayProgram, KernelsGetTheirNamesWhateverTheyWereCalled) {
  RayFunctions functions = built_in_ray_program().functions;
  for (Function& function : functions) function.name = "main";
  EXPECT_EQ(make_ray_program(functions, {}).program.entries, built_in_ray_program().program.entries);
}

TEST(RayProgram, RunsItsOwnKernelsNatively) {
  RayFunctions functions = built_in_ray_program().functions;
  functions[RayKernel::Shade] = record_kernel("shade", [](auto& k) {
    k.ray_in();
    k.set_word(word::kColor, k.float_word(word::kDistance));
    k.frame_out();
  });
  const RayProgram program = make_ray_program(functions, {});
  std::array<uint32_t, kArguments> arguments{};
  Memory memory(64);
  NativeThread thread;
  thread.arguments = &arguments;
  thread.memory = &memory;
  thread.input[word::kDistance] = as_bits(2.5f);
  program.native(RayKernel::Shade, thread);
  ASSERT_EQ(thread.frame.size(), 1u);
  EXPECT_EQ(thread.frame[0].rgb[0], as_bits(2.5f));
}

TEST(RayProgram, AWordThatTheRecordLacksIsRefusedWithItsLine) {
  Function function = record_kernel("k", [](auto& k) { k.set_word(0, k.int_word(19)); });
  RecordLayout layout;
  layout.place[19] = RecordLayout::kAbsent;
  EXPECT_THROW(place_words(function, layout), InputError);
}

TEST(RayProgram, AMachineWithFewerWordsThanItsKernelsNeedIsRefused) {
  Configuration configuration;
  configuration.intersection_words = 15;
  const RayProgram& program = built_in_ray_program(KernelTarget(configuration));
  EXPECT_THROW(record_layout(program, configuration), InputError);
  configuration.intersection_words = 16;
  EXPECT_EQ(record_layout(program, configuration).words, 16u);
}

}  // namespace
}  // namespace raypool::kernel
