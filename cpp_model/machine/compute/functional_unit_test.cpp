#include "machine/compute/functional_unit.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "bits.hpp"
#include "machine/compute/special_census.hpp"
#include "machine/compute/test_chip.hpp"
#include "machine/compute/test_exports.hpp"
#include "machine/compute/test_program.hpp"

namespace raypool {
namespace {

using test::assembled;
using test::TestChip;

constexpr uint32_t kMemoryBytes = 8192;

struct Fixture {
  Memory memory{kMemoryBytes};
  std::unique_ptr<ComputeUnit> unit;
  TestChip chip;

  explicit Fixture(const std::vector<uint64_t>& code, int ready_percent = 100, uint32_t seed = 1)
      : unit(make_functional_unit(configuration(), memory)), chip(*unit, memory, seed, ready_percent) {
    test::put_program(memory, code);
    unit->reset(size32(code), kMemoryBytes);
  }
  static Configuration configuration() {
    Configuration result;
    result.warps = 2;
    result.lanes = 4;
    return result;
  }
  void launch(uint32_t threads, ImportKind import = ImportKind::None, uint32_t pc = 0) {
    LaunchCommand command;
    command.threads = threads;
    command.import = import;
    command.pc = pc;
    chip.launches.push_back(command);
  }
};

// r1 = word 7 of the package + 1 into word 7, exported as a ray and, from the next
// kernel's point of view, nothing else.
const std::vector<uint64_t> kRayProgram = assembled("rin; rld r1, 7; iadd r1, r1, 1; rst 7, r1; rout; exit");

TEST(FunctionalUnit, KernelsEndInTurnWithOnePulseEach) {
  Fixture fixture(assembled("tid r1; shl r2, r1, 2; st [r2+1024], r1; exit"));
  EXPECT_TRUE(fixture.unit->outputs().idle);
  for (int i = 0; i < 5; ++i) fixture.launch(7);
  EXPECT_TRUE(fixture.chip.run());
  EXPECT_EQ(fixture.chip.kernels_done, 5u);
  for (uint32_t thread = 0; thread < 7; ++thread) EXPECT_EQ(fixture.memory.load(1024 + 4 * thread), thread);
  EXPECT_EQ(fixture.memory.load(1024 + 4 * 7), 0u);
  EXPECT_EQ(fixture.unit->counter(counter::kInstructions), 5u * 2 * 4);
  EXPECT_EQ(fixture.unit->counter(counter::kThreadInstructions), 5u * 7 * 4);
  EXPECT_EQ(fixture.unit->counter(counter::kIssued + static_cast<int>(AluType::Mem)), 5u * 2);
  EXPECT_FALSE(fixture.unit->timed());
}

TEST(FunctionalUnit, ABusyUnitIsNotIdleAndTakesOneLaunchMore) {
  Fixture fixture(assembled("jany 0"));
  fixture.launch(8);
  fixture.launch(8);
  fixture.launch(8);
  for (int i = 0; i < 6; ++i) fixture.chip.cycle();
  EXPECT_EQ(fixture.chip.launches.size(), 1u);
  EXPECT_TRUE(fixture.unit->outputs().busy);
  EXPECT_FALSE(fixture.unit->outputs().idle);
  EXPECT_FALSE(fixture.unit->outputs().launch_ready);
}

TEST(FunctionalUnit, PackagesComeInAndRaysGoOutInOrderWhateverThePortsDo) {
  for (uint32_t seed = 1; seed <= 20; ++seed) {
    Fixture fixture(kRayProgram, seed == 1 ? 100 : 40, seed);
    for (int i = 0; i < 3; ++i) fixture.launch(7, i == 1 ? ImportKind::Shadow : ImportKind::Normal);
    ASSERT_TRUE(fixture.chip.run()) << "seed " << seed;
    ASSERT_EQ(fixture.chip.requests.size(), 21u);
    EXPECT_EQ(fixture.chip.requests[6], ImportKind::Normal);
    EXPECT_EQ(fixture.chip.requests[7], ImportKind::Shadow);
    ASSERT_EQ(fixture.chip.rays.size(), 21u) << "seed " << seed;
    std::vector<uint32_t> pixels;
    for (const Ray& ray : fixture.chip.rays) {
      pixels.push_back(ray[7]);
      EXPECT_EQ(ray[11], ray[7] + 3) << "a ray is 12 words of one package";
    }
    std::sort(pixels.begin(), pixels.end());
    for (uint32_t i = 0; i < 21; ++i) EXPECT_EQ(pixels[i], i * 100 + 8) << "seed " << seed;
  }
}

TEST(FunctionalUnit, TheNextKernelsPackagesComeWhileTheFirstOneWaits) {
  Fixture fixture(kRayProgram);
  fixture.chip.exports_ready = false;
  for (int i = 0; i < 3; ++i) fixture.launch(8, ImportKind::Normal);
  for (int i = 0; i < 400; ++i) fixture.chip.cycle();
  // Kernel 1 has ended with its rays in the output slices, kernel 2 waits in rout, kernel
  // 3's packages fill the input slices.
  EXPECT_EQ(fixture.chip.kernels_done, 1u);
  EXPECT_EQ(fixture.chip.requests.size(), 24u);
  EXPECT_TRUE(fixture.unit->outputs().export_valid);
  const Beat beat = fixture.unit->outputs().export_data;
  fixture.chip.cycle();
  EXPECT_EQ(fixture.unit->outputs().export_data, beat) << "a payload is stable while it waits";
  fixture.chip.exports_ready = true;
  EXPECT_TRUE(fixture.chip.run());
  EXPECT_EQ(fixture.chip.kernels_done, 3u);
  EXPECT_EQ(fixture.chip.rays.size(), 24u);
}

TEST(FunctionalUnit, APackageIsNotRequestedBeforeItsSliceIsFree) {
  Fixture fixture(assembled("jany 0"));
  fixture.launch(8, ImportKind::Normal);
  fixture.launch(8, ImportKind::Normal);
  for (int i = 0; i < 200; ++i) fixture.chip.cycle();
  EXPECT_EQ(fixture.chip.requests.size(), 8u);
  EXPECT_FALSE(fixture.unit->outputs().import_request_valid);
}

TEST(FunctionalUnit, FrameContributionsCarryPixelAndColour) {
  Fixture fixture(assembled("rin; lane r1; ige p1, r1, 2; @p1 rfb; exit"), 50);
  fixture.launch(8, ImportKind::Shadow);
  EXPECT_TRUE(fixture.chip.run());
  ASSERT_EQ(fixture.chip.frame.size(), 4u);
  EXPECT_EQ(fixture.chip.frame[1].pixel, 307u);
  EXPECT_EQ(fixture.chip.frame[1].rgb[2], 310u);
  EXPECT_TRUE(fixture.chip.rays.empty());
}

TEST(FunctionalUnit, CountsTheExportsOfAKernelBeforeItIsDone) {
  const std::vector<uint64_t> code = test::exporting_program();
  for (const bool traced : {false, true}) {
    Fixture fixture(code, 50);
    if (traced) fixture.unit->trace_on();
    for (const bool alone : {true, false}) {
      fixture.unit->reset(size32(code), kMemoryBytes);
      TestChip chip(*fixture.unit, fixture.memory, 1, 50);
      test::expect_exports_counted(*fixture.unit, chip, Fixture::configuration(), alone);
    }
  }
}

TEST(FunctionalUnit, AFaultIsStickyAndStopsEverything) {
  Fixture fixture(assembled("ret"));
  fixture.launch(8);
  EXPECT_FALSE(fixture.chip.run());
  EXPECT_EQ(fixture.unit->outputs().fault.code, FaultCode::StackUnderflow);
  for (int i = 0; i < 10; ++i) fixture.chip.cycle();
  EXPECT_EQ(fixture.unit->outputs().fault.code, FaultCode::StackUnderflow);
  EXPECT_FALSE(fixture.unit->outputs().launch_ready);
  fixture.unit->reset(1, kMemoryBytes);
  EXPECT_EQ(fixture.unit->outputs().fault.code, FaultCode::None);
  EXPECT_TRUE(fixture.unit->outputs().idle);
}

TEST(FunctionalUnit, ASubnormalNumberStopsAMachineThatHasNone) {
  Configuration configuration;
  configuration.subnormals = Subnormals::None;
  Memory memory(kMemoryBytes);
  const std::vector<uint64_t> code =
      assembled("lane r1; ige p1, r1, 8; mov r2, 1.0; @p1 fadd r3, r2, 1e-39; fadd r3, r2, 1e-39; exit");
  test::put_program(memory, code);
  const std::unique_ptr<ComputeUnit> unit = make_functional_unit(configuration, memory);
  unit->reset(size32(code), kMemoryBytes);
  TestChip chip(*unit, memory);
  LaunchCommand command;
  command.threads = 8;
  chip.launches.push_back(command);
  EXPECT_FALSE(chip.run());
  EXPECT_EQ(unit->outputs().fault.code, FaultCode::SubnormalNumber);
  EXPECT_EQ(unit->outputs().fault.pc, 4u) << "no lane of the one before is active";
}

TEST(FunctionalUnit, InfinitiesAndNansAreCountedWhereTheyAriseAndWhereTheyAreRead) {
  const std::vector<uint64_t> code = assembled(
      "lane r1; ige p1, r1, 8; mov r2, 0; mov r3, 0; @p1 frcp r3, r2; frcp r3, r2; fsub r3, r3, r3; fgt p2, r3, r2; "
      "f2i r4, r3; fmin r3, r3, r2; i2f r4, r3; fdiv r4, r2, r2; iadd r4, r4, r4; exit");
  Memory memory(kMemoryBytes);
  test::put_program(memory, code);
  SpecialCensus census(arith::Mode{});
  const std::unique_ptr<ComputeUnit> unit = make_counting_functional_unit({}, memory, census);
  unit->reset(size32(code), kMemoryBytes);
  TestChip chip(*unit, memory);
  LaunchCommand command;
  command.threads = 8;
  chip.launches.push_back(command);
  ASSERT_TRUE(chip.run());
  const auto at = [&](uint32_t pc) {
    const SpecialCounts counts = pc < census.counts().size() ? census.counts()[pc] : SpecialCounts{};
    return std::vector<uint64_t>{counts.executed, counts.infinite_operands, counts.infinite_results,
                                 counts.nan_operands, counts.nan_results};
  };
  using Row = std::vector<uint64_t>;
  EXPECT_EQ(at(4), (Row{0, 0, 0, 0, 0})) << "in no lane of its mask";
  EXPECT_EQ(at(5), (Row{8, 0, 8, 0, 0})) << "frcp of 0";
  EXPECT_EQ(at(6), (Row{8, 8, 0, 0, 8})) << "infinity less itself, which it overwrites";
  EXPECT_EQ(at(7), (Row{8, 0, 0, 8, 0})) << "a compare gives no float";
  EXPECT_EQ(at(8), (Row{8, 0, 0, 8, 0})) << "nor does f2i";
  EXPECT_EQ(at(9), (Row{8, 0, 0, 8, 0})) << "the other operand is a number";
  EXPECT_EQ(at(10), (Row{0, 0, 0, 0, 0})) << "i2f reads no float";
  EXPECT_EQ(at(11), (Row{8, 0, 0, 0, 8})) << "0 / 0";
  EXPECT_EQ(at(12), (Row{0, 0, 0, 0, 0})) << "an integer addition of the same bits";
}

TEST(FunctionalUnit, InfinitiesAreThoseOfTheSignificand) {
  Configuration configuration;
  configuration.significand = 13;
  const std::vector<uint64_t> code =
      assembled("mov r1, 0x7f800001; fadd r2, r1, 0.0; mov r1, 0x7f801000; fadd r2, r1, 0.0; exit");
  Memory memory(kMemoryBytes);
  test::put_program(memory, code);
  SpecialCensus census(arith::mode_of(configuration));
  const std::unique_ptr<ComputeUnit> unit = make_counting_functional_unit(configuration, memory, census);
  unit->reset(size32(code), kMemoryBytes);
  TestChip chip(*unit, memory);
  LaunchCommand command;
  command.threads = 1;
  chip.launches.push_back(command);
  ASSERT_TRUE(chip.run());
  EXPECT_EQ(census.counts().at(1).infinite_operands, 1u) << "its one lies below the significand";
  EXPECT_EQ(census.counts().at(1).nan_operands, 0u);
  EXPECT_EQ(census.counts().at(3).nan_operands, 1u);
}

TEST(FunctionalUnit, TheTraceShowsAtMostOneInstructionOfAWarpInACycle) {
  Fixture fixture(assembled("tid r1; shl r2, r1, 2; st [r2+1024], r1; rst 3, r1; exit"));
  fixture.unit->trace_on();
  fixture.launch(8);
  size_t retired = 0, stores = 0, ray_writes = 0;
  for (int i = 0; i < 10; ++i) {
    fixture.chip.cycle();
    const UnitTrace& trace = fixture.unit->trace();
    EXPECT_LE(trace.retired.size(), 2u);
    retired += trace.retired.size();
    stores += trace.stores.size();
    ray_writes += trace.ray_writes.size();
  }
  EXPECT_EQ(retired, 10u);
  EXPECT_EQ(stores, 2u);
  EXPECT_EQ(ray_writes, 2u);
}

TEST(FunctionalUnit, WritesNoWaveform) {
  Fixture fixture(assembled("exit"));
  EXPECT_THROW(fixture.unit->open_waveform("waves.fst"), std::runtime_error);
}

}  // namespace
}  // namespace raypool
