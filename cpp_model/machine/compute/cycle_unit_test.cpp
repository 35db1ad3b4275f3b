#include "machine/compute/cycle_unit.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "bits.hpp"
#include "machine/compute/functional_unit.hpp"
#include "machine/compute/model.hpp"
#include "machine/compute/test_chip.hpp"
#include "machine/compute/test_exports.hpp"
#include "machine/compute/test_program.hpp"
#include "machine/compute/warp_cycles.hpp"

namespace raypool {
namespace {

using test::assembled;
using test::TestChip;

constexpr uint32_t kMemoryBytes = 16384;
constexpr uint32_t kData = 8192;

Configuration make_configuration(uint32_t warps, uint32_t lanes) {
  Configuration configuration;
  configuration.warps = warps;
  configuration.lanes = lanes;
  return configuration;
}

// Imports, a divergent loop over memory, slow arithmetic, exports: every block has something to do.
const std::vector<uint64_t> kProgram = assembled(fmt::format(R"(
    rin
    rld r1, 7
    tid r2
    and r5, r2, 3
    shl r3, r2, 6
    ige p1, r5, 0
    @p1 loop 14
    @p1 ld r4, [r3+{0}]
    @p1 iadd r4, r4, r5
    @p1 st [r3+{0}], r4
    i2f r6, r4
    fsqrt r6, r6
    @p1 isub r5, r5, 1
    @p1 ige p1, r5, 0
    rst 8, r6
    rout
    rst 9, r4
    rfb
    exit)",
                                                             kData));

Memory with_program(const std::vector<uint64_t>& code) {
  Memory memory(kMemoryBytes);
  test::put_program(memory, code);
  return memory;
}

LaunchCommand launch_of(uint32_t threads, ImportKind import = ImportKind::None) {
  LaunchCommand command;
  command.threads = threads;
  command.import = import;
  return command;
}

TEST(CycleUnit, LeavesWhatTheFunctionalUnitLeaves) {
  for (const auto& [warps, lanes] : {std::pair{1, 1}, {4, 4}, {8, 8}, {2, 32}}) {
    const Configuration configuration = make_configuration(warps, lanes);
    std::vector<std::vector<Ray>> rays;
    std::vector<Memory> memories;
    for (const bool timed : {false, true}) {
      Memory memory = with_program(kProgram);
      std::unique_ptr<ComputeUnit> unit;
      if (timed) {
        unit = std::make_unique<CycleUnit>(configuration, memory);
      } else {
        unit = make_functional_unit(configuration, memory);
      }
      unit->reset(size32(kProgram), kMemoryBytes);
      TestChip chip(*unit, memory, 3, 70);
      for (int i = 0; i < 3; ++i)
        chip.launches.push_back(launch_of(static_cast<uint32_t>(configuration.contents()), ImportKind::Normal));
      EXPECT_TRUE(chip.run());
      EXPECT_EQ(chip.kernels_done, 3u);
      // Warps finish in another order, rays are the same.
      std::sort(chip.rays.begin(), chip.rays.end());
      rays.push_back(chip.rays);
      memories.push_back(memory);
    }
    EXPECT_EQ(rays[0], rays[1]);
    for (uint32_t address = 0; address < kMemoryBytes; address += 4)
      EXPECT_EQ(memories[0].load(address), memories[1].load(address));
  }
}

// docs/machine/architecture.md, section 3.
TEST(CycleUnit, AWarpWithoutStallsIssuesEveryFourCyclesWithAnAluOfDepthOne) {
  const std::vector<uint64_t> code = assembled("tid r1; tid r2; tid r3; tid r4; exit");
  Memory memory = with_program(code);
  CycleUnit unit(make_configuration(1, 4), memory);
  unit.trace_on();
  unit.reset(size32(code), kMemoryBytes);
  TestChip chip(unit, memory);
  chip.launches.push_back(launch_of(4));
  std::vector<uint64_t> retired;
  for (int i = 0; i < 200; ++i) {
    chip.cycle();
    for (size_t n = 0; n < unit.trace().retired.size(); ++n) retired.push_back(chip.cycles);
  }
  ASSERT_EQ(retired.size(), 5u);
  for (size_t i = 1; i < 4; ++i) EXPECT_EQ(retired[i] - retired[i - 1], 4u);
  // The branch ALU has two stages.
  EXPECT_EQ(retired[4] - retired[3], 5u);
}

/// Cycles in which what stands between two instructions without stalls is written back, counted from its issue;
/// one warp, with its lines in the instruction cache.
std::vector<uint64_t> written_back(const std::string& text, uint32_t lanes, bool overlaps, uint32_t flt_depth = 3) {
  Configuration configuration = make_configuration(1, lanes);
  configuration.triples = configuration.fma = true;
  configuration.alus[AluType::Flt].depth = flt_depth;
  // The loop's first round brings the lines.
  const std::vector<uint64_t> code =
      assembled("mov r0, 1024; mov r15, 2; igt p1, r15, 0; @p1 loop 10; isub r15, r15, 1; igt p1, r15, 0; tid r14; " +
                text + "; tid r14; tid r14; exit");
  Memory memory = with_program(code);
  CycleUnit unit(configuration, memory);
  unit.trace_on();
  unit.reset(size32(code), kMemoryBytes);
  TestChip chip(unit, memory);
  chip.launches.push_back(launch_of(lanes));
  std::vector<uint64_t> cycles;
  uint64_t begin = 0;
  for (int i = 0; i < 600; ++i) {
    chip.cycle();
    for (const RetireEvent& event : unit.trace().retired) {
      if (event.pc == 6) begin = chip.cycles, cycles.clear();
      if (event.pc == 7) cycles.push_back(chip.cycles - begin);
      if (event.pc == 8) cycles.push_back(chip.cycles - begin);
    }
  }
  EXPECT_EQ(unit.counter(counter::kFltOverlapped), overlaps ? 4u : 0u) << text;  // 2 of each round
  return cycles;
}

// docs/machine/architecture.md, section 3. The last is a `tid` behind it, which takes 4.
TEST(CycleUnit, ATripleTakesTheCyclesOfArchitectureMd) {
  using Cycles = std::vector<uint64_t>;
  EXPECT_EQ(written_back("ffma r1, r4, r7, r10", 4, false), (Cycles{6, 10}));
  EXPECT_EQ(written_back("ffma3 r1, r4, r7, r10", 4, true), (Cycles{6, 8, 10, 14}));
  EXPECT_EQ(written_back("ffma3 r1, r2, r7, r10", 4, true), (Cycles{6, 8, 10, 14}));
  EXPECT_EQ(written_back("ffma3 r2, r1, r7, r10", 4, false), (Cycles{6, 12, 18, 22}));
  EXPECT_EQ(written_back("ffma3 r1, r4, r7, r10", 4, true, 5), (Cycles{8, 10, 12, 16}));
  EXPECT_EQ(written_back("fmul3s r1, r1, r7", 4, false), (Cycles{6, 12, 18, 22}));
  EXPECT_EQ(written_back("arg3 r1, 0", 4, false), (Cycles{4, 8, 12, 16}));
  EXPECT_EQ(written_back("rld3 r1, 0", 4, false), (Cycles{5, 7, 9, 13}));
  EXPECT_EQ(written_back("rst3 0, r1", 8, false), (Cycles{6, 8, 10, 14}));
  EXPECT_EQ(written_back("rld3 r1, 0", 16, false), (Cycles{8, 12, 16, 20}));
  EXPECT_EQ(written_back("ld3 r1, [r0]", 4, false), (Cycles{6, 12, 18, 22}));
}

TEST(CycleUnit, TheLowestWarpGoesFirstAndTheOthersAreCountedAsWaiting) {
  Configuration configuration = make_configuration(4, 1);
  configuration.alus[AluType::Int].latency = 16;
  const std::vector<uint64_t> code = assembled("mov r1, 1; exit");
  Memory memory = with_program(code);
  CycleUnit unit(configuration, memory);
  unit.trace_on();
  unit.reset(size32(code), kMemoryBytes);
  TestChip chip(unit, memory);
  chip.launches.push_back(launch_of(4));
  std::vector<std::pair<uint32_t, uint64_t>> retired;
  for (int i = 0; i < 300; ++i) {
    chip.cycle();
    for (const RetireEvent& event : unit.trace().retired) {
      if (event.pc == 0) retired.emplace_back(event.warp, chip.cycles);
    }
  }
  ASSERT_EQ(retired.size(), 4u);
  for (uint32_t warp = 0; warp < 4; ++warp) {
    EXPECT_EQ(retired[warp].first, warp);
    if (warp > 0) {
      EXPECT_EQ(retired[warp].second - retired[warp - 1].second, 16u);
    }
  }
  EXPECT_GT(unit.counter(counter::kWaiting + static_cast<int>(AluType::Int)), 3u * 10);
  EXPECT_EQ(unit.counter(counter::kIssued + static_cast<int>(AluType::Int)), 4u);
}

TEST(CycleUnit, CountersCountModuloTheirBits) {
  const std::vector<uint64_t> code =
      assembled("mov r1, 4000; igt p1, r1, 0; @p1 loop 5; isub r1, r1, 1; igt p1, r1, 0; exit");
  Memory memory = with_program(code);
  std::array<std::vector<uint64_t>, 2> values;
  for (const uint32_t bits : {48u, 16u}) {
    Configuration configuration = make_configuration(2, 4);
    configuration.counter_bits = bits;
    CycleUnit unit(configuration, memory);
    unit.reset(size32(code), kMemoryBytes);
    TestChip chip(unit, memory);
    chip.launches.push_back(launch_of(8));
    ASSERT_TRUE(chip.run(200000));
    for (int number = 0; number < counter::kCount; ++number) values[bits == 48 ? 0 : 1].push_back(unit.counter(number));
  }
  uint64_t more = 0;
  for (size_t number = 0; number < values[0].size(); ++number) {
    EXPECT_EQ(values[1][number], values[0][number] & 0xffff) << number;
    more += values[0][number] >> 16;
  }
  EXPECT_GT(more, 2u) << "none has wrapped";
}

// Two units, one clocked and one run; the memory answers after a fixed time, the ports are always ready.
// Two launches of which every thread stores its index, the threads of its launch and its block; warp 0 of each takes
// longer than the others.
TEST(CycleUnit, WarpsOfTwoKernelsRunAtTheSameTimeEachWithItsOwnLaunch) {
  Configuration configuration = make_configuration(4, 2);
  configuration.kernel_overlap = true;
  const std::vector<uint64_t> code = assembled(fmt::format(R"(
    tid r1
    threads r2
    block r3
    blocks r6
    ilt p1, r1, 2
    mov r4, 30
    @p1 loop 10
    @p1 isub r4, r4, 1
    @p1 ige p1, r4, 1
    or r4, r4, r4
    shl r5, r3, 3
    iadd r5, r5, r1
    shl r5, r5, 4
    st [r5+{0}], r1
    st [r5+{1}], r2
    st [r5+{2}], r3
    st [r5+{3}], r6
    exit)",
                                                           kData, kData + 4, kData + 8, kData + 12));
  Memory memory = with_program(code);
  CycleUnit unit(configuration, memory);
  unit.trace_on();
  unit.reset(size32(code), kMemoryBytes);
  TestChip chip(unit, memory);
  chip.launches = {launch_of(8), launch_of(7), launch_of(8)};
  for (uint32_t n = 0; n < chip.launches.size(); ++n) {
    chip.launches[n].block = n;
    chip.launches[n].blocks = 10 + n;
  }
  // [warp] when its exit has retired, and when its next instruction has
  std::vector<std::vector<uint64_t>> exits(4), begins(4);
  std::vector<uint64_t> done;
  uint64_t kernels = 0;
  while (chip.kernels_done < 3 && chip.cycles < 20000) {
    chip.cycle();
    for (const RetireEvent& event : unit.trace().retired) {
      if (event.pc == 0) begins[event.warp].push_back(chip.cycles);
      if (event.pc == size32(code) - 1) exits[event.warp].push_back(chip.cycles);
    }
    if (chip.kernels_done > kernels) done.push_back(chip.cycles);
    kernels = chip.kernels_done;
  }
  ASSERT_EQ(done.size(), 3u);
  for (uint32_t warp = 0; warp < 4; ++warp) {
    ASSERT_EQ(begins[warp].size(), 3u) << warp;
    ASSERT_EQ(exits[warp].size(), 3u) << warp;
  }
  EXPECT_LT(begins[3][1], exits[0][0]) << "beside the kernel before";
  EXPECT_LT(exits[3][1], done[0]) << "and through before that one is";
  EXPECT_GT(begins[3][2], done[0]) << "but never three kernels";
  EXPECT_LT(begins[3][2], done[1]);
  for (uint32_t block = 0; block < 3; ++block) {
    const uint32_t threads = block == 1 ? 7 : 8;
    for (uint32_t thread = 0; thread < 8; ++thread) {
      const uint32_t address = kData + 16 * (8 * block + thread);
      const bool there = thread < threads;
      EXPECT_EQ(memory.load(address), there ? thread : 0) << block << ", " << thread;
      EXPECT_EQ(memory.load(address + 4), there ? threads : 0) << block << ", " << thread;
      EXPECT_EQ(memory.load(address + 8), there ? block : 0) << block << ", " << thread;
      EXPECT_EQ(memory.load(address + 12), there ? 10 + block : 0) << block << ", " << thread;
    }
  }
  const WarpCycles cycles = warp_cycles(configuration, unit);
  EXPECT_EQ(cycles.sum(), cycles.busy);
  EXPECT_GT(cycles.busy, 0u);
}

// docs/machine/architecture.md, section 3.
TEST(CycleUnit, AWarpThatHasEndedIsStartedInTheNextCycle) {
  std::vector<uint64_t> between;
  for (const bool overlap : {false, true}) {
    Configuration configuration = make_configuration(1, 1);
    configuration.kernel_overlap = overlap;
    const std::vector<uint64_t> code = assembled("tid r1; exit");
    Memory memory = with_program(code);
    CycleUnit unit(configuration, memory);
    unit.trace_on();
    unit.reset(size32(code), kMemoryBytes);
    TestChip chip(unit, memory);
    chip.launches = {launch_of(1), launch_of(1), launch_of(1)};
    uint64_t exited = 0;
    while (chip.kernels_done < 3 && chip.cycles < 1000) {
      chip.cycle();
      for (const RetireEvent& event : unit.trace().retired) {
        if (event.pc == 0 && exited != 0) between.push_back(chip.cycles - exited);
        if (event.pc == 1) exited = chip.cycles;
      }
    }
  }
  ASSERT_EQ(between.size(), 4u);
  for (size_t i : {0, 1}) EXPECT_EQ(between[2 + i], between[i] - 1);
}

TEST(CycleUnit, RunIsClockRepeatedUntilSomethingHappens) {
  const Configuration configuration = make_configuration(4, 4);
  Memory memory = with_program(kProgram);
  CycleUnit clocked(configuration, memory), run(configuration, memory);
  for (CycleUnit* unit : {&clocked, &run}) unit->reset(size32(kProgram), kMemoryBytes);
  UnitInputs ready;
  ready.memory_request_ready = ready.import_request_ready = ready.export_ready = ready.frame_ready = true;
  std::deque<std::pair<uint64_t, uint8_t>> lines;
  std::deque<uint64_t> beats;  // cycles in which a beat of a package comes
  uint64_t now = 0, calls = 0;
  bool launched = false;
  while (now < 20000) {
    UnitInputs inputs = ready;
    const UnitOutputs& out = run.outputs();
    EXPECT_EQ(out.signals(), clocked.outputs().signals()) << now;
    EXPECT_EQ(out.exports, clocked.outputs().exports) << now;
    if (!launched && out.launch_ready) {
      inputs.launch_valid = launched = true;
      inputs.launch = launch_of(16, ImportKind::Shadow);
    }
    if (out.memory_request_valid && !out.memory_request.write) lines.emplace_back(now + 100, out.memory_request.id);
    if (out.import_request_valid) {
      for (uint64_t i = 0; i < kIntersectionBeats; ++i)
        beats.push_back(std::max(now + 10, beats.empty() ? 0 : beats.back() + 1));
    }
    if (!lines.empty() && now >= lines.front().first) {
      inputs.memory_response_valid = true;
      inputs.memory_response.id = lines.front().second;
      inputs.memory_response.beat = static_cast<uint8_t>(now - lines.front().first);
      if (inputs.memory_response.beat == 3) lines.pop_front();
    }
    if (!beats.empty() && beats.front() == now) {
      inputs.import_beat_valid = true;
      beats.pop_front();
    }
    // Until the next thing that the host has to do.
    uint64_t next = 20000;
    if (!lines.empty()) next = std::min(next, std::max(lines.front().first, now + 1));
    if (!beats.empty()) next = std::min(next, beats.front());
    const uint64_t cycles = run.run(inputs, next - now);
    ASSERT_GE(cycles, 1u);
    ASSERT_LE(cycles, next - now);
    clocked.clock(inputs);
    for (uint64_t i = 1; i < cycles; ++i) clocked.clock(ready);
    now += cycles;
    ++calls;
  }
  EXPECT_LT(calls, 3000u) << "run() was to skip what is quiet";
  EXPECT_GT(run.counter(counter::kInstructions), 50u);
  EXPECT_EQ(run.outputs().exports[0], 32u) << "16 threads, a ray and a contribution each";
  for (int number = 0; number < counter::kCount; ++number)
    EXPECT_EQ(run.counter(number), clocked.counter(number)) << number;
}

TEST(CycleUnit, CountsTheExportsOfAKernelBeforeItIsDone) {
  const std::vector<uint64_t> code = test::exporting_program();
  for (const auto& [warps, lanes] : {std::pair{1, 1}, {2, 1}, {4, 4}, {8, 8}, {2, 32}}) {
    for (const bool overlap : {false, true}) {
      Configuration configuration = make_configuration(warps, lanes);
      configuration.kernel_overlap = overlap;
      for (const int ready_percent : {100, 60, 15}) {
        SCOPED_TRACE(testing::Message() << warps << "w" << lanes << "c, " << ready_percent << "% ready");
        Memory memory = with_program(code);
        CycleUnit unit(configuration, memory);
        for (const bool alone : {true, false}) {
          unit.reset(size32(code), kMemoryBytes);
          TestChip chip(unit, memory, 1, ready_percent);
          test::expect_exports_counted(unit, chip, configuration, alone);
        }
      }
    }
  }
}

TEST(Model, RefusesNumbersOfUnitsThatAMultiprocessorCannotHave) {
  Memory memory = with_program(kProgram);
  EXPECT_EQ(make_model(make_configuration(2, 2), memory, 4).units.size(), 4u);
  EXPECT_THROW(make_model(make_configuration(2, 2), memory, 3), InputError);
}

// Each group of warps has its code in another line of one set of the instruction cache. The warp that has missed and
// fetched a line must get to use it before it is replaced, whatever the memory's latency.
TEST(CycleUnit, WarpsDoNotTakeLinesFromEachOtherForEver) {
  constexpr uint32_t kPlaces = 32, kApart = 32;  // instructions from place to place: the two ways of a set are 64 lines
  Configuration configuration = make_configuration(32, 1);
  configuration.instruction_cache_bytes = 2 * kApart * 8;
  std::string text = fmt::format("warp r1; and r1, r1, {};", kPlaces - 1);
  for (uint32_t place = 0; place < kPlaces; ++place)
    text += fmt::format("ieq p1, r1, {}; @p1 jany {};", place, (place + 3) * kApart);
  std::vector<uint64_t> code = assembled(text);
  code.resize((kPlaces + 3) * kApart, assembled("exit")[0]);
  const std::vector<uint64_t> busy(6, assembled("iadd r2, r2, 1")[0]);
  for (uint32_t place = 3; place < kPlaces + 3; ++place)
    std::copy(busy.begin(), busy.end(), code.begin() + place * kApart);
  for (int latency = 1; latency < 70; ++latency) {
    Memory memory = with_program(code);
    CycleUnit unit(configuration, memory);
    unit.reset(size32(code), kMemoryBytes);
    TestChip chip(unit, memory, 1, 100, latency);
    chip.launches.push_back(launch_of(32));
    EXPECT_TRUE(chip.run(200000)) << "latency " << latency;
  }
}

}  // namespace
}  // namespace raypool
