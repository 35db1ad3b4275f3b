// The lockstep with a second model in the place of the RTL: a test can alter its inputs, trace, outputs and counters.
#include "lockstep/lockstep_unit.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <iostream>

#include "bits.hpp"
#include "lockstep/comparison.hpp"
#include "machine/compute/cycle_unit.hpp"
#include "machine/compute/test_chip.hpp"
#include "machine/compute/test_program.hpp"

namespace raypool {
namespace {

using test::assembled;
using test::TestChip;

constexpr uint32_t kMemoryBytes = 8192;

Configuration make_configuration() {
  Configuration configuration;
  configuration.warps = 2;
  configuration.lanes = 4;
  return configuration;
}

// A device under test: a model of its own in the place of the RTL, and what a test does to it.
class Device : public ComputeUnit {
 public:
  std::function<void(UnitTrace&)> alter_trace = [](UnitTrace&) {};
  std::function<void(UnitOutputs&)> alter_outputs = [](UnitOutputs&) {};
  std::function<UnitInputs(UnitInputs)> alter_inputs = [](UnitInputs inputs) { return inputs; };
  std::function<uint64_t(int, uint64_t)> alter_counter = [](int, uint64_t value) { return value; };

  explicit Device(const Memory& memory) : unit_(make_configuration(), memory) {}

  void reset(uint32_t program_length, uint32_t memory_limit) override {
    unit_.reset(program_length, memory_limit);
    update();
  }
  void set_argument(uint32_t index, uint32_t value) override { unit_.set_argument(index, value); }
  const UnitOutputs& outputs() const override { return outputs_; }
  void clock(const UnitInputs& inputs) override {
    unit_.clock(alter_inputs(inputs));
    update();
  }
  void trace_on() override { unit_.trace_on(); }
  const UnitTrace& trace() const override { return trace_; }
  uint64_t counter(int number) override { return alter_counter(number, unit_.counter(number)); }
  bool timed() const override { return true; }

 private:
  void update() {
    outputs_ = unit_.outputs();
    trace_ = unit_.trace();
    alter_trace(trace_);
    alter_outputs(outputs_);
  }
  CycleUnit unit_;
  UnitOutputs outputs_;
  UnitTrace trace_;
};

// Everything a kernel can do: import, ray words, arithmetic, predicates, a loop,
// loads and stores, exports of both sorts.
const std::vector<uint64_t> kProgram = assembled(R"(
    rin                 # 0
    rld r1, 7           # 1
    tid r2              # 2
    shl r3, r2, 2       # 3
    st [r3+1024], r1    # 4
    ld r4, [r3+1024]    # 5
    and r5, r2, 3       # 6
    igt p1, r5, 0       # 7
    @p1 loop 12         # 8
    @p1 isub r5, r5, 1  # 9
    @p1 iadd r4, r4, 1  # 10
    @p1 igt p1, r5, 0   # 11
    rst 8, r4           # 12
    ige p2, r2, 2       # 13
    @p2 rout            # 14
    rst 7, r2
    rst 8, 0x1          # 15, 16
    rst 9, 0x2
    rst 10, 0x3
    @p2 rfb             # 19
    exit)");

struct Fixture {
  Memory memory;
  Device* device;
  std::unique_ptr<LockstepUnit> unit;
  TestChip chip;

  explicit Fixture(const std::vector<uint64_t>& code = kProgram, LockstepOptions options = {}, int ready_percent = 60)
      : memory(with_program(code)),
        device(new Device(memory)),
        unit(make_lockstep_unit(make_configuration(), std::unique_ptr<ComputeUnit>(device), memory,
                                named(std::move(options)))),
        chip(*unit, memory, 7, ready_percent) {
    unit->reset(size32(code), kMemoryBytes);
  }
  static Memory with_program(const std::vector<uint64_t>& code) {
    Memory result(kMemoryBytes);
    test::put_program(result, code);
    return result;
  }
  static LockstepOptions named(LockstepOptions options) {
    options.kernel_names = {{0, "everything"}};
    return options;
  }
  void launch(uint32_t threads = 7, ImportKind import = ImportKind::Normal) {
    LaunchCommand command;
    command.threads = threads;
    command.import = import;
    chip.launches.push_back(command);
  }
  // Runs two kernels; the report, or "" without a difference.
  std::string report() {
    launch();
    launch();
    try {
      chip.run(20000);
    } catch (const LockstepDifference& difference) {
      EXPECT_EQ(unit->counts().differences, 1u);
      return difference.what();
    }
    return "";
  }
};

void expect_parts(const std::string& report, const std::vector<std::string>& parts) {
  for (const std::string& part : parts) {
    EXPECT_NE(report.find(part), std::string::npos) << "the report lacks '" << part << "':\n" << report;
  }
}

TEST(Lockstep, EqualUnitsShowNoDifferenceAndEverythingIsCounted) {
  Fixture fixture;
  EXPECT_EQ(fixture.report(), "");
  const LockstepCounts& counts = fixture.unit->counts();
  EXPECT_EQ(counts.kernels, 2u);
  // 17 instructions outside the loop; 4 times `loop` and 3 bodies of 3 in warp 0;
  // warp 1 has 3 threads and one turn less.
  EXPECT_EQ(counts.instructions, 2u * ((17 + 4 + 9) + (17 + 3 + 6)));
  EXPECT_EQ(counts.stores, 14u);
  EXPECT_EQ(counts.memory_writes, 4u);
  EXPECT_EQ(counts.ray_words, 2u * 5 * 7);
  EXPECT_EQ(counts.imports, 14u);
  EXPECT_EQ(counts.exports, 10u);
  EXPECT_EQ(counts.frame_contributions, 10u);
  EXPECT_EQ(counts.differences, 0u);
  EXPECT_GT(counts.thread_results, 0u);
  EXPECT_NE(to_string(counts).find("0 differences"), std::string::npos);
}

TEST(Lockstep, AWrongRegisterResultIsReportedWithItsOperandsAndHistory) {
  Fixture fixture;
  fixture.device->alter_trace = [](UnitTrace& trace) {
    for (RetireEvent& event : trace.retired) {
      if (event.warp == 1 && event.pc == 6) event.data[2] ^= 0x10;
    }
  };
  const std::string report = fixture.report();
  expect_parts(report,
               {"register result differs", "everything", "warp 1, PC 6: and", "<-- differs", "00000012", "00000002",
                "rp_int_alu.v", "not in the thread mask", "2 launched so far", "before it", "immediate"});
  EXPECT_THROW(fixture.chip.cycle(), LockstepDifference) << "a difference stays";
}

TEST(Lockstep, AWrongLaneOutsideTheMaskIsNoDifference) {
  Fixture fixture;
  fixture.device->alter_trace = [](UnitTrace& trace) {
    for (RetireEvent& event : trace.retired) {
      for (uint32_t lane = 0; lane < 4; ++lane) {
        if (!(event.mask >> lane & 1)) event.data[lane] = 0xdead;
      }
    }
  };
  EXPECT_EQ(fixture.report(), "");
}

struct TraceCase {
  const char* name;
  std::function<void(UnitTrace&)> alter;
  std::vector<std::string> parts;
};

// Alters the event of warp 0 at a PC.
std::function<void(UnitTrace&)> at(uint32_t pc, const std::function<void(RetireEvent&)>& change) {
  return [=](UnitTrace& trace) {
    for (RetireEvent& event : trace.retired) {
      if (event.warp == 0 && event.pc == pc) change(event);
    }
  };
}

class LockstepTrace : public testing::TestWithParam<TraceCase> {};

TEST_P(LockstepTrace, DifferenceIsFound) {
  Fixture fixture;
  fixture.device->alter_trace = GetParam().alter;
  expect_parts(fixture.report(), GetParam().parts);
}

INSTANTIATE_TEST_SUITE_P(All, LockstepTrace,
                         testing::Values(TraceCase{"pc",
                                                   at(9, [](RetireEvent& event) { event.pc = 13; }),
                                                   {"another PC", "PC    13", "rp_pc_stack.v"}},
                                         TraceCase{"instruction",
                                                   at(9, [](RetireEvent& event) { event.instruction ^= 1; }),
                                                   {"another instruction", "rp_instruction_cache.v"}},
                                         TraceCase{"mask",
                                                   at(9, [](RetireEvent& event) { event.mask ^= 1; }),
                                                   {"thread mask differs", "1111", "rp_predicate_file.v"}},
                                         TraceCase{"predicate",
                                                   at(7, [](RetireEvent& event) { event.predicate ^= 1; }),
                                                   {"predicate result differs", "igt", "rp_brh_alu.v"}},
                                         TraceCase{"lost_instruction",
                                                   [](UnitTrace& trace) {
                                                     if (!trace.retired.empty() && trace.retired[0].warp == 0 &&
                                                         trace.retired[0].pc == 3)
                                                       trace.retired.erase(trace.retired.begin());
                                                   },
                                                   {"in this cycle in the model, and not in the RTL", "PC     3: shl"}},
                                         TraceCase{"store_data",
                                                   [](UnitTrace& trace) {
                                                     for (StoreEvent& event : trace.stores) event.data[1] ^= 1;
                                                   },
                                                   {"words stored differ", "st", "rp_mem_alu.v"}},
                                         TraceCase{"store_address",
                                                   [](UnitTrace& trace) {
                                                     for (StoreEvent& event : trace.stores) event.address += 16;
                                                   },
                                                   {"words stored differ", "00000410"}},
                                         TraceCase{"store_lost",
                                                   [](UnitTrace& trace) { trace.stores.clear(); },
                                                   {"stores in this cycle in the model, and not in the RTL", "st"}},
                                         TraceCase{"ray_data",
                                                   [](UnitTrace& trace) {
                                                     for (RayWriteEvent& event : trace.ray_writes) event.data[1] ^= 1;
                                                   },
                                                   {"words written to ray memory differ", "rst", "rp_ray_alu.v"}},
                                         TraceCase{"ray_word",
                                                   [](UnitTrace& trace) {
                                                     for (RayWriteEvent& event : trace.ray_writes) event.word ^= 1;
                                                   },
                                                   {"words written to ray memory differ", "word 9"}},
                                         TraceCase{"ray_mask",
                                                   [](UnitTrace& trace) {
                                                     for (RayWriteEvent& event : trace.ray_writes) event.mask &= 7;
                                                   },
                                                   {"words written to ray memory differ", "0111"}}),
                         [](const auto& test_case) { return std::string(test_case.param.name); });

struct PortCase {
  const char* name;
  std::function<void(UnitOutputs&)> alter;
  std::vector<std::string> parts;
};

class LockstepPort : public testing::TestWithParam<PortCase> {};

TEST_P(LockstepPort, DifferenceIsFound) {
  Fixture fixture;
  fixture.device->alter_outputs = GetParam().alter;
  expect_parts(fixture.report(), GetParam().parts);
}

INSTANTIATE_TEST_SUITE_P(
    All, LockstepPort,
    testing::Values(
        PortCase{"write_data",
                 [](UnitOutputs& out) { out.memory_request.data[1] ^= 1; },
                 {"memory requests differ", "word 1", "<-- differs", "rp_data_cache.v"}},
        PortCase{
            "write_alone",
            [](UnitOutputs& out) { out.memory_request_valid = out.memory_request_valid && !out.memory_request.write; },
            {"memory requests differ", "kind", "write", "00000400", "word 0", "-    "}},
        PortCase{
            "read_alone",
            [](UnitOutputs& out) { out.memory_request_valid = out.memory_request_valid && out.memory_request.write; },
            {"memory requests differ", "read of instructions", "00000000", "16 (unit 0)",
             "rtl/compute/rp_instruction_cache.v"}},
        PortCase{"write_mask", [](UnitOutputs& out) { out.memory_request.mask &= 7; }, {"memory requests differ"}},
        PortCase{
            "write_address", [](UnitOutputs& out) { out.memory_request.address ^= 64; }, {"memory requests differ"}},
        PortCase{"export_data",
                 [](UnitOutputs& out) {
                   if (out.export_last) out.export_data[0] ^= 1;
                 },
                 {"exported beats differ", "word 0", "<-- differs"}},
        PortCase{"export_last", [](UnitOutputs& out) { out.export_last = false; }, {"exported beats differ", "last"}},
        PortCase{
            "frame_colour", [](UnitOutputs& out) { out.frame.rgb[1] ^= 1; }, {"frame contributions differ", "green"}},
        PortCase{
            "frame_pixel", [](UnitOutputs& out) { out.frame.pixel ^= 1; }, {"frame contributions differ", "pixel"}},
        PortCase{"exports",
                 [](UnitOutputs& out) {
                   if (out.exports[0] > 2) --out.exports[0];
                 },
                 {"counts of packages to be exported differ", "exports of unit 0", "rtl/compute/rp_ray_alu.v"}},
        PortCase{"import_kind",
                 [](UnitOutputs& out) { out.import_request_kind = ImportKind::Shadow; },
                 {"import requests differ", "kind"}},
        PortCase{"done_early",
                 [](UnitOutputs& out) { out.kernel_done = out.busy; },
                 {"launch outputs differ", "kernel_done"}},
        PortCase{"done_never", [](UnitOutputs& out) { out.kernel_done = 0; }, {"launch outputs differ"}},
        PortCase{"idle_early", [](UnitOutputs& out) { out.idle = true; }, {"idle"}},
        PortCase{"fault",
                 [](UnitOutputs& out) {
                   if (out.export_valid) out.fault = {FaultCode::Misaligned, 0, 3};
                 },
                 {"faults differ", "misaligned address (code 5) at warp 0, PC 3"}}),
    [](const auto& test_case) { return std::string(test_case.param.name); });

TEST(Lockstep, ACounterThatDiffersIsFoundWhenTheUnitIsIdle) {
  Fixture fixture;
  fixture.device->alter_counter = [](int number, uint64_t value) {
    return value + (number == counter::kWaiting + 3 ? 1 : 0);
  };
  expect_parts(fixture.report(), {"performance counter 27 differs", "rp_performance_counters.v"});
}

TEST(Lockstep, ACycleThatBothSidesForgetIsFoundWhenTheUnitIsIdle) {
  const Memory memory(65536);
  Device device(memory);
  device.alter_counter = [](int number, uint64_t value) { return value + (number == counter::kBusyCycles ? 1 : 0); };
  try {
    lockstep::compare_counters(make_configuration(), device, device);
    FAIL() << "a busy cycle in which no warp was in any state";
  } catch (const lockstep::Mismatch& mismatch) {
    EXPECT_EQ(mismatch.title, "the warps' states do not sum up to their cycles");
  }
}

TEST(Lockstep, ARetirementThatComesACycleLateIsFound) {
  Fixture fixture;
  std::vector<RetireEvent> late;
  fixture.device->alter_trace = [&late](UnitTrace& trace) {
    const std::vector<RetireEvent> now = trace.retired;
    trace.retired.clear();
    for (const RetireEvent& event : late) trace.retired.push_back(event);
    late.clear();
    for (const RetireEvent& event : now) (event.pc == 6 && event.warp == 1 ? late : trace.retired).push_back(event);
  };
  expect_parts(fixture.report(), {"warp 1 retires an instruction in this cycle in the model, and not in the RTL",
                                  "PC     6: and", "rp_fetch_arbiter.v"});
}

TEST(Lockstep, AnOutputThatComesACycleLateIsFound) {
  Fixture fixture;
  fixture.device->alter_outputs = [before = false](UnitOutputs& out) mutable {
    const bool now = out.frame_valid;
    out.frame_valid = now && before;
    before = now;
  };
  expect_parts(fixture.report(), {"frame contributions differ in this cycle", "valid", "<-- differs"});
}

TEST(Lockstep, AnOutputThatChangesWhileItWaitsIsFound) {
  Fixture fixture;
  uint32_t salt = 0;
  fixture.device->alter_outputs = [&salt](UnitOutputs& out) { out.export_data[3] = ++salt; };
  expect_parts(fixture.report(), {"export"});
}

TEST(Lockstep, AnAlteredImportIsFound) {
  Fixture fixture;
  fixture.device->alter_inputs = [](UnitInputs inputs) {
    inputs.import_beat[3] ^= 4;
    return inputs;
  };
  expect_parts(fixture.report(), {"register result differs", "rld", "rp_ray_alu.v"});
}

TEST(Lockstep, AWrongLaunchIsFound) {
  Fixture fixture;
  fixture.device->alter_inputs = [](UnitInputs inputs) {
    inputs.launch.threads = 8;
    return inputs;
  };
  EXPECT_NE(fixture.report(), "");
}

TEST(Lockstep, AHangIsReportedWithWhatEveryWarpWaitsFor) {
  LockstepOptions options;
  options.watchdog_cycles = 100;
  Fixture fixture(kProgram, options);
  fixture.chip.imports_ready = false;
  const std::string report = fixture.report();
  expect_parts(report, {"hang", "for 100 cycles", "warp  0: PC     0: rin", "its packages have not come",
                        "7 packages announced"});
  EXPECT_LT(fixture.unit->counts().cycles, 800u);
}

TEST(Lockstep, AWaitForASlowChipIsNoHang) {
  LockstepOptions options;
  options.watchdog_cycles = 100;
  options.answered_soon = false;
  Fixture fixture(kProgram, options);
  fixture.chip.imports_ready = false;
  fixture.launch();
  for (int i = 0; i < 1000; ++i) fixture.chip.cycle();
  fixture.chip.imports_ready = true;
  EXPECT_EQ(fixture.report(), "");
  EXPECT_GT(fixture.unit->counts().instructions, 0u);
}

TEST(Lockstep, AWarpThatWaitsWithoutARequestHangsHoweverSlowTheChip) {
  LockstepOptions options;
  options.watchdog_cycles = 100;
  options.answered_soon = false;
  Fixture fixture(assembled("rin; exit"), options);
  fixture.launch(7, ImportKind::None);
  std::string report;
  try {
    for (int i = 0; i < 1000; ++i) fixture.chip.cycle();
  } catch (const LockstepDifference& difference) {
    report = difference.what();
  }
  expect_parts(report, {"hang", "for 100 cycles", "warp  0: PC     0: rin"});
}

TEST(Lockstep, FaultsThatBothReportAlikeAreNoDifference) {
  Fixture fixture(assembled("mov r1, 2; ld r1, [r1]; mov r2, 0; exit"));
  fixture.launch(3, ImportKind::None);
  EXPECT_FALSE(fixture.chip.run());
  for (int i = 0; i < 50; ++i) fixture.chip.cycle();
  EXPECT_EQ(fixture.unit->counts().faults, 1u);
  EXPECT_EQ(fixture.unit->counts().differences, 0u);
  EXPECT_EQ(fixture.unit->outputs().fault.code, FaultCode::Misaligned);
}

TEST(Lockstep, AFaultThatTheUnitMissesIsFound) {
  Fixture fixture(assembled("mov r1, 2; ld r1, [r1]; mov r2, 0; exit"));
  fixture.device->alter_outputs = [](UnitOutputs& out) { out.fault = {}; };
  fixture.launch(3, ImportKind::None);
  try {
    fixture.chip.run(2000);
    FAIL() << "no difference";
  } catch (const LockstepDifference& difference) {
    expect_parts(difference.what(), {"faults differ", "RTL:   no fault", "misaligned address"});
  }
}

TEST(Lockstep, AFaultThatDoesNotStayIsFound) {
  Fixture fixture(assembled("mov r1, 2; ld r1, [r1]; exit"));
  fixture.launch(3, ImportKind::None);
  EXPECT_FALSE(fixture.chip.run());
  for (int i = 0; i < 5; ++i) fixture.chip.cycle();
  fixture.device->alter_outputs = [](UnitOutputs& out) { out.fault.pc = 7; };
  EXPECT_THROW(fixture.chip.cycle(), LockstepDifference);
}

TEST(Lockstep, ARunThatIsToFindADifferenceAgainEndsWithoutOne) {
  LockstepOptions options;
  options.inspect_until = 30;
  Fixture fixture(kProgram, options);
  fixture.launch();
  EXPECT_THROW(fixture.chip.run(20000), std::runtime_error);
  EXPECT_EQ(fixture.unit->counts().cycles, 30u);
}

/// What comes of runs with these `reports`, one after another: "" is a run without a difference.
std::string inspected(const std::vector<std::string>& reports, uint64_t first_until,
                      const std::vector<uint64_t>& expected_runs) {
  std::vector<uint64_t> runs;
  std::string result;
  try {
    inspect_differences([&](uint64_t inspect_until) {
      runs.push_back(inspect_until);
      const std::string& report = reports.at(runs.size() - 1);
      if (!report.empty()) throw LockstepDifference(report, runs.size() == 1 ? first_until : 0);
    });
  } catch (const LockstepDifference& difference) {
    result = difference.what();
    EXPECT_EQ(difference.inspect_until, 0u);
  }
  EXPECT_EQ(runs, expected_runs);
  return result;
}

TEST(InspectDifferences, RunsAgainOnlyForADifferenceOfWhichMoreCanBeKnown) {
  const std::string first = "the results differ\n  cycle 7, kernel 1\n  look at: rtl/a.v", better = first + ", rtl/b.v";
  EXPECT_EQ(inspected({""}, 7, {0}), "");
  EXPECT_EQ(inspected({first}, 0, {0}), first);
  EXPECT_EQ(inspected({first, better}, 7, {0, 7}), better);
}

TEST(InspectDifferences, KeepTheFirstReportWhenTheSecondRunGoesOtherwise) {
  const std::string first = "the results differ\n  cycle 7, kernel 1\n  look at: rtl/a.v";
  for (const std::string second : {"", "the results differ\n  cycle 6, kernel 1\n  look at: rtl/b.v"}) {
    const std::string result = inspected({first, second}, 7, {0, 7});
    expect_parts(result, {first, "it went otherwise", second.empty() ? "without a difference" : second});
  }
}

TEST(Lockstep, ResetStartsAfresh) {
  Fixture fixture;
  EXPECT_EQ(fixture.report(), "");
  fixture.unit->reset(size32(kProgram), kMemoryBytes);
  EXPECT_EQ(fixture.report(), "");
  EXPECT_EQ(fixture.unit->counts().kernels, 4u);
}

TEST(Lockstep, ArgumentsReachBoth) {
  Fixture fixture(assembled("arg r1, 5; exit"));
  fixture.unit->set_argument(5, 99);
  fixture.launch(8, ImportKind::None);
  EXPECT_TRUE(fixture.chip.run());
  EXPECT_EQ(fixture.unit->counts().thread_results, 8u);
}

}  // namespace
}  // namespace raypool
