// Memory models of one's own at the chip's socket.
#include <gtest/gtest.h>

#include "bits.hpp"
#include "chip/chip_device_module.hpp"
#include "chip/chip_module.hpp"
#include "chip/fixed_latency_memory.hpp"
#include "chip/program_module.hpp"
#include "chip/simulation.hpp"
#include "chip/test_banked_dram.hpp"
#include "chip/test_board.hpp"
#include "chip/test_driver.hpp"
#include "chip/test_real_frame.hpp"
#include "kernel/compute_kernels.hpp"
#include "machine/cycle_unit.hpp"
#include "machine/test_program.hpp"

namespace raypool::chip {
namespace {

using test::BankedDram;

ChipResult draw(test::RealFrame& run) {
  Simulation simulation;
  Chip chip("chip", run.options);
  BankedDram dram("dram", run.image.memory);
  chip.memory.bind(dram.socket);
  return chip.draw();
}

TEST(OwnMemory, AnswersInItsOwnTime) {
  Simulation simulation;
  ChipClock clock("clock");
  MemoryPort port("memory_port", {});
  Memory memory(65536);
  BankedDram dram("dram", memory);
  port.clock(clock.now);
  port.socket.bind(dram.socket);
  std::vector<std::pair<uint8_t, uint64_t>> last_beats;
  test::drive(simulation, clock, [&](uint64_t cycle) {
    if (cycle == 10) {
      port.request({false, 0, {}, 0, 0});         // served in cycle 10: opens row 0
      port.request({false, 128, {}, 0, 1});       // 18: row 0 again, when its bank is free
      port.request({false, 2048, {}, 0, 2});      // 26: another bank, done before; but beats come in order
      port.request({true, 8 * 2048, {}, 15, 0});  // 34: closes row 0; nobody waits for it
      port.request({false, 192, {}, 0, 3});       // 36: opens row 0 again, after the write
    }
    if (port.response_due() > cycle) return cycle < 600;
    MemoryResponse response;
    port.response(response);
    if (response.beat == 3) last_beats.emplace_back(response.id, cycle);
    return true;
  });
  const uint64_t first = 10 + 140, second = first + 60, write = second + 140;
  EXPECT_EQ(last_beats,
            (std::vector<std::pair<uint8_t, uint64_t>>{{0, first}, {1, second}, {2, second + 8}, {3, write + 140}}));
  EXPECT_EQ(dram.row_hits, 1u);
  EXPECT_EQ(dram.row_misses, 4u);
}

TEST(OwnMemory, DrawsTheSamePictureInAnotherTime) {
  test::RealFrame fixed(2, 2, 24, 16, 3), banked(2, 2, 24, 16, 3);
  fixed.set_device(std::make_unique<CycleUnit>(fixed.options.configuration, fixed.image.memory));
  banked.set_device(std::make_unique<CycleUnit>(banked.options.configuration, banked.image.memory));
  const ChipResult expected = run_chip(fixed.options), result = draw(banked);
  EXPECT_TRUE(banked.frame == fixed.frame);
  EXPECT_EQ(result.contributions, expected.contributions);
  EXPECT_NE(result.cycles, expected.cycles);
}

/// Does with every access what a test wants.
struct Peculiar : sc_core::sc_module {
  Peculiar(const sc_core::sc_module_name& name, std::function<void(tlm::tlm_generic_payload&)> what)
      : sc_module(name), act(std::move(what)) {
    socket.register_b_transport(this, &Peculiar::b_transport);
  }
  void b_transport(tlm::tlm_generic_payload& payload, sc_core::sc_time&) { act(payload); }

  tlm_utils::simple_target_socket<Peculiar, kMemoryBits> socket{"socket"};
  std::function<void(tlm::tlm_generic_payload&)> act;
};

// The chip as one piece, with a traverser inside, whose memory is another one.
ChipResult draw_in_systemc(test::TreeBoard& board) {
  const uint64_t latency = board.run.options.configuration.chip.memory_latency;
  Simulation simulation;
  ChipDeviceModule chip("chip", board.run.options, *board.device);
  FixedLatencyMemory memory("memory", board.run.image.memory, latency), tree("tree", board.tree.memory, latency);
  chip.memory.bind(memory.socket);
  chip.tree.bind(tree.socket);
  return chip.draw();
}

ChipResult draw_banked(test::TreeBoard& board, uint64_t& row_hits) {
  Simulation simulation;
  ChipDeviceModule chip("chip", board.run.options, *board.device);
  BankedDram memory("memory", board.run.image.memory), tree("tree", board.tree.memory);
  chip.memory.bind(memory.socket);
  chip.tree.bind(tree.socket);
  ChipResult result = chip.draw();
  row_hits = tree.row_hits;
  return result;
}

TEST(OwnMemory, OfTheChipAsOnePieceTakesAsLongAsTheBoardsIfItDoes) {
  test::TreeBoard board, systemc;
  const ChipResult expected = board.draw(), result = draw_in_systemc(systemc);
  EXPECT_TRUE(systemc.run.frame == board.run.frame);
  EXPECT_EQ(result.cycles, expected.cycles);
  EXPECT_EQ(result.memory_port_utilisation, expected.memory_port_utilisation);
}

TEST(OwnMemory, OfTheChipAsOnePieceDrawsTheSamePictureInAnotherTime) {
  test::TreeBoard board, banked;
  uint64_t row_hits = 0;
  const ChipResult expected = board.draw(), result = draw_banked(banked, row_hits);
  EXPECT_TRUE(banked.run.frame == board.run.frame);
  EXPECT_EQ(result.contributions, expected.contributions);
  EXPECT_NE(result.cycles, expected.cycles);
  EXPECT_GT(row_hits, 0u);
}

TEST(OwnMemory, OfTheChipAsOnePieceThatRefusesEndsTheRunWithASentence) {
  test::TreeBoard board;
  Simulation simulation;
  ChipDeviceModule chip("chip", board.run.options, *board.device);
  Peculiar refuses("memory", [](tlm::tlm_generic_payload& payload) {
    payload.set_response_status(tlm::TLM_ADDRESS_ERROR_RESPONSE);
  });
  chip.memory.bind(refuses.socket);
  FixedLatencyMemory tree("tree", board.tree.memory, 100);
  chip.tree.bind(tree.socket);
  EXPECT_THROW(chip.draw(), InputError);
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
    unit = std::make_unique<CycleUnit>(options.configuration, memory);
    options.device = unit.get();
  }
  void expect_result() const {
    for (uint32_t i = 0; i < kElements; ++i) {
      EXPECT_EQ(memory.load(kY + 4 * i), as_bits(static_cast<float>(i) + 0.5f)) << i;
    }
  }
};

TEST(OwnMemory, ServesAComputeProgram) {
  Saxpy fixed, banked;
  const ProgramResult expected = run_program(fixed.options);
  Simulation simulation;
  ProgramChip chip("chip", banked.options);
  BankedDram dram("dram", banked.memory);
  chip.memory.bind(dram.socket);
  const ProgramResult result = chip.run();
  fixed.expect_result();
  banked.expect_result();
  EXPECT_EQ(result.memory_reads, expected.memory_reads);
  EXPECT_EQ(dram.row_hits + dram.row_misses, result.memory_reads + result.memory_writes);
  EXPECT_GT(dram.row_hits, dram.row_misses);
  EXPECT_NE(result.cycles, expected.cycles);
}

std::string refusal(std::function<void(tlm::tlm_generic_payload&)> what) {
  Saxpy saxpy;
  Simulation simulation;
  ProgramChip chip("chip", saxpy.options);
  Peculiar memory("memory", std::move(what));
  chip.memory.bind(memory.socket);
  try {
    chip.run();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(OwnMemory, ThatRefusesAnAccessEndsTheRunWithASentence) {
  EXPECT_EQ(
      refusal([](tlm::tlm_generic_payload& payload) { payload.set_response_status(tlm::TLM_ADDRESS_ERROR_RESPONSE); }),
      "the memory model answers TLM_ADDRESS_ERROR_RESPONSE to a read of 64 bytes at address 0x0: it must serve it");
  EXPECT_EQ(refusal([](tlm::tlm_generic_payload&) {}).find("the memory model answers TLM_INCOMPLETE_RESPONSE"), 0u);
}

TEST(OwnMemory, ThatWaitsEndsTheRunWithASentence) {
  const std::string text = refusal([](tlm::tlm_generic_payload&) { sc_core::wait(1, sc_core::SC_NS); });
  EXPECT_EQ(text.find("the memory model fails in a read at address 0x"), 0u) << text;
  EXPECT_NE(text.find("must add to the delay, and not wait"), std::string::npos) << text;
}

}  // namespace
}  // namespace raypool::chip
