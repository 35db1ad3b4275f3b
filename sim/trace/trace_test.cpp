#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "isa/encoding.hpp"
#include "isa/input_error.hpp"
#include "machine/compute/cycle_unit.hpp"
#include "machine/compute/multiprocessor.hpp"
#include "machine/compute/test_chip.hpp"
#include "machine/compute/test_program.hpp"
#include "trace/trace_recorder.hpp"

namespace raypool::trace {
namespace {

using nlohmann::json;

constexpr uint32_t kMemoryBytes = 16384;

// Every port and every type of ALU, and triples of three of them.
const char* const kProgram = R"(
    rin
    rld r1, 7
    rld3 r4, 0
    tid r2
    and r5, r2, 3
    shl r3, r2, 4
    ld3 r7, [r3+8192]
    fadd3 r7, r7, r4
    fsqrt r6, r4
    st [r3+8192], r6
    ige p1, r5, 2
    @p1 rst 8, r6
    rst 7, r2
    rout
    rfb
    exit)";

Configuration machine(uint32_t warps, uint32_t lanes) {
  Configuration configuration;
  configuration.name = "small";
  configuration.warps = warps;
  configuration.lanes = lanes;
  configuration.triples = true;
  return configuration;
}

struct Outcome {
  MachineTrace trace;
  uint64_t cycles = 0, instructions = 0;
  std::vector<Ray> rays;
  size_t requests = 0, contributions = 0;
};

/// Three kernels; with hesitant ports. Without a window nothing stands around the device.
Outcome run(const std::string& text, const Configuration& configuration, int units, std::optional<Window> window) {
  Outcome result;
  const std::vector<uint64_t> code = test::assembled(text);
  Memory memory(kMemoryBytes);
  test::put_program(memory, code);
  std::vector<std::unique_ptr<ComputeUnit>> all;
  for (int i = 0; i < units; ++i) all.push_back(std::make_unique<CycleUnit>(configuration, memory));
  auto device = make_multiprocessor(std::move(all), static_cast<int>(configuration.intersection_beats()));
  result.trace.kernels = {{0, "everything"}};
  if (window) device = std::make_unique<TraceRecorder>(std::move(device), configuration, *window, result.trace);
  device->reset(size32(code), kMemoryBytes);
  test::TestChip chip(*device, memory, 5, 60);
  for (uint32_t i = 0; i < 3; ++i) {
    LaunchCommand launch;
    launch.threads = configuration.contents();
    launch.import = ImportKind::Normal;
    chip.launches.push_back(launch);
  }
  EXPECT_TRUE(chip.run());
  result.cycles = chip.cycles;
  result.instructions = device->counter(counter::kInstructions);
  result.rays = chip.rays;
  result.requests = chip.requests.size();
  result.contributions = chip.frame.size();
  device.reset();  // the trace is whole
  return result;
}

uint64_t executed(const MachineTrace& trace) {
  uint64_t count = 0;
  for (const InstructionSpan& span : trace.instructions) count += is_triple(info_of(span)) ? kElements : 1;
  return count;
}

size_t passed(const MachineTrace& trace, Port port) {
  return static_cast<size_t>(std::count_if(trace.transfers.begin(), trace.transfers.end(),
                                           [&](const Transfer& each) { return each.port == port && !each.waits; }));
}

TEST(Trace, HasEveryInstructionAndTransferAndChangesNoCycle) {
  for (const int units : {1, 2}) {
    const Outcome plain = run(kProgram, machine(2, 4), units, {});
    const Outcome traced = run(kProgram, machine(2, 4), units, Window{});
    EXPECT_EQ(traced.cycles, plain.cycles);
    EXPECT_EQ(traced.rays, plain.rays);
    const MachineTrace& trace = traced.trace;
    EXPECT_EQ(executed(trace), traced.instructions);
    EXPECT_EQ(traced.instructions, plain.instructions);
    EXPECT_EQ(passed(trace, Port::Launch), 3u);
    EXPECT_EQ(passed(trace, Port::Request), traced.requests);
    EXPECT_EQ(passed(trace, Port::Frame), traced.contributions);
    EXPECT_GT(traced.contributions, 0u);
    // Beats of records and rays with gaps between them are several spans.
    EXPECT_GE(passed(trace, Port::Import), traced.requests);
    EXPECT_GE(passed(trace, Port::Export), traced.rays.size());
    uint64_t beats = 0;
    for (const Transfer& transfer : trace.transfers)
      beats += transfer.port == Port::Export && !transfer.waits ? transfer.to - transfer.from : 0;
    EXPECT_EQ(beats, 3 * traced.rays.size());
  }
}

TEST(Trace, TimesFollowOneAnother) {
  const Configuration configuration = machine(4, 4);
  const Outcome traced = run(kProgram, configuration, 2, Window{});
  std::map<std::pair<uint32_t, uint32_t>, uint64_t> free;  // [unit, warp]
  std::map<AluType, uint32_t> seen;
  for (const InstructionSpan& span : traced.trace.instructions) {
    EXPECT_LE(span.wanted, span.issued);
    // Two cycles to read the operands.
    EXPECT_LE(span.issued + 2, span.granted);
    EXPECT_LT(span.granted, span.retired);
    EXPECT_GE(span.issued, (free[{span.unit, span.warp}]));
    free[{span.unit, span.warp}] = span.retired;
    const AluType alu = info_of(span).alu();
    ++seen[alu];
    if (alu == AluType::Mem || alu == AluType::Ray || is_triple(info_of(span))) continue;
    EXPECT_EQ(span.retired - span.granted, configuration.task_of(alu).depth + 1);
  }
  EXPECT_EQ(seen.size(), size_t{kAluTypes});
}

TEST(Trace, AWindowHasWhatLiesInIt) {
  const Outcome whole = run(kProgram, machine(2, 4), 1, Window{});
  const Outcome part = run(kProgram, machine(2, 4), 1, Window{200, 150, {}});
  EXPECT_EQ(part.cycles, whole.cycles);
  EXPECT_EQ(part.trace.from, 200u);
  EXPECT_EQ(part.trace.to, 350u);
  const auto inside = [](const auto& all, auto begin, auto end) {
    return std::count_if(all.begin(), all.end(),
                         [&](const auto& each) { return begin(each) >= 200 && end(each) < 350; });
  };
  const auto& instructions = part.trace.instructions;
  EXPECT_EQ(static_cast<long>(instructions.size()),
            inside(
                whole.trace.instructions, [](const auto& span) { return span.issued; },
                [](const auto& span) { return span.retired; }));
  ASSERT_GT(instructions.size(), 5u);
  for (const InstructionSpan& span : instructions) EXPECT_GE(span.wanted, 200u);
  for (const Transfer& transfer : part.trace.transfers) {
    EXPECT_GE(transfer.from, 200u);
    EXPECT_LE(transfer.to, 350u);
  }
  // Behind the end of the program there is nothing.
  const Outcome none = run(kProgram, machine(2, 4), 1, Window{1'000'000, 10, {}});
  EXPECT_TRUE(none.trace.instructions.empty());
}

TEST(Trace, AWindowAroundAPixelHasItsRay) {
  // Word 7 of the rays is the thread's number.
  const Outcome whole = run(kProgram, machine(2, 4), 1, Window{});
  const Outcome part = run(kProgram, machine(2, 4), 1, Window{0, 100, 6});
  ASSERT_EQ(part.trace.to - part.trace.from, 100u);
  const auto ray = std::find_if(whole.rays.begin(), whole.rays.end(), [](const Ray& each) { return each[7] == 6; });
  ASSERT_NE(ray, whole.rays.end());
  // The beat with the pixel, the second one of this ray, passes a quarter of the window behind its begin.
  uint64_t beats = 3 * static_cast<uint64_t>(ray - whole.rays.begin()) + 1, cycle = 0;
  for (const Transfer& transfer : whole.trace.transfers) {
    if (transfer.port != Port::Export || transfer.waits) continue;
    if (beats < transfer.to - transfer.from) {
      cycle = transfer.from + beats;
      break;
    }
    beats -= transfer.to - transfer.from;
  }
  EXPECT_EQ(part.trace.from + 25, cycle);
  EXPECT_FALSE(part.trace.instructions.empty());
  EXPECT_TRUE(run(kProgram, machine(2, 4), 1, Window{0, 100, 99}).trace.instructions.empty());
}

TEST(Trace, EventsNestAndNameWhatHappens) {
  const Outcome traced = run(kProgram, machine(2, 4), 2, Window{});
  const json document = json::parse(to_trace_events(traced.trace));
  EXPECT_EQ(document.at("otherData").at("warps"), 2);
  std::map<std::pair<int, int>, std::vector<std::pair<uint64_t, uint64_t>>> open;  // [process, thread]
  std::map<std::string, int> names;
  int instructions = 0;
  for (const json& event : document.at("traceEvents")) {
    if (event.at("ph") == "M") {
      ++names[event.at("args").at("name")];
      continue;
    }
    ASSERT_EQ(event.at("ph"), "X");
    const uint64_t from = event.at("ts"), to = from + event.at("dur").get<uint64_t>();
    EXPECT_LT(from, to);
    auto& around = open[{event.at("pid"), event.at("tid")}];
    while (!around.empty() && around.back().second <= from) around.pop_back();
    if (!around.empty()) {
      EXPECT_LE(to, around.back().second) << event.dump();
    }
    around.emplace_back(from, to);
    instructions += event.contains("args") && event.at("args").contains("instruction");
    if (event.at("name") == "flt") {
      EXPECT_EQ(event.at("args").at("instruction"), "fadd3 r7, r7, r4");
    }
  }
  EXPECT_EQ(static_cast<size_t>(instructions), traced.trace.instructions.size());
  EXPECT_EQ(names["warp 1"], 2);
  EXPECT_EQ(names["compute unit 1"], 1);
  EXPECT_EQ(names["rays"], 1);
}

TEST(Trace, KanataLogOfASmallKernel) {
  MachineTrace trace;
  trace.warps = trace.units = 1;
  trace.from = 10;
  trace.to = 40;
  const std::vector<uint64_t> code = test::assembled("tid r1; exit");
  trace.instructions = {{0, 0, 0, code[0], 4, 12, 14, 16, 18}, {0, 0, 1, code[1], 4, 15, 18, 21, 24}};
  EXPECT_EQ(to_kanata(trace),
            "Kanata\t0004\nC=\t10\n"
            "C\t2\nI\t0\t0\t0\nL\t0\t0\t0: tid r1\nL\t0\t1\tunit 0, warp 0, 4 threads\nS\t0\t0\tfetch\n"
            "C\t2\nS\t0\t0\twait\n"
            "C\t1\nI\t1\t1\t0\nL\t1\t0\t1: exit\nL\t1\t1\tunit 0, warp 0, 4 threads\nS\t1\t0\tfetch\n"
            "C\t1\nS\t0\t0\ttid\n"
            "C\t2\nR\t0\t0\t0\nS\t1\t0\twait\n"
            "C\t3\nS\t1\t0\tbrh\n"
            "C\t3\nR\t1\t1\t0\n");
}

TEST(Trace, WindowsAreParsed) {
  EXPECT_EQ(parse_window(":").from, 0u);
  EXPECT_EQ(parse_window(":").cycles, 20'000u);
  EXPECT_EQ(parse_window("500").from, 500u);
  EXPECT_EQ(parse_window("500:7").cycles, 7u);
  EXPECT_EQ(parse_window(":7").cycles, 7u);
  EXPECT_EQ(parse_window("pixel:3,2").pixel, 0x20003u);
  EXPECT_EQ(parse_window("pixel:3,2:50").cycles, 50u);
  for (const char* const text : {"", "x", "-1:5", "1:0", "1:1000001", "1:2:3", "pixel:", "pixel:1", "pixel:1,",
                                 "pixel:1,2:", "pixel:1,70000", "pixel:1,2:0", "1,2"})
    EXPECT_THROW(parse_window(text), InputError) << text;
}

}  // namespace
}  // namespace raypool::trace
