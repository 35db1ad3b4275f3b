// The chip as a SystemC module, on boards of the project's modules and of one's own.
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "chip/board_modules.hpp"
#include "chip/frame_setup.hpp"
#include "chip/port_traverser.hpp"
#include "chip/simulation.hpp"
#include "chip/test_banked_dram.hpp"
#include "chip/test_board.hpp"
#include "chip/test_metronome.hpp"

namespace raypool::chip {
namespace {

using test::BankedDram;
using test::BoardRun;
using test::expect_the_same;
using test::TreeBoard;

const ChipConfiguration& chip_of(const BoardRun& board) { return board.run.options.configuration.chip; }

// ---- The board of the project's modules

TEST(SystemcBoard, TakesTheCyclesOfTheBareLoop) {
  TreeBoard bare, systemc;
  const ChipResult expected = bare.draw(), result = run_chip(systemc.run.options, *systemc.device);
  EXPECT_TRUE(systemc.run.frame == bare.run.frame);
  expect_the_same(result, expected);
}

TEST(SystemcBoard, TakesTheCyclesOfTheBareLoopWithATraverserAtThePorts) {
  for (const uint32_t units : {1u, 2u}) {
    const test::BoardCase machine{"", 4, 4, units, 31, 17, 3};
    BoardRun bare(machine), systemc(machine);
    const ChipResult expected = bare.draw(), result = run_chip(systemc.run.options, *systemc.device);
    EXPECT_TRUE(systemc.run.frame == bare.run.frame);
    expect_the_same(result, expected);
  }
}

TEST(SystemcBoard, DrawsOneFrameAfterAnotherOnAChip) {
  TreeBoard bare, systemc;
  bare.draw();
  run_chip(systemc.run.options, *systemc.device);
  const ChipResult expected = run_board(bare.run.options, *bare.device, FrameBegin::Next);
  expect_the_same(run_chip(systemc.run.options, *systemc.device, FrameBegin::Next), expected);
  EXPECT_TRUE(systemc.run.frame == bare.run.frame);
}

std::string error_of(const std::function<void()>& run) {
  try {
    run();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

TEST(SystemcBoard, EndsWithTheErrorsOfTheBareLoop) {
  BoardRun board({"", 4, 4, 1, 16, 8, 2});
  const auto draw = [&] { run_chip(board.run.options, *board.device); };
  board.run.options.limits.cycles = 500;
  const std::string error = error_of(draw);
  EXPECT_EQ(error.find("the limit of 500 cycles has passed, at cycle 500; "), 0u) << error;
  board.run.options.limits.cycles = 0;
  board.run.options.program_length = 3;
  EXPECT_THROW(draw(), ChipFault);
}

TEST(SystemcBoard, RefusesATraverserBesideTheOneInside) {
  TreeBoard board;
  PortTraverser traverser(board.run.scene_tracer, board.run.options.configuration.chip, 1, board.run.options.layout);
  board.run.options.traverser = &traverser;
  EXPECT_NE(error_of([&] { run_chip(board.run.options, *board.device); }).find("--traverser static"),
            std::string::npos);
}

// ---- Boards of one's own

/// All but the memories, which a test adds.
struct Assembly {
  explicit Assembly(BoardRun& board)
      : chip("chip", board.run.options, *board.device),
        frame("frame", board.run.sink),
        host("host", frame_setup(board.run.options)) {
    chip.frame.bind(frame.socket);
    host.socket.bind(chip.host);
    chip.done.bind(done);
    host.done.bind(done);
  }
  ChipResult draw() {
    simulation.run();
    return chip.result();
  }

  Simulation simulation;
  ChipModule chip;
  FrameBufferModule frame;
  HostModule host;
  sc_core::sc_signal<bool> done{"done"};
};

// For docs/machine/board.md.
ChipResult draw_with_own_dram(const ChipOptions& options, ChipDevice& device, uint64_t& row_hits) {
  Simulation simulation;
  ChipModule chip("chip", options, device);
  BankedDram memory("memory", *options.memory), tree("tree", options.tree->memory);
  FrameBufferModule frame("frame", *options.frame);
  HostModule host("host", frame_setup(options));
  sc_core::sc_signal<bool> done("done");
  chip.memory.bind(memory.socket);
  chip.tree.bind(tree.socket);
  chip.frame.bind(frame.socket);
  host.socket.bind(chip.host);
  chip.done.bind(done);
  host.done.bind(done);
  simulation.run();
  row_hits = tree.row_hits;
  return chip.result();
}

TEST(SystemcBoard, DrawsTheSamePictureInAnotherTimeWithOwnDram) {
  TreeBoard bare, banked;
  uint64_t row_hits = 0;
  const ChipResult expected = bare.draw(), result = draw_with_own_dram(banked.run.options, *banked.device, row_hits);
  EXPECT_TRUE(banked.run.frame == bare.run.frame);
  EXPECT_EQ(result.contributions, expected.contributions);
  EXPECT_NE(result.cycles, expected.cycles);
  EXPECT_GT(row_hits, 0u);
}

/// Does with every access what a test wants.
struct Peculiar : sc_core::sc_module {
  using Act = std::function<void(tlm::tlm_generic_payload&, sc_core::sc_time&)>;
  Peculiar(const sc_core::sc_module_name& name, Act what) : sc_module(name), act(std::move(what)) {
    socket.register_b_transport(this, &Peculiar::b_transport);
  }
  void b_transport(tlm::tlm_generic_payload& payload, sc_core::sc_time& delay) { act(payload, delay); }

  tlm_utils::simple_target_socket<Peculiar, kMemoryBits> socket{"socket"};
  Act act;
};

std::string refusal(Peculiar::Act act) {
  BoardRun board({"", 4, 4, 1, 16, 8, 2});
  Assembly assembly(board);
  Peculiar memory("memory", std::move(act));
  assembly.chip.memory.bind(memory.socket);
  return error_of([&] { assembly.draw(); });
}

TEST(SystemcBoard, AMemoryThatRefusesEndsTheRunWithASentence) {
  EXPECT_EQ(
      refusal([](tlm::tlm_generic_payload& payload, sc_core::sc_time&) {
        payload.set_response_status(tlm::TLM_ADDRESS_ERROR_RESPONSE);
      }),
      "the memory model answers TLM_ADDRESS_ERROR_RESPONSE to a read of 64 bytes at address 0x0: it must serve it");
}

TEST(SystemcBoard, AMemoryThatWaitsEndsTheRunWithASentence) {
  const std::string text =
      refusal([](tlm::tlm_generic_payload&, sc_core::sc_time&) { sc_core::wait(1, sc_core::SC_NS); });
  EXPECT_EQ(text.find("the memory model fails in a read at address 0x"), 0u) << text;
  EXPECT_NE(text.find("must add to the delay, and not wait"), std::string::npos) << text;
}

TEST(SystemcBoard, AMemoryThatNeverAnswersEndsTheRunWithASentence) {
  const std::string text = refusal([](tlm::tlm_generic_payload& payload, sc_core::sc_time& delay) {
    delay = sc_core::sc_max_time();
    payload.set_response_status(tlm::TLM_OK_RESPONSE);
  });
  EXPECT_NE(text.find("waits at port "), std::string::npos) << text;
}

// ---- Frame buffers

/// Draws with a frame buffer that takes a contribution every so many cycles.
ChipResult draw_with_slow_frame_buffer(BoardRun& board, uint64_t cycles, std::vector<uint64_t>& when) {
  Simulation simulation;
  ChipModule chip("chip", board.run.options, *board.device);
  FixedLatencyMemory memory("memory", board.run.image.memory, chip_of(board));
  Peculiar frame("frame", [&](tlm::tlm_generic_payload& payload, sc_core::sc_time& delay) {
    const FrameContribution contribution = contribution_of(payload);
    EXPECT_EQ(payload.get_address(), uint64_t{16} * contribution.pixel);
    when.push_back((sc_core::sc_time_stamp() + delay).value() / kCyclePicoseconds);
    board.run.sink.add(contribution);
    delay += sc_core::sc_time::from_value(cycles * kCyclePicoseconds);
    payload.set_response_status(tlm::TLM_OK_RESPONSE);
  });
  HostModule host("host", frame_setup(board.run.options));
  sc_core::sc_signal<bool> done("done");
  chip.memory.bind(memory.socket);
  chip.frame.bind(frame.socket);
  host.socket.bind(chip.host);
  chip.done.bind(done);
  host.done.bind(done);
  simulation.run();
  return chip.result();
}

TEST(SystemcBoard, WaitsForAFrameBufferThatIsSlow) {
  const test::BoardCase machine{"", 4, 4, 1, 16, 8, 2};
  BoardRun bare(machine), once(machine), slow(machine);
  std::vector<uint64_t> when_once, when;
  const ChipResult expected = bare.draw();
  EXPECT_EQ(draw_with_slow_frame_buffer(once, 0, when_once).cycles, expected.cycles);
  const ChipResult result = draw_with_slow_frame_buffer(slow, 50, when);
  EXPECT_TRUE(slow.run.frame == bare.run.frame);
  EXPECT_EQ(result.contributions, when.size());
  EXPECT_GT(result.cycles, expected.cycles);
  for (size_t i = 1; i < when.size(); ++i) EXPECT_GE(when[i], when[i - 1] + 50);
}

// ---- Hosts

/// Writes all registers at once, begins a frame and resets it, then draws two without a reset in between, and polls.
struct PollingHost : sc_core::sc_module {
  SC_HAS_PROCESS(PollingHost);
  PollingHost(const sc_core::sc_module_name& name, const FrameSetup& setup) : sc_module(name) {
    registers.set(setup);
    SC_THREAD(run);
  }
  uint32_t status() { return read_register(*socket[0], host_register::kStatus); }
  void start(uint32_t how) { write_registers(*socket[0], host_register::kControl, &how, 1); }
  void run() {
    EXPECT_EQ(status() & (host_register::kBusy | host_register::kDone), 0u);
    std::vector<uint32_t> words;
    for (uint32_t address = host_register::kProgramLength; address < host_register::kBytes; address += 4)
      words.push_back(registers.load(address));
    write_registers(*socket[0], host_register::kProgramLength, words.data(), static_cast<uint32_t>(words.size()));
    EXPECT_EQ(read_register(*socket[0], host_register::kWidth), registers.load(host_register::kWidth));
    wait(1500, sc_core::SC_PS);
    start(host_register::kStart | host_register::kReset);
    wait(20, sc_core::SC_NS);
    EXPECT_EQ(status(), host_register::kBusy);
    EXPECT_THROW(start(host_register::kStart), InputError);
    const uint32_t word = 0;
    EXPECT_THROW(write_registers(*socket[0], host_register::kStatus, &word, 1), InputError);
    EXPECT_THROW(read_register(*socket[0], host_register::kBytes), InputError);
    EXPECT_THROW(read_register(*socket[0], 2), InputError);
    words.resize(host_register::kBytes / 4 + 1);
    EXPECT_THROW(write_registers(*socket[0], 0, words.data(), static_cast<uint32_t>(words.size())), InputError);
    wait(700, sc_core::SC_NS);
    start(host_register::kStart | host_register::kReset);
    while ((status() & host_register::kReady) == 0) wait(100, sc_core::SC_NS);
    EXPECT_EQ(status() & host_register::kDone, 0u);
    start(host_register::kStart);
    while ((status() & host_register::kDone) == 0) wait(7, sc_core::SC_NS);
    sc_core::sc_stop();
  }

  tlm_utils::simple_initiator_socket<PollingHost, kHostBits> socket{"socket"};
  HostRegisters registers;
};

TEST(SystemcBoard, IsDrivenByAHostOfOnesOwn) {
  TreeBoard bare, own;
  bare.draw();
  const ChipResult expected = run_board(bare.run.options, *bare.device, FrameBegin::Next);

  Simulation simulation;
  ChipModule chip("chip", own.run.options, *own.device);
  FixedLatencyMemory memory("memory", own.run.image.memory, chip_of(own)), tree("tree", own.tree.memory, chip_of(own));
  FrameBufferModule frame("frame", own.run.sink);
  PollingHost host("host", frame_setup(own.run.options));
  chip.memory.bind(memory.socket);
  chip.tree.bind(tree.socket);
  chip.frame.bind(frame.socket);
  host.socket.bind(chip.host);
  simulation.run();
  const ChipResult result = chip.result();
  EXPECT_TRUE(own.run.frame == bare.run.frame);
  EXPECT_EQ(result.cycles, expected.cycles);
  EXPECT_EQ(result.contributions, expected.contributions);
}

TEST(SystemcBoard, TakesPictureAndCameraFromTheHost) {
  BoardRun bare({"", 4, 4, 1, 16, 8, 2}), other({"", 4, 4, 1, 24, 12, 3});
  const ChipResult expected = bare.draw();
  ChipOptions options = other.run.options;  // of another frame
  options.frame = nullptr;
  BoardRun drawn({"", 4, 4, 1, 16, 8, 2});
  Simulation simulation;
  ChipModule chip("chip", options, *drawn.device);
  FixedLatencyMemory memory("memory", drawn.run.image.memory, chip_of(drawn));
  FrameBufferModule frame("frame", drawn.run.sink);
  HostModule host("host", frame_setup(drawn.run.options));
  sc_core::sc_signal<bool> done("done");
  chip.memory.bind(memory.socket);
  chip.frame.bind(frame.socket);
  host.socket.bind(chip.host);
  chip.done.bind(done);
  host.done.bind(done);
  simulation.run();
  EXPECT_EQ(chip.result().cycles, expected.cycles);
  EXPECT_TRUE(drawn.run.frame == bare.run.frame);
}

TEST(SystemcBoard, ReportsThatNoFrameHasBeenDrawn) {
  BoardRun board({"", 4, 4, 1, 16, 8, 2});
  Assembly assembly(board);
  FixedLatencyMemory memory("memory", board.run.image.memory, chip_of(board));
  assembly.chip.memory.bind(memory.socket);
  const test::Metronome metronome("metronome");
  EXPECT_NE(error_of([&] { assembly.chip.result(); }).find("the host has started no frame"), std::string::npos);
  sc_core::sc_start(100, sc_core::SC_NS);
  EXPECT_NE(error_of([&] { assembly.chip.result(); }).find("ended before the frame"), std::string::npos);
}

TEST(HostRegisters, HoldWhatStaysForAFrame) {
  const TreeBoard board;
  const FrameSetup setup = frame_setup(board.run.options);
  HostRegisters registers, again;
  registers.set(setup);
  again.set(registers.setup(setup.tree.layout.words));
  for (uint32_t address = 0; address < host_register::kBytes; address += 4)
    EXPECT_EQ(again.load(address), registers.load(address)) << address;
  EXPECT_EQ(registers.setup(setup.tree.layout.words).tree.layout.place, setup.tree.layout.place);
  EXPECT_EQ(registers.load(host_register::kArguments), setup.arguments[0]);
}

// ---- Traversers

/// Traces each ray as soon as it has read it.
class EagerTraverser : public sc_core::sc_module, public ExternalTraverserIf {
 public:
  EagerTraverser(const sc_core::sc_module_name& name, const ChipOptions& options)
      : sc_module(name), batches_(*options.tracer, eager(options.configuration.chip), 1, options.layout) {}

  void start(const FrameSetup& setup) override { batches_.start(setup); }
  void offer(TraverserPorts& ports) override { batches_.offer(ports); }
  void clock(const ChipOutputs& outputs, const TraverserPorts& ports, bool) override {
    batches_.clock(outputs, ports, true);
  }
  const TraverserCounts& counts() const override { return batches_.counts(); }
  std::string describe() const override { return batches_.describe(); }

 private:
  static ChipConfiguration eager(ChipConfiguration chip) {
    chip.static_traverser_stall_cycles = 1;
    return chip;
  }
  PortTraverser batches_;
};

TEST(SystemcBoard, DrawsWithATraverserOfOnesOwn) {
  const test::BoardCase machine{"", 4, 4, 1, 31, 17, 3};
  BoardRun bare(machine), own(machine), metronomed(machine);
  const ChipResult expected = bare.draw();
  uint64_t cycles = 0;
  for (BoardRun* board : {&own, &metronomed}) {
    Assembly assembly(*board);
    FixedLatencyMemory memory("memory", board->run.image.memory, chip_of(*board));
    assembly.chip.memory.bind(memory.socket);
    EagerTraverser traverser("traverser", board->run.options);
    assembly.chip.traverser.bind(traverser);
    std::unique_ptr<test::Metronome> metronome;
    if (board == &metronomed) metronome = std::make_unique<test::Metronome>("metronome");
    const ChipResult result = assembly.draw();
    EXPECT_TRUE(board->run.frame == bare.run.frame);
    EXPECT_EQ(result.rays(), expected.rays());
    EXPECT_LT(result.cycles, expected.cycles);
    if (cycles == 0) cycles = result.cycles;
    EXPECT_EQ(result.cycles, cycles);
  }
}

// ---- Temporal decoupling

/// Counts how often the chip is clocked.
class Counted : public ChipDevice {
 public:
  explicit Counted(ChipDevice& chip) : chip_(chip) {}
  uint32_t units() const override { return chip_.units(); }
  void start(const FrameSetup& setup) override { chip_.start(setup); }
  void start_next(const FrameSetup& setup) override { chip_.start_next(setup); }
  const ChipOutputs& outputs() const override { return chip_.outputs(); }
  void clock(const ChipInputs& inputs) override {
    ++clocked;
    const uint64_t now = sc_core::sc_time_stamp().value();
    calls += now != last_;
    last_ = now;
    chip_.clock(inputs);
  }
  uint64_t run(const ChipInputs& inputs, uint64_t cycles) override {
    const uint64_t now = sc_core::sc_time_stamp().value(), done = chip_.run(inputs, cycles);
    clocked += done;
    calls += now != last_;
    last_ = now;
    return done;
  }
  ChipCounts counts() override { return chip_.counts(); }
  uint64_t counter(int number) override { return chip_.counter(number); }

  uint64_t clocked = 0, calls = 0;  ///< cycles; times of SystemC in which there were any

 private:
  ChipDevice& chip_;
  uint64_t last_ = UINT64_MAX;
};

/// Looks at the chip some time after each access.
struct LookingMemory : sc_core::sc_module {
  SC_HAS_PROCESS(LookingMemory);
  LookingMemory(const sc_core::sc_module_name& name, Memory& own_memory, const Counted& looked_at, double after)
      : sc_module(name), memory(own_memory), chip(looked_at), look_after(after, sc_core::SC_NS) {
    socket.register_b_transport(this, &LookingMemory::b_transport);
    SC_METHOD(look);
    sensitive << later;
    dont_initialize();
  }
  void b_transport(tlm::tlm_generic_payload& payload, sc_core::sc_time& delay) {
    transfer(payload, memory);
    later.notify(delay + look_after);
    delay += sc_core::sc_time(50, sc_core::SC_NS);
  }
  // Cycle 1 is the first.
  void look() {
    seen.push_back(chip.clocked);
    EXPECT_EQ(chip.clocked, (sc_core::sc_time_stamp().value() + kCyclePicoseconds - 1) / kCyclePicoseconds - 1);
  }

  tlm_utils::simple_target_socket<LookingMemory, kMemoryBits> socket{"socket"};
  Memory& memory;
  const Counted& chip;
  const sc_core::sc_time look_after;
  sc_core::sc_event later;
  std::vector<uint64_t> seen;  ///< cycles that the chip had been clocked then
};

struct Drawn {
  Drawn(bool decoupled, double look_after) {
    const std::unique_ptr<ChipDevice> made = std::move(board.device);
    auto counted = std::make_unique<Counted>(*made);
    const Counted& chip = *counted;
    board.device = std::move(counted);
    {
      Assembly assembly(board);
      LookingMemory memory("memory", board.run.image.memory, chip, look_after);
      FixedLatencyMemory tree("tree", board.tree.memory, chip_of(board));
      assembly.chip.memory.bind(memory.socket);
      assembly.chip.tree.bind(tree.socket);
      std::unique_ptr<test::Metronome> metronome;
      if (!decoupled) metronome = std::make_unique<test::Metronome>("metronome");
      result = assembly.draw();
      seen = memory.seen;
      if (!decoupled) {
        EXPECT_GE(metronome->beats, result.cycles);
      }
    }
    clocked = chip.clocked;
    calls = chip.calls;
    board.device.reset();
  }
  TreeBoard board;
  ChipResult result;
  uint64_t clocked = 0, calls = 0;
  std::vector<uint64_t> seen;
};

TEST(TemporalDecouplingOfTheChip, ChangesNoCycleAndNoFigure) {
  for (const double look_after : {5.0, 5.25}) {
    const Drawn ahead(true, look_after), stepped(false, look_after);
    EXPECT_LT(ahead.calls, stepped.calls / 2);  // it did run ahead,
    EXPECT_EQ(stepped.calls, stepped.clocked);  // and did not
    EXPECT_FALSE(ahead.seen.empty());
    EXPECT_EQ(ahead.seen, stepped.seen);
    EXPECT_EQ(ahead.clocked, stepped.clocked);
    EXPECT_TRUE(ahead.board.run.frame == stepped.board.run.frame);
    expect_the_same(ahead.result, stepped.result);
  }
}

}  // namespace
}  // namespace raypool::chip
