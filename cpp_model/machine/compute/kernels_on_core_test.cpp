// The compiled kernels on the functional core, of several sizes: rays, contributions and memory
// are those of the kernels run as C++.
#include <gtest/gtest.h>

#include "bits.hpp"
#include "kernel/compute_kernels.hpp"
#include "kernel/kernels.hpp"
#include "machine/compute/functional_core.hpp"
#include "machine/compute/test_program.hpp"
#include "random.hpp"

namespace raypool {
namespace {

constexpr uint32_t kMemoryBytes = 32768;
constexpr uint32_t kMaterial = 16384;

const char* const kConfigurations[] = {"1w1c", "8w8c", "2w32c", "32w2c", "4w16c"};

struct Result {
  std::vector<std::vector<Ray>> rays;  // [thread]
  std::vector<std::vector<FrameContribution>> frame;
};

/// Runs one block until it has ended; every warp in turn, one instruction.
Result run(FunctionalCore& core, const LaunchCommand& command, const std::vector<Intersection>& packages) {
  Result result;
  result.rays.resize(command.threads);
  result.frame.resize(command.threads);
  core.launch(command);
  if (command.import != ImportKind::None) {
    core.expect_import(command.threads);
    for (const Intersection& package : packages) core.import_package(package);
  }
  for (int turn = 0; core.running() && turn < 100000; ++turn) {
    for (uint32_t warp = 0; warp < core.warps(); ++warp) {
      const Step& step = core.step(warp);
      if (step.status == Step::Status::Fault) {
        ADD_FAILURE() << "fault " << to_underlying(step.fault.code) << " at " << step.fault.pc;
        return result;
      }
      uint32_t ray = 0, contribution = 0;
      for (uint32_t lane = 0; lane < core.lanes(); ++lane) {
        if ((step.mask >> lane & 1) == 0 || step.status != Step::Status::Executed) continue;
        const uint32_t thread = warp * core.lanes() + lane;
        if (ray < step.ray_count) result.rays[thread].push_back(step.rays[ray++]);
        if (contribution < step.frame_count) result.frame[thread].push_back(step.frame[contribution++]);
      }
    }
  }
  EXPECT_FALSE(core.running());
  return result;
}

// One of 16 modes of arithmetic, on some with triples, on some with compact records.
Configuration configuration_in_mode(const char* name, int mode) {
  Configuration configuration = load_configuration(name);
  configuration.subnormals = static_cast<Subnormals>(mode & 1);
  configuration.slow_unit = static_cast<SlowUnit>(mode >> 1 & 3);
  configuration.fma = mode >= 8;
  configuration.triples = mode % 2 == 1;
  if (mode % 3 == 2) configuration.intersection_words = 16;
  configuration.chip.culling = mode % 3 == 0;
  return configuration;
}

TEST(KernelsOnCore, RayKernelsLeaveWhatTheyLeaveNatively) {
  for (const char* name : kConfigurations) {
    for (int mode = 0; mode < 16; ++mode) {
      SCOPED_TRACE(std::string(name) + " mode " + std::to_string(mode));
      const Configuration configuration = configuration_in_mode(name, mode);
      Random random(static_cast<uint32_t>(mode) + 1);
      const auto number = [&] { return as_bits((static_cast<int>(random() % 4001) - 2000) / 512.0f); };

      Memory memory(kMemoryBytes);
      const Program& program = ray_kernel_program(KernelTarget(configuration));
      const RecordLayout layout = ray_record_layout(configuration);
      test::put_program(memory, program.code);
      for (uint32_t i = 0; i < 8; ++i) memory.store(kMaterial + 4 * i, number());
      FunctionalCore core(configuration, memory);
      core.reset(size32(program.code), kMemoryBytes);
      std::array<uint32_t, kArguments> arguments{};
      for (uint32_t& word : arguments) word = number();
      arguments[argument::kTileWidthLog2] = 3;
      arguments[argument::kTileMask] = 7;
      arguments[argument::kWidth] = 30;
      arguments[argument::kHeight] = 20;
      for (int i = 0; i < kArguments; ++i) core.set_argument(i, arguments[i]);

      for (int kernel = 0; kernel < kRayKernels; ++kernel) {
        const auto which = static_cast<RayKernel>(kernel);
        LaunchCommand command;
        command.pc = program.entries.at(std::string(kRayKernelNames[kernel]));
        command.threads =
            std::max(1u, configuration.contents() - std::min<uint32_t>(configuration.contents(), mode % 8));
        command.block = 24u | 16u << 16;
        if (which != RayKernel::CastEye)
          command.import = which == RayKernel::Shade ? ImportKind::Shadow : ImportKind::Normal;
        std::vector<Intersection> packages(command.threads);
        for (Intersection& package : packages) {
          for (uint32_t& word : package) word = number();
          package[word::kFlags] = random() % 8;
          package[word::kMaterial] = kMaterial;
          // What a compact record lacks.
          if (layout.words < kIntersectionWords)
            package[word::kLimit] = as_bits(std::numeric_limits<float>::infinity());
        }
        std::vector<Intersection> records;
        for (const Intersection& package : packages) records.push_back(packed(package, layout));
        const Result result = run(core, command, records);
        for (uint32_t t = 0; t < command.threads; ++t) {
          NativeThread thread;
          thread.thread = t;
          thread.block = command.block;
          thread.threads = command.threads;
          thread.arguments = &arguments;
          thread.memory = &memory;
          thread.mode = arith::mode_of(configuration);
          thread.culling = configuration.chip.culling;
          thread.input = packages[t];
          run_native(which, thread);
          ASSERT_EQ(result.rays[t], thread.rays) << kRayKernelNames[kernel] << ", thread " << t;
          ASSERT_EQ(result.frame[t].size(), thread.frame.size());
          for (size_t i = 0; i < thread.frame.size(); ++i) {
            ASSERT_EQ(result.frame[t][i].pixel, thread.frame[i].pixel);
            ASSERT_EQ(result.frame[t][i].rgb, thread.frame[i].rgb);
          }
        }
      }
    }
  }
}

TEST(KernelsOnCore, ComputeKernelsLeaveTheMemoryTheyLeaveNatively) {
  for (const char* name : kConfigurations) {
    for (const ComputeKernel which : {ComputeKernel::Saxpy, ComputeKernel::Matmul}) {
      const std::string kernel(kComputeKernelNames[which]);
      SCOPED_TRACE(name + (" " + kernel));
      Configuration configuration = load_configuration(name);
      configuration.fma = configuration.warps == 4;
      const Program& program = compute_kernel_program(KernelTarget(configuration));
      Memory memory(kMemoryBytes);
      test::put_program(memory, program.code);
      for (uint32_t address = 4096; address < kMemoryBytes; address += 4) {
        memory.store(address, as_bits((address % 977) / 16.0f));
      }
      Memory native = memory;
      const std::array<uint32_t, kArguments> arguments =
          which == ComputeKernel::Saxpy ? std::array<uint32_t, kArguments>{300, as_bits(1.5f), 4096, 8192}
                                        : std::array<uint32_t, kArguments>{11, 4096, 8192, 12288};
      FunctionalCore core(configuration, memory);
      core.reset(size32(program.code), kMemoryBytes);
      for (int i = 0; i < kArguments; ++i) core.set_argument(i, arguments[i]);
      LaunchCommand command;
      command.pc = program.entries.at(kernel);
      command.threads = configuration.contents();
      command.blocks = 3;
      for (command.block = 0; command.block < command.blocks; ++command.block) {
        run(core, command, {});
        for (uint32_t t = 0; t < command.threads; ++t) {
          NativeThread thread;
          thread.thread = t;
          thread.block = command.block;
          thread.threads = command.threads;
          thread.blocks = command.blocks;
          thread.arguments = &arguments;
          thread.memory = &native;
          thread.mode = arith::mode_of(configuration);
          run_native(which, thread);
        }
      }
      for (uint32_t address = 0; address < kMemoryBytes; address += 4)
        ASSERT_EQ(memory.load(address), native.load(address)) << address;
    }
  }
}

}  // namespace
}  // namespace raypool
