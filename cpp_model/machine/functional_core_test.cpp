#include "machine/functional_core.hpp"

#include <gtest/gtest.h>

#include <map>

#include "bits.hpp"
#include "machine/test_program.hpp"

namespace raypool {
namespace {

using test::Encode;
using Status = Step::Status;

constexpr uint32_t kMemoryBytes = 4096;

Configuration make_configuration(int warps = 2, int lanes = 4, int stack_depth = 4) {
  Configuration configuration;
  configuration.warps = warps;
  configuration.lanes = lanes;
  configuration.stack_depth = stack_depth;
  return configuration;
}

struct Machine {
  Memory memory{kMemoryBytes};
  FunctionalCore core;

  explicit Machine(const std::vector<uint64_t>& code, const Configuration& configuration = make_configuration(),
                   uint32_t threads = 0)
      : core(configuration, memory) {
    test::put_program(memory, code);
    core.reset(static_cast<uint32_t>(code.size()), kMemoryBytes);
    LaunchCommand command;
    command.threads = threads == 0 ? static_cast<uint32_t>(configuration.contents()) : threads;
    command.block = 77;
    command.blocks = 5;
    core.launch(command);
  }
  // Runs a warp until it cannot go on; returns the last status.
  Status run(uint32_t warp = 0, int limit = 1000) {
    for (int i = 0; i < limit; ++i) {
      const Step& step = core.step(warp);
      if (step.status != Status::Executed) return step.status;
    }
    ADD_FAILURE() << "the program does not end";
    return Status::Executed;
  }
  uint32_t reg(uint32_t warp, uint32_t number, uint32_t lane) const { return core.register_row(warp, number)[lane]; }
};

Encode mov(uint64_t rd, uint32_t value) { return Encode("mov").rd(rd).imm(value); }

// Result of `mnemonic r3, r1, r2`, with r1 = a and r2 = b; once more with b as the immediate.
uint32_t binary(std::string_view mnemonic, uint32_t a, uint32_t b) {
  Machine machine(
      {mov(1, a), mov(2, b), Encode(mnemonic).rd(3).ra(1).rb(2), Encode(mnemonic).rd(4).ra(1).imm(b), Encode("exit")});
  EXPECT_EQ(machine.run(), Status::NotRunning);
  EXPECT_EQ(machine.reg(0, 3, 0), machine.reg(0, 4, 3)) << mnemonic;
  return machine.reg(0, 3, 2);
}

bool compares(std::string_view mnemonic, uint32_t a, uint32_t b) {
  Machine machine(
      {mov(1, a), mov(2, b), Encode(mnemonic).rd(3).ra(1).rb(2), Encode(mnemonic).rd(4).ra(1).imm(b), Encode("exit")});
  EXPECT_EQ(machine.run(), Status::NotRunning);
  EXPECT_EQ(machine.core.predicate(0, 3), machine.core.predicate(0, 4)) << mnemonic;
  EXPECT_TRUE(machine.core.predicate(0, 3) == 0 || machine.core.predicate(0, 3) == 15) << mnemonic;
  return machine.core.predicate(0, 3) != 0;
}

TEST(FunctionalCore, IntegerInstructionsComputeWhatTheTableSays) {
  const uint32_t minus3 = static_cast<uint32_t>(-3);
  EXPECT_EQ(binary("mov", 1, 9), 9u);
  EXPECT_EQ(binary("iadd", 0xffffffffu, 2), 1u);
  EXPECT_EQ(binary("isub", 2, 5), minus3);
  EXPECT_EQ(binary("imul", minus3, 7), static_cast<uint32_t>(-21));
  EXPECT_EQ(binary("and", 12, 10), 8u);
  EXPECT_EQ(binary("or", 12, 10), 14u);
  EXPECT_EQ(binary("xor", 12, 10), 6u);
  EXPECT_EQ(binary("shl", 3, 33), 6u);
  EXPECT_EQ(binary("shr", 0x80000000u, 31), 1u);
  EXPECT_EQ(binary("sar", 0x80000000u, 31), 0xffffffffu);
  EXPECT_EQ(binary("imin", minus3, 7), minus3);
  EXPECT_EQ(binary("imax", minus3, 7), 7u);
  EXPECT_EQ(binary("umin", minus3, 7), 7u);
  EXPECT_EQ(binary("umax", minus3, 7), minus3);
}

TEST(FunctionalCore, FloatInstructionsComputeWhatTheTableSays) {
  const uint32_t three = as_bits(3), half = as_bits(0.5f);
  EXPECT_EQ(binary("fadd", three, half), as_bits(3.5f));
  EXPECT_EQ(binary("fsub", three, half), as_bits(2.5f));
  EXPECT_EQ(binary("fmul", three, half), as_bits(1.5f));
  EXPECT_EQ(binary("fmin", three, half), half);
  EXPECT_EQ(binary("fmax", three, half), three);
  EXPECT_EQ(binary("fdiv", three, half), as_bits(6));
  EXPECT_EQ(binary("f2i", as_bits(-2.75f), 0), static_cast<uint32_t>(-2));
  EXPECT_EQ(binary("i2f", static_cast<uint32_t>(-2), 0), as_bits(-2));
  EXPECT_EQ(binary("fsqrt", as_bits(9), 0), three);
  EXPECT_EQ(binary("frsqrt", as_bits(4), 0), half);
  EXPECT_EQ(binary("frcp", as_bits(2), 0), half);
}

TEST(FunctionalCore, ComparesGiveWhatTheTableSays) {
  struct Row {
    const char* mnemonic;
    bool less, equal, greater;  // for (1, 2), (2, 2), (2, 1)
  };
  for (const Row& row : {Row{"ieq", false, true, false},
                         {"ine", true, false, true},
                         {"ilt", true, false, false},
                         {"ile", true, true, false},
                         {"igt", false, false, true},
                         {"ige", false, true, true},
                         {"ult", true, false, false},
                         {"ule", true, true, false},
                         {"ugt", false, false, true},
                         {"uge", false, true, true}}) {
    EXPECT_EQ(compares(row.mnemonic, 1, 2), row.less) << row.mnemonic;
    EXPECT_EQ(compares(row.mnemonic, 2, 2), row.equal) << row.mnemonic;
    EXPECT_EQ(compares(row.mnemonic, 2, 1), row.greater) << row.mnemonic;
  }
  EXPECT_TRUE(compares("ilt", 0xffffffffu, 0));
  EXPECT_FALSE(compares("ult", 0xffffffffu, 0));
  const uint32_t one = as_bits(1), two = as_bits(2), nan = 0x7fc00000u;
  for (const Row& row : {Row{"feq", false, true, false},
                         {"fne", true, false, true},
                         {"flt", true, false, false},
                         {"fle", true, true, false},
                         {"fgt", false, false, true},
                         {"fge", false, true, true}}) {
    EXPECT_EQ(compares(row.mnemonic, one, two), row.less) << row.mnemonic;
    EXPECT_EQ(compares(row.mnemonic, two, two), row.equal) << row.mnemonic;
    EXPECT_EQ(compares(row.mnemonic, two, one), row.greater) << row.mnemonic;
    EXPECT_EQ(compares(row.mnemonic, nan, one), std::string_view(row.mnemonic) == "fne") << row.mnemonic;
  }
}

TEST(FunctionalCore, IndicesDimensionsAndArgumentsAreThoseOfTheLaunch) {
  Machine machine({Encode("tid").rd(1), Encode("lane").rd(2), Encode("warp").rd(3), Encode("block").rd(4),
                   Encode("threads").rd(5), Encode("blocks").rd(6), Encode("arg").rd(7).plain_imm(31), Encode("exit")},
                  make_configuration(), 7);
  machine.core.set_argument(31, 1234);
  machine.run(0);
  machine.run(1);
  const std::array<uint32_t, 7> expected = {6, 2, 1, 77, 7, 5, 1234};
  for (uint32_t i = 0; i < 7; ++i) EXPECT_EQ(machine.reg(1, i + 1, 2), expected[i]) << i;
}

TEST(FunctionalCore, LanesBeyondTheLaunchAreNeverActiveAndTheirWarpsNeverStart) {
  Machine machine({mov(1, 5), Encode("ieq").rd(1).ra(1).imm(5), Encode("exit")}, make_configuration(4, 4), 6);
  EXPECT_FALSE(machine.core.warp_running(2));
  EXPECT_EQ(machine.core.step(2).status, Status::NotRunning);
  const Step& step = machine.core.step(1);
  EXPECT_EQ(step.mask, 3u);
  EXPECT_EQ(machine.reg(1, 1, 1), 5u);
  EXPECT_EQ(machine.reg(1, 1, 2), 0u);
  machine.run(1);
  EXPECT_EQ(machine.core.predicate(1, 1), 3u);
  EXPECT_TRUE(machine.core.running());
  machine.run(0);
  EXPECT_FALSE(machine.core.running());
}

TEST(FunctionalCore, AGuardedCompareGivesResultAndMaskInAllLanesSoThatConditionsNest) {
  Machine machine({Encode("lane").rd(1), Encode("ige").rd(1).ra(1).imm(1),                // p1 = lanes 1 2 3
                   Encode("ieq").rd(2).ra(1).imm(0),                                      // p2 = lane 0
                   Encode("ilt").guard(1).rd(2).ra(1).imm(3),                             // p2 = lanes 1 2; lane 0 is cleared
                   Encode("iadd").guard(2).rd(2).ra(1).imm(100),                          // r2 in lanes 1 2
                   Encode("iadd").guard(2, true).rd(2).ra(1).imm(200), Encode("exit")});  // r2 in lanes 0 3
  machine.run();
  EXPECT_EQ(machine.core.predicate(0, 1), 14u);
  EXPECT_EQ(machine.core.predicate(0, 2), 6u);
  EXPECT_EQ(machine.reg(0, 2, 0), 200u);
  EXPECT_EQ(machine.reg(0, 2, 1), 101u);
  EXPECT_EQ(machine.reg(0, 2, 2), 102u);
  EXPECT_EQ(machine.reg(0, 2, 3), 203u);
}

TEST(FunctionalCore, PredicateLogicAndSelectUseTheTwoSources) {
  Machine machine({Encode("lane").rd(1), Encode("and").rd(2).ra(1).imm(1), Encode("ine").rd(1).ra(2).imm(0),  // p1 = 1010
                   Encode("ige").rd(2).ra(1).imm(2),                                                          // p2 = 1100
                   Encode("pand").rd(3).x(1).rb(2), Encode("por").rd(4).x(1).rb(2), Encode("pxor").rd(5).x(1).rb(2),
                   Encode("pandn").rd(6).x(1).rb(2), Encode("sel").rd(3).x(2).ra(1).imm(50), Encode("exit")});
  machine.run();
  EXPECT_EQ(machine.core.predicate(0, 3), 8u);
  EXPECT_EQ(machine.core.predicate(0, 4), 14u);
  EXPECT_EQ(machine.core.predicate(0, 5), 6u);
  EXPECT_EQ(machine.core.predicate(0, 6), 2u);
  EXPECT_EQ(machine.reg(0, 3, 1), 50u);
  EXPECT_EQ(machine.reg(0, 3, 3), 3u);
}

TEST(FunctionalCore, PredicateZeroReadsAsOnesAndIsNeverWritten) {
  Machine machine({Encode("lane").rd(1), Encode("ilt").rd(0).ra(1).imm(0), mov(2, 9), Encode("exit")});
  machine.core.step(0);
  const Step& step = machine.core.step(0);
  EXPECT_EQ(step.predicate, 0u);
  machine.run();
  EXPECT_EQ(machine.reg(0, 2, 3), 9u);
}

TEST(FunctionalCore, JumpsLookAtTheMaskedLanes) {
  Machine machine({Encode("lane").rd(1), Encode("igt").rd(1).ra(1).imm(7),  // p1 = none
                   Encode("jany").guard(1).target(6),                       // not taken
                   Encode("jnone").guard(1).target(5),                      // taken
                   mov(2, 1),                                               // skipped
                   Encode("jany").target(7),                                // taken
                   mov(2, 2),                                               // skipped
                   mov(3, 3), Encode("exit")});
  machine.run();
  EXPECT_EQ(machine.reg(0, 2, 0), 0u);
  EXPECT_EQ(machine.reg(0, 3, 0), 3u);
}

TEST(FunctionalCore, ALoopRunsUntilItsMaskIsEmpty) {
  Machine machine({Encode("lane").rd(1), Encode("igt").rd(1).ra(1).imm(0),  // p1 = lanes that have turns left
                   Encode("loop").guard(1).target(6),                       //
                   Encode("isub").guard(1).rd(1).ra(1).imm(1),              //
                   Encode("iadd").guard(1).rd(2).ra(2).imm(10),             //
                   Encode("igt").guard(1).rd(1).ra(1).imm(0),               //
                   Encode("mov").rd(3).imm(4), Encode("exit")});
  machine.run();
  for (uint32_t lane = 0; lane < 4; ++lane) EXPECT_EQ(machine.reg(0, 2, lane), 10 * lane);
  EXPECT_EQ(machine.reg(0, 3, 0), 4u);
}

TEST(FunctionalCore, NestedLoopsAndCallsReturnToTheirPlaces) {
  // Outer loop twice, inner loop three times, a call in the inner body; r4 counts the calls.
  Machine machine({mov(1, 2),                           // 0
                   Encode("igt").rd(1).ra(1).imm(0),    // 1
                   Encode("loop").guard(1).target(11),  // 2
                   mov(2, 3),                           // 3
                   Encode("igt").rd(2).ra(2).imm(0),    // 4
                   Encode("loop").guard(2).target(9),   // 5
                   Encode("call").target(13, 14),       // 6: body ends by RPC
                   Encode("isub").rd(2).ra(2).imm(1),   // 7
                   Encode("igt").rd(2).ra(2).imm(0),    // 8
                   Encode("isub").rd(1).ra(1).imm(1),   // 9
                   Encode("igt").rd(1).ra(1).imm(0),    // 10
                   Encode("call").target(15, 100),      // 11: body ends by ret
                   Encode("exit"),                      // 12
                   Encode("iadd").rd(4).ra(4).imm(1),   // 13
                   mov(4, 99),                          // 14: never reached
                   mov(5, 7), Encode("ret"), mov(5, 99)});
  EXPECT_EQ(machine.run(), Status::NotRunning);
  EXPECT_EQ(machine.reg(0, 4, 0), 6u);
  EXPECT_EQ(machine.reg(0, 5, 0), 7u);
}

TEST(FunctionalCore, LoadsAndStoresReachMemoryAndTheHighestLaneWins) {
  Machine machine({Encode("lane").rd(1), Encode("shl").rd(2).ra(1).imm(2), Encode("iadd").rd(3).ra(1).imm(40),
                   Encode("st").ra(2).rb(3).plain_imm(1024), mov(4, 1060), Encode("st").ra(4).rb(3).plain_imm(0xfffffffcu),
                   Encode("ld").rd(5).ra(2).plain_imm(1024), Encode("ld").rd(6).ra(4).plain_imm(0xfffffffcu), Encode("exit")});
  for (int i = 0; i < 3; ++i) machine.core.step(0);
  const Step& step = machine.core.step(0);
  ASSERT_EQ(step.store_count, 4u);
  EXPECT_EQ(step.stores[2].address, 1032u);
  EXPECT_EQ(step.stores[2].value, 42u);
  machine.run();
  for (uint32_t lane = 0; lane < 4; ++lane) {
    EXPECT_EQ(machine.memory.load(1024 + 4 * lane), 40 + lane);
    EXPECT_EQ(machine.reg(0, 5, lane), 40 + lane);
    EXPECT_EQ(machine.reg(0, 6, lane), 43u);
  }
  EXPECT_EQ(machine.memory.load(1056), 43u);
}

TEST(FunctionalCore, RoutinesOfTheRayMemoryMoveImportsAndExports) {
  Machine machine({Encode("rin"), Encode("rld").rd(1).x(20), Encode("rst").x(0).imm(as_bits(2.5f)), Encode("lane").rd(2),
                   Encode("igt").rd(1).ra(2).imm(1), Encode("rout").guard(1), Encode("rin"), Encode("rfb"), Encode("exit")});
  EXPECT_EQ(machine.core.step(0).status, Status::WaitsForImport);
  machine.core.expect_import(8);
  machine.core.expect_import(3);
  const auto give = [&machine](uint32_t seed, int count) {
    for (int i = 0; i < count; ++i, ++seed) {
      Intersection package;
      for (uint32_t word = 0; word < kIntersectionWords; ++word) package[word] = seed * 100 + word;
      machine.core.import_package(package);
    }
  };
  give(1, 3);
  EXPECT_EQ(machine.core.step(0).status, Status::WaitsForImport);
  give(4, 5);
  EXPECT_EQ(machine.core.slices().packages_expected(), 3u);
  EXPECT_EQ(machine.core.step(0).status, Status::Executed);
  machine.core.step(0);
  EXPECT_EQ(machine.reg(0, 1, 3), 420u);
  const Step& write = machine.core.step(0);
  ASSERT_NE(write.ray_words, nullptr);
  EXPECT_EQ(write.ray_words[1], as_bits(2.5f));
  machine.core.step(0);
  machine.core.step(0);
  machine.core.set_output_busy(0, true);
  EXPECT_EQ(machine.core.step(0).status, Status::WaitsForExport);
  machine.core.set_output_busy(0, false);
  const Step& rout = machine.core.step(0);
  ASSERT_EQ(rout.ray_count, 2u);
  EXPECT_EQ(rout.rays[0][0], as_bits(2.5f));
  EXPECT_EQ(rout.rays[1][11], 411u);
  EXPECT_EQ(machine.core.step(0).status, Status::WaitsForImport);
  give(9, 3);
  EXPECT_EQ(machine.core.step(0).status, Status::Executed);
  const Step& rfb = machine.core.step(0);
  ASSERT_EQ(rfb.frame_count, 4u);
  EXPECT_EQ(rfb.frame[2].pixel, 1107u);
  EXPECT_EQ(rfb.frame[2].rgb[2], 1110u);
  EXPECT_EQ(rfb.rays[0][0], as_bits(2.5f)) << "results of an earlier step need not change";
}

TEST(FunctionalCore, APackageThatNobodyExpectsIsRefused) {
  Machine machine({Encode("exit")});
  EXPECT_THROW(machine.core.import_package({}), std::logic_error);
}

struct FaultCase {
  const char* name;
  std::vector<uint64_t> code;
  FaultCode fault;
  uint32_t pc;
};

class FunctionalCoreFault : public testing::TestWithParam<FaultCase> {};

TEST_P(FunctionalCoreFault, IsReportedWithWarpAndPcAndStopsTheUnit) {
  Machine machine(GetParam().code, make_configuration(2, 4, 3));
  EXPECT_EQ(machine.run(1), Status::Fault);
  const Step& step = machine.core.step(0);
  EXPECT_EQ(step.status, Status::Fault);
  EXPECT_EQ(step.fault.code, GetParam().fault);
  EXPECT_EQ(step.fault.warp, 1u);
  EXPECT_EQ(step.fault.pc, GetParam().pc);
}

INSTANTIATE_TEST_SUITE_P(
    All, FunctionalCoreFault,
    testing::Values(FaultCase{"unit", {mov(1, 1), uint64_t{15} << 60}, FaultCode::IllegalInstruction, 1},
                    FaultCase{"operation", {mov(1, 1), Encode("mov").field(31, 55)}, FaultCode::IllegalInstruction, 1},
                    FaultCase{
                        "without_fma", {mov(1, 1), Encode("ffma").rd(2).ra(1).rb(1).x(1)}, FaultCode::IllegalInstruction, 1},
                    FaultCase{"end", {mov(1, 1)}, FaultCode::PcOutsideProgram, 1},
                    FaultCase{"jump", {Encode("jany").target(9)}, FaultCode::PcOutsideProgram, 9},
                    FaultCase{"overflow", {Encode("call").target(0, 5)}, FaultCode::StackOverflow, 0},
                    FaultCase{"loop",
                              {mov(1, 0), Encode("loop").target(9), Encode("loop").target(9), Encode("loop").target(9)},
                              FaultCode::StackOverflow,
                              3},
                    FaultCase{"underflow", {mov(1, 1), Encode("ret")}, FaultCode::StackUnderflow, 1},
                    FaultCase{"misaligned", {mov(1, 2), Encode("ld").rd(1).ra(1)}, FaultCode::Misaligned, 1},
                    FaultCase{"outside", {mov(1, kMemoryBytes), Encode("st").rb(1).ra(1)}, FaultCode::AddressOutsideMemory, 1},
                    FaultCase{"read_word", {Encode("rld").rd(1).x(21)}, FaultCode::RayWordOutside, 0},
                    FaultCase{"write_word", {Encode("rst").x(31).rb(1)}, FaultCode::RayWordOutside, 0}),
    [](const auto& test_case) { return std::string(test_case.param.name); });

TEST(FunctionalCore, AddressesOfLanesThatAreNotMaskedDoNotFault) {
  Machine machine(
      {mov(1, kMemoryBytes + 3), Encode("ieq").rd(1).ra(1).imm(1), Encode("ld").guard(1).rd(2).ra(1), Encode("exit")});
  EXPECT_EQ(machine.run(), Status::NotRunning);
}

TEST(FunctionalCore, EveryNumberOfLanesComputes) {
  for (int lanes = 1; lanes <= 32; lanes *= 2) {
    for (int warps = 1; warps <= 32; warps *= 8) {
      Machine machine({Encode("tid").rd(1), Encode("imul").rd(2).ra(1).imm(3), Encode("exit")}, make_configuration(warps, lanes));
      for (uint32_t warp = 0; warp < static_cast<uint32_t>(warps); ++warp) machine.run(warp);
      EXPECT_FALSE(machine.core.running());
      const uint32_t last = static_cast<uint32_t>(warps * lanes) - 1;
      EXPECT_EQ(machine.reg(static_cast<uint32_t>(warps) - 1, 2, static_cast<uint32_t>(lanes) - 1), 3 * last);
    }
  }
}

TEST(FunctionalCore, ALaunchClearsPredicatesAndKeepsRegisters) {
  Machine machine({mov(1, 6), Encode("ieq").rd(1).ra(1).imm(6), Encode("exit"), mov(2, 7), Encode("exit")});
  machine.run(0);
  machine.run(1);
  LaunchCommand command;
  command.pc = 3;
  command.threads = 8;
  machine.core.launch(command);
  EXPECT_EQ(machine.core.predicate(0, 1), 0u);
  EXPECT_EQ(machine.reg(0, 1, 0), 6u);
  EXPECT_EQ(machine.core.step(0).pc, 3u);
}

}  // namespace
}  // namespace raypool
