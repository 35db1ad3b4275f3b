#include "machine/compute/functional_core.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <map>
#include <random>

#include "bits.hpp"
#include "isa/encoding.hpp"
#include "machine/compute/test_program.hpp"

namespace raypool {
namespace {

using test::assembled;
using Status = Step::Status;

constexpr uint32_t kMemoryBytes = 4096;

Configuration make_configuration(uint32_t warps = 2, uint32_t lanes = 4, uint32_t stack_depth = 4) {
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
    core.reset(size32(code), kMemoryBytes);
    LaunchCommand command;
    command.threads = threads == 0 ? configuration.contents() : threads;
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

// A program that does `body` with r1 = a and r2 = b.
std::vector<uint64_t> with_operands(uint32_t a, uint32_t b, const std::string& body) {
  return assembled(fmt::format("mov r1, {}; mov r2, {}; {}; exit", a, b, body));
}

uint32_t unary(std::string_view mnemonic, uint32_t a) {
  Machine machine(with_operands(a, 0, fmt::format("{} r3, r1", mnemonic)));
  EXPECT_EQ(machine.run(), Status::NotRunning);
  return machine.reg(0, 3, 2);
}

// With b in a register; once more with b as the immediate.
uint32_t binary(std::string_view mnemonic, uint32_t a, uint32_t b) {
  Machine machine(with_operands(a, b, fmt::format("{0} r3, r1, r2; {0} r4, r1, 0x{1:x}", mnemonic, b)));
  EXPECT_EQ(machine.run(), Status::NotRunning);
  EXPECT_EQ(machine.reg(0, 3, 0), machine.reg(0, 4, 3)) << mnemonic;
  return machine.reg(0, 3, 2);
}

bool compares(std::string_view mnemonic, uint32_t a, uint32_t b) {
  Machine machine(with_operands(a, b, fmt::format("{0} p3, r1, r2; {0} p4, r1, 0x{1:x}", mnemonic, b)));
  EXPECT_EQ(machine.run(), Status::NotRunning);
  EXPECT_EQ(machine.core.predicate(0, 3), machine.core.predicate(0, 4)) << mnemonic;
  EXPECT_TRUE(machine.core.predicate(0, 3) == 0 || machine.core.predicate(0, 3) == 15) << mnemonic;
  return machine.core.predicate(0, 3) != 0;
}

TEST(FunctionalCore, IntegerInstructionsFollowTheTable) {
  const uint32_t minus3 = static_cast<uint32_t>(-3);
  EXPECT_EQ(unary("mov", 9), 9u);
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

TEST(FunctionalCore, FloatInstructionsFollowTheTable) {
  const uint32_t three = as_bits(3), half = as_bits(0.5f);
  EXPECT_EQ(binary("fadd", three, half), as_bits(3.5f));
  EXPECT_EQ(binary("fsub", three, half), as_bits(2.5f));
  EXPECT_EQ(binary("fmul", three, half), as_bits(1.5f));
  EXPECT_EQ(binary("fmin", three, half), half);
  EXPECT_EQ(binary("fmax", three, half), three);
  EXPECT_EQ(binary("fdiv", three, half), as_bits(6));
  EXPECT_EQ(unary("f2i", as_bits(-2.75f)), static_cast<uint32_t>(-2));
  EXPECT_EQ(unary("i2f", static_cast<uint32_t>(-2)), as_bits(-2));
  EXPECT_EQ(unary("fsqrt", as_bits(9)), three);
  EXPECT_EQ(unary("frsqrt", as_bits(4)), half);
  EXPECT_EQ(unary("frcp", as_bits(2)), half);
}

TEST(FunctionalCore, ComparesFollowTheTable) {
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
  Machine machine(assembled(R"(
      tid r1
      lane r2
      warp r3
      block r4
      threads r5
      blocks r6
      arg r7, 31
      exit)"),
                  make_configuration(), 7);
  machine.core.set_argument(31, 1234);
  machine.run(0);
  machine.run(1);
  const std::array<uint32_t, 7> expected = {6, 2, 1, 77, 7, 5, 1234};
  for (uint32_t i = 0; i < 7; ++i) EXPECT_EQ(machine.reg(1, i + 1, 2), expected[i]) << i;
}

TEST(FunctionalCore, LanesBeyondTheLaunchAreNeverActiveAndTheirWarpsNeverStart) {
  Machine machine(assembled("mov r1, 5; ieq p1, r1, 5; exit"), make_configuration(4, 4), 6);
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
  Machine machine(assembled(R"(
      lane r1
      ige p1, r1, 1          # p1 = lanes 1 2 3
      ieq p2, r1, 0          # p2 = lane 0
      @p1 ilt p2, r1, 3      # p2 = lanes 1 2, lane 0 is cleared
      @p2 iadd r2, r1, 100   # r2 in lanes 1 2
      @!p2 iadd r2, r1, 200  # r2 in lanes 0 3
      exit)"));
  machine.run();
  EXPECT_EQ(machine.core.predicate(0, 1), 14u);
  EXPECT_EQ(machine.core.predicate(0, 2), 6u);
  EXPECT_EQ(machine.reg(0, 2, 0), 200u);
  EXPECT_EQ(machine.reg(0, 2, 1), 101u);
  EXPECT_EQ(machine.reg(0, 2, 2), 102u);
  EXPECT_EQ(machine.reg(0, 2, 3), 203u);
}

TEST(FunctionalCore, PredicateLogicAndSelectUseTheTwoSources) {
  Machine machine(assembled(R"(
      lane r1
      and r2, r1, 1
      ine p1, r2, 0       # p1 = 1010
      ige p2, r1, 2       # p2 = 1100
      pand p3, p1, p2
      por p4, p1, p2
      pxor p5, p1, p2
      pandn p6, p1, p2
      sel r3, p2, r1, 50
      exit)"));
  machine.run();
  EXPECT_EQ(machine.core.predicate(0, 3), 8u);
  EXPECT_EQ(machine.core.predicate(0, 4), 14u);
  EXPECT_EQ(machine.core.predicate(0, 5), 6u);
  EXPECT_EQ(machine.core.predicate(0, 6), 2u);
  EXPECT_EQ(machine.reg(0, 3, 1), 50u);
  EXPECT_EQ(machine.reg(0, 3, 3), 3u);
}

TEST(FunctionalCore, PredicateZeroReadsAsOnesAndIsNeverWritten) {
  Machine machine(assembled("lane r1; ilt p0, r1, 0; mov r2, 9; exit"));
  machine.core.step(0);
  const Step& step = machine.core.step(0);
  EXPECT_EQ(step.predicate, 0u);
  machine.run();
  EXPECT_EQ(machine.reg(0, 2, 3), 9u);
}

TEST(FunctionalCore, JumpsLookAtTheMaskedLanes) {
  Machine machine(assembled(R"(
      lane r1
      igt p1, r1, 7  # p1 = none
      @p1 jany 6     # not taken
      @p1 jnone 5    # taken
      mov r2, 1      # skipped
      jany 7         # taken
      mov r2, 2      # skipped
      mov r3, 3
      exit)"));
  machine.run();
  EXPECT_EQ(machine.reg(0, 2, 0), 0u);
  EXPECT_EQ(machine.reg(0, 3, 0), 3u);
}

TEST(FunctionalCore, ALoopRunsUntilItsMaskIsEmpty) {
  Machine machine(assembled(R"(
      lane r1
      igt p1, r1, 0        # p1 = lanes that have turns left
      @p1 loop 6
      @p1 isub r1, r1, 1
      @p1 iadd r2, r2, 10
      @p1 igt p1, r1, 0
      mov r3, 4
      exit)"));
  machine.run();
  for (uint32_t lane = 0; lane < 4; ++lane) EXPECT_EQ(machine.reg(0, 2, lane), 10 * lane);
  EXPECT_EQ(machine.reg(0, 3, 0), 4u);
}

TEST(FunctionalCore, NestedLoopsAndCallsReturnToTheirPlaces) {
  // Outer loop twice, inner loop three times, a call in the inner body; r4 counts the calls.
  Machine machine(assembled(R"(
      mov r1, 2       # 0
      igt p1, r1, 0   # 1
      @p1 loop 11     # 2
      mov r2, 3       # 3
      igt p2, r2, 0   # 4
      @p2 loop 9      # 5
      call 13, 14     # 6: body ends by RPC
      isub r2, r2, 1  # 7
      igt p2, r2, 0   # 8
      isub r1, r1, 1  # 9
      igt p1, r1, 0   # 10
      call 15, 100    # 11: body ends by ret
      exit            # 12
      iadd r4, r4, 1  # 13
      mov r4, 99      # 14: never reached
      mov r5, 7
      ret
      mov r5, 99)"));
  EXPECT_EQ(machine.run(), Status::NotRunning);
  EXPECT_EQ(machine.reg(0, 4, 0), 6u);
  EXPECT_EQ(machine.reg(0, 5, 0), 7u);
}

TEST(FunctionalCore, LoadsAndStoresReachMemoryAndTheHighestLaneWins) {
  Machine machine(assembled(R"(
      lane r1
      shl r2, r1, 2
      iadd r3, r1, 40
      st [r2+1024], r3
      mov r4, 1060
      st [r4-4], r3
      ld r5, [r2+1024]
      ld r6, [r4-4]
      exit)"));
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
  Machine machine(assembled(R"(
      rin
      rld r1, 20
      rst 0, 2.5
      lane r2
      igt p1, r2, 1
      @p1 rout
      rin
      rfb
      exit)"));
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

TEST(FunctionalCore, RefusesAnUnexpectedPackage) {
  Machine machine(assembled("exit"));
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
    testing::Values(
        FaultCase{"unit", assembled("mov r1, 1; .word 0xf000000000000000"), FaultCode::IllegalInstruction, 1},
        FaultCase{"operation", assembled("mov r1, 1; .word 0x3f80000000000000"), FaultCode::IllegalInstruction, 1},
        FaultCase{"without_fma", assembled("mov r1, 1; ffma r2, r1, r1, r1"), FaultCode::IllegalInstruction, 1},
        FaultCase{"end", assembled("mov r1, 1"), FaultCode::PcOutsideProgram, 1},
        FaultCase{"jump", assembled("jany 9"), FaultCode::PcOutsideProgram, 9},
        FaultCase{"overflow", assembled("call 0, 5"), FaultCode::StackOverflow, 0},
        FaultCase{"loop", assembled("mov r1, 0; loop 9; loop 9; loop 9"), FaultCode::StackOverflow, 3},
        FaultCase{"underflow", assembled("mov r1, 1; ret"), FaultCode::StackUnderflow, 1},
        FaultCase{"misaligned", assembled("mov r1, 2; ld r1, [r1]"), FaultCode::Misaligned, 1},
        FaultCase{"outside", assembled(fmt::format("mov r1, {}; st [r1], r1", kMemoryBytes)),
                  FaultCode::AddressOutsideMemory, 1},
        FaultCase{"read_word", assembled(".word 0x6180401500000000  # rld r1, 21"), FaultCode::RayWordOutside, 0},
        FaultCase{"write_word", assembled(".word 0x6200005f00000000  # rst 31, r1"), FaultCode::RayWordOutside, 0}),
    [](const auto& test_case) { return std::string(test_case.param.name); });

Configuration with_triples(bool fma) {
  Configuration configuration = make_configuration();
  configuration.triples = true;
  configuration.fma = fma;
  return configuration;
}

TEST(FunctionalCore, TriplesThatTheMachineHasNotAreIllegal) {
  const Configuration fused = with_triples(true), triples = with_triples(false);
  Configuration fma = make_configuration();
  fma.fma = true;
  const auto first_fault = [](const std::string& text, const Configuration& configuration) {
    Machine machine(assembled(text + "; exit"), configuration);
    return machine.run() == Status::Fault ? machine.core.step(0).fault.code : FaultCode::None;
  };
  for (const char* text : {"fadd3 r1, r4, r7", "arg3 r1, 0", "ld3 r1, [r0]", "rld3 r1, 18", "rst3 18, r1"}) {
    EXPECT_EQ(first_fault(text, triples), FaultCode::None) << text;
    EXPECT_EQ(first_fault(text, fma), FaultCode::IllegalInstruction) << text;
  }
  EXPECT_EQ(first_fault("ffma3 r1, r4, r7, r1", fused), FaultCode::None);
  EXPECT_EQ(first_fault("ffma3 r1, r4, r7, r1", triples), FaultCode::IllegalInstruction);
  EXPECT_EQ(first_fault("ffma3s r1, r4, r7, r1", fma), FaultCode::IllegalInstruction);
  // Of three words the last would be outside.
  for (const char* text : {"rld3 r1, 19", "rst3 20, r1", ".word 0x6a0000df00000000  # rst3 31, r3"})
    EXPECT_EQ(first_fault(text, triples), FaultCode::IllegalInstruction) << text;
  Configuration compact = triples;
  compact.intersection_words = 16;
  for (const char* text : {"rld3 r1, 13", "rst3 13, r1"})
    EXPECT_EQ(first_fault(text, compact), FaultCode::None) << text;
  for (const char* text : {"rld3 r1, 14", "rst3 18, r1"})
    EXPECT_EQ(first_fault(text, compact), FaultCode::IllegalInstruction) << text;
}

TEST(FunctionalCore, WhatNamesMoreThanThereIsIsIllegal) {
  Configuration configuration = with_triples(true);
  configuration.registers = 12, configuration.predicates = 5, configuration.arguments = 11;
  const auto fault_of = [&](const std::string& text) {
    Machine machine(assembled(text + "; exit"), configuration);
    return machine.run() == Status::Fault ? machine.core.step(0).fault.code : FaultCode::None;
  };
  for (const char* text : {"iadd r11, r11, r11", "pand p4, p4, p4", "arg r0, 10", "fadd3 r9, r9, r9", "arg3 r0, 8",
                           "fmul3s r0, r11, r9", "@p4 mov r1, 15", "sel r1, p4, r2, r3"})
    EXPECT_EQ(fault_of(text), FaultCode::None) << text;
  for (const char* text : {"iadd r12, r1, r1",
                           "iadd r1, r12, r1",
                           "iadd r1, r1, r15",
                           "pand p5, p1, p1",
                           "pand p1, p8, p1",
                           "pand p1, p1, p5",
                           "@p5 mov r1, 0",
                           "@!p9 jany 0",
                           "arg r0, 11",
                           "st [r12], r1",
                           "mov r1, 1024; st [r1], r12",
                           "fadd3 r10, r0, r0",
                           "fadd3 r0, r10, r0",
                           "fadd3 r0, r0, r11",
                           "ffma3 r0, r3, r6, r10",
                           "fmul3s r0, r12, r1",
                           "arg3 r0, 9",
                           "sel r1, p5, r2, r3",
                           "sel r1, p1, r2, r12",
                           "rst3 0, r10"})
    EXPECT_EQ(fault_of(text), FaultCode::IllegalInstruction) << text;
}

// The greatest PC is outside: what lies beyond is not taken for what its lower bits name.
TEST(FunctionalCore, APcThatDoesNotFitIsOutsideOfTheProgram) {
  Configuration configuration = make_configuration();
  configuration.pc_bits = 8;
  for (const char* text : {"jany 256; exit", "jany 257; exit", "jany 65535", "jany 255"}) {
    Machine machine(assembled(text), configuration);
    EXPECT_EQ(machine.run(), Status::Fault) << text;
    EXPECT_EQ(machine.core.step(0).fault.code, FaultCode::PcOutsideProgram) << text;
    EXPECT_EQ(machine.core.step(0).fault.pc, 255u) << text;
  }
  // An end beyond is never reached: the function goes on to its ret.
  Machine machine(assembled("call 2, 256; exit; mov r1, 7; ret"), configuration);
  EXPECT_EQ(machine.run(), Status::NotRunning);
  EXPECT_EQ(machine.reg(0, 1, 0), 7u);
}

constexpr uint32_t kTable = 2048;

/// All that a program leaves: how it ended, registers and the ray words of both warps.
std::vector<uint32_t> left_by(const std::vector<uint64_t>& code) {
  Machine machine(code, with_triples(true));
  for (uint32_t address = kTable; address < kMemoryBytes; address += 4)
    machine.memory.store(address, address * 2654435761u);
  std::vector<uint32_t> left;
  for (const uint32_t warp : {0u, 1u}) {
    // A load may have overwritten its own address.
    left.push_back(to_underlying(machine.run(warp)));
    for (uint32_t number = 0; number < kRegisters; ++number)
      for (uint32_t lane = 0; lane < 4; ++lane) left.push_back(machine.reg(warp, number, lane));
  }
  return left;
}

TEST(FunctionalCore, ATripleLeavesWhatItsThreeElementsLeave) {
  // r0 .. r15 differ between lanes and are aligned addresses; so are all words of the slice.
  std::string prologue = "tid r0; ieq p1, r0, 2; ilt p2, r0, 6";
  for (int n = 15; n >= 0; --n) prologue += fmt::format("; imul r{0}, r0, {1}; iadd r{0}, r{0}, {2}", n, 4 * n, 16 * n);
  for (int n = 0; n < 21; ++n) prologue += fmt::format("; rst {}, r{}", n, n % 16);
  std::string epilogue;
  for (int n = 0; n < 8; ++n) epilogue += fmt::format("rld r{0}, {0}; ", n);
  std::mt19937 random(1);
  const auto below = [&random](uint32_t limit) { return static_cast<uint8_t>(random() % limit); };
  for (size_t row = kSingles; row < std::size(kInstructions); ++row) {
    for (int i = 0; i < 60; ++i) {
      Instruction triple;
      triple.info = &kInstructions[row];
      triple.guard = below(3), triple.guard_negated = triple.guard != 0 && below(2) != 0;
      triple.rd = below(16), triple.ra = below(16), triple.rb = below(16);
      if (has_operand(*triple.info, Operand::Rc)) triple.x = below(16);
      if (has_operand(*triple.info, Operand::Word)) triple.x = below(6);
      if (has_operand(*triple.info, Operand::Argument)) triple.immediate = below(32);
      if (has_operand(*triple.info, Operand::Address)) triple.immediate = kTable + below(8) * 16;
      if (has_operand(*triple.info, Operand::B) && below(3) == 0)
        triple.b_is_immediate = true, triple.immediate = random();
      const auto program = [&](const std::vector<uint64_t>& middle) {
        std::vector<uint64_t> code = assembled(prologue);
        code.insert(code.end(), middle.begin(), middle.end());
        const std::vector<uint64_t> end =
            assembled(has_operand(*triple.info, Operand::Rd) ? "exit" : epilogue + "exit");
        code.insert(code.end(), end.begin(), end.end());
        return code;
      };
      ASSERT_EQ(left_by(program({encode(triple)})),
                left_by(program({encode(element(triple, 0)), encode(element(triple, 1)), encode(element(triple, 2))})))
          << disassemble(encode(triple));
    }
  }
}

TEST(FunctionalCore, ALoadOfATripleThatFaultsLeavesTheOnesBefore) {
  Machine machine(assembled(fmt::format("mov r0, {}; ld3 r1, [r0]; exit", kMemoryBytes - 8)), with_triples(false));
  for (uint32_t e = 0; e < 3; ++e) machine.memory.store(kMemoryBytes - 12 + 4 * e, 70 + e);
  EXPECT_EQ(machine.run(), Status::Fault);
  EXPECT_EQ(machine.core.step(0).fault.code, FaultCode::AddressOutsideMemory);
  EXPECT_EQ(machine.core.step(0).fault.pc, 1u);
  EXPECT_EQ(machine.reg(0, 1, 0), 71u);
  EXPECT_EQ(machine.reg(0, 2, 0), 72u);
}

TEST(FunctionalCore, AddressesOfLanesThatAreNotMaskedDoNotFault) {
  Machine machine(assembled(fmt::format("mov r1, {}; ieq p1, r1, 1; @p1 ld r2, [r1]; exit", kMemoryBytes + 3)));
  EXPECT_EQ(machine.run(), Status::NotRunning);
}

TEST(FunctionalCore, EveryNumberOfLanesComputes) {
  for (uint32_t lanes = 1; lanes <= 32; lanes *= 2) {
    for (uint32_t warps = 1; warps <= 32; warps *= 8) {
      Machine machine(assembled("tid r1; imul r2, r1, 3; exit"), make_configuration(warps, lanes));
      for (uint32_t warp = 0; warp < warps; ++warp) machine.run(warp);
      EXPECT_FALSE(machine.core.running());
      const uint32_t last = warps * lanes - 1;
      EXPECT_EQ(machine.reg(warps - 1, 2, lanes - 1), 3 * last);
    }
  }
}

TEST(FunctionalCore, ALaunchClearsPredicatesAndKeepsRegisters) {
  Machine machine(assembled("mov r1, 6; ieq p1, r1, 6; exit; mov r2, 7; exit"));
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
