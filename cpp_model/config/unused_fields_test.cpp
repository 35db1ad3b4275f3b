#include "config/unused_fields.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "config/settings.hpp"

namespace raypool {
namespace {

std::vector<std::string> unused(const std::vector<std::string>& set) {
  std::vector<std::string> paths;
  for (const UnusedField& field : unused_fields(load_configuration("8w8c", set))) paths.push_back(field.path);
  return paths;
}
bool is_unused(const std::string& path, const std::vector<std::string>& set) {
  const std::vector<std::string> paths = unused(set);
  return std::find(paths.begin(), paths.end(), path) != paths.end();
}
std::string refused(const std::vector<std::string>& set) {
  try {
    refuse_unused_settings(load_configuration("8w8c", set));
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST(UnusedFields, AreThoseOfATraverserThatIsNotThere) {
  std::vector<std::string> hardware;
  for (const ConfigurationField& field : fields())
    if (field.path.rfind("chip.hardware_traverser.", 0) == 0) hardware.push_back(field.path);
  hardware.insert(hardware.end(), {"chip.memory.banks", "chip.memory.row_bytes"});
  EXPECT_EQ(unused({"chip.traverser=static"}), hardware);
  EXPECT_EQ(unused({}), (std::vector<std::string>{"chip.static_traverser.batch", "chip.static_traverser.stall_cycles",
                                                  "chip.memory.banks", "chip.memory.row_bytes"}));
}

TEST(UnusedFields, AreWhatOtherFieldsMakeMeaningless) {
  EXPECT_FALSE(is_unused("chip.static_traverser.batch", {"chip.policy=fill"})) << "the policy looks at it";
  EXPECT_TRUE(is_unused("chip.thresholds.rays", {"chip.policy=fill"}));
  EXPECT_FALSE(is_unused("chip.memory.banks", {"chip.memory.row_miss=30"}));
  EXPECT_FALSE(is_unused("chip.hardware_traverser.triangle_pipes", {"chip.traverser=hardware"}));
  EXPECT_TRUE(is_unused("wide_ray_memory", {"lanes=4", "wide_ray_memory=true"}));
  EXPECT_FALSE(is_unused("wide_ray_memory", {"wide_ray_memory=true"}));
}

TEST(UnusedFields, AreRefusedWhereTheyAreSet) {
  EXPECT_EQ(refused({"chip.traverser=static", "chip.hardware_traverser.lanes=1"}),
            "chip.hardware_traverser.lanes is not looked at: chip.traverser is static, which has no machine inside; "
            "choose chip.traverser=hardware, or leave it out");
  EXPECT_EQ(refused({"chip.hardware_traverser.lanes=2"}), "");
  EXPECT_NE(refused({"chip.traverser=static chip.hardware_traverser.rays=8 chip.hardware_traverser.lanes=4"})
                .find(" are not looked at"),
            std::string::npos);
  EXPECT_NE(refused({"chip.traverser=static", "chip.hardware_traverser.lanes=4"}), "") << "also to what it is anyway";
}

TEST(UnusedFields, OfAFileAreToldWhereTheyAreNotTheDefaults) {
  EXPECT_EQ(unused_in_file(load_configuration("8w8c")), "");
  const std::string said = unused_in_file(load_configuration("best_8w8c", {"chip.traverser=static"}));
  EXPECT_EQ(said.find("configuration best"), 0u) << said;
  EXPECT_NE(said.find("chip.hardware_traverser.rays and 7 more are not looked at"), std::string::npos) << said;
  EXPECT_EQ(unused_in_file(load_configuration("best_8w8c")), "");
}

}  // namespace
}  // namespace raypool
