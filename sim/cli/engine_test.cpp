#include "cli/engine.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>

#include "config/data_folder.hpp"

namespace raypool {
namespace {

namespace fs = std::filesystem;

TEST(NewerVerilog, IsAFileChangedAfterTheUnitWasBuilt) {
  const fs::path folder = fs::path(testing::TempDir()) / "newer_verilog", rtl = folder / "rtl";
  fs::remove_all(folder);
  EXPECT_TRUE(fs::create_directories(rtl / "compute") && fs::create_directories(rtl / "include"));
  const fs::path library = folder / "libraypool_unit.so";
  for (const fs::path& file : {library, rtl / "compute/rp_warp.v", rtl / "include/rp_isa.vh", rtl / "waivers.vlt"})
    std::ofstream(file) << "x";
  const auto built = fs::last_write_time(library);
  const auto change = [&](const char* file, int seconds) {
    fs::last_write_time(rtl / file, built + std::chrono::seconds(seconds));
  };
  change("compute/rp_warp.v", -1);
  change("include/rp_isa.vh", 0);
  change("waivers.vlt", 1);
  EXPECT_EQ(newer_verilog(library, rtl), "");
  change("include/rp_isa.vh", 1);
  EXPECT_EQ(newer_verilog(library, rtl), rtl / "include/rp_isa.vh");
  EXPECT_EQ(newer_verilog(library, folder / "no such folder"), "");
  fs::remove_all(folder);
}

TEST(ProgramCommand, RunsTheProgramAsItWasCalled) {
  const std::string command = program_command();
  EXPECT_EQ(fs::path(command).filename(), fs::read_symlink("/proc/self/exe").filename());
  EXPECT_TRUE(command.find('/') == std::string::npos || fs::equivalent(command, "/proc/self/exe")) << command;
}

}  // namespace
}  // namespace raypool
