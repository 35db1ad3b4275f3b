// rtl/compute/rp_multiprocessor.v against its C++ counterpart: the Verilated multiprocessor of n units and a
// Multiprocessor over n Verilated single units are given the same inputs, and must show the same outputs in every
// cycle.
#include "machine/compute/multiprocessor.hpp"

#include <gtest/gtest.h>

#include <iostream>
#include <numeric>
#include <random>

#include "bits.hpp"
#include "cosim/cosim.hpp"
#include "cosim/random_program.hpp"
#include "lockstep/rtl_loader.hpp"
#include "machine/compute/test_chip.hpp"
#include "machine/compute/test_program.hpp"
#include "rtl/compared_device.hpp"
#include "rtl/test_library.hpp"

namespace raypool {
namespace {

using test::assembled;
using test::ComparedDevice;

Configuration configuration() {
  Configuration result;
  result.name = "2w2c_small";
  result.warps = result.lanes = 2;
  result.instruction_cache_bytes = result.data_cache_bytes = 512;
  result.data_cache_mshrs = 2;
  return result;
}

class RtlMultiprocessor : public testing::TestWithParam<int> {
 protected:
  void SetUp() override {
    single_ = test::build_library(configuration());
    several_ = test::build_library(configuration(), GetParam());
  }

  std::unique_ptr<ComparedDevice> device() const {
    std::vector<std::unique_ptr<ComputeUnit>> units;
    for (int i = 0; i < GetParam(); ++i) units.push_back(load_rtl_unit(single_, configuration()));
    return std::make_unique<ComparedDevice>(
        load_rtl_unit(several_, configuration(), GetParam()),
        make_multiprocessor(std::move(units), static_cast<int>(configuration().intersection_beats())));
  }

  std::string single_, several_;
};

uint64_t sum(const std::array<uint64_t, kMostUnits>& counts) {
  return std::accumulate(counts.begin(), counts.end(), uint64_t{0});
}

TEST_P(RtlMultiprocessor, AgreesWithTheArbitersInCppInEveryCycleOfRandomPrograms) {
  const size_t units = GetParam();
  test::PortCounts total;
  uint64_t cycles = 0, kernels = 0;
  const auto add = [&](auto& to, const auto& from) {
    for (size_t u = 0; u < kMostUnits; ++u) to[u] += from[u];
  };
  for (uint64_t seed = 1; seed <= 150; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    RandomProgram program = make_random_program(configuration(), seed, 60);
    if (program.faults != 0) continue;  // it would be reset before its last kernel
    program.restart = 0;                // what is counted below is counted from one reset on
    std::mt19937_64 random(seed);
    const size_t distinct = program.kernels.size();
    for (size_t i = random() % (6 * units); i > 0; --i) {
      RandomProgram::Kernel kernel = program.kernels[random() % distinct];
      kernel.threads = 1 + static_cast<uint32_t>(random() % configuration().contents());
      program.kernels.push_back(kernel);
    }
    Memory memory = program.memory;
    const std::unique_ptr<ComparedDevice> compared = device();
    try {
      run_random_program(*compared, memory, program, seed);
      for (int i = 0; i < counter::kCount; ++i) compared->counter(i);
    } catch (const std::exception& error) {
      FAIL() << error.what();
    }
    const test::PortCounts& counts = compared->counts;
    EXPECT_EQ(sum(counts.launches), program.kernels.size());
    EXPECT_EQ(sum(counts.kernels), program.kernels.size());
    EXPECT_EQ(sum(counts.retired), compared->counter(counter::kInstructions));
    kernels += program.kernels.size();
    cycles += compared->cycles;
    add(total.launches, counts.launches), add(total.reads, counts.reads), add(total.writes, counts.writes);
    add(total.imports, counts.imports), add(total.rays, counts.rays), add(total.contributions, counts.contributions);
    add(total.retired, counts.retired);
  }
  std::cout << units << " units: " << kernels << " kernels, " << cycles << " cycles, " << sum(total.retired)
            << " instructions, " << sum(total.reads) << " reads, " << sum(total.writes) << " writes, "
            << sum(total.imports) << " imports, " << sum(total.rays) << " rays, " << sum(total.contributions)
            << " contributions; 0 differences\n";
  for (size_t u = 0; u < units; ++u) {
    EXPECT_GT(total.launches[u], kernels / units / 2) << "unit " << u;
    EXPECT_GT(total.reads[u], 500u) << "unit " << u;
    EXPECT_GT(total.writes[u], 100u) << "unit " << u;
    EXPECT_GT(total.imports[u], 20u) << "unit " << u;
    EXPECT_GT(total.rays[u], 10u) << "unit " << u;
    EXPECT_GT(total.contributions[u], 10u) << "unit " << u;
  }
}

TEST_P(RtlMultiprocessor, AgreesWhenEveryUnitWantsThePoolsAllTheTime) {
  const std::vector<uint64_t> code = assembled(R"(
      rin
      rld r1, 7
      rst 8, r1
      rout
      rst 7, r1
      rfb
      rst 11, r1
      rout
      exit)");
  for (const int ready_percent : {100, 70, 25}) {
    SCOPED_TRACE(testing::Message() << ready_percent << "% ready");
    Memory memory(8192);
    test::put_program(memory, code);
    const std::unique_ptr<ComparedDevice> compared = device();
    compared->reset(size32(code), memory.size());
    test::TestChip chip(*compared, memory, 1, ready_percent);
    const int launches = 60 * GetParam();
    for (int i = 0; i < launches; ++i) {
      LaunchCommand command;
      command.threads = 4;
      command.import = i % 3 == 0 ? ImportKind::Shadow : ImportKind::Normal;
      chip.launches.push_back(command);
    }
    try {
      ASSERT_TRUE(chip.run(200000));
    } catch (const std::exception& error) {
      FAIL() << error.what();
    }
    const test::PortCounts& counts = compared->counts;
    EXPECT_EQ(chip.kernels_done, static_cast<uint64_t>(launches));
    for (size_t u = 0; u < static_cast<size_t>(GetParam()); ++u) {
      EXPECT_EQ(counts.rays[u], 2 * 4 * counts.launches[u]);
      EXPECT_EQ(counts.contributions[u], 4 * counts.launches[u]);
      EXPECT_EQ(counts.imports[u], 4 * counts.launches[u]);
      EXPECT_GT(counts.launches[u], 40u);
    }
    std::cout << GetParam() << " units, ports " << ready_percent << "% ready: " << chip.rays.size() << " rays, "
              << chip.frame.size() << " contributions in " << compared->cycles << " cycles; 0 differences\n";
  }
}

TEST_P(RtlMultiprocessor, ShowsTheFirstFaultAndItsUnit) {
  // The block word is an address: 0 is good, 2 misaligned.
  const std::vector<uint64_t> code = assembled("block r1; ld r2, [r1]; exit");
  for (int faulty = 0; faulty < GetParam(); ++faulty) {
    SCOPED_TRACE(testing::Message() << "unit " << faulty);
    Memory memory(8192);
    test::put_program(memory, code);
    const std::unique_ptr<ComparedDevice> compared = device();
    compared->reset(size32(code), memory.size());
    test::TestChip chip(*compared, memory);
    for (int i = 0; i < GetParam(); ++i) {
      LaunchCommand command;
      command.threads = 1;
      command.block = i == faulty ? 2 : 0;
      chip.launches.push_back(command);
    }
    EXPECT_FALSE(chip.run(2000));
    EXPECT_EQ(compared->outputs().fault.code, FaultCode::Misaligned);
    EXPECT_EQ(compared->outputs().fault.unit, static_cast<uint32_t>(faulty));
    EXPECT_EQ(compared->outputs().fault.pc, 1u);
    // A later fault of another unit changes nothing.
    for (int i = 0; i < 8; ++i) {
      LaunchCommand command;
      command.threads = 1;
      command.block = 2;
      chip.launches.push_back(command);
    }
    for (int i = 0; i < 2000; ++i) chip.cycle();
    EXPECT_EQ(compared->outputs().fault.unit, static_cast<uint32_t>(faulty));
  }
}

INSTANTIATE_TEST_SUITE_P(Units, RtlMultiprocessor, testing::Values(2, 4),
                         [](const auto& units) { return std::to_string(units.param) + "units"; });

TEST(RtlMultiprocessorLibrary, IsRefusedForAnotherNumberOfUnits) {
  const std::string library = test::build_library(configuration(), 2);
  EXPECT_EQ(load_rtl_unit(library, configuration(), 2)->units(), 2u);
  try {
    load_rtl_unit(library, configuration(), 4);
    FAIL() << "it was loaded";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("UNITS=2"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace raypool
