// Textures in the kernel language against a reference in double precision, which knows texels and wraps only.
#include "shader/texture.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "bits.hpp"
#include "kernel/test_interpreter.hpp"
#include "random.hpp"

namespace raypool::shader {
namespace {

using kernel::NativeKernel;
using Ieee = NativeKernel<Subnormals::Ieee, SlowUnit::Exact>;
using Fused = NativeKernel<Subnormals::Flush, SlowUnit::Exact, true>;
using Narrow = NativeKernel<Subnormals::Flush, SlowUnit::Newton0, true, true>;
using Color = std::array<double, 4>;

constexpr uint32_t kRecord = 64;
constexpr uint32_t kTexels = 128;

/// A texture of random texels, its record at kRecord. Memory ends behind the last texel.
struct Picture {
  uint32_t width, height;
  Wrap s, t;
  Memory memory;

  Picture(uint32_t columns, uint32_t rows, Wrap across, Wrap down, bool nearest = false)
      : width(columns), height(rows), s(across), t(down), memory(kTexels + 8 * columns * rows) {
    memory.store(kRecord, kTexels);
    memory.store(kRecord + 4, width);
    memory.store(kRecord + 8, height);
    memory.store(kRecord + 12,
                 to_underlying(s) | to_underlying(t) << kTextureWrapTShift | (nearest ? kTextureNearest : 0));
    Random random(width * 31 + height);
    for (uint32_t word = 0; word < 2 * width * height; ++word)
      memory.store(kTexels + 4 * word, static_cast<uint32_t>(random()));
  }

  Color texel(uint32_t x, uint32_t y) const {
    const uint32_t address = kTexels + 8 * (y * width + x);
    Color color{};
    for (uint32_t channel = 0; channel < 4; ++channel)
      color[channel] = (memory.load(address + channel / 2 * 4) >> (channel % 2 * 16) & 0xffff) / 65535.0;
    return color;
  }

  /// The texel that a number of a texel, which may be outside, stands for.
  static uint32_t inside(int64_t at, uint32_t size, Wrap wrap) {
    const int64_t count = size;
    if (wrap == Wrap::Clamp) return static_cast<uint32_t>(std::clamp<int64_t>(at, 0, count - 1));
    const int64_t period = wrap == Wrap::Mirror ? 2 * count : count;
    const int64_t rest = ((at % period) + period) % period;
    return static_cast<uint32_t>(rest < count ? rest : 2 * count - 1 - rest);
  }

  Color nearest(double u, double v) const {
    return texel(inside(static_cast<int64_t>(std::floor(u * width)), width, s),
                 inside(static_cast<int64_t>(std::floor(v * height)), height, t));
  }

  Color bilinear(double u, double v) const {
    const double x = u * width - 0.5, y = v * height - 0.5;
    const double left = std::floor(x), top = std::floor(y);
    Color sum{};
    for (int corner = 0; corner < 4; ++corner) {
      const int right = corner & 1, below = corner >> 1;
      const double weight = (right != 0 ? x - left : 1 - (x - left)) * (below != 0 ? y - top : 1 - (y - top));
      const Color color = texel(inside(static_cast<int64_t>(left) + right, width, s),
                                inside(static_cast<int64_t>(top) + below, height, t));
      for (size_t channel = 0; channel < 4; ++channel) sum[channel] += weight * color[channel];
    }
    return sum;
  }
};

constexpr auto kSample = [](auto& k, const auto& record, const auto& u, const auto& v) {
  return sample(k, record, as_float(u), as_float(v));
};
constexpr auto kBilinear = [](auto& k, const auto& record, const auto& u, const auto& v) {
  return sample_bilinear(k, record, as_float(u), as_float(v));
};
constexpr auto kNearest = [](auto& k, const auto& record, const auto& u, const auto& v) {
  return sample_nearest(k, record, as_float(u), as_float(v));
};
constexpr auto kFetch = [](auto& k, const auto& record, const auto& x, const auto& y) {
  return fetch_texel(k, record, x, y);
};

template <typename K, typename Function>
std::array<uint32_t, 4> native(const Function& function, Picture& picture, uint32_t u, uint32_t v,
                               uint32_t significand = arith::kFullSignificand) {
  NativeThread thread;
  thread.mode = K::mode();
  thread.mode.significand = significand;
  thread.memory = &picture.memory;
  K k(thread);
  using Int = typename K::Int;
  const Texel<K> texel = function(k, Int(kRecord), Int(u), Int(v));
  return {texel.x.bits, texel.y.bits, texel.z.bits, texel.w.bits};
}

template <typename K, typename Function>
void expect_color(const Function& function, Picture& picture, float u, float v, const Color& expected, double bound) {
  const std::array<uint32_t, 4> color = native<K>(function, picture, as_bits(u), as_bits(v));
  for (size_t channel = 0; channel < 4; ++channel)
    ASSERT_NEAR(as_float(color[channel]), expected[channel], bound)
        << fmt::format("channel {} at {} {}, {} x {} texels, wraps {} {}", channel, u, v, picture.width, picture.height,
                       to_underlying(picture.s), to_underlying(picture.t));
}

/// Calls check(picture, u, v) for textures of all wraps and many sizes.
template <typename Check>
void each_place(bool nearest, const Check& check) {
  Random random(5);
  for (const auto& [width, height] :
       std::vector<std::pair<uint32_t, uint32_t>>{{1, 1}, {2, 3}, {5, 4}, {16, 1}, {37, 64}}) {
    for (const Wrap s : {Wrap::Repeat, Wrap::Clamp, Wrap::Mirror}) {
      for (const Wrap t : {Wrap::Repeat, Wrap::Clamp, Wrap::Mirror}) {
        Picture picture(width, height, s, t, nearest);
        for (int i = 0; i < 300; ++i) {
          const auto coordinate = [&] {
            const auto bits = static_cast<int32_t>(static_cast<uint32_t>(random()));
            return static_cast<float>(bits) * (i % 3 == 0 ? 0x1p-27f : 0x1p-30f);  // -16 .. 16, -2 .. 2
          };
          const float u = coordinate(), v = coordinate();
          check(picture, u, v);
          if (testing::Test::HasFatalFailure()) return;
        }
        // Corners, and centres of the texels at the edges.
        const float half_x = 0.5f / static_cast<float>(width), half_y = 0.5f / static_cast<float>(height);
        for (const float u : {0.0f, 1.0f, -1.0f, 2.0f, half_x, 1.0f - half_x, -half_x})
          for (const float v : {0.0f, 1.0f, -1.0f, 2.0f, half_y, 1.0f - half_y, -half_y}) check(picture, u, v);
      }
    }
  }
}

// A coordinate of up to 16 has rounding errors of 2^-20, of which 64 texels make 2^-14 of a texel along each axis.
constexpr double kBound = 0x1p-12;

TEST(Texture, BilinearIsTheWeightedSumOfFourTexels) {
  each_place(false, [](Picture& picture, float u, float v) {
    const Color expected = picture.bilinear(u, v);
    expect_color<Ieee>(kBilinear, picture, u, v, expected, kBound);
    expect_color<Fused>(kBilinear, picture, u, v, expected, kBound);
    expect_color<Ieee>(kSample, picture, u, v, expected, kBound);
  });
}

TEST(Texture, NearestIsTheTexelThatHoldsThePoint) {
  each_place(true, [](Picture& picture, float u, float v) {
    // Not where a rounding decides.
    const auto near_border = [](float coordinate, uint32_t size) {
      const double place = double{coordinate} * size;
      return std::fabs(place - std::round(place)) < 0x1p-12;
    };
    if (near_border(u, picture.width) || near_border(v, picture.height)) return;
    const Color expected = picture.nearest(u, v);
    expect_color<Ieee>(kNearest, picture, u, v, expected, 1e-7);
    expect_color<Ieee>(kSample, picture, u, v, expected, 1e-7);
    expect_color<Fused>(kSample, picture, u, v, expected, 1e-7);
  });
}

TEST(Texture, CentresGiveTheTexelsThemselves) {
  Picture picture(8, 4, Wrap::Repeat, Wrap::Clamp);
  for (uint32_t y = 0; y < 4; ++y) {
    for (uint32_t x = 0; x < 8; ++x) {
      const float u = (static_cast<float>(x) + 0.5f) / 8, v = (static_cast<float>(y) + 0.5f) / 4;
      expect_color<Ieee>(kBilinear, picture, u, v, picture.texel(x, y), 1e-7);
      const std::array<uint32_t, 4> fetched = native<Ieee>(kFetch, picture, x, y);
      EXPECT_EQ(native<Ieee>(kNearest, picture, as_bits(u), as_bits(v)), fetched);
      EXPECT_EQ(native<Ieee>(kBilinear, picture, as_bits(u), as_bits(v)), fetched);
    }
  }
}

/// Fails where a kernel reads outside of the texture and its record.
TEST(Texture, NoCoordinateReadsOutsideOfTheTexture) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  std::vector<float> coordinates = {
      0.0f,      1.0f,       -0.0f,  0x1p31f, -0x1p31f,    3e38f,         -3e38f,
      kInfinity, -kInfinity, 1e-45f, -1e-9f,  0.99999994f, 2147483520.0f, std::numeric_limits<float>::quiet_NaN()};
  for (const Wrap wrap : {Wrap::Repeat, Wrap::Clamp, Wrap::Mirror}) {
    Picture picture(3, 5, wrap, wrap);
    // All texels are white; what lies before the texture is not, and behind it is no memory, which reads as 0.
    for (uint32_t word = 0; word < 2 * 3 * 5; ++word) picture.memory.store(kTexels + 4 * word, ~0u);
    for (const float u : coordinates) {
      for (const float v : coordinates) {
        expect_color<Ieee>(kBilinear, picture, u, v, {1, 1, 1, 1}, 1e-6);
        expect_color<Ieee>(kNearest, picture, u, v, {1, 1, 1, 1}, 1e-6);
        for (const uint32_t bits : native<Narrow>(kBilinear, picture, as_bits(u), as_bits(v), 11))
          ASSERT_NEAR(as_float(bits), 1, 0.01) << u << " " << v;
      }
    }
  }
}

/// Compiles `function` and what stores its four channels, with `held` other values alive meanwhile.
template <typename Function>
kernel::CompileCounts compile(Program& program, const Function& function, bool fused, int held) {
  return kernel::add_kernel(
      program, "k",
      [&](auto& k) {
        k.ray_in();
        using K = std::decay_t<decltype(k)>;
        std::vector<typename K::Int> values;
        values.reserve(static_cast<size_t>(held));
        for (int i = 0; i < held; ++i) values.push_back(k.load_int(k.int_argument(0), 4 * i));
        const Texel<K> texel = function(k, k.int_argument(0), k.int_word(0), k.int_word(1));
        k.set_word(7, k.thread());
        k.set_word(0, texel.x);
        k.set_word(1, texel.y);
        k.set_word(2, texel.z);
        k.set_word(3, texel.w);
        for (int i = 0; i < held; ++i) k.set_word(4 + i, values[static_cast<size_t>(i)]);
        k.ray_out();
      },
      KernelTarget(fused, false));
}

template <typename K, typename Function>
void expect_native_bits(const Function& function) {
  Picture picture(13, 9, Wrap::Mirror, Wrap::Repeat);
  Program program;
  compile(program, function, K::mode().fused, 0);
  test::Interpreter machine;
  machine.mode = K::mode();
  machine.memory = picture.memory;
  machine.arguments[0] = kRecord;
  Random random(6);
  for (int i = 0; i < 200; ++i) {
    for (auto& lane : machine.input)
      for (size_t word = 0; word < 2; ++word)
        lane[word] = as_bits(static_cast<float>(static_cast<int32_t>(static_cast<uint32_t>(random()))) * 0x1p-29f);
    for (auto& rays : machine.rays) rays.clear();
    machine.run(program, 0);
    for (size_t lane = 0; lane < test::Interpreter::kLanes; ++lane) {
      const std::array<uint32_t, 4> expected =
          native<K>(function, picture, machine.input[lane][0], machine.input[lane][1]);
      ASSERT_EQ(machine.rays[lane].size(), 1u);
      for (size_t channel = 0; channel < 4; ++channel) ASSERT_EQ(machine.rays[lane][0][channel], expected[channel]);
    }
  }
}

TEST(Texture, MachineCodeGivesTheBitsOfNativeKernels) {
  expect_native_bits<Ieee>(kSample);
  expect_native_bits<Fused>(kSample);
  expect_native_bits<Ieee>(kBilinear);
  expect_native_bits<Fused>(kNearest);
}

TEST(Texture, FourValuesKeepTheirRegistersWhileATextureIsSampled) {
  for (const bool fused : {false, true}) {
    Program program;
    const kernel::CompileCounts counts = compile(program, kSample, fused, 4);
    EXPECT_EQ(counts.stores + counts.loads, 0) << "fused: " << fused;
  }
}

}  // namespace
}  // namespace raypool::shader
