#include "config/configuration.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

#include "config/parameter_table.hpp"
#include "config/reference.hpp"
#include "isa/encoding.hpp"

namespace raypool {
namespace {

namespace fs = std::filesystem;

/// A file that is gone after the test.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& text, const std::string& name = "test.json") {
    folder_ = fs::temp_directory_path() / ("raypool_configuration_test_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
    std::ofstream(folder_ / name) << text;
    path_ = folder_ / name;
  }
  ~TemporaryFile() { fs::remove_all(folder_); }
  std::string path() const { return path_.string(); }
  std::string folder() const { return folder_.string(); }

 private:
  fs::path folder_, path_;
};

std::string error_of(const std::string& json) {
  const TemporaryFile file(json);
  try {
    load_configuration(file.path());
  } catch (const InputError& error) {
    const std::string what = error.what();
    EXPECT_EQ(what.find(file.path() + ": "), 0u) << what;
    return what.substr(std::min(what.size(), file.path().size() + 2));
  }
  return "no error";
}

bool equal(const Configuration& a, const Configuration& b) { return to_json(a) == to_json(b); }

TEST(Configuration, CheckedInFilesHaveTheNameAndSizeTheyAreCalledBy) {
  int files = 0;
  for (const auto& entry : fs::directory_iterator("configs")) {
    if (entry.path().extension() != ".json") continue;
    const std::string name = entry.path().stem().string();
    SCOPED_TRACE(name);
    const Configuration configuration = load_configuration(name);
    EXPECT_EQ(configuration.name, name);
    EXPECT_TRUE(equal(configuration, load_configuration(entry.path().string())));
    int warps = 0, lanes = 0;
    char end = 0;
    if (std::sscanf(name.c_str(), "%dw%dc%c", &warps, &lanes, &end) == 2) {
      EXPECT_EQ(configuration.warps, warps);
      EXPECT_EQ(configuration.lanes, lanes);
    }
    ++files;
  }
  EXPECT_GE(files, 10);
}

TEST(Configuration, NameOfTheFormNwMcNeedsNoFile) {
  const Configuration configuration = load_configuration("2w16c");
  EXPECT_EQ(configuration.name, "2w16c");
  EXPECT_EQ(configuration.warps, 2);
  EXPECT_EQ(configuration.lanes, 16);
  EXPECT_EQ(configuration.contents(), 32);
}

TEST(Configuration, WhatAFileDoesNotNameKeepsItsDefault) {
  const TemporaryFile file(R"({"warps": 4, "alus": {"flt": {"count": 2}}, "arithmetic": {"subnormals": "flush"}})");
  Configuration expected;
  expected.name = "test";
  expected.warps = 4;
  expected.alus[AluType::Flt].count = 2;
  expected.subnormals = Subnormals::Flush;
  EXPECT_TRUE(equal(load_configuration(file.path()), expected));
}

TEST(Configuration, WrittenAndReadAgainIsTheSame) {
  Configuration configuration;
  configuration.name = "odd-1.2";
  configuration.warps = 16;
  configuration.lanes = 2;
  configuration.stack_depth = 5;
  for (uint32_t type = 0; type < kAluTypes; ++type) {
    AluConfiguration& alu = configuration.alus[type];
    if (!kAluTable[type].timed_by_events()) alu = {1 + type % 4, 2 + type, alu.depth + 2 + type % 3};
  }
  configuration.instruction_cache_bytes = 1024;
  configuration.data_cache_bytes = 2048;
  configuration.data_cache_mshrs = 7;
  configuration.subnormals = Subnormals::Flush;
  configuration.slow_unit = SlowUnit::Newton1;
  configuration.fma = true;
  configuration.chip.ray_pool_size = 100;
  configuration.chip.held_limit = 77;
  configuration.chip.window_remedy = false;
  configuration.chip.memory_latency = 60;
  const TemporaryFile file(to_json(configuration));
  const Configuration read = load_configuration(file.path());
  EXPECT_TRUE(equal(read, configuration));
  EXPECT_EQ(verilog_parameters(read), verilog_parameters(configuration));
  EXPECT_EQ(read.alu(AluType::Slw).depth, 15);
  EXPECT_EQ(read.slow_unit, SlowUnit::Newton1);
  EXPECT_TRUE(read.fma);
}

TEST(Configuration, ErrorsNameKeyValueAndAllowedRange) {
  EXPECT_EQ(error_of(R"({"warps": 3})"), "warps is 3; it must be a power of two from 1 to 32");
  EXPECT_EQ(error_of(R"({"warps": 64})"), "warps is 64; it must be a power of two from 1 to 32");
  EXPECT_EQ(error_of(R"({"lanes": 0})"), "lanes is 0; it must be a power of two from 1 to 32");
  EXPECT_EQ(error_of(R"({"stack_depth": 1})"), "stack_depth is 1; it must be an integer from 2 to 32");
  EXPECT_EQ(error_of(R"({"alus": {"slw": {"depth": 10}}})"),
            "alus.slw.depth is 10; it must be an integer from 11 to 32");
  EXPECT_EQ(error_of(R"({"alus": {"int": {"latency": 17}}})"),
            "alus.int.latency is 17; it must be an integer from 1 to 16");
  EXPECT_EQ(error_of(R"({"alus": {"mem": {"count": 2}}})"),
            "alus.mem.count is 2; it must be 1, because this unit owns the data cache");
  EXPECT_EQ(error_of(R"({"data_cache": {"bytes": 3000}})"),
            "data_cache.bytes is 3000; it must be a power of two from 512 to 65536");
  EXPECT_EQ(error_of(R"({"data_cache": {"mshrs": 0}})"), "data_cache.mshrs is 0; it must be an integer from 1 to 16");
  EXPECT_EQ(error_of(R"({"warps": "8"})"), "warps is \"8\"; it must be an integer without quotes");
  EXPECT_EQ(error_of(R"({"warps": 8.5})"), "warps is 8.5; it must be an integer without quotes");
  EXPECT_EQ(error_of(R"({"warps": 4294967304})"), "warps is 4294967304; it must be an integer without quotes");
  EXPECT_EQ(error_of(R"({"arithmetic": {"slow_unit": "fast"}})"),
            "arithmetic.slow_unit is \"fast\"; it must be one of exact, newton2, newton1, newton0");
  EXPECT_EQ(error_of(R"({"name": "a b"})"),
            "name is 'a b'; it must have 1 to 64 characters out of letters, digits and _ . + -");
  EXPECT_EQ(error_of(R"({"chip": {"ray_pool": {"size": 0}}})"),
            "chip.ray_pool.size is 0; it must be an integer from 1 to 1048576");
  EXPECT_EQ(error_of(R"({"chip": {"policy": "magic"}})"),
            "chip.policy is \"magic\"; it must be " + text_of(parameter::kOfChip[0].range));
  EXPECT_EQ(error_of(R"({"chip": {"memory": 5}})"), "chip.memory must be an object in braces, not 5");
  EXPECT_EQ(error_of(R"({"alus": 3})"), "alus must be an object in braces, not 3");
  EXPECT_EQ(error_of("[]"), "the file must be an object in braces, not []");
}

TEST(Configuration, TheChipHoldsAsManyPixelsAsTheIntersectionPoolUnlessToldOtherwise) {
  const auto held = [](const std::string& chip) {
    const TemporaryFile file(R"({"chip": )" + chip + "}");
    return load_configuration(file.path()).chip.held_limit;
  };
  EXPECT_EQ(Configuration().chip.held_limit, Configuration().chip.intersection_pool_size);
  EXPECT_EQ(held(R"({"intersection_pool": {"size": 100}})"), 100);
  EXPECT_EQ(held(R"({"intersection_pool": {"size": 100}, "held_limit": 50})"), 50);
  EXPECT_EQ(error_of(R"({"chip": {"held_limit": 513}})"),
            "chip.held_limit is 513; it must be from 8, the width of a tile of 64 contents, to 512, which is "
            "chip.intersection_pool.size");
  EXPECT_EQ(error_of(R"({"chip": {"held_limit": 7}})"),
            "chip.held_limit is 7; it must be from 8, the width of a tile of 64 contents, to 512, which is "
            "chip.intersection_pool.size");
  EXPECT_EQ(error_of(R"({"warps": 32, "lanes": 32, "chip": {"intersection_pool": {"size": 31}}})"),
            "chip.intersection_pool.size is 31; with 1024 contents it must be at least 32, the width of a tile");
}

TEST(Configuration, RefusesCullingOfRaysThatReturn) {
  EXPECT_TRUE(load_configuration("4w4c", {"chip.miss_records=true"}).chip.miss_records);
  EXPECT_EQ(error_of(R"({"chip": {"miss_records": true, "culling": true}})"),
            "chip.miss_records and chip.culling are both true, but culling drops rays that would have to return: set "
            "one of them to false");
}

TEST(Configuration, ATraverserInHardwareHasSizesThatItsModulesCanHave) {
  const auto chip = [](const std::string& traverser, const std::string& sizes) {
    return R"({"chip": {"traverser": ")" + traverser + R"(", "hardware_traverser": {)" + sizes + "}}}";
  };
  for (const auto& [sizes, key, value, must] : std::vector<std::array<std::string, 4>>{
           {R"("lanes": 32)", "lanes", "32", "an integer from 1 to 31"},
           {R"("box_bits": 17)", "box_bits", "17", "an integer from 6 to 16"},
           {R"("rays": 126)", "rays", "126", "a multiple of lanes, which is 4, and at most 256 for each of them"},
           {R"("rays": 514, "lanes": 2)", "rays", "514",
            "a multiple of lanes, which is 2, and at most 256 for each of them"},
           {R"("triangle_pipes": 5)", "triangle_pipes", "5", "at most 4, which is lanes"},
           {R"("cache_banks": 32)", "cache_banks", "32", "a power of two from 1 to 16"},
           {R"("node_cache_ways": 1)", "node_cache_ways", "1", "a power of two from 2 to 16"},
           {R"("triangle_cache_ways": 1)", "triangle_cache_ways", "1", "a power of two from 2 to 16"},
           {R"("node_cache_bytes": 2048)", "node_cache_bytes", "2048",
            "at least 4096: two sets of 4 ways of 64 bytes in each of 8 banks"},
           {R"("triangle_cache_bytes": 1024, "triangle_cache_ways": 16, "cache_banks": 1)", "triangle_cache_bytes",
            "1024", "at least 2048: two sets of 16 ways of 64 bytes in each of 1 banks"},
           {R"("node_cache_mshrs": 12)", "node_cache_mshrs", "12",
            "a multiple of cache_banks, which is 8, and at most 32 in each bank"},
           {R"("triangle_cache_mshrs": 33, "cache_banks": 1)", "triangle_cache_mshrs", "33",
            "a multiple of cache_banks, which is 1, and at most 32 in each bank"}}) {
    EXPECT_EQ(error_of(chip("hardware", sizes)),
              fmt::format("chip.hardware_traverser.{} is {}; it must be {}", key, value, must));
  }
  const TemporaryFile file(chip("hardware", R"("rays": 512, "lanes": 2, "cache_banks": 16, "node_cache_ways": 16,
                                              "node_cache_bytes": 32768, "node_cache_mshrs": 64)"));
  EXPECT_NO_THROW(load_configuration(file.path()));
}

TEST(Configuration, TheChipHasTheSizesOfATraverserThatIsInside) {
  Configuration configuration;
  ChipConfiguration& chip = configuration.chip;
  const auto value = [&configuration](const std::string& name) {
    const auto parameters = chip_verilog_parameters(configuration, 1);
    const auto found = std::find_if(parameters.begin(), parameters.end(),
                                    [&](const auto& parameter) { return parameter.first == "TRAVERSER" + name; });
    EXPECT_NE(found, parameters.end()) << name;
    return found->second;
  };
  chip.traverser = TraverserName::Static;
  const auto outside = chip_verilog_parameters(configuration, 1);
  EXPECT_EQ(value(""), 0);
  chip.hardware_traverser_rays = 96;
  chip.hardware_traverser_lanes = 8;
  chip.hardware_traverser_node_cache_bytes = 1 << 17;
  EXPECT_EQ(chip_verilog_parameters(configuration, 1), outside) << "whatever sizes one inside would have";
  chip.traverser = TraverserName::Hardware;
  EXPECT_EQ(value(""), 1);
  EXPECT_EQ(value("_LANES"), 8);
  EXPECT_EQ(value("_SLOTS"), 12);
  EXPECT_EQ(value("_NODE_LINES"), 2048);
  EXPECT_EQ(value("_BITS"), 12);
  chip.hardware_traverser_box_bits = 9;
  EXPECT_EQ(value("_BITS"), 9);
}

TEST(Configuration, TheChipIsPartOfTheMachineAndNotOfItsVerilog) {
  const TemporaryFile file(R"({"chip": {"ray_pool": {"size": 100}}})");
  const Configuration configuration = load_configuration(file.path());
  EXPECT_EQ(verilog_parameters(configuration), verilog_parameters(Configuration()));
  EXPECT_FALSE(equal(configuration, Configuration()));
  const TemporaryFile taken(R"({"name": "8w8c", "chip": {"ray_pool": {"size": 100}}})", "other.json");
  EXPECT_THROW(load_configuration(taken.path()), InputError) << "another chip under a name that has a meaning";
}

TEST(Configuration, FewerNewtonStepsMakeSlwShallower) {
  for (const auto& [name, depth] : {std::pair{"exact", 11}, {"newton2", 11}, {"newton1", 8}, {"newton0", 6}}) {
    const std::string arithmetic = fmt::format(R"("arithmetic": {{"slow_unit": "{}"}})", name);
    const TemporaryFile file("{" + arithmetic + "}");
    EXPECT_EQ(load_configuration(file.path()).alu(AluType::Slw).depth, depth);
    EXPECT_EQ(error_of(fmt::format(R"({{"alus": {{"slw": {{"depth": {}}}}}, {}}})", depth - 1, arithmetic)),
              fmt::format("alus.slw.depth is {}; it must be an integer from {} to 32", depth - 1, depth));
  }
}

TEST(Configuration, FusedMultiplyAddDeepensFlt) {
  const TemporaryFile file(R"({"alus": {"flt": {"count": 2}}, "arithmetic": {"fma": true}})");
  const Configuration read = load_configuration(file.path());
  EXPECT_EQ(read.alu(AluType::Flt).depth, 5);
  EXPECT_EQ(least_depth(read, AluType::Flt), 5);
  EXPECT_EQ(least_depth(Configuration{}, AluType::Flt), 3);
  EXPECT_TRUE(read.has(instruction(Opcode::Ffma)));
  EXPECT_FALSE(Configuration{}.has(instruction(Opcode::Ffma)));
  EXPECT_EQ(error_of(R"({"alus": {"flt": {"depth": 4}}, "arithmetic": {"fma": true}})"),
            "alus.flt.depth is 4; it must be an integer from 5 to 32");
  EXPECT_EQ(error_of(R"({"arithmetic": {"fma": 1}})"), "arithmetic.fma is 1; it must be true or false");
}

TEST(Configuration, AnAluMayLackInstructions) {
  const TemporaryFile file(R"({"name": "few", "alus": {"int": {"without": ["sar", "imul"]}, "slw": {"without": []}}})");
  const Configuration read = load_configuration(file.path());
  EXPECT_EQ(read.alu(AluType::Int).without, 1u << operation_of(Opcode::Imul) | 1u << operation_of(Opcode::Sar));
  EXPECT_FALSE(read.has(instruction(Opcode::Imul)));
  EXPECT_TRUE(read.has(instruction(Opcode::Imax)));
  EXPECT_TRUE(read.has(instruction(Opcode::Fmul)));
  EXPECT_TRUE(read.has(instruction(Opcode::Fdiv)));
  const nlohmann::json written = nlohmann::json::parse(to_json(read));
  EXPECT_EQ(written["alus"]["int"]["without"].dump(), R"(["imul","sar"])");
  EXPECT_EQ(written["alus"]["slw"]["without"].dump(), "[]");
  EXPECT_FALSE(written["alus"]["tid"].contains("without"));
  EXPECT_EQ(parse_configuration(to_json(read), "here").alu(AluType::Int).without, read.alu(AluType::Int).without);
  EXPECT_EQ(load_configuration("4w4c", {"alus.int.without=sar,imul"}).name, "4w4c+alus.int.without-imul_sar");
  EXPECT_EQ(error_of(R"({"alus": {"flt": {"without": ["fmul"]}}})"),
            "alus.flt.without has \"fmul\"; it must be a list of some of fmin, fmax, f2i, i2f");
  EXPECT_EQ(error_of(R"({"alus": {"slw": {"without": "fdiv"}}})"),
            "alus.slw.without has \"fdiv\"; it must be a list of some of fdiv, fsqrt, frsqrt, frcp");
  EXPECT_EQ(error_of(R"({"alus": {"slw": {"without": ["imul"]}}})"),
            "alus.slw.without has \"imul\"; it must be a list of some of fdiv, fsqrt, frsqrt, frcp");
  EXPECT_EQ(error_of(R"({"alus": {"ray": {"without": []}}})"), "unknown key alus.ray.without; known here: count");
}

TEST(Configuration, UnknownKeysAreRefusedWithTheKnownOnes) {
  EXPECT_EQ(
      error_of(R"({"threads": 8})"),
      "unknown key threads; known here: name, warps, lanes, stack_depth, triples, kernel_overlap, wide_ray_memory, "
      "slow_lanes, sharing, intersection_words, registers, predicates, arguments, pc_bits, counter_bits, "
      "instruction_cache, data_cache, arithmetic, alus, chip, $schema");
  EXPECT_EQ(error_of(R"({"alus": {"ray": {"depth": 2}}})"), "unknown key alus.ray.depth; known here: count");
}

TEST(Configuration, AMistypedKeyOrNameNamesTheNearest) {
  EXPECT_EQ(error_of(R"({"wraps": 8})").find("unknown key wraps: did you mean warps? (known here: name, warps, "), 0u);
  EXPECT_EQ(error_of(R"({"alus": {"flt": {"counts": 1}}})"),
            "unknown key alus.flt.counts: did you mean count? (known here: count, latency, depth, without)");
  EXPECT_EQ(
      error_of(R"({"chip": {"ray_pol": {"size": 100}}})").find("unknown key chip.ray_pol: did you mean ray_pool?"), 0u);
  EXPECT_EQ(error_of(R"({"arithmetic": {"slow_unit": "newton"}})"),
            "arithmetic.slow_unit is \"newton\": did you mean newton2, newton1 or newton0? (it must be one of exact, "
            "newton2, newton1, newton0)");
  EXPECT_EQ(
      error_of(R"({"alus": {"slw": {"without": ["fdvi"]}}})"),
      "alus.slw.without has \"fdvi\": did you mean fdiv? (it must be a list of some of fdiv, fsqrt, frsqrt, frcp)");
}

TEST(Configuration, AKeyByItsOldNameIsToldTheNewOne) {
  EXPECT_EQ(error_of(R"({"warps": 4, "cores": 2})"), "'cores' is called 'lanes': rename the key");
}

TEST(Configuration, APresetsNameMayEndInWarpsAndLanes) {
  const Configuration best = load_configuration("best_4w2c"), thesis = load_configuration("4w2c");
  EXPECT_EQ(best.name, "best_4w2c");
  EXPECT_EQ(best.warps, 4u);
  EXPECT_EQ(best.lanes, 2u);
  EXPECT_TRUE(best.triples && best.kernel_overlap);
  EXPECT_EQ(best.chip.policy, PolicyName::Fill);
  EXPECT_FALSE(thesis.triples || thesis.kernel_overlap);
  EXPECT_TRUE(is_built_in(best));
  EXPECT_FALSE(is_built_in(load_configuration("best_4w2c", {"triples=false", "name=other"})));
  EXPECT_THROW(load_configuration("best_4w2c", {"triples=false", "name=best_4w2c"}), InputError);
  EXPECT_THROW(load_configuration("best_3w2c"), InputError);
  EXPECT_THROW(load_configuration("nonesuch_4w2c"), InputError);
}

TEST(TileWidth, IsHalfTheContentsRoundedUp) {
  const int expected[][2] = {{1, 0}, {2, 1}, {4, 1}, {8, 2}, {16, 2}, {32, 3}, {64, 3}, {128, 4}, {1024, 5}};
  for (const auto& pair : expected) EXPECT_EQ(tile_width_log2(pair[0]), pair[1]) << pair[0];
}

TEST(Generated, CheckedInFilesAreThoseOfTheTableOfParameters) {
  for (const GeneratedFile& generated : generated_parameter_files()) {
    std::ifstream file(generated.path);
    const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    EXPECT_EQ(text, generated.text) << generated.path << ": make isa";
  }
}

TEST(Parameters, HaveTheSameNameInFilesAndVerilog) {
  std::set<std::string> names;
  for (const Parameter& parameter : parameter::kAll) {
    std::string path = path_of(parameter);
    if (!parameter.of_part && !parameter.section.empty()) path = parameter.key;  // modes of the arithmetic
    std::replace(path.begin(), path.end(), '.', '_');
    EXPECT_EQ(parameter.name, path);
    EXPECT_EQ(verilog_name(parameter), upper(path));
    EXPECT_TRUE(names.insert(verilog_name(parameter)).second) << path << " stands twice";
  }
}

TEST(Parameters, TheChipsHaveTheSameNameInFilesAndCpp) {
  std::set<std::string> names;
  for (const Parameter& parameter : parameter::kOfChip) {
    std::string path = path_of(parameter);
    ASSERT_EQ(path.rfind("chip.", 0), 0u) << path;
    path = path.substr(5);
    std::replace(path.begin(), path.end(), '.', '_');
    EXPECT_EQ(parameter.name, path);
    EXPECT_TRUE(names.insert(path).second) << path << " stands twice";
    EXPECT_TRUE(parameter.range.has(parameter.get(Configuration()))) << path;
  }
}

TEST(Parameters, DefaultsAndTriedValuesAreInTheirRanges) {
  for (const Parameter& parameter : parameter::kAll) {
    EXPECT_TRUE(parameter.range.has(parameter.get(Configuration()))) << parameter.name;
    for (size_t i = 0; i < parameter.tried.count; ++i) {
      const int value = parameter.tried.values.at(i);
      EXPECT_TRUE(parameter.range.has(value)) << parameter.name << ' ' << value;
      Configuration configuration;
      parameter.set(configuration, value);
      EXPECT_EQ(parameter.get(configuration), value) << parameter.name;
    }
  }
}

TEST(Configuration, SchemaForEditorsMayBeNamed) {
  const TemporaryFile file(R"({"$schema": "../schemas/configuration.json", "warps": 4})");
  EXPECT_EQ(load_configuration(file.path()).warps, 4);
  EXPECT_EQ(error_of(R"({"$schema": 3})"), "$schema is 3; it must be a text in quotes");
}

TEST(Configuration, BrokenJsonIsReportedWithItsLine) {
  const std::string error = error_of("{\n  \"warps\": 8,,\n}");
  EXPECT_EQ(error.find("not valid JSON: parse error at line 2, column 14"), 0u) << error;
}

TEST(Configuration, ANameWithoutFileIsRefusedWithWhatToGive) {
  try {
    load_configuration("nonesuch");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(
        error.what(),
        "no configuration 'nonesuch'; give the path of a JSON file, the name of a file in configs/, NwMc for N "
        "warps of M lanes, or best_NwMc");
  }
  try {
    load_configuration("tniy");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).find("no configuration 'tniy': did you mean tiny? (give the path of a JSON "),
              0u);
  }
  EXPECT_THROW(load_configuration(""), InputError);
  EXPECT_THROW(load_configuration("no/such/file.json"), InputError);
  EXPECT_THROW(load_configuration("3w3c"), InputError);
}

TEST(Configuration, FolderOfTheEnvironmentComesFirst) {
  const TemporaryFile file(R"({"name": "mine", "warps": 1, "lanes": 1})", "8w8c.json");
  ::setenv("RAYPOOL_CONFIGS", file.folder().c_str(), 1);
  const Configuration configuration = load_configuration("8w8c");
  ::unsetenv("RAYPOOL_CONFIGS");
  EXPECT_EQ(configuration.warps, 1);
  EXPECT_EQ(load_configuration("8w8c").warps, 8);
}

TEST(Configuration, OtherHardwareMayNotGoByANameThatHasAMeaning) {
  // The name of a file in configs/, as key or from the file's name, and NwMc.
  for (const auto& [text, file_name] : std::vector<std::pair<std::string, std::string>>{
           {R"({"name": "4w4c_fma", "warps": 4})", "mine.json"},
           {R"({"warps": 2})", "8w8c.json"},
           {R"({"name": "2w2c", "warps": 2, "lanes": 2, "stack_depth": 4})", "mine.json"}}) {
    const TemporaryFile file(text, file_name);
    try {
      load_configuration(file.path());
      FAIL() << text;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("stands for other hardware"), std::string::npos) << error.what();
    }
  }
  // The same hardware may.
  const TemporaryFile same(to_json(load_configuration("4w4c_fma")), "copy.json");
  EXPECT_EQ(load_configuration(same.path()).name, "4w4c_fma");
  EXPECT_TRUE(is_built_in(load_configuration(same.path())));
  EXPECT_TRUE(is_built_in(load_configuration("2w2c")));
  EXPECT_FALSE(is_built_in(load_configuration("tb/mutants/2w2c.json")));
}

TEST(Configuration, AFileNameThatIsNoNameBecomesOne) {
  const TemporaryFile file(R"({"warps": 2})", "caf\xe9 1.json");
  EXPECT_EQ(load_configuration(file.path()).name, "caf__1");
}

TEST(Configuration, AKeyThatStandsTwiceIsRefused) {
  EXPECT_EQ(error_of(R"({"warps": 2, "warps": 4})"), "the key \"warps\" stands twice in one object: keep one of them");
  EXPECT_EQ(error_of(R"({"alus": {"int": {"count": 1}, "flt": {"count": 1, "count": 2}}})"),
            "the key \"count\" stands twice in one object: keep one of them");
}

/// Appends each `parameter integer NAME = VALUE` of a module's parameter list, also of what it includes.
void read_parameters(const std::string& path, std::vector<std::pair<std::string, int>>& declared) {
  std::ifstream file(path);
  ASSERT_TRUE(file.good()) << path << ": run the tests from the repository's root";
  for (std::string line; std::getline(file, line) && line.find(") (") == std::string::npos;) {
    char name[64];
    int value = 0;
    if (std::sscanf(line.c_str(), " parameter integer %63[A-Z_] = %d", name, &value) == 2)
      declared.emplace_back(name, value);
    if (std::sscanf(line.c_str(), " `include \"%63[a-z_.]\"", name) == 1)
      read_parameters(std::string("rtl/include/") + name, declared);
  }
}

TEST(Configuration, VerilogParametersAreThoseOfTheComputeUnitInOrder) {
  // The port list is the contract: parameters with the default configuration's values, but for derived ones, and for
  // the number that a unit has among several.
  std::vector<std::pair<std::string, int>> declared;
  read_parameters("rtl/compute/rp_compute_unit.v", declared);
  ASSERT_EQ(declared.back(), std::pair(std::string("UNIT"), 0));
  declared.pop_back();
  const auto parameters = verilog_parameters(Configuration{});
  EXPECT_EQ(parameters, declared);
}

}  // namespace
}  // namespace raypool
