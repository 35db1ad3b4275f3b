// The whole compute unit in RTL: Verilated for several configurations and run in lockstep
// with the model, on random programs.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <iostream>

#include "bits.hpp"
#include "cosim/cosim.hpp"
#include "lockstep/lockstep_unit.hpp"
#include "lockstep/rtl_loader.hpp"
#include "machine/compute/test_chip.hpp"
#include "machine/compute/test_exports.hpp"
#include "machine/compute/test_program.hpp"
#include "rtl/test_library.hpp"

namespace raypool {
namespace {

using test::assembled;
using test::TestChip;

constexpr uint32_t kData = 32768;
constexpr uint32_t kMemoryBytes = kData + 64 * 1024;

struct Case {
  const char* name;
  std::function<void(Configuration&)> change;
  bool waves = false;
};

Configuration configuration_of(const Case& test_case) {
  Configuration configuration;
  configuration.name = test_case.name;
  test_case.change(configuration);
  check_configuration(configuration, test_case.name);
  return configuration;
}

std::string library_of(const Case& test_case) {
  return test::build_library(configuration_of(test_case), 1, test_case.waves);
}

class RtlUnit : public testing::TestWithParam<Case> {};

TEST_P(RtlUnit, AgreesWithTheModelOnRandomPrograms) {
  const std::string library = library_of(GetParam());
  const Configuration configuration = configuration_of(GetParam());
  LockstepCounts sum;
  for (uint64_t seed = 1; seed <= 100; ++seed) {
    const RandomProgram program = make_random_program(configuration, seed);
    Memory memory = program.memory;
    LockstepOptions options;
    options.inspect_until = kInspectAlways;
    const auto unit = make_lockstep_unit(configuration, load_rtl_unit(library, configuration), memory, options);
    try {
      run_random_program(*unit, memory, program, seed);
    } catch (const std::exception& error) {
      FAIL() << "seed " << seed << ": " << error.what();
    }
    EXPECT_EQ(unit->uninspected(), "");
    for (const lockstep::Finding& finding : unit->inside()) ADD_FAILURE() << "seed " << seed << ": " << finding.text;
    sum += unit->counts();
  }
  std::cout << to_string(sum) << "\n";
  EXPECT_GT(sum.instructions, 10000u);
  EXPECT_GT(sum.stores, 100u);
  EXPECT_GT(sum.exports, 5u);
  EXPECT_GT(sum.frame_contributions, 5u);
  EXPECT_GT(sum.imports, 10u);
}

struct FaultProgram {
  const char* name;
  std::vector<uint64_t> code;
  FaultCode fault;
  uint32_t pc = 0;  // of the launch
};

TEST_P(RtlUnit, ReportsTheModelsFaults) {
  const std::string library = library_of(GetParam());
  const Configuration configuration = configuration_of(GetParam());
  const FaultProgram programs[] = {
      {"illegal", assembled("mov r1, 1; .word 0xf000000000000000; exit"), FaultCode::IllegalInstruction},
      {"outside", assembled("mov r1, 1; jany 99"), FaultCode::PcOutsideProgram},
      {"end", assembled("mov r1, 1"), FaultCode::PcOutsideProgram},
      // All warps in the same cycle: the lowest counts.
      {"launch", assembled("exit"), FaultCode::PcOutsideProgram, 99},
      {"overflow", assembled("call 0, 99; exit"), FaultCode::StackOverflow},
      {"underflow", assembled("mov r1, 1; ret; exit"), FaultCode::StackUnderflow},
      {"misaligned", assembled("mov r1, 1026; ld r1, [r1]; exit"), FaultCode::Misaligned},
      {"limit", assembled(fmt::format("mov r1, {}; st [r1], r1; exit", kMemoryBytes)), FaultCode::AddressOutsideMemory},
      {"word", assembled(".word 0x6180401500000000  # rld r1, 21\nexit"), FaultCode::RayWordOutside},
      {"unmasked_word", assembled(".word 0x6240005e00000000  # @!p0 rst 30, r1\nexit"), FaultCode::RayWordOutside},
  };
  std::vector<FaultProgram> all(std::begin(programs), std::end(programs));
  if (configuration.subnormals == Subnormals::None) {
    all.push_back({"operand", assembled("mov r1, 1.0; fadd r2, r1, 1e-39; exit"), FaultCode::SubnormalNumber});
    all.push_back({"result", assembled("mov r1, 1e-20; fmul r2, r1, r1; exit"), FaultCode::SubnormalNumber});
    all.push_back({"compare", assembled("mov r1, 1.0; flt p1, r1, 1e-39; exit"), FaultCode::SubnormalNumber});
    all.push_back({"quotient", assembled("mov r1, 1e-30; fdiv r2, r1, 1e30; exit"), FaultCode::SubnormalNumber});
  }
  if (configuration.registers < kRegisters) {
    all.push_back({"register", assembled("mov r1, 1; iadd r2, r1, r12; exit"), FaultCode::IllegalInstruction});
    all.push_back({"predicate", assembled("mov r1, 1; @p5 mov r1, 2; exit"), FaultCode::IllegalInstruction});
    all.push_back({"argument", assembled("mov r1, 1; arg r1, 11; exit"), FaultCode::IllegalInstruction});
    all.push_back({"twin", assembled(fmt::format("mov r1, 1; jany {}; exit", (1 << configuration.pc_bits) + 2)),
                   FaultCode::PcOutsideProgram});
    all.push_back({"launch_twin", assembled("exit"), FaultCode::PcOutsideProgram, 1u << configuration.pc_bits});
  }
  for (const FaultProgram& program : all) {
    Memory memory(kMemoryBytes);
    test::put_program(memory, program.code);
    auto unit = make_lockstep_unit(configuration, load_rtl_unit(library, configuration), memory);
    unit->reset(size32(program.code), kMemoryBytes);
    TestChip chip(*unit, memory);
    LaunchCommand command;
    command.pc = program.pc;
    command.threads = configuration.contents();
    chip.launches.push_back(command);
    try {
      EXPECT_FALSE(chip.run(20000)) << program.name;
      EXPECT_EQ(unit->outputs().fault.code, program.fault) << program.name;
      EXPECT_EQ(unit->counts().faults, 1u) << program.name;
    } catch (const LockstepDifference& difference) {
      ADD_FAILURE() << program.name << ": " << difference.what();
    }
  }
}

TEST_P(RtlUnit, CountsTheExportsOfAKernelBeforeItIsDone) {
  const std::string library = library_of(GetParam());
  const Configuration configuration = configuration_of(GetParam());
  const std::vector<uint64_t> code = test::exporting_program();
  for (const bool alone : {true, false}) {
    Memory memory(kMemoryBytes);
    test::put_program(memory, code);
    const auto unit = make_lockstep_unit(configuration, load_rtl_unit(library, configuration), memory);
    unit->reset(size32(code), kMemoryBytes);
    TestChip chip(*unit, memory, 1, 50);
    test::expect_exports_counted(*unit, chip, configuration, alone);
  }
}

// A narrow counter wraps in a kernel of 70,000 cycles and more, as a wide one does after days.
TEST_P(RtlUnit, CountsOnWhereACounterWraps) {
  const std::string library = library_of(GetParam());
  const Configuration configuration = configuration_of(GetParam());
  const std::vector<uint64_t> code = assembled("mov r1, 0; iadd r1, r1, 1; ilt p1, r1, 20000; @p1 jany 1; exit");
  Memory memory(kMemoryBytes);
  test::put_program(memory, code);
  const auto unit = make_lockstep_unit(configuration, load_rtl_unit(library, configuration), memory);
  unit->reset(size32(code), kMemoryBytes);
  TestChip chip(*unit, memory);
  LaunchCommand command;
  command.threads = configuration.contents();
  chip.launches.push_back(command);
  try {
    EXPECT_TRUE(chip.run(2'000'000));
  } catch (const LockstepDifference& difference) {
    FAIL() << difference.what();
  }
  EXPECT_GT(unit->counts().counters, 0u);
  EXPECT_GT(unit->counts().cycles, 70'000u);
  const uint64_t most = (uint64_t{1} << configuration.counter_bits) - 1;
  EXPECT_LE(unit->counter(counter::kBusyCycles), most);
  EXPECT_EQ(unit->counter(counter::kBusyCycles) < 70'000, most < 70'000);
}

TEST_P(RtlUnit, ALibraryOfOtherParametersIsRefused) {
  const std::string library = library_of(GetParam());
  Configuration other = configuration_of(GetParam());
  other.data_cache_mshrs = other.data_cache_mshrs == 3 ? 5 : 3;
  try {
    load_rtl_unit(library, other);
    FAIL() << "it was loaded";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("DATA_CACHE_MSHRS"), std::string::npos) << error.what();
  }
  EXPECT_THROW(load_rtl_unit("no/such/library.so", other), InputError);
}

const Case kCases[] = {
    {"8w8c", [](Configuration&) {}},
    {"1w1c",
     [](Configuration& c) {
       c.warps = c.lanes = 1, c.data_cache_mshrs = 1, c.data_cache_bytes = c.instruction_cache_bytes = 512;
     }},
    {"2w2c_least",
     [](Configuration& c) {
       c.warps = c.lanes = 2, c.registers = 8, c.predicates = 2, c.arguments = 4, c.pc_bits = 8, c.counter_bits = 16;
     }},
    {"2w4c_less",
     [](Configuration& c) {
       c.warps = 2, c.lanes = 4, c.registers = 12, c.predicates = 5, c.arguments = 11, c.pc_bits = 11;
       c.counter_bits = 20, c.fma = c.triples = true;
       c.alus[AluType::Flt].depth = 5;
     }},
    {"4w2c_many",
     [](Configuration& c) {
       c.warps = 4, c.lanes = 2, c.subnormals = Subnormals::None, c.slow_unit = SlowUnit::Newton1, c.stack_depth = 5,
       c.fma = true;
       c.alus[AluType::Int] = {2, 1, 4};
       c.alus[AluType::Flt] = {3, 4, 5};
       c.alus[AluType::Slw] = {1, 16, 12};
       c.alus[AluType::Brh] = {1, 2, 2};
       c.alus[AluType::Tid] = {2, 1, 1};
     }},
};

INSTANTIATE_TEST_SUITE_P(Configurations, RtlUnit, testing::ValuesIn(kCases),
                         [](const auto& test_case) { return std::string(test_case.param.name); });

TEST(RtlUnitWaves, WritesAWaveformWhenBuiltForIt) {
  const Case waves{"1w1c_waves", [](Configuration& c) { c.warps = c.lanes = 1; }, true};
  const Configuration configuration = configuration_of(waves);
  const std::string path = std::string(RAYPOOL_TEST_UNITS) + "/waves.fst";
  std::filesystem::remove(path);
  Memory memory(kMemoryBytes);
  test::put_program(memory, assembled("exit"));
  {
    auto unit = load_rtl_unit(library_of(waves), configuration);
    unit->open_waveform(path);
    unit->reset(1, kMemoryBytes);
    TestChip chip(*unit, memory);
    LaunchCommand command;
    command.threads = 1;
    chip.launches.push_back(command);
    EXPECT_TRUE(chip.run(10000));
    EXPECT_TRUE(unit->timed());
    EXPECT_EQ(unit->counter(counter::kInstructions), 1u);
  }
  EXPECT_GT(std::filesystem::file_size(path), 1000u);
}

}  // namespace
}  // namespace raypool
