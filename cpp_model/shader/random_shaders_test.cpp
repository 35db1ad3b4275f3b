// Random shader sets are GLSL, the same for a seed, and have what they are made to test.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>

#include "bits.hpp"
#include "shader/test_random_shaders.hpp"

namespace raypool::shader {
namespace {

constexpr uint32_t kSeeds = 50;

size_t occurrences(const std::string& text, const std::string& part) {
  size_t count = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

std::string every_text(uint32_t seed) {
  const RandomShaders shaders = random_shaders(seed);
  return shaders.ray_generation + shaders.closest_hit + shaders.miss;
}

class RandomShadersTest : public testing::Test {
 protected:
  RandomShadersTest() { std::filesystem::create_directories(folder_); }
  ~RandomShadersTest() override { std::filesystem::remove_all(folder_); }

  // What glslangValidator prints for a faulty set; nothing for a right one.
  std::string errors(const RandomShaders& shaders) const {
    std::ofstream(folder_ / "a.rgen") << shaders.ray_generation;
    std::ofstream(folder_ / "a.rchit") << shaders.closest_hit;
    std::ofstream(folder_ / "a.rmiss") << shaders.miss;
    const std::string command =
        "cd '" + folder_.string() + "' && glslangValidator -V --target-env vulkan1.2 a.rgen a.rchit a.rmiss > log 2>&1";
    if (std::system(command.c_str()) == 0) return {};
    std::ifstream log(folder_ / "log");
    return {std::istreambuf_iterator<char>(log), {}};
  }

 private:
  const std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) / testing::UnitTest::GetInstance()->current_test_info()->name();
};

TEST_F(RandomShadersTest, FiftySeedsPassTheValidator) {
  for (std::string RandomShaders::*const stage :
       {&RandomShaders::ray_generation, &RandomShaders::closest_hit, &RandomShaders::miss}) {
    RandomShaders mistaken = random_shaders(0);
    (mistaken.*stage) += "?";
    ASSERT_NE(errors(mistaken), "");
  }
  for (uint32_t seed = 0; seed < kSeeds; ++seed) ASSERT_EQ(errors(random_shaders(seed)), "") << "seed " << seed;
}

TEST(RandomShaders, SameSeedGivesSameShadersAndOthersDiffer) {
  std::set<std::string> texts;
  for (uint32_t seed = 0; seed < kSeeds; ++seed) {
    const RandomShaders once = random_shaders(seed), again = random_shaders(seed);
    EXPECT_EQ(once.ray_generation, again.ray_generation);
    EXPECT_EQ(once.closest_hit, again.closest_hit);
    EXPECT_EQ(once.miss, again.miss);
    EXPECT_EQ(once.block, again.block);
    EXPECT_EQ(once.buffer, again.buffer);
    texts.insert(once.ray_generation + once.closest_hit + once.miss);
  }
  EXPECT_EQ(texts.size(), kSeeds);
}

TEST(RandomShaders, TraceNoMoreRaysThanAKernelExports) {
  size_t both = 0, none = 0;
  for (uint32_t seed = 0; seed < kSeeds; ++seed) {
    SCOPED_TRACE(seed);
    const RandomShaders shaders = random_shaders(seed);
    EXPECT_EQ(occurrences(shaders.ray_generation, "traceRayEXT(tree, gl_RayFlagsOpaqueEXT,"), 1u);
    EXPECT_EQ(occurrences(shaders.ray_generation, "traceRayEXT("), 1u);
    EXPECT_EQ(occurrences(shaders.miss, "traceRayEXT("), 0u);
    EXPECT_EQ(occurrences(shaders.miss, "imageStore(picture, ivec2(gl_LaunchIDEXT.xy), "), 1u);
    const size_t normal = occurrences(shaders.closest_hit, "traceRayEXT(tree, gl_RayFlagsOpaqueEXT,");
    const size_t shadow = occurrences(shaders.closest_hit, "traceRayEXT(tree, kShadow,");
    EXPECT_LE(normal, 1u);
    EXPECT_LE(shadow, 1u);
    EXPECT_EQ(occurrences(shaders.closest_hit, "traceRayEXT("), normal + shadow);
    both += normal + shadow == 2;
    none += normal + shadow == 0;
  }
  EXPECT_GT(both, kSeeds / 4);
  EXPECT_GT(none, 0u);
}

TEST(RandomShaders, DoNotReadThePayloadAfterItsRay) {
  size_t followed = 0;  // shaders in which a shadow ray comes after the normal one
  for (uint32_t seed = 0; seed < kSeeds; ++seed) {
    const std::string text = random_shaders(seed).closest_hit;
    const size_t ray = text.find("traceRayEXT(tree, gl_RayFlagsOpaqueEXT,");
    if (ray == std::string::npos) continue;
    EXPECT_EQ(text.find("payload.", ray), std::string::npos) << "seed " << seed << "\n" << text;
    followed += text.find("traceRayEXT(tree, kShadow,", ray) != std::string::npos;
  }
  EXPECT_GT(followed, 5u);
}

TEST(RandomShaders, UseTheWholeLanguage) {
  std::string text;
  for (uint32_t seed = 0; seed < kSeeds; ++seed) text += every_text(seed);
  for (const char* part : {"if (",           "} else {",        "} else if (",
                           "switch (",       "default: {",      "while (",
                           "do {",           "} while (",       "for (",
                           "break;",         "continue;",       "return;",
                           "inout vec3",     "out float",       "Thing(",
                           ".color",         "int[2][2]",       "float[](",
                           "vec2(",          "vec4(",           "ivec3(",
                           "mat2(",          "mat3(",           "mat3x2(",
                           "kRamp[",         "table.codes[",    "table.tints[",
                           "numbers.turned", "carried = ",      " ? ",
                           "sin(",           "atan(",           "pow(",
                           "inversesqrt(",   "smoothstep(",     "determinant(",
                           "inverse(mat3(",  "refract(",        "faceforward(",
                           "modf(",          "frexp(",          "ldexp(",
                           "uaddCarry(",     "bitCount(",       "bitfieldExtract(",
                           "findMSB(",       "unpackHalf2x16(", "packUnorm4x8(",
                           "mix(",           "lessThan(",       "roundEven(",
                           "isnan(",         "outerProduct(",   "matrixCompMult(",
                           ">>= ",           "uintBitsToFloat", "uint16_t(",
                           "hit.depth",      "attributes",      "gl_PrimitiveID"})
    EXPECT_NE(text.find(part), std::string::npos) << part;
}

TEST(RandomShaders, GrowWithTheSeedModuloFour) {
  std::array<size_t, 4> bytes{};
  for (uint32_t seed = 0; seed < 4 * kSeeds; ++seed) bytes[seed % 4] += every_text(seed).size();
  for (size_t size = 1; size < bytes.size(); ++size) EXPECT_GT(bytes[size], bytes[size - 1]) << size;
}

TEST(RandomShaders, BlockAndBufferHoldFiniteFloatsAndLeaveRoomForACamera) {
  for (uint32_t seed = 0; seed < kSeeds; ++seed) {
    const RandomShaders shaders = random_shaders(seed);
    ASSERT_EQ(shaders.block.size(), 49u);
    ASSERT_EQ(shaders.buffer.size(), 112u);
    for (uint32_t word = 0; word < kRandomCameraWords; ++word) EXPECT_EQ(shaders.block[word], 0u);
    for (const uint32_t word : {16u, 23u, 28u, 47u}) EXPECT_LE(std::fabs(as_float(shaders.block[word])), 4.0f) << word;
    for (const uint32_t word : {0u, 63u, 80u, 111u}) EXPECT_LE(std::fabs(as_float(shaders.buffer[word])), 4.0f) << word;
  }
}

}  // namespace
}  // namespace raypool::shader
