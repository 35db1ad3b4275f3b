#include "explore/area_table.hpp"

#include <gtest/gtest.h>

#include "config/limits.hpp"
#include "files/input_file.hpp"

namespace raypool::explore {
namespace {

const char* const kTable = R"t({"blocks": [
  {"block": "warp", "scope": "unit", "mm2": {"1": 1, "warps * lanes": 0.5, "sqrt(lanes * lanes * warps)": 0.25}},
  {"block": "pool", "scope": "chip", "mm2": {"units": 10, "chip.shading=traverser * warps": 100, "kernel_overlap": 7}},
  {"block": "slow", "scope": "unit", "mm2": {"slow_lanes": 1000}}]})t";

double area_of(const std::string& name, const std::vector<std::string>& set, uint32_t units) {
  return AreaTable(kTable, "t.json").area_of(load_configuration(name, set), units);
}

TEST(AreaTable, AddsTermsOfUnitsAndOfTheChip) {
  EXPECT_DOUBLE_EQ(area_of("4w4c", {}, 0), 1 + 8 + 2 + 4000);
  EXPECT_DOUBLE_EQ(area_of("4w4c", {"slow_lanes=1"}, 0), 1 + 8 + 2 + 1000);
  EXPECT_DOUBLE_EQ(area_of("4w4c", {"slow_lanes=1"}, 2), 2 * 1011 + 20);
  EXPECT_DOUBLE_EQ(area_of("4w4c", {"slow_lanes=1", "chip.shading=traverser", "kernel_overlap=true"}, 1),
                   1011 + 10 + 400 + 7);
}

std::string refusal(const std::string& text) {
  try {
    AreaTable(text, "t.json").area_of(load_configuration("4w4c"), 1);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(AreaTable, RefusesWhatIsNone) {
  for (const char* text :
       {"{}", "[", R"({"blocks": [{"scope": "unit"}]})", R"({"blocks": [{"scope": "unit", "mm2": {"1": "x"}}]})"})
    EXPECT_EQ(refusal(text).rfind("t.json is not a table of areas: ", 0), 0u) << text << ": " << refusal(text);
  EXPECT_EQ(refusal(R"({"blocks": [{"scope": "unit", "mm2": {"wraps": 1}}]})"),
            "t.json: 'wraps' is not a field of a configuration");
}

// Synthesised with the unit's own flow: docs/studies/unit-area.md.
TEST(AreaTable, OfTheProjectKnowsItsUnits) {
  const AreaTable table(read_text_file(area_table_path(), "table of areas"), area_table_path());
  EXPECT_NEAR(table.area_of(load_configuration("4w4c"), 0), 0.328, 0.02);
  EXPECT_NEAR(table.area_of(load_configuration("8w8c"), 0), 0.647, 0.03);
  EXPECT_NEAR(table.area_of(load_configuration("best_8w8c"), 0), 0.482, 0.03);
}

}  // namespace
}  // namespace raypool::explore
