#include "chip/program_run.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "machine/functional_unit.hpp"
#include "machine/model.hpp"
#include "machine/test_program.hpp"

namespace raypool {
namespace {

using test::assembled;

constexpr uint32_t kResults = 1024;

struct Bench {
  Configuration configuration;
  Memory memory{65536};
  std::unique_ptr<ComputeUnit> unit;
  ProgramOptions options;

  explicit Bench(const std::vector<uint64_t>& code) {
    test::put_program(memory, code);
    unit = make_functional_unit(configuration, memory);
    options.configuration = configuration;
    options.device = unit.get();
    options.memory = &memory;
    options.program_length = size32(code);
    options.threads = 64;
  }
};

// word[arg0 + 4 * (block * threads + tid)] = block * threads + tid
std::vector<uint64_t> number_threads() {
  return assembled(R"(
      tid r1
      block r2
      threads r3
      imul r2, r2, r3
      iadd r1, r1, r2
      shl r2, r1, 2
      arg r3, 0
      iadd r2, r2, r3
      st [r2], r1
      exit)");
}

TEST(ProgramRun, RunsEveryBlockOnce) {
  Bench bench(number_threads());
  bench.options.blocks = 7;
  bench.options.arguments[0] = kResults;
  const ProgramResult result = run_program(bench.options);
  for (uint32_t i = 0; i < 7 * 64; ++i) EXPECT_EQ(bench.memory.load(kResults + 4 * i), i);
  EXPECT_EQ(bench.memory.load(kResults + 4 * 7 * 64), 0u);
  EXPECT_EQ(result.counters[counter::kInstructions], 7u * 8 * 10);
  EXPECT_FALSE(result.timed);
  EXPECT_GT(result.cycles, 0u);
}

TEST(ProgramRun, ReportsAFault) {
  Bench bench(assembled("mov r1, 2; ld r2, [r1]; exit"));
  try {
    run_program(bench.options);
    FAIL() << "no fault";
  } catch (const ChipFault& fault) {
    EXPECT_EQ(fault.fault.code, FaultCode::Misaligned);
    EXPECT_EQ(fault.fault.pc, 1u);
  }
}

TEST(ProgramRun, RefusesProgramsThatNeedThePools) {
  for (const char* mnemonic : {"rin", "rout", "rfb"}) {
    Bench bench(assembled(fmt::format("{}; exit", mnemonic)));
    EXPECT_THROW(run_program(bench.options), InputError) << mnemonic;
  }
}

TEST(ProgramRun, GivesUpOnAProgramThatNeverEnds) {
  Bench bench(assembled("@p1 jnone 0; exit"));
  bench.options.watchdog_cycles = 10;
  bench.options.limits.silent_cycles = 1000;
  EXPECT_THROW(run_program(bench.options), LimitPassed);
  bench.options.watchdog_cycles = 0;
  bench.options.limits = {200, {}};
  EXPECT_THROW(run_program(bench.options), LimitPassed);
}

// Some 12,000 cycles in which nothing passes a port.
TEST(ProgramRun, OfAKernelThatCountsForLongTheLimitThatWasGivenHolds) {
  const std::vector<uint64_t> code = assembled(R"(
      mov r1, 1000
      igt p1, r1, 0
      @p1 loop 5
      @p1 isub r1, r1, 1
      @p1 igt p1, r1, 0
      exit)");
  const auto limit_passed = [&](const RunLimits& limits) {
    Bench bench(code);
    bench.unit = make_model(bench.configuration, bench.memory, 1).device;
    bench.options.device = bench.unit.get();
    bench.options.watchdog_cycles = 100;
    bench.options.limits = limits;
    try {
      run_program(bench.options);
      return std::string();
    } catch (const LimitPassed& passed) {
      return passed.limit;
    }
  };
  EXPECT_NE(limit_passed({0, 5000}).find("for 5000 cycles instructions have ended"), std::string::npos);
  EXPECT_EQ(limit_passed({1'000'000, {}}), "") << "a limit that was given is the limit";
  EXPECT_EQ(limit_passed({0, 0}), "");
  EXPECT_EQ(limit_passed({3000, {}}), "the limit of 3000 cycles has passed");
}

TEST(ProgramRun, WithoutTimeTheLimitCountsInstructions) {
  // 80 instructions a block.
  Bench bench(number_threads());
  bench.options.blocks = 3;
  bench.options.arguments[0] = kResults;
  bench.options.limits.cycles = 3 * 80;
  EXPECT_EQ(run_program(bench.options).counters[counter::kInstructions], 3u * 80);
  --bench.options.limits.cycles;
  try {
    run_program(bench.options);
    FAIL() << "no limit";
  } catch (const ChipStalled& stalled) {
    EXPECT_EQ(std::string(stalled.what()).find("the limit of 239 instructions has passed"), 0u) << stalled.what();
  }
}

TEST(ProgramRun, TellsTheAddressBehindAFault) {
  // Thread t loads from 64 + 6 t: thread 1 is the first that is not aligned.
  const std::vector<uint64_t> code = assembled("tid r1; imul r1, r1, 6; ld r2, [r1+64]; exit");
  Bench bench(code);
  const Memory before = bench.memory;
  try {
    run_program(bench.options);
    FAIL() << "no fault";
  } catch (const ChipFault& fault) {
    EXPECT_EQ(faulting_access(bench.options, before, fault.fault), "thread 1 of block 0 goes to address 0x46");
    Fault other = fault.fault;
    other.pc = 1;
    EXPECT_EQ(faulting_access(bench.options, before, other), "");
  }
}

TEST(ProgramRun, RefusesSizesThatTheUnitDoesNotHold) {
  Bench bench(number_threads());
  bench.options.threads = 65;
  EXPECT_THROW(run_program(bench.options), InputError);
  bench.options.threads = 64;
  bench.options.blocks = 0;
  EXPECT_THROW(run_program(bench.options), InputError);
}

}  // namespace
}  // namespace raypool
