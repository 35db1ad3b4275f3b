#include "config/settings.hpp"

#include <gtest/gtest.h>

#include <set>

namespace raypool {
namespace {

std::string settings_error(const std::vector<std::string>& set, const std::string& config = "8w2c") {
  try {
    load_configuration(config, set);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Settings, ChangeAnyFieldOfUnitAndChip) {
  const Configuration changed =
      load_configuration("4w4c", {"alus.flt.count=2", "arithmetic.fma=true chip.ray_pool.size=100", "warps=8"});
  EXPECT_EQ(changed.alu(AluType::Flt).count, 2);
  EXPECT_TRUE(changed.fma);
  EXPECT_EQ(changed.chip.ray_pool_size, 100);
  EXPECT_EQ(changed.warps, 8);
  EXPECT_EQ(changed.lanes, 4);
}

TEST(Settings, ReachEveryFieldThatAFileHolds) {
  // Each is set to another value where it has one, and that value must be what the machine then prints. Sizes of the
  // traverser in hardware bound one another.
  const std::string base = "chip.traverser=static";
  const Configuration fixed = load_configuration("8w8c", {base});
  const nlohmann::ordered_json before = nlohmann::ordered_json::parse(to_json(fixed));
  for (const ConfigurationField& field : fields()) {
    const std::string value = value_text(before, field.path);
    const std::string other = field.range.form == Range::Form::OnOff ? (value == "true" ? "false" : "true")
                              : field.range.form == Range::Form::Name || field.range.form == Range::Form::Instructions
                                  ? std::string(names_of(field.range).back())
                              : field.path == "chip.held_limit" ? "100"
                                                                : std::to_string(field.range.greatest);
    const Configuration changed = load_configuration("8w8c", {base, field.path + "=" + other});
    EXPECT_EQ(value_text(nlohmann::ordered_json::parse(to_json(changed)), field.path), other) << field.path;
    EXPECT_EQ(changed.name == fixed.name, other == value) << field.path;
  }
}

TEST(Settings, WhatFollowsAFieldFollowsIt) {
  EXPECT_EQ(load_configuration("8w8c", {"arithmetic.slow_unit=newton1"}).alu(AluType::Slw).depth, 8);
  EXPECT_EQ(load_configuration("8w8c", {"chip.intersection_pool.size=64"}).chip.held_limit, 64);
}

TEST(Settings, TheNameShowsWhatWasChanged) {
  const auto name = [](const std::vector<std::string>& set) { return load_configuration("8w8c", set).name; };
  EXPECT_EQ(name({"alus.flt.count=2", "warps=4"}), "8w8c+warps-4+alus.flt.count-2");
  EXPECT_EQ(name({"warps=4", "alus.flt.count=2", "warps=2"}), "8w8c+warps-2+alus.flt.count-2");
  EXPECT_EQ(name({"chip.window_remedy=false"}), "8w8c+chip.window_remedy-false");
  EXPECT_EQ(name({"warps=8"}), "8w8c") << "nothing is changed";
  EXPECT_EQ(name({"name=mine", "warps=4"}), "mine");
  EXPECT_EQ(name({"alus.flt.count=2 alus.int.count=2 alus.slw.count=2 warps=4 lanes=4"}), "8w8c+5_changes");
  EXPECT_EQ(settings_error({"name=4w4c"}).find("8w2c with --set name=4w4c: the name '4w4c' stands for other hardware"),
            0u);
}

TEST(Settings, OnlyTheUnitsFieldsAskForAnotherVerilatedUnit) {
  const auto verilog = [](const std::string& set) { return verilog_parameters(load_configuration("8w8c", {set})); };
  EXPECT_EQ(verilog("chip.ray_pool.size=100"), verilog_parameters(Configuration()));
  EXPECT_NE(verilog("data_cache.bytes=4096"), verilog_parameters(Configuration()));
}

TEST(Settings, AnUnknownFieldNamesTheNearest) {
  EXPECT_EQ(settings_error({"chip.ray_pol=9"}),
            "--set: there is no field 'chip.ray_pol': did you mean chip.ray_pool.size, chip.ray_pool.overhead or "
            "chip.ray_pool.cycles_per_beat? (raypool config prints all)");
  EXPECT_EQ(settings_error({"flt.count=2"}),
            "--set: there is no field 'flt.count': did you mean alus.flt.count? (raypool config prints all)");
  EXPECT_EQ(settings_error({"slow_unit=exact"}),
            "--set: there is no field 'slow_unit': did you mean arithmetic.slow_unit? (raypool config prints all)");
  EXPECT_EQ(settings_error({"data_cache.size=512"}),
            "--set: there is no field 'data_cache.size': did you mean data_cache.bytes or data_cache.mshrs? (raypool "
            "config prints all)");
  EXPECT_EQ(settings_error({"chip.memory=5"})
                .find("--set: there is no field 'chip.memory': did you mean chip.memory.latency, "
                      "chip.memory.cycles_per_beat or chip.memory.queue? (raypool config prints all)"),
            0u)
      << settings_error({"chip.memory=5"});
  EXPECT_EQ(settings_error({"colour=5"}), "--set: there is no field 'colour'; raypool config prints all");
}

TEST(Settings, AParameterOfTheVerilogNamesItsField) {
  EXPECT_EQ(settings_error({"DATA_CACHE_BYTES=4096"}),
            "--set: there is no field 'DATA_CACHE_BYTES': did you mean data_cache.bytes? (raypool config prints all)");
}

TEST(Settings, FieldsWithCommasBetweenAreToldApart) {
  EXPECT_EQ(settings_error({"data_cache.bytes=4096,alus.flt.count=2"}),
            "--set data_cache.bytes=4096,alus.flt.count=2: put blanks between fields, not commas: "
            "\"data_cache.bytes=4096 alus.flt.count=2\"");
}

TEST(Settings, AMistypedNameNamesTheNearest) {
  EXPECT_EQ(settings_error({"chip.traverser=hardwre"}),
            "--set chip.traverser=hardwre: did you mean hardware? (it must be one of static, hardware)");
}

TEST(Settings, AValueThatCannotBeIsOneSentence) {
  EXPECT_EQ(settings_error({"warps=eight"}), "--set warps=eight: warps must be a power of two from 1 to 32");
  EXPECT_EQ(settings_error({"warps="}), "--set warps=: warps must be a power of two from 1 to 32");
  EXPECT_EQ(settings_error({"warps=8.5"}), "--set warps=8.5: warps must be a power of two from 1 to 32");
  EXPECT_EQ(settings_error({"stack_depth=99999999999"}),
            "--set stack_depth=99999999999: stack_depth must be an integer from 2 to 32");
  EXPECT_EQ(settings_error({"arithmetic.fma=1"}), "--set arithmetic.fma=1: arithmetic.fma must be true or false");
  EXPECT_EQ(settings_error({"warps"}), "--set warps: write FIELD=VALUE, such as data_cache.bytes=4096");
  EXPECT_EQ(settings_error({"warps=3"}), "8w2c with --set warps=3: warps is 3; it must be a power of two from 1 to 32");
  EXPECT_EQ(settings_error({"arithmetic.slow_unit=fast"}),
            "--set arithmetic.slow_unit=fast: arithmetic.slow_unit must be one of exact, newton2, newton1, newton0");
  EXPECT_EQ(settings_error({"arithmetic.slow_unit=\xff"}).find("--set arithmetic.slow_unit="), 0u);
  EXPECT_EQ(
      settings_error({"alus.mem.count=2"}),
      "8w2c with --set alus.mem.count=2: alus.mem.count is 2; it must be 1, because this unit owns the data cache");
}

}  // namespace
}  // namespace raypool
