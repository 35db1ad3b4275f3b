// Pictures of shader sets are the same whatever draws them: engines, machines, traversers and numbers of units. They
// are small, as scripts/tests/shaders_in_lockstep.sh has the Verilog beside the model.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>

#include "bits.hpp"
#include "cli/commands.hpp"
#include "config/data_folder.hpp"
#include "isa/input_error.hpp"
#include "shader/test_random_shaders.hpp"

namespace raypool {
namespace {

namespace fs = std::filesystem;

/// A set is compiled from GLSL once, however often it draws.
std::shared_ptr<const shader::ShaderSet> loaded_once(const std::string& folder) {
  static std::map<std::string, std::shared_ptr<const shader::ShaderSet>> sets;
  std::shared_ptr<const shader::ShaderSet>& set = sets[folder];
  if (!set) set = load_shaders(folder);
  return set;
}

constexpr size_t kOfOneColour = 150;  // PNG squeezes such a picture to a few dozen bytes

class ShaderEngines : public testing::Test {
 protected:
  ShaderEngines() : folder_(fs::path(testing::TempDir()) / fmt::format("raypool-shader-engines-{}", ::getpid())) {
    fs::create_directories(folder_);
    fs::current_path(data_folder());
  }
  ~ShaderEngines() override {
    fs::current_path(before_);
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }

  SimOptions options(const std::string& set, const std::string& scene, std::vector<std::string> machine = {}) const {
    SimOptions options;
    options.scene = scene;
    options.detail = scene == "room" ? 0.05 : 1;
    options.config = "4w4c";
    options.set = std::move(machine);
    if (options.set.empty()) options.set = {"chip.traverser=static"};
    options.size = "16x12";
    options.depth = 2;
    options.shaders = set;
    options.shader_source.load = loaded_once;
    options.out = (folder_ / "out").string();
    options.quiet = true;
    options.threads = 0;
    return options;
  }

  /// The folder of a set whose ray generation shader does nothing but store this colour.
  std::string set_storing(const std::string& colour) const {
    const fs::path set = folder_ / fmt::format("stores-{}", std::hash<std::string>()(colour));
    fs::create_directories(set);
    const char* begin = "#version 460\n#extension GL_GOOGLE_include_directive : require\n#include \"raypool.glsl\"\n";
    std::ofstream(set / "a.rgen") << begin << "void main() { imageStore(raypool_picture, ivec2(gl_LaunchIDEXT.xy), "
                                  << colour << "); }\n";
    std::ofstream(set / "a.rchit") << begin << "void main() {}\n";
    return set.string();
  }

  /// The picture's bytes; nothing where it is refused, which fails.
  std::string drawn(SimOptions options, const std::string& engine) const {
    options.engine = engine;
    try {
      sim_command(options);
    } catch (const InputError& error) {
      ADD_FAILURE() << engine << ": " << error.what();
      return {};
    }
    std::ostringstream bytes;
    bytes << std::ifstream(folder_ / "out" / "image.png", std::ios::binary).rdbuf();
    return bytes.str();
  }
  nlohmann::json report() const { return nlohmann::json::parse(std::ifstream(folder_ / "out" / "report.json")); }

  /// Draws with all these engines; their pictures are equal. Returns how many bytes they have.
  size_t equal_pictures(const SimOptions& options,
                        const std::vector<std::string>& engines = {"native", "model"}) const {
    SCOPED_TRACE(fmt::format("{} of {}, {} {}, {} units", options.shaders, options.scene, options.config,
                             fmt::join(options.set, " "), options.units));
    const std::string first = drawn(options, engines.front());
    if (first.empty()) return 0;
    const nlohmann::json counts = report();
    for (size_t i = 1; i < engines.size(); ++i) {
      EXPECT_TRUE(drawn(options, engines[i]) == first) << engines[i] << " draws another picture than " << engines[0];
      for (const char* count : {"contributions", "rays_by_kind"}) EXPECT_EQ(report()[count], counts[count]) << count;
    }
    return first.size();
  }

  /// The same, and what they show is more than one colour.
  void agree(const SimOptions& options, const std::vector<std::string>& engines = {"native", "model"}) const {
    EXPECT_GT(equal_pictures(options, engines), kOfOneColour) << options.shaders;
  }

  std::string refusal(SimOptions options) const {
    options.engine = "native";
    try {
      sim_command(options);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }

  const fs::path folder_;

 private:
  const fs::path before_ = fs::current_path();
};

constexpr const char* kTextured = "examples/scenes/features.gltf";
const std::vector<std::string> kSets = {"whitted", "ao", "preview", "path", "debug"};

TEST_F(ShaderEngines, DrawTheSamePicture) {
  for (const std::string& set : kSets) agree(options(set, kTextured), {"native", "functional", "model"});
}

TEST_F(ShaderEngines, DrawTheSamePictureWithEachTraverserAndNumberOfUnits) {
  for (const char* traverser : {"static", "hardware"}) {
    for (const int units : {1, 2, 4}) {
      SimOptions several = options("whitted", "cornell", {fmt::format("chip.traverser={}", traverser)});
      several.units = units;
      agree(several);
    }
  }
  SimOptions textured = options("preview", kTextured, {"chip.traverser=hardware"});
  textured.units = 2;
  agree(textured);
}

TEST_F(ShaderEngines, DrawTheSamePictureOnEveryKindOfMachine) {
  const std::vector<std::vector<std::string>> machines = {
      {"arithmetic.fma=true", "triples=true"},
      {"triples=true", "warps=1"},
      {"arithmetic.subnormals=flush", "arithmetic.significand=17"},
      {"arithmetic.slow_unit=newton1", "lanes=1"},
      {"kernel_overlap=true", "wide_ray_memory=true", "lanes=8", "slow_lanes=2"},
  };
  for (std::vector<std::string> machine : machines) {
    machine.emplace_back("chip.traverser=static");
    for (const char* set : {"ao", "preview"}) agree(options(set, kTextured, machine));
  }
}

TEST_F(ShaderEngines, DrawTheSamePictureWithRecordsOfTheWordsThatASetNeeds) {
  const auto machine = [](const std::string& words) {
    return std::vector<std::string>{"intersection_words=" + words, "chip.traverser=static"};
  };
  std::set<std::string> needed;
  for (const std::string& set : kSets) {
    const std::string refused = refusal(options(set, kTextured, machine("12")));
    std::smatch found;
    const bool lacks = std::regex_search(refused, found, std::regex("kernels need ([0-9]+) words of an intersection"));
    EXPECT_TRUE(lacks || refused == "no error") << refused;
    const std::string words = lacks ? found[1].str() : "12";
    needed.insert(words);
    agree(options(set, kTextured, machine(words)));
  }
  EXPECT_GT(needed.size(), 2u);
}

/// Those whose shaders wait for their rays.
const std::vector<std::string> kWaiting = {"triangle", "reflections", "shadow_inside", "bounces",
                                           "groups",   "cutouts",     "table",         "nested"};

TEST_F(ShaderEngines, DrawTheSamePictureWhereShadersWaitForTheirRays) {
  const std::vector<std::vector<std::string>> machines = {
      {"chip.traverser=static"},
      {"chip.traverser=hardware", "triples=true", "arithmetic.fma=true"},
      {"chip.traverser=static", "kernel_overlap=true", "lanes=8", "warps=1", "data_cache.bytes=512"},
  };
  for (const std::string& set : kWaiting) {
    for (const std::vector<std::string>& machine : machines) {
      SimOptions waiting = options("cpp_model/shader/cases/" + set, "cornell", machine);
      waiting.depth = 1;  // of what the chip counts they have their own
      EXPECT_GT(equal_pictures(waiting, {"native", "functional", "model"}), set == "table" ? 0 : kOfOneColour);
    }
    const std::string needs = refusal(options("cpp_model/shader/cases/" + set, "cornell", {"chip.miss_records=false"}));
    EXPECT_NE(needs.find("chip.miss_records=true"), std::string::npos) << needs;
  }
}

TEST_F(ShaderEngines, ClosestHitShadersThatWaitForEachOtherDrawWhatALoopDraws) {
  const auto picture = [&](const std::string& set, int depth) {
    SimOptions mirrors = options("cpp_model/shader/cases/" + set, kTextured);
    mirrors.depth = depth;
    return drawn(mirrors, "native");
  };
  const std::string loop = picture("reflections", 1);
  EXPECT_TRUE(picture("nested", 4) == loop);
  EXPECT_FALSE(picture("nested", 1) == loop) << "deeper rays are not traced";
}

/// The sets look at that themselves, and store green where it is so.
TEST_F(ShaderEngines, AnyHitShadersCulledSidesAndTheTableOfShadersDoWhatTheyShould) {
  const std::string expected = drawn(options(set_storing("vec4(0, 1, 0, 1)"), "cornell"), "native");
  ASSERT_FALSE(expected.empty());
  for (const char* set : {"layers", "table", "by_material", "accumulated"}) {
    const SimOptions checked = options(fmt::format("cpp_model/shader/cases/{}", set), "cornell");
    for (const char* engine : {"native", "model"}) EXPECT_TRUE(drawn(checked, engine) == expected) << set << engine;
  }
}

TEST_F(ShaderEngines, DrawTheSamePictureWherePathsGoOnInAnotherUnit) {
  for (const std::string& set : kWaiting) {
    for (const int units : {2, 4}) {
      SimOptions several = options("cpp_model/shader/cases/" + set, "cornell",
                                   {fmt::format("chip.traverser={}", units == 2 ? "static" : "hardware")});
      several.units = units;
      several.depth = 1;
      EXPECT_GT(equal_pictures(several, {"native", "functional", "model"}), set == "table" ? 0 : kOfOneColour);
      EXPECT_EQ(report()["configuration"]["sharing"], true);
    }
  }
  SimOptions without = options("cpp_model/shader/cases/reflections", "cornell", {"sharing=false"});
  agree(without);
  without.units = 2;
  EXPECT_NE(refusal(without).find("draw with --set sharing=true, or --units 1"), std::string::npos) << refusal(without);
}

TEST_F(ShaderEngines, DrawTheSamePictureInPathsOfManySamples) {
  SimOptions deep = options("path", kTextured, {"triples=true", "arithmetic.fma=true", "chip.traverser=static"});
  deep.depth = 5;
  deep.samples = 3;
  agree(deep, {"native", "functional", "model"});
}

TEST_F(ShaderEngines, AClockCountsSamples) {
  SimOptions clock = options("cpp_model/shader/cases/clock", "cornell");
  clock.samples = 3;
  equal_pictures(clock, {"native", "functional", "model"});
  const std::string sum = set_storing("vec4(0.75, 0.75, 3 * (gl_LaunchIDEXT.x & 1), 1)");
  EXPECT_TRUE(drawn(clock, "native") == drawn(options(sum, "cornell"), "native"));
}

TEST_F(ShaderEngines, EachFrameBeginsWithTheBuffersOfTheSet) {
  const fs::path set = folder_ / "counts";
  fs::create_directories(set);
  std::ofstream(set / "a.rgen")
      << "#version 460\n#extension GL_EXT_ray_tracing : require\n"
         "layout(set = 0, binding = 1, rgba32f) uniform image2D picture;\n"
         "layout(set = 0, binding = 2) buffer Frames { uint count[192]; } frames;\n"
         "void main() {\n"
         "  const uint own = gl_LaunchIDEXT.y * 16u + gl_LaunchIDEXT.x;\n"
         "  const uint before = frames.count[own];\n"
         "  frames.count[own] = before + 10u;\n"
         "  imageStore(picture, ivec2(gl_LaunchIDEXT.xy), vec4(float(before + 1u) / 128.0));\n"
         "}\n";
  std::ofstream(set / "a.rchit") << "#version 460\n#extension GL_EXT_ray_tracing : require\nvoid main() {}\n";
  std::vector<int> zeros(192, 0);
  std::ofstream(set / "shaders.json") << fmt::format(
      R"({{"bindings": [{{"binding": 2, "holds": {{"integers": [{}]}}}}]}})", fmt::join(zeros, ", "));
  SimOptions counted = options(set.string(), "cornell");
  counted.samples = 3;
  EXPECT_GT(equal_pictures(counted, {"native", "functional", "model"}), 0);
}

TEST_F(ShaderEngines, MachinesWithoutAnInstructionAreRefusedByItsNameAndItsKernels) {
  const std::vector<std::array<std::string, 4>> missing = {{"path", "int", "imul", "cast_eye"},
                                                           {"ao", "int", "sel", "cast_secondary"},
                                                           {"path", "slw", "frsqrt", "cast_eye"}};
  for (const auto& [set, alu, instruction, kernel] : missing) {
    const std::string without = fmt::format("alus.{}.without={}", alu, instruction);
    const std::regex expected(
        fmt::format("kernel {0} has {1} \\(instruction [0-9]+\\), which 4w4c\\+alus.{2}.without-{1} "
                    "is without: take it off alus.{2}.without of that configuration",
                    kernel, instruction, alu));
    const std::string refused = refusal(options(set, "cornell", {without}));
    EXPECT_TRUE(std::regex_match(refused, expected)) << refused;
  }
}

/// A random set in a folder, which looks at the scene with the camera of the frame.
class RandomShaderEngines : public ShaderEngines {
 protected:
  struct Drawn {
    int sets = 0, coloured = 0;
  };

  /// Draws it, if it can be drawn: a miss shader has no memory for values that find no register.
  void agree_on(uint32_t seed, Drawn& drawn) const {
    SCOPED_TRACE(fmt::format("seed {}", seed));
    const shader::RandomShaders shaders = shader::random_shaders(seed);
    const fs::path set = folder_ / fmt::format("set-{}", seed);
    fs::create_directories(set);
    std::ofstream(set / "a.rgen") << shaders.ray_generation;
    std::ofstream(set / "a.rchit") << shaders.closest_hit;
    std::ofstream(set / "a.rmiss") << shaders.miss;
    const std::vector<std::string> machine =
        seed % 2 == 0 ? std::vector<std::string>{"chip.traverser=static"}
                      : std::vector<std::string>{"chip.traverser=hardware", "triples=true", "arithmetic.fma=true"};
    SimOptions random = options(set.string(), "cornell", machine);
    random.depth = 3;
    random.units = seed % 3 == 0 ? 2 : 1;
    random.shader_source.memory = [&](MemoryImage& image, const Scene& /*scene*/, const shader::ShaderSet& /*set*/,
                                      const ShaderFrame& frame) { return memory_of(shaders, image, frame); };
    const std::string refused = refusal(random);
    if (refused.find("a.rmiss") != std::string::npos && refused.find("values at once here") != std::string::npos)
      return;
    ++drawn.sets;
    // Some look away from the scene, or store the same everywhere.
    drawn.coloured += equal_pictures(random) > kOfOneColour ? 1 : 0;
  }

 private:
  static shader::Resources memory_of(const shader::RandomShaders& shaders, MemoryImage& image,
                                     const ShaderFrame& frame) {
    shader::Resources resources;
    resources.width = frame.width;
    resources.height = frame.height;
    std::vector<shader::Word>& block = resources.blocks[{0, 2}];
    for (const uint32_t bits : shaders.block) block.push_back({bits, std::nullopt});
    constexpr uint32_t kCameraNumbers = 12;  // eye, corner, step_x, step_y
    for (uint32_t i = 0; i < kCameraNumbers; ++i)
      block.at(i / 3 * 4 + i % 3).bits = as_bits(static_cast<float>(frame.camera.at(i)));
    const uint32_t address = std::max(kShaderDataBegin, (image.memory.size() + 63) / 64 * 64);
    const uint32_t bytes = 4 * size32(shaders.buffer);
    resources.buffers[{0, 3}] = {address, bytes};
    resources.saved = (address + bytes + 63) / 64 * 64;
    image.memory.grow(resources.saved);
    for (uint32_t i = 0; i < shaders.buffer.size(); ++i) image.memory.store(address + 4 * i, shaders.buffer[i]);
    return resources;
  }
};

TEST_F(RandomShaderEngines, DrawTheSamePicture) {
  Drawn drawn;
  for (uint32_t seed = 0; drawn.sets < 10 && seed < 20; ++seed) agree_on(seed, drawn);
  EXPECT_EQ(drawn.sets, 10);
  EXPECT_GE(drawn.coloured, 4);
}

TEST_F(RandomShaderEngines, DrawTheSamePictureOfManySets) {
  Drawn drawn;
  for (uint32_t seed = 20; seed < 100; ++seed) agree_on(seed, drawn);
  EXPECT_GE(drawn.sets, 30);
  EXPECT_GE(drawn.coloured, 15);
}

}  // namespace
}  // namespace raypool
