#include "chip/program_run.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "bits.hpp"
#include "chip/board_memory.hpp"
#include "chip/progress_watch.hpp"
#include "kernel/compute_kernels.hpp"
#include "machine/compute/functional_unit.hpp"
#include "machine/compute/model.hpp"
#include "machine/compute/test_program.hpp"

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

TEST(ProgramRun, ReportsTheAddressBehindAFault) {
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

/// y[i] = x[i] + y[i] for 512 elements.
struct Saxpy {
  static constexpr uint32_t kElements = 512, kX = 8192, kY = 16384;
  Memory memory{32768};
  ProgramOptions options;
  std::unique_ptr<ComputeUnit> unit;

  Saxpy() {
    const Program& program = compute_kernel_program();
    test::put_program(memory, program.code);
    for (uint32_t i = 0; i < kElements; ++i) {
      memory.store(kX + 4 * i, as_bits(static_cast<float>(i)));
      memory.store(kY + 4 * i, as_bits(0.5f));
    }
    options.program_length = size32(program.code);
    options.entry = program.entries.at("saxpy");
    options.arguments[saxpy_argument::kN] = kElements;
    options.arguments[saxpy_argument::kA] = as_bits(1);
    options.arguments[saxpy_argument::kX] = kX;
    options.arguments[saxpy_argument::kY] = kY;
    options.threads = 64;
    options.blocks = 2;
    options.memory = &memory;
    use(make_model(options.configuration, memory, 1).device);
  }
  void use(std::unique_ptr<ComputeUnit> device) {
    unit = std::move(device);
    options.device = unit.get();
  }
  void expect_result() const {
    for (uint32_t i = 0; i < kElements; ++i) {
      EXPECT_EQ(memory.load(kY + 4 * i), as_bits(static_cast<float>(i) + 0.5f)) << i;
    }
  }
};

// A memory of one's own, of rows of 2 KB. One is open: a line of it takes 60 cycles, any other 140.
class RowStore : public chip::FixedLatencyStore {
 public:
  explicit RowStore(Memory& memory) : FixedLatencyStore(memory, nullptr, 0) {}

  uint64_t read(bool traverser, uint32_t address, Line& line) override {
    FixedLatencyStore::read(traverser, address, line);
    return opens(address) ? 140 : 60;
  }
  void write(bool traverser, const MemoryRequest& request) override {
    FixedLatencyStore::write(traverser, request);
    opens(request.address);
  }

  uint64_t row_hits = 0, row_misses = 0;

 private:
  bool opens(uint32_t address) {
    const bool miss = address / 2048 != row_;
    ++(miss ? row_misses : row_hits);
    row_ = address / 2048;
    return miss;
  }
  uint32_t row_ = UINT32_MAX;
};

TEST(ProgramRun, OnAMemoryOfOnesOwnComputesTheSameInAnotherTime) {
  Saxpy fixed, own;
  const ProgramResult expected = run_program(fixed.options);
  RowStore rows(own.memory);
  const ProgramResult result = run_program(own.options, rows);
  fixed.expect_result();
  own.expect_result();
  EXPECT_EQ(result.memory_reads, expected.memory_reads);
  EXPECT_EQ(rows.row_hits + rows.row_misses, result.memory_reads + result.memory_writes);
  EXPECT_GT(rows.row_hits, 0u);
  EXPECT_NE(result.cycles, expected.cycles);
}

TEST(ProgramRun, HasStoredEverythingWhenItEnds) {
  for (const uint32_t units : {1u, 2u, 4u}) {
    Saxpy saxpy;
    // What the model stores goes through the port alone.
    Memory own = saxpy.memory;
    saxpy.use(make_model(saxpy.options.configuration, own, units).device);
    const ProgramResult result = run_program(saxpy.options);
    saxpy.expect_result();
    EXPECT_EQ(result.memory_writes, 2 * Saxpy::kElements / 8) << units;
  }
}

/// Clocks each cycle by itself, as an engine does that cannot skip any.
struct EveryCycle : ComputeUnit {
  explicit EveryCycle(std::unique_ptr<ComputeUnit> inner) : unit(std::move(inner)) {}
  uint32_t units() const override { return unit->units(); }
  void reset(uint32_t length, uint32_t limit) override { unit->reset(length, limit); }
  void set_argument(uint32_t index, uint32_t value) override { unit->set_argument(index, value); }
  const UnitOutputs& outputs() const override { return unit->outputs(); }
  void clock(const UnitInputs& inputs) override { unit->clock(inputs); }
  const UnitTrace& trace() const override { return unit->trace(); }
  uint64_t counter(int number) override { return unit->counter(number); }
  bool timed() const override { return unit->timed(); }

  std::unique_ptr<ComputeUnit> unit;
};

TEST(ProgramRun, SkipsOnlyCyclesInWhichNothingHappens) {
  for (const uint32_t units : {1u, 2u}) {
    Saxpy quick, slow;
    quick.use(make_model(quick.options.configuration, quick.memory, units).device);
    slow.use(std::make_unique<EveryCycle>(make_model(slow.options.configuration, slow.memory, units).device));
    const ProgramResult expected = run_program(slow.options), result = run_program(quick.options);
    EXPECT_EQ(result.cycles, expected.cycles) << units;
    EXPECT_EQ(result.counters, expected.counters) << units;
    EXPECT_EQ(result.memory_port_utilisation, expected.memory_port_utilisation) << units;
  }
}

struct SilentStore : chip::FixedLatencyStore {
  explicit SilentStore(Memory& memory) : FixedLatencyStore(memory, nullptr, chip::kFarAway + 1000) {}
};

TEST(ProgramRun, OnAMemoryThatNeverAnswersIsLockedUp) {
  Saxpy saxpy;
  SilentStore silent(saxpy.memory);
  saxpy.options.watchdog_cycles = 1000;
  try {
    run_program(saxpy.options, silent);
    FAIL() << "no lock-up";
  } catch (const ChipStalled& stalled) {
    const std::string text = stalled.what();
    for (const char* part :
         {"the chip is locked up: for 1000 cycles", "2 of 2 blocks launched; unit 0: running, 2 kernels to end",
          "the device waits for a line that the memory never gives", "0 instructions retired"})
      EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
  }
}

TEST(ProgramRun, WaitsForASlowMemory) {
  Saxpy saxpy;
  saxpy.options.configuration.chip.memory_latency = 10'000;
  saxpy.options.watchdog_cycles = 1000;
  EXPECT_GT(run_program(saxpy.options).cycles, 10'000u);
  saxpy.expect_result();
}

TEST(ProgramRun, RefusesAMemoryFasterThanThePort) {
  Saxpy saxpy;
  saxpy.options.configuration.chip.memory_latency = 8;
  EXPECT_THROW(run_program(saxpy.options), InputError);
  ++saxpy.options.configuration.chip.memory_latency;
  run_program(saxpy.options);
  saxpy.expect_result();
}

TEST(ProgramRun, EndsBeforeAPerformanceCounterMayBeginAgain) {
  Bench bench(assembled("@p1 jnone 0; exit"));
  bench.configuration.counter_bits = bench.options.configuration.counter_bits = 16;
  bench.unit = make_model(bench.configuration, bench.memory, 1).device;
  bench.options.device = bench.unit.get();
  try {
    run_program(bench.options);
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).find("1023 cycles have passed"), 0u) << error.what();
  }
}

TEST(ProgramRun, ShowsItsProgressNowAndThen) {
  Bench bench(assembled("@p1 jnone 0; exit"));
  bench.unit = make_model(bench.configuration, bench.memory, 1).device;
  bench.options.device = bench.unit.get();
  bench.options.limits.cycles = 50'000;
  std::vector<uint64_t> shown;
  bench.options.progress = [&](uint64_t cycles, uint64_t) { shown.push_back(cycles); };
  EXPECT_THROW(run_program(bench.options), LimitPassed);
  EXPECT_EQ(shown, (std::vector<uint64_t>{16384, 32768, 49152}));
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
