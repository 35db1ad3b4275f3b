#include "faulty/guilty.hpp"

#include <gtest/gtest.h>

namespace raypool::faulty {
namespace {

const std::string kTitle = "lockstep difference in unit: the memory requests differ in this cycle\n  cycle 5\n";

TEST(FilesNamed, AreThoseBeforeTheFirstSemicolonAndAtMostThree) {
  EXPECT_EQ(
      files_named(kTitle + "  look at: rtl/x/a.v, rtl/x/b.v, rtl/x/b.v; else rtl/x/c.v\n  so far nothing, rtl/x/d.v"),
      (std::vector<std::string>{"a.v", "b.v"}));
  EXPECT_EQ(files_named(kTitle + "  look at: rtl/room/a.v, rtl/room/b.v, rtl/room/c.v, rtl/room/d.v"),
            (std::vector<std::string>{"a.v", "b.v", "c.v"}));
  EXPECT_EQ(files_named(kTitle + "  look at: what the warps wait for\n  rtl/room/a.v"), std::vector<std::string>());
  EXPECT_EQ(files_named("another fault than expected in rtl/room/a.v"), std::vector<std::string>());
}

TEST(FilesNamed, AreWhatTheSimulatorPrintsWhenItStops) {
  EXPECT_EQ(files_named("signal 6: %Error: rtl/compute/rp_data_cache.v:203: Verilog $stop"),
            std::vector<std::string>{"rp_data_cache.v"});
}

TEST(Hierarchy, IsThatOfTheVerilog) {
  const Hierarchy hierarchy("rtl");
  EXPECT_EQ(hierarchy.parents("event_counter"), (std::set<std::string>{"frame_port", "intersection_pool", "memory_port",
                                                                       "performance_counters", "ray_pool"}));
  EXPECT_EQ(hierarchy.parents("data_cache"), std::set<std::string>{"mem_alu"});
  EXPECT_EQ(hierarchy.parents("int_alu"), std::set<std::string>{"compute_unit"}) << "instantiated in an included file";
  EXPECT_EQ(hierarchy.parents("round_robin"),
            (std::set<std::string>{"block_scheduler", "fetch_arbiter", "port_arbiter", "ray_exit", "traverser",
                                   "tree_banks", "tree_cache", "tree_port", "triangle_group"}));
  EXPECT_EQ(hierarchy.parents("multiprocessor"), std::set<std::string>{"chip"});
  EXPECT_TRUE(hierarchy.parents("chip").empty());
  EXPECT_TRUE(hierarchy.contains("mem_alu", "ram_1rw"));
  EXPECT_FALSE(hierarchy.contains("ray_alu", "miss_status"));
}

TEST(Judge, KnowsTheFileItsParentAndOthers) {
  const Hierarchy hierarchy("rtl");
  EXPECT_EQ(judge(hierarchy, {"rp_warp.v", "rp_pc_stack.v"}, "rp_pc_stack.v"), Verdict::Right);
  EXPECT_EQ(judge(hierarchy, {"rp_warp.v"}, "rp_pc_stack.v"), Verdict::Parent);
  EXPECT_EQ(judge(hierarchy, {"rp_compute_unit.v"}, "rp_pc_stack.v"), Verdict::Wrong) << "two levels above is no help";
  EXPECT_EQ(judge(hierarchy, {"rp_pc_stack.v"}, "rp_warp.v"), Verdict::Wrong) << "a child is not the parent";
  EXPECT_EQ(judge(hierarchy, {}, "rp_warp.v"), Verdict::None);
}

TEST(NamedEarly, IsTheFirstOrTheSecondOfTheFiles) {
  EXPECT_TRUE(named_early({"rp_warp.v", "rp_pc_stack.v", "rp_launcher.v"}, "rp_warp.v"));
  EXPECT_TRUE(named_early({"rp_warp.v", "rp_pc_stack.v", "rp_launcher.v"}, "rp_pc_stack.v"));
  EXPECT_FALSE(named_early({"rp_warp.v", "rp_pc_stack.v", "rp_launcher.v"}, "rp_launcher.v"));
  EXPECT_FALSE(named_early({"rp_warp.v"}, "rp_launcher.v"));
  EXPECT_FALSE(named_early({}, "rp_warp.v"));
}

}  // namespace
}  // namespace raypool::faulty
