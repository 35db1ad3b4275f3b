#include "chip/module_tree.hpp"

#include <gtest/gtest.h>

#include "chip/chip_module.hpp"
#include "chip/simulation.hpp"
#include "chip/test_banked_dram.hpp"
#include "chip/test_real_frame.hpp"
#include "machine/cycle_unit.hpp"

namespace raypool::chip {
namespace {

TEST(ModuleTree, SaysWhatEachPortIsBoundTo) {
  test::RealFrame run(2, 2, 8, 8, 1);
  run.set_device(std::make_unique<CycleUnit>(run.options.configuration, run.image.memory));
  const std::string text = chip_modules(run.options);
  const auto has = [&](const std::string& line) {
    EXPECT_NE(text.find(line + "\n"), std::string::npos) << line << "\n" << text;
  };
  has("chip                    Chip");
  has("  device_host           DeviceHost");
  has("    memory              port of MemoryIf -> chip.memory_port.device");
  has("    kernel_events       port of KernelEventsIf -> chip.controller.kernel_events, "
      "chip.pixel_ledger.kernel_events, "
      "chip.traverser.kernel_events");
  has("    watched             port of WatchedIf -> chip");
  has("    rays                port of RaySourceIf -> chip.ray_pool.traverser");
  has("  memory                initiator socket, 128 bits -> memory.socket");
  has("memory                  FixedLatencyMemory");
  has("  socket                target socket, 128 bits");
  EXPECT_EQ(text.find("nothing"), std::string::npos) << text;
  EXPECT_EQ(text.find("without a name"), std::string::npos) << text;
}

TEST(ModuleTree, ShowsTheMemoryThatIsBound) {
  test::RealFrame run(2, 2, 8, 8, 1);
  run.set_device(std::make_unique<CycleUnit>(run.options.configuration, run.image.memory));
  Simulation simulation;
  Chip chip("own", run.options);
  test::BankedDram dram("dram", run.image.memory);
  chip.memory.bind(dram.socket);
  const std::string text = module_tree();
  EXPECT_NE(text.find("  memory                initiator socket, 128 bits -> dram.socket\n"), std::string::npos)
      << text;
  EXPECT_NE(text.find("dram                    BankedDram\n"), std::string::npos) << text;
}

}  // namespace
}  // namespace raypool::chip
