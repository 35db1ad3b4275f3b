// Frames that a shader set draws, from options to files. The set here has no shaders: it wraps kernels that are
// recorded from C++, the built-in ones where their picture is known.
#include "cli/shaders.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "kernel/compiler.hpp"
#include "kernel/kernel.hpp"
#include "kernel/ray_kernels.hpp"
#include "kernel/ray_program.hpp"

namespace raypool {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

class RecordedSet : public shader::ShaderSet {
 public:
  using Record = std::function<RayFunctions(const shader::Resources&, const KernelTarget&)>;
  RecordedSet(std::string folder, Record record) : folder_(std::move(folder)), record_(std::move(record)) {}
  const std::string& folder() const override { return folder_; }
  const std::vector<shader::Binding>& bindings() const override { return bindings_; }
  const std::vector<shader::Member>& push_constants() const override { return constants_; }
  const std::vector<shader::ShaderRecord>& shader_records() const override { return records_; }
  bool waits() const override { return false; }
  uint32_t path_words(const std::map<uint32_t, uint32_t>&, uint32_t) const override { return 0; }
  RayFunctions record(const shader::Resources& resources, const KernelTarget& target,
                      const RecordLayout& /*layout*/) const override {
    return record_(resources, target);
  }

 private:
  std::string folder_;
  Record record_;
  std::vector<shader::Binding> bindings_;
  std::vector<shader::Member> constants_;
  std::vector<shader::ShaderRecord> records_;
};

RayFunctions built_in(const shader::Resources& /*resources*/, const KernelTarget& target) {
  return built_in_ray_program(target).functions;
}

/// Memory behind 1 MiB for one buffer, and nothing else.
shader::Resources one_buffer(MemoryImage& image, const Scene& /*scene*/, const shader::ShaderSet& /*set*/,
                             const ShaderFrame& frame) {
  shader::Resources resources;
  resources.width = frame.width;
  resources.height = frame.height;
  constexpr uint32_t kAddress = 1u << 20;
  image.memory.grow(kAddress + 64);
  image.memory.store(kAddress, frame.samples);
  resources.buffers[{0, 3}] = {kAddress, 64};
  return resources;
}

/// Of each sample every pixel gets, from the ray generation, red of its number, and green of how many there are, which
/// the memory says.
RayFunctions samples_shown(const shader::Resources& resources, const KernelTarget& target) {
  RayFunctions functions = built_in_ray_program(target).functions;
  const uint32_t address = resources.buffers.at({0, 3}).address;
  functions[RayKernel::CastEye] = kernel::record_kernel(
      "cast_eye",
      [&](kernel::RecordedKernel& k) {
        using Int = kernel::RecordedKernel::Int;
        using Float = kernel::RecordedKernel::Float;
        const Int tile = k.thread();
        const Int x = (k.block() & 0xffff) + (tile & k.int_argument(argument::kTileMask));
        const Int y = shift_right_logical(k.block(), Int(16)) + (tile >> k.int_argument(argument::kTileWidthLog2));
        const Float sample = to_float(k.int_argument(argument::kSample));
        const Float samples = to_float(k.load_int(Int(address)));
        k.set_word(word::kPixel, x | y << 16);
        k.set_word(word::kColor, (sample + 1.0f) * 0.0625f);
        k.set_word(word::kColor + 1, samples * 0.125f);
        k.set_word(word::kColor + 2, Float(0.0f));
        k.if_(x < k.int_argument(argument::kWidth) && y < k.int_argument(argument::kHeight), [&] { k.frame_out(); });
      },
      target);
  return functions;
}

std::string text_of(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

class ShadersTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / "raypool_shaders_test" /
              testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "set");
    std::ofstream(folder_ / "set" / "a.rgen") << "void main() {}\n";
  }
  void TearDown() override { fs::remove_all(folder_); }

  SimOptions options(const std::string& engine) const {
    SimOptions options;
    options.scene = "cornell";
    options.config = "4w4c";
    options.size = "24x16";
    options.engine = engine;
    options.out = (folder_ / "out").string();
    options.quiet = true;
    options.threads = 0;
    return options;
  }
  /// The same, drawn by a set of these kernels.
  SimOptions with(const RecordedSet::Record& record, const std::string& engine) const {
    SimOptions chosen = options(engine);
    chosen.shaders = (folder_ / "set").string();
    chosen.shader_source = {
        [record](const std::string& folder) { return std::make_shared<RecordedSet>(folder, record); }, one_buffer};
    return chosen;
  }
  std::string picture() const { return text_of(folder_ / "out" / "image.png"); }
  Json report() const { return Json::parse(text_of(folder_ / "out" / "report.json")); }
  static std::string refusal(const SimOptions& chosen) {
    try {
      sim_command(chosen);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }

  fs::path folder_;
};

TEST_F(ShadersTest, BuiltInKernelsInASetDrawTheBuiltInPicture) {
  for (const int depth : {1, 3}) {
    SimOptions plain = options("native");
    plain.depth = depth;
    sim_command(plain);
    const std::string expected = picture();
    for (const char* engine : {"native", "functional", "model"}) {
      SimOptions chosen = with(built_in, engine);
      chosen.depth = depth;
      sim_command(chosen);
      EXPECT_TRUE(picture() == expected) << engine << ", depth " << depth;
    }
  }
}

TEST_F(ShadersTest, BuiltInKernelsInASetDrawTheBuiltInPictureOnEveryKindOfMachine) {
  const std::vector<std::vector<std::string>> machines = {
      {"intersection_words=16"},
      {"arithmetic.fma=true", "triples=true"},
      {"arithmetic.subnormals=flush", "arithmetic.significand=17"},
      {"arithmetic.slow_unit=newton1"},
  };
  for (const auto& machine : machines) {
    SimOptions plain = options("native");
    plain.set = machine;
    sim_command(plain);
    const std::string expected = picture();
    for (const char* engine : {"native", "model"}) {
      SimOptions chosen = with(built_in, engine);
      chosen.set = machine;
      sim_command(chosen);
      EXPECT_TRUE(picture() == expected) << engine << ", " << machine.front();
    }
  }
}

TEST_F(ShadersTest, TheModelTakesTheCyclesOfTheBuiltInKernels) {
  sim_command(options("model"));
  const Json plain = report();
  sim_command(with(built_in, "model"));
  const Json set = report();
  EXPECT_EQ(set["instructions"], plain["instructions"]);
  EXPECT_EQ(set["rays"], plain["rays"]);
  EXPECT_EQ(set["kernels"]["cast_eye"]["threads"], plain["kernels"]["cast_eye"]["threads"]);
}

TEST_F(ShadersTest, TheReportNamesTheSetAndItsInstructions) {
  sim_command(options("native"));
  EXPECT_FALSE(report().contains("shaders"));
  sim_command(with(built_in, "native"));
  const Json shaders = report().at("shaders");
  EXPECT_EQ(shaders.at("folder"), (folder_ / "set").string());
  EXPECT_EQ(shaders.at("samples"), 1);
  EXPECT_EQ(shaders.at("instructions").at("shade"), 3);
  EXPECT_EQ(shaders.at("instructions").at("cast_eye"), 55);
}

TEST_F(ShadersTest, RaysOfASetHaveNoWeights) {
  sim_command(with(built_in, "native"));
  const Json counts = report();
  for (const char* kind : {"eye", "reflection", "shadow"}) {
    EXPECT_EQ(counts["rays_without_weight"][kind], 0);
    EXPECT_EQ(counts["rays_left_out"][kind], 0);
  }
  EXPECT_EQ(counts["rays_wasted"]["shadow"], counts["rays_that_end"]["blocked"]);
}

TEST_F(ShadersTest, ADepthAboveOneTracesRaysWhateverMaterialsReflect) {
  SimOptions chosen = with(built_in, "native");
  chosen.scene = "room";
  chosen.detail = 0.05;
  chosen.depth = 2;
  sim_command(chosen);
  EXPECT_EQ(report()["reflections"], true);
  chosen.depth = 1;
  sim_command(chosen);
  EXPECT_EQ(report()["reflections"], false);
}

TEST_F(ShadersTest, SamplesAddUpAndKnowTheirNumbers) {
  std::map<std::string, std::string> pictures;
  for (const char* engine : {"native", "functional", "model"}) {
    SimOptions chosen = with(samples_shown, engine);
    chosen.samples = 3;
    sim_command(chosen);
    pictures[engine] = picture();
    EXPECT_EQ(report()["contributions"], 3 * 24 * 16);
    EXPECT_EQ(report()["shaders"]["samples"], 3);
    EXPECT_EQ(report()["kernels"]["cast_eye"]["threads"], 3 * 24 * 16);
  }
  FrameBuffer expected(24, 16);
  for (uint32_t pixel = 0; pixel < 24 * 16; ++pixel)
    expected.add({pixel % 24 | pixel / 24 << 16, {as_bits(6 * 0.0625f), as_bits(3 * 3 * 0.125f), as_bits(0.0f)}});
  const std::vector<uint8_t> png = encode_png(expected);
  for (const auto& [engine, drawn] : pictures) EXPECT_TRUE(drawn == std::string(png.begin(), png.end())) << engine;
}

TEST_F(ShadersTest, CyclesOfSamplesAreThoseOfTheirFrames) {
  SimOptions chosen = with(samples_shown, "model");
  sim_command(chosen);
  const auto cycles = report()["cycles"].get<uint64_t>();
  chosen.samples = 4;
  sim_command(chosen);
  EXPECT_EQ(report()["cycles"].get<uint64_t>(), 4 * cycles) << "each begins on a chip that is cold";
}

TEST_F(ShadersTest, TheFolderOfTheResultsChangesWithTheFilesOfTheSet) {
  const std::string set = (folder_ / "set").string();
  const std::string before = name_of_shaders(set);
  EXPECT_EQ(before.substr(0, 4), "set-");
  EXPECT_EQ(name_of_shaders(set + "/"), before);
  std::ofstream(folder_ / "set" / "a.rgen", std::ios::app) << "// more\n";
  const std::string changed = name_of_shaders(set);
  EXPECT_NE(changed, before);
  fs::rename(folder_ / "set" / "a.rgen", folder_ / "set" / "b.rgen");
  EXPECT_NE(name_of_shaders(set), changed);
  EXPECT_THROW(name_of_shaders((folder_ / "none").string()), InputError);
}

TEST_F(ShadersTest, WhatDoesNotGoWithShadersIsRefused) {
  const auto refused = [&](const std::string& engine, const std::function<void(SimOptions&)>& change) {
    SimOptions chosen = with(built_in, engine);
    static const EstimatingEngines kEngines = {};
    chosen.estimating = &kEngines;
    change(chosen);
    return refusal(chosen);
  };
  const auto set = [](const char* setting) { return [=](SimOptions& chosen) { chosen.set = {setting}; }; };
  EXPECT_EQ(refused("estimate", [](SimOptions&) {}),
            "engine estimate knows the built-in kernels alone: draw shaders with native, functional, sampled, model, "
            "rtl or lockstep");
  EXPECT_EQ(refused("sampled", [](SimOptions& chosen) { chosen.samples = 2; }),
            "engine sampled draws one frame, and samples of a pixel are frames that take about as long: leave "
            "--samples out");
  EXPECT_EQ(refused("native", [](SimOptions& chosen) { chosen.precision = "double"; }),
            "--precision double draws with the built-in kernels alone: leave it or --shaders out");
  EXPECT_EQ(refused("native", [](SimOptions& chosen) { chosen.unstable = 2; }),
            "--unstable moves what the built-in kernels know of the camera: leave it or --shaders out");
  EXPECT_EQ(refused("model",
                    [](SimOptions& chosen) {
                      chosen.samples = 2;
                      chosen.trace = ":";
                    }),
            "a waveform or trace is of one frame: leave --samples out, or --waves and --trace");
  EXPECT_EQ(refused("model", set("chip.culling=true")),
            "chip.culling drops rays whose first payload words are zero, which are no weights in shaders: draw with "
            "--set chip.culling=false");
  EXPECT_EQ(refused("model", set("chip.shading=traverser")),
            "chip.shading is traverser, which adds to the picture without a miss shader: draw with --set "
            "chip.shading=kernel");
  EXPECT_EQ(refused("model", set("chip.reflections=false")),
            "depth 3 traces rays from closest-hit shaders, but 4w4c+chip.reflections-false has no kernel for them "
            "(chip.reflections): draw "
            "with --depth 1 or --set chip.reflections=true");
  EXPECT_EQ(refused("native", [](SimOptions& chosen) { chosen.shader_source = {}; }),
            "this program draws with the built-in kernels alone: leave --shaders out");
}

TEST_F(ShadersTest, SamplesOfTheBuiltInKernelsAreRefused) {
  SimOptions chosen = options("native");
  chosen.samples = 2;
  EXPECT_EQ(refusal(chosen),
            "--samples is for shader sets: the built-in kernels draw every sample alike; leave it out, or give "
            "--shaders too");
}

TEST_F(ShadersTest, EmbreesHitsDrawTheSetToo) {
  SimOptions chosen = with(built_in, "native");
  chosen.hits = "embree";
  sim_command(chosen);
  EXPECT_EQ(report()["hits"], "embree");
  EXPECT_GT(report()["contributions"].get<uint64_t>(), 0u);
}

TEST_F(ShadersTest, ABlackPictureIsNotBlamedOnTheLight) {
  SimOptions chosen = with(
      [](const shader::Resources&, const KernelTarget& target) {
        RayFunctions functions = built_in_ray_program(target).functions;
        functions[RayKernel::Shade] = kernel::record_kernel(
            "shade", [](kernel::RecordedKernel& k) { k.ray_in(); }, target);
        return functions;
      },
      "native");
  testing::internal::CaptureStderr();
  sim_command(chosen);
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "raypool: warning: the picture is all black: its shaders add nothing to it that is light enough to show; "
            "look at what they store\n");
}

}  // namespace
}  // namespace raypool
