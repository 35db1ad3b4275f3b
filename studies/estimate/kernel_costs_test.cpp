#include "estimate/kernel_costs.hpp"

#include <gtest/gtest.h>

#include "kernel/kernel_report.hpp"
#include "kernel/kernels.hpp"
#include "kernel/target.hpp"

namespace raypool::estimate {
namespace {

KernelCosts costs_on(const Configuration& configuration, RayKernel kernel) {
  return costs_of(ray_kernel_program(KernelTarget(configuration)), kRayKernelNames[kernel], configuration);
}

TEST(KernelCosts, DivideAKernelWhereItExchangesPackages) {
  const Configuration configuration;
  const auto exchanges = [&](RayKernel kernel) { return costs_on(configuration, kernel).exchanges; };
  using E = Exchange;
  EXPECT_EQ(exchanges(RayKernel::CastEye), (std::vector{E::ExportRays, E::End}));
  EXPECT_EQ(exchanges(RayKernel::CastSecondary), (std::vector{E::Import, E::ExportRays, E::ExportRays, E::End}));
  EXPECT_EQ(exchanges(RayKernel::CastSecondaryDirect), (std::vector{E::Import, E::ExportRays, E::End}));
  EXPECT_EQ(exchanges(RayKernel::Shade), (std::vector{E::Import, E::Contribute, E::End}));
}

TEST(KernelCosts, CountEveryInstructionOnce) {
  const Configuration configuration;
  const Program& program = ray_kernel_program(KernelTarget(configuration));
  for (size_t i = 0; i < kRayKernels; ++i) {
    const InstructionCounts counts = count_instructions(program, std::string(kRayKernelNames[i]));
    const KernelCosts costs = costs_on(configuration, static_cast<RayKernel>(i));
    for (size_t type = 0; type < kAluTypes; ++type) {
      double tasks = 0;
      for (const Segment& segment : costs.segments) tasks += segment.tasks[type];
      EXPECT_EQ(tasks, counts[type]) << kRayKernelNames[i] << ", " << kAluNames[type];
    }
  }
}

TEST(KernelCosts, GrowWithTheDepthOfAnAluAndTheLanesOfAnAccess) {
  Configuration configuration;
  const auto serial = [&] { return costs_on(configuration, RayKernel::CastSecondary).segments[1].serial; };
  const double before = serial();
  const double flt = costs_on(configuration, RayKernel::CastSecondary).segments[1].tasks[AluType::Flt];
  ++configuration.alus[AluType::Flt].depth;
  EXPECT_EQ(serial(), before + flt);
  --configuration.alus[AluType::Flt].depth;
  configuration.lanes = 16;
  EXPECT_GT(serial(), before);
}

}  // namespace
}  // namespace raypool::estimate
