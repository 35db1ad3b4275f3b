#include "chip/module_tree.hpp"

#include <gtest/gtest.h>

#include "chip/board_modules.hpp"
#include "chip/frame_setup.hpp"
#include "chip/simulation.hpp"
#include "chip/test_banked_dram.hpp"
#include "chip/test_board.hpp"

namespace raypool::chip {
namespace {

TEST(ModuleTree, ShowsWhatEachSocketIsBoundTo) {
  test::TreeBoard board;
  const std::string text = chip_modules(board.run.options, *board.device);
  EXPECT_EQ(text, R"(chip                    ChipModule
  memory                initiator socket, 128 bits -> memory.socket
  tree                  initiator socket, 128 bits -> tree.socket
  frame                 initiator socket, 128 bits -> frame.socket
  host                  target socket, 32 bits
  traverser             port of ExternalTraverserIf -> nothing
  done                  port of sc_signal_write_if -> done
memory                  FixedLatencyMemory
  socket                target socket, 128 bits
frame                   FrameBufferModule
  socket                target socket, 128 bits
host                    HostModule
  socket                initiator socket, 32 bits -> chip.host
  done                  port of sc_signal_in_if -> done
tree                    FixedLatencyMemory
  socket                target socket, 128 bits
)");
}

TEST(ModuleTree, DrawsNothing) {
  test::BoardRun board({"", 4, 4, 1, 16, 12, 1});
  const FrameBuffer before = board.run.frame;
  chip_modules(board.run.options, *board.device);
  EXPECT_TRUE(board.run.frame == before);
}

TEST(ModuleTree, ShowsTheMemoryThatIsBound) {
  test::BoardRun board({"", 4, 4, 1, 16, 12, 1});
  Simulation simulation;
  ChipModule chip("own", board.run.options, *board.device);
  test::BankedDram dram("dram", board.run.image.memory);
  FrameBufferModule frame("frame", board.run.sink);
  HostModule host("host", frame_setup(board.run.options));
  sc_core::sc_signal<bool> done{"done"};
  chip.memory.bind(dram.socket);
  chip.frame.bind(frame.socket);
  host.socket.bind(chip.host);
  host.done.bind(done);
  const std::string text = module_tree();
  const auto has = [&](const std::string& line) {
    EXPECT_NE(text.find(line + "\n"), std::string::npos) << line << "\n" << text;
  };
  has("  memory                initiator socket, 128 bits -> dram.socket");
  has("  tree                  initiator socket, 128 bits -> nothing");
  has("  done                  port of sc_signal_write_if -> nothing");
  has("dram                    BankedDram");
}

}  // namespace
}  // namespace raypool::chip
