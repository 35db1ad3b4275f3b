#include "scene/image.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace raypool {
namespace {

FrameContribution contribution(uint32_t x, uint32_t y, float r, float g, float b) {
  FrameContribution result;
  result.pixel = x | y << 16;
  const float rgb[3] = {r, g, b};
  std::memcpy(result.rgb.data(), rgb, sizeof rgb);
  return result;
}

std::vector<char> bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(FixedPoint, EveryFloatHasADefinedValue) {
  EXPECT_EQ(to_fixed(0.0f), 0u);
  EXPECT_EQ(to_fixed(-0.0f), 0u);
  EXPECT_EQ(to_fixed(-1.0f), 0u);
  EXPECT_EQ(to_fixed(-INFINITY), 0u);
  EXPECT_EQ(to_fixed(std::nanf("")), 0u);
  EXPECT_EQ(to_fixed(1.0f), uint64_t{1} << 32);
  EXPECT_EQ(to_fixed(0x1p-32f), 1u);
  EXPECT_EQ(to_fixed(0x1p-33f), 1u);  // half a unit, up
  EXPECT_EQ(to_fixed(std::nextafter(0x1p-33f, 0.0f)), 0u);
  EXPECT_EQ(to_fixed(0x1.8p-32f), 2u);
  EXPECT_EQ(to_fixed(0x1.fffffep31f), uint64_t{0xffffff} << 40);
  EXPECT_EQ(to_fixed(0x1p32f), UINT64_MAX);
  EXPECT_EQ(to_fixed(INFINITY), UINT64_MAX);
  EXPECT_EQ(to_fixed(1e-45f), 0u);
}

TEST(FrameBuffer, DoesNotDependOnTheOrderOfContributions) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> value(0, 0.3f);
  std::vector<FrameContribution> all;
  for (int i = 0; i < 5000; ++i) {
    all.push_back(contribution(random() % 16, random() % 8, value(random), value(random) * 1e-6f, value(random)));
  }
  // Two that saturate, and some that are worth nothing.
  for (int i = 0; i < 3; ++i) all.push_back(contribution(1, 1, 3e9f, 1e20f, std::nanf("")));
  FrameBuffer reference(16, 8);
  for (const auto& c : all) reference.add(c);
  const std::vector<uint8_t> png = encode_png(reference);
  for (int round = 0; round < 5; ++round) {
    std::shuffle(all.begin(), all.end(), random);
    FrameBuffer a(16, 8), b(16, 8);
    for (size_t i = 0; i < all.size(); ++i) (i % 3 == 0 ? a : b).add(all[i]);
    b.add(a);
    EXPECT_TRUE(b == reference);
    EXPECT_EQ(encode_png(b), png);
  }
  EXPECT_EQ(reference.raw(1, 1, 1), UINT64_MAX);
}

TEST(FrameBuffer, IgnoresPixelsOutside) {
  FrameBuffer frame(4, 3);
  EXPECT_TRUE(frame.add(contribution(3, 2, 1, 1, 1)));
  EXPECT_FALSE(frame.add(contribution(4, 0, 1, 1, 1)));
  EXPECT_FALSE(frame.add(contribution(0, 3, 1, 1, 1)));
  EXPECT_FALSE(frame.add(contribution(65535, 65535, 1, 1, 1)));
  EXPECT_THROW(FrameBuffer(0, 5), InputError);
  EXPECT_THROW(FrameBuffer(5, 70000), InputError);
}

TEST(Tone, IsSrgb) {
  EXPECT_EQ(to_srgb8(0), 0);
  EXPECT_EQ(to_srgb8(1), 255);
  EXPECT_EQ(to_srgb8(7), 255);
  EXPECT_EQ(to_srgb8(-1), 0);
  EXPECT_EQ(to_srgb8(std::nan("")), 0);
  EXPECT_EQ(to_srgb8(0.5), 188);
  EXPECT_EQ(to_srgb8(0.2140), 127);
  EXPECT_EQ(to_srgb8(0.002), 7);
}

TEST(Png, HoldsTheToneOfEveryPixelTopRowFirst) {
  FrameBuffer frame(5, 3);
  frame.add(contribution(0, 0, 1, 0, 0));
  frame.add(contribution(4, 2, 0, 0.5f, 1));
  const std::string path = ::testing::TempDir() + "raypool_image_test.png";
  write_png(frame, path);
  const std::vector<char> first = bytes_of(path);
  write_png(frame, path);
  EXPECT_EQ(bytes_of(path), first);
  int width = 0, height = 0, channels = 0;
  unsigned char* pixels = stbi_load(path.c_str(), &width, &height, &channels, 3);
  ASSERT_NE(pixels, nullptr);
  EXPECT_EQ(width, 5);
  EXPECT_EQ(height, 3);
  EXPECT_EQ(std::vector<uint8_t>(pixels, pixels + 45), to_rgb8(frame));
  EXPECT_EQ(pixels[0], 255);
  EXPECT_EQ(pixels[1], 0);
  EXPECT_EQ(pixels[43], 188);
  stbi_image_free(pixels);
  std::filesystem::remove(path);
}

TEST(Png, ThatCannotBeWrittenIsAnInputErrorAndLeavesNothing) {
  const std::string folder = ::testing::TempDir() + "raypool_png_test";
  std::filesystem::create_directories(folder + "/taken.png/inside");
  EXPECT_THROW(write_png(FrameBuffer(2, 2), folder + "/none/a.png"), InputError);
  EXPECT_THROW(write_png(FrameBuffer(2, 2), folder + "/taken.png"), InputError);  // a folder of this name
  int entries = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) entries += entry.exists();
  EXPECT_EQ(entries, 1);
  std::filesystem::remove_all(folder);
}

TEST(Difference, CountsPixelsAndMeasuresTheWorst) {
  FrameBuffer a(4, 4), b(4, 4);
  EXPECT_EQ(compare(a, b).pixels, 0u);
  EXPECT_TRUE(std::isinf(compare(a, b).psnr));
  b.add(contribution(1, 2, 1, 0, 0));
  b.add(contribution(3, 3, 1e-9f, 0, 0));
  const ImageDifference difference = compare(a, b);
  EXPECT_EQ(difference.pixels, 2u);
  EXPECT_EQ(difference.visible, 1u);
  EXPECT_EQ(difference.largest, 255);
  EXPECT_NEAR(difference.psnr, 10 * std::log10(48.0), 1e-9);
  EXPECT_THROW(compare(a, FrameBuffer(3, 4)), InputError);
}

}  // namespace
}  // namespace raypool
