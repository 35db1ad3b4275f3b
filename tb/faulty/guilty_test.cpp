#include "faulty/guilty.hpp"

#include <gtest/gtest.h>

namespace raypool::faulty {
namespace {

const std::string kTitle = "lockstep difference in unit: the memory requests differ in this cycle\n  cycle 5\n";

TEST(FilesNamed, AreThoseBeforeTheFirstSemicolonAndAtMostThree) {
  EXPECT_EQ(files_named(kTitle + "  look at: rtl/a.v, rtl/b.v, rtl/b.v; else rtl/c.v\n  so far nothing, rtl/d.v"),
            (std::vector<std::string>{"a.v", "b.v"}));
  EXPECT_EQ(files_named(kTitle + "  look at: rtl/a.v, rtl/b.v, rtl/c.v, rtl/d.v"),
            (std::vector<std::string>{"a.v", "b.v", "c.v"}));
  EXPECT_EQ(files_named(kTitle + "  look at: what the warps wait for\n  rtl/a.v"), std::vector<std::string>());
  EXPECT_EQ(files_named("another fault than expected in rtl/a.v"), std::vector<std::string>());
}

TEST(FilesNamed, AreWhatTheSimulatorSaysWhenItStops) {
  EXPECT_EQ(files_named("signal 6: %Error: rtl/data_cache.v:203: Verilog $stop"),
            std::vector<std::string>{"data_cache.v"});
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
  EXPECT_EQ(judge(hierarchy, {"warp.v", "pc_stack.v"}, "pc_stack.v"), Verdict::Right);
  EXPECT_EQ(judge(hierarchy, {"warp.v"}, "pc_stack.v"), Verdict::Parent);
  EXPECT_EQ(judge(hierarchy, {"compute_unit.v"}, "pc_stack.v"), Verdict::Wrong) << "two levels above is no help";
  EXPECT_EQ(judge(hierarchy, {"pc_stack.v"}, "warp.v"), Verdict::Wrong) << "a child is not the parent";
  EXPECT_EQ(judge(hierarchy, {}, "warp.v"), Verdict::None);
}

TEST(NamedEarly, IsTheFirstOrTheSecondOfTheFiles) {
  EXPECT_TRUE(named_early({"warp.v", "pc_stack.v", "launcher.v"}, "warp.v"));
  EXPECT_TRUE(named_early({"warp.v", "pc_stack.v", "launcher.v"}, "pc_stack.v"));
  EXPECT_FALSE(named_early({"warp.v", "pc_stack.v", "launcher.v"}, "launcher.v"));
  EXPECT_FALSE(named_early({"warp.v"}, "launcher.v"));
  EXPECT_FALSE(named_early({}, "warp.v"));
}

}  // namespace
}  // namespace raypool::faulty
