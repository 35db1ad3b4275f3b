// The kernels themselves: natively against formulas in double precision, and as machine code against native.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <numeric>
#include <random>
#include <sstream>

#include "bits.hpp"
#include "isa/encoding.hpp"
#include "kernel/compute_kernels.hpp"
#include "kernel/kernel_report.hpp"
#include "kernel/kernels.hpp"
#include "kernel/test_interpreter.hpp"
#include "random.hpp"

namespace raypool {
namespace {

constexpr uint32_t kMaterialAddress = 256;

struct Vec {
  double x, y, z;
};
Vec operator+(Vec a, Vec b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Vec operator-(Vec a, Vec b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Vec operator*(double s, Vec a) { return {s * a.x, s * a.y, s * a.z}; }
double dot(Vec a, Vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
double length(Vec a) { return std::sqrt(dot(a, a)); }

template <typename Words>
Vec get(const Words& words, int number) {
  return {as_float(words[number]), as_float(words[number + 1]), as_float(words[number + 2])};
}
template <typename Words>
void put(Words& words, int number, Vec v) {
  words[number] = as_bits(static_cast<float>(v.x));
  words[number + 1] = as_bits(static_cast<float>(v.y));
  words[number + 2] = as_bits(static_cast<float>(v.z));
}
void expect_near(Vec a, Vec b, double tolerance, const char* what) {
  EXPECT_LT(length(a - b), tolerance * (1 + length(b))) << what;
}

/// A thread with everything a kernel reads; random but reasonable values.
struct Case {
  std::array<uint32_t, kArguments> arguments{};
  Memory memory{1024};
  NativeThread thread;

  explicit Case(uint32_t seed) {
    Random random(seed);
    const auto number = [&] { return std::uniform_real_distribution<double>(-4, 4)(random); };
    const auto positive = [&] { return std::uniform_real_distribution<double>(0.05, 1)(random); };
    const auto vec = [&] { return Vec{number(), number(), number()}; };
    put(arguments, argument::kEye, vec());
    put(arguments, argument::kCorner, vec());
    put(arguments, argument::kStepX, 0.01 * vec());
    put(arguments, argument::kStepY, 0.01 * vec());
    put(arguments, argument::kLight, 3 * vec());
    put(arguments, argument::kLightColor, {positive(), positive(), positive()});
    arguments[argument::kOffset] = as_bits(1e-3f);
    arguments[argument::kTileWidthLog2] = 3;
    arguments[argument::kTileMask] = 7;
    arguments[argument::kWidth] = 100;
    arguments[argument::kHeight] = 50;
    std::array<uint32_t, 8> material{};
    put(material, 0, {positive(), positive(), positive()});
    put(material, 4, {positive(), positive(), positive()});
    for (uint32_t i = 0; i < 8; ++i) memory.store(kMaterialAddress + 4 * i, material[i]);
    Intersection& hit = thread.input;
    put(hit, word::kOrigin, vec());
    put(hit, word::kDirection, vec());
    hit[word::kLimit] = as_bits(std::numeric_limits<float>::infinity());
    hit[word::kPixel] = 17u | 23u << 16;
    put(hit, word::kColor, {positive(), positive(), positive()});
    hit[word::kFlags] = 2;
    hit[word::kDistance] = as_bits(static_cast<float>(4 * positive()));
    const Vec normal = vec();
    put(hit, word::kNormal, (1 / length(normal)) * normal);
    hit[word::kMaterial] = kMaterialAddress;
    hit[word::kTriangle] = 5;
    thread.arguments = &arguments;
    thread.memory = &memory;
    thread.threads = 64;
  }
  Case(const Case&) = delete;

  Vec argument_vec(int number) const { return get(arguments, number); }
  Vec material_vec(uint32_t offset) const {
    return {as_float(memory.load(kMaterialAddress + offset)), as_float(memory.load(kMaterialAddress + offset + 4)),
            as_float(memory.load(kMaterialAddress + offset + 8))};
  }
};

/// The shadow ray that the formulas of docs/use/kernels.md give, in double precision.
struct Expected {
  Vec origin, direction, contribution, reflected, throughput;
  double facing;  // how clearly the ray meets one side; near 0 rounding decides
};
Expected expect(const Case& test) {
  const Intersection& hit = test.thread.input;
  const Vec direction = get(hit, word::kDirection);
  const Vec geometric = get(hit, word::kNormal);
  const double projection = dot(direction, geometric);
  const Vec normal = projection > 0 ? -1.0 * geometric : geometric;
  Expected expected;
  expected.facing = std::fabs(projection);
  const double distance = as_float(hit[word::kDistance]);
  const Vec point = get(hit, word::kOrigin) + distance * direction;
  const double largest = std::max({std::fabs(point.x), std::fabs(point.y), std::fabs(point.z)});
  const double offset = as_float(test.arguments[argument::kOffset]) * (largest + distance);
  expected.origin = point + offset * normal;
  expected.direction = test.argument_vec(argument::kLight) - expected.origin;
  const double cosine = std::max(0.0, dot(normal, expected.direction)) / length(expected.direction);
  const Vec kd = test.material_vec(kMaterialDiffuse);
  const Vec ks = test.material_vec(kMaterialReflectance);
  const Vec color = test.argument_vec(argument::kLightColor);
  const Vec throughput = get(hit, word::kColor);
  expected.contribution = {throughput.x * kd.x * color.x * cosine, throughput.y * kd.y * color.y * cosine,
                           throughput.z * kd.z * color.z * cosine};
  expected.reflected = direction - 2 * projection * geometric;
  expected.throughput = {throughput.x * ks.x, throughput.y * ks.y, throughput.z * ks.z};
  return expected;
}

void check_shadow_ray(const Case& test, const Ray& ray) {
  const Expected expected = expect(test);
  expect_near(get(ray, word::kOrigin), expected.origin, 1e-5, "origin");
  expect_near(get(ray, word::kDirection), expected.direction, 1e-5, "direction");
  expect_near(get(ray, word::kColor), expected.contribution, 1e-4, "contribution");
  EXPECT_EQ(ray[word::kLimit], as_bits(1.0f));
  EXPECT_EQ(ray[word::kPixel], test.thread.input[word::kPixel]);
  EXPECT_EQ(ray[word::kFlags], kShadowFlag | 2u);
}

TEST(RayKernels, CastEyeMakesTheRayThroughThePixel) {
  for (uint32_t seed = 1; seed <= 50; ++seed) {
    Case test(seed);
    test.thread.thread = seed;           // x 1 .., y of the tile
    test.thread.block = 40u | 8u << 16;  // the tile's first pixel
    run_native(RayKernel::CastEye, test.thread);
    ASSERT_EQ(test.thread.rays.size(), 1u);
    const Ray& ray = test.thread.rays[0];
    const uint32_t x = 40 + seed % 8;
    const uint32_t y = 8 + seed / 8;
    expect_near(get(ray, word::kOrigin), test.argument_vec(argument::kEye), 1e-12, "origin");
    expect_near(get(ray, word::kDirection),
                test.argument_vec(argument::kCorner) + double(x) * test.argument_vec(argument::kStepX) +
                    double(y) * test.argument_vec(argument::kStepY),
                1e-6, "direction");
    EXPECT_EQ(ray[word::kLimit], as_bits(std::numeric_limits<float>::infinity()));
    EXPECT_EQ(ray[word::kPixel], x | y << 16);
    expect_near(get(ray, word::kColor), {1, 1, 1}, 1e-12, "throughput");
    EXPECT_EQ(ray[word::kFlags], 1u);
  }
}

TEST(RayKernels, CastEyeExportsPixelsOfTheImageOnly) {
  int exported = 0;
  for (uint32_t thread = 0; thread < 64; ++thread) {
    Case test(1);
    test.thread.thread = thread;
    test.thread.block = 96u | 48u << 16;  // 4 columns and 2 rows of the tile lie in the image of 100 x 50
    run_native(RayKernel::CastEye, test.thread);
    EXPECT_EQ(test.thread.rays.size(), thread % 8 < 4 && thread / 8 < 2 ? 1u : 0u) << thread;
    exported += static_cast<int>(test.thread.rays.size());
  }
  EXPECT_EQ(exported, 8);
}

TEST(RayKernels, SecondaryRaysFollowTheFormulas) {
  int lit = 0;
  for (uint32_t seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(seed);
    Case test(seed);
    const Expected expected = expect(test);
    if (expected.facing < 1e-3) continue;
    lit += length(expected.contribution) > 0 ? 1 : 0;
    run_native(RayKernel::CastSecondaryDirect, test.thread);
    ASSERT_EQ(test.thread.rays.size(), 1u);
    check_shadow_ray(test, test.thread.rays[0]);

    test.thread.rays.clear();
    run_native(RayKernel::CastSecondary, test.thread);
    ASSERT_EQ(test.thread.rays.size(), 2u);
    const Ray& reflection = test.thread.rays[0];
    expect_near(get(reflection, word::kOrigin), expected.origin, 1e-5, "reflection's origin");
    expect_near(get(reflection, word::kDirection), expected.reflected, 1e-5, "reflected direction");
    expect_near(get(reflection, word::kColor), expected.throughput, 1e-6, "throughput");
    EXPECT_EQ(reflection[word::kLimit], as_bits(std::numeric_limits<float>::infinity()));
    EXPECT_EQ(reflection[word::kPixel], test.thread.input[word::kPixel]);
    EXPECT_EQ(reflection[word::kFlags], 3u);
    check_shadow_ray(test, test.thread.rays[1]);
  }
  EXPECT_GT(lit, 50);
}

TEST(RayKernels, LightBehindOrOnTheSurfaceContributesNothing) {
  for (const bool on_surface : {false, true}) {
    Case test(3);
    const Expected expected = expect(test);
    Vec light = expected.origin;
    if (!on_surface) {
      const Vec normal = get(test.thread.input, word::kNormal);
      light = light - (dot(get(test.thread.input, word::kDirection), normal) > 0 ? -2.0 : 2.0) * normal;
    } else {
      // Exactly the float origin that the kernel computes.
      run_native(RayKernel::CastSecondaryDirect, test.thread);
      light = get(test.thread.rays[0], word::kOrigin);
      test.thread.rays.clear();
    }
    put(test.arguments, argument::kLight, light);
    run_native(RayKernel::CastSecondaryDirect, test.thread);
    ASSERT_EQ(test.thread.rays.size(), 1u) << "without culling a shadow ray is always cast";
    for (int i = 0; i < 3; ++i) EXPECT_EQ(test.thread.rays[0][word::kColor + i], 0u) << on_surface;
    test.thread.rays.clear();
    test.thread.culling = true;
    run_native(RayKernel::CastSecondaryDirect, test.thread);
    EXPECT_TRUE(test.thread.rays.empty()) << on_surface;
  }
}

TEST(RayKernels, CullingLeavesOutShadowRaysAwayFromTheLightAndNoOthers) {
  int left_out = 0, cast = 0;
  for (uint32_t seed = 1; seed <= 300; ++seed) {
    for (const RayKernel which : {RayKernel::CastSecondary, RayKernel::CastSecondaryDirect}) {
      Case all(seed), some(seed);
      some.thread.culling = true;
      run_native(which, all.thread);
      run_native(which, some.thread);
      std::vector<Ray> expected;
      for (const Ray& ray : all.thread.rays) {
        if ((ray[word::kFlags] & kShadowFlag) == 0 || !is_black(ray)) expected.push_back(ray);
      }
      EXPECT_EQ(some.thread.rays, expected) << seed;
      left_out += static_cast<int>(all.thread.rays.size() - expected.size());
      cast += static_cast<int>(expected.size());
    }
  }
  EXPECT_GT(left_out, 50);
  EXPECT_GT(cast, 500);
}

TEST(RayKernels, ShadeAddsTheContributionToItsPixel) {
  Case test(1);
  run_native(RayKernel::Shade, test.thread);
  ASSERT_EQ(test.thread.frame.size(), 1u);
  EXPECT_EQ(test.thread.frame[0].pixel, 17u | 23u << 16);
  for (size_t i = 0; i < 3; ++i) EXPECT_EQ(test.thread.frame[0].rgb[i], test.thread.input[word::kColor + i]);
  EXPECT_TRUE(test.thread.rays.empty());
}

TEST(RayKernels, EveryWordOfARayIsWritten) {
  for (const RayKernel which : {RayKernel::CastEye, RayKernel::CastSecondary, RayKernel::CastSecondaryDirect}) {
    Case test(2);
    test.thread.block = 0;
    run_native(which, test.thread);
    for (const Ray& ray : test.thread.rays) {
      for (const uint32_t bits : ray) EXPECT_NE(bits, kernel::kUndefinedWord);
    }
  }
}

TEST(RayKernels, MachineCodeAgreesWithNativeInEveryMode) {
  int rays = 0;
  for (int mode = 0; mode < 8; ++mode) {
    const bool culling = mode % 3 == 0;
    const Program& program = ray_kernel_program({false, false, culling});
    for (int which = 0; which < kRayKernels; ++which) {
      for (uint32_t seed = 1; seed <= 40; ++seed) {
        Case base(seed);
        test::Interpreter machine;
        machine.mode = {static_cast<Subnormals>(mode & 1), static_cast<SlowUnit>(mode >> 1)};
        machine.memory = base.memory;
        machine.arguments = base.arguments;
        machine.block = 96u | 49u << 16;
        Random random(seed);
        for (uint32_t lane = 0; lane < test::Interpreter::kLanes; ++lane) {
          machine.input[lane] = Case(1000 * seed + lane).thread.input;
          // Also bit patterns that no renderer would send.
          if (random() % 4 == 0) machine.input[lane][random() % 18] = random();
        }
        const std::string name(kRayKernelNames[which]);
        machine.run(program, program.entries.at(name));
        for (uint32_t lane = 0; lane < test::Interpreter::kLanes; ++lane) {
          NativeThread thread;
          thread.thread = lane;
          thread.block = machine.block;
          thread.threads = machine.threads;
          thread.arguments = &machine.arguments;
          thread.memory = &base.memory;
          thread.mode = machine.mode;
          thread.culling = culling;
          thread.input = machine.input[lane];
          run_native(static_cast<RayKernel>(which), thread);
          ASSERT_EQ(thread.rays, machine.rays[lane])
              << name << " mode " << mode << " seed " << seed << " lane " << lane;
          ASSERT_EQ(thread.frame.size(), machine.frame[lane].size());
          for (size_t i = 0; i < thread.frame.size(); ++i) {
            ASSERT_EQ(thread.frame[i].pixel, machine.frame[lane][i].pixel);
            ASSERT_EQ(thread.frame[i].rgb, machine.frame[lane][i].rgb);
          }
          rays += static_cast<int>(thread.rays.size());
        }
      }
    }
  }
  EXPECT_GT(rays, 8 * 40 * 8 * 3);
}

TEST(RayKernels, OfAFrameAreThoseThatTheChipMayLaunch) {
  ChipConfiguration chip;
  using Kernels = std::vector<RayKernel>;
  const auto eye = RayKernel::CastEye, reflecting = RayKernel::CastSecondary, direct = RayKernel::CastSecondaryDirect,
             shade = RayKernel::Shade;
  EXPECT_EQ(kernels_of(chip, 3, true), (Kernels{eye, reflecting, shade}));
  EXPECT_EQ(kernels_of(chip, 3, false), (Kernels{eye, direct, shade}));
  EXPECT_EQ(kernels_of(chip, 1, true), (Kernels{eye, direct, shade}));
  chip.culling = true;
  EXPECT_EQ(kernels_of(chip, 3, true), (Kernels{eye, reflecting, direct, shade}));
  chip.shading = Shading::Traverser;
  EXPECT_EQ(kernels_of(chip, 1, true), (Kernels{eye, direct}));
}

TEST(RayKernels, AreAsShortAsTheyWere) {
  const auto total = [](const char* name) {
    const InstructionCounts counts = count_instructions(ray_kernel_program(), name);
    return std::accumulate(counts.begin(), counts.end(), 0);
  };
  EXPECT_LE(total("cast_eye"), 55);
  EXPECT_LE(total("cast_secondary"), 120);
  EXPECT_LE(total("cast_secondary_direct"), 93);
  EXPECT_EQ(total("shade"), 3);
  EXPECT_EQ(count_instructions(ray_kernel_program(), "shade"), (InstructionCounts{0, 1, 0, 0, 0, 0, 2}));
  const std::string table = kernel_table();
  for (const char* text : {"cast_secondary_direct", "(77)", "(191)", "(110)", "(54)"})
    EXPECT_NE(table.find(text), std::string::npos) << table;
}

TEST(RayKernels, DocumentHasTheTableOfToday) {
  std::ifstream file("docs/use/kernels.md");
  ASSERT_TRUE(file.good()) << "run the tests from the repository's root";
  std::stringstream document, table(kernel_table());
  document << file.rdbuf();
  for (std::string line; std::getline(table, line);) {
    EXPECT_NE(document.str().find("\n    " + line + "\n"), std::string::npos)
        << "put the output of `raypool kernels` into docs/use/kernels.md:\n"
        << line;
  }
}

TEST(ComputeKernels, SaxpyTakesAnyNumberOfBlocksAndThreads) {
  for (const uint32_t n : {0u, 1u, 7u, 8u, 100u}) {
    for (const uint32_t blocks : {1u, 3u}) {
      for (const uint32_t threads : {1u, 5u, 8u}) {
        Random random(n);
        const uint32_t x = 64, y = 2048;
        test::Interpreter machine;
        machine.memory = Memory(4096);
        for (uint32_t address = 64; address < 4096; address += 4)
          machine.memory.store(address, as_bits((random() % 1000) / 7.0f));
        machine.arguments[saxpy_argument::kN] = n;
        machine.arguments[saxpy_argument::kA] = as_bits(2.5f);
        machine.arguments[saxpy_argument::kX] = x;
        machine.arguments[saxpy_argument::kY] = y;
        machine.threads = threads;
        machine.blocks = blocks;
        const Memory before = machine.memory;
        Memory native = machine.memory;
        for (uint32_t block = 0; block < blocks; ++block) {
          machine.block = block;
          machine.run(compute_kernel_program(), compute_kernel_program().entries.at("saxpy"));
          for (uint32_t t = 0; t < threads; ++t) {
            NativeThread thread;
            thread.thread = t;
            thread.block = block;
            thread.threads = threads;
            thread.blocks = blocks;
            thread.arguments = &machine.arguments;
            thread.memory = &native;
            run_native(ComputeKernel::Saxpy, thread);
          }
        }
        for (uint32_t address = 64; address < 4096; address += 4) {
          uint32_t expected = before.load(address);
          if (address >= y && address < y + 4 * n)
            expected = as_bits(2.5f * as_float(before.load(address - y + x)) + as_float(expected));
          ASSERT_EQ(machine.memory.load(address), expected)
              << "n " << n << " blocks " << blocks << " threads " << threads << " at " << address;
          ASSERT_EQ(native.load(address), expected);
        }
      }
    }
  }
}

TEST(ComputeKernels, MatmulTakesAnyNumberOfBlocksAndThreads) {
  for (const uint32_t n : {1u, 3u, 9u}) {
    for (const uint32_t blocks : {1u, 4u}) {
      for (const uint32_t threads : {1u, 8u}) {
        Random random(n);
        const uint32_t a = 64, b = 1024, c = 2048;
        test::Interpreter machine;
        machine.memory = Memory(4096);
        for (uint32_t i = 0; i < n * n; ++i) {
          machine.memory.store(a + 4 * i, as_bits((random() % 100) / 7.0f));
          machine.memory.store(b + 4 * i, as_bits((random() % 100) / 3.0f));
        }
        machine.arguments[matmul_argument::kN] = n;
        machine.arguments[matmul_argument::kA] = a;
        machine.arguments[matmul_argument::kB] = b;
        machine.arguments[matmul_argument::kC] = c;
        machine.threads = threads;
        machine.blocks = blocks;
        Memory native = machine.memory;
        for (uint32_t block = 0; block < blocks; ++block) {
          machine.block = block;
          machine.run(compute_kernel_program(), compute_kernel_program().entries.at("matmul"));
          for (uint32_t t = 0; t < threads; ++t) {
            NativeThread thread;
            thread.thread = t;
            thread.block = block;
            thread.threads = threads;
            thread.blocks = blocks;
            thread.arguments = &machine.arguments;
            thread.memory = &native;
            run_native(ComputeKernel::Matmul, thread);
          }
        }
        for (uint32_t row = 0; row < n; ++row) {
          for (uint32_t column = 0; column < n; ++column) {
            float sum = 0;
            for (uint32_t k = 0; k < n; ++k) {
              sum += as_float(machine.memory.load(a + 4 * (row * n + k))) *
                     as_float(machine.memory.load(b + 4 * (k * n + column)));
            }
            const uint32_t address = c + 4 * (row * n + column);
            ASSERT_EQ(machine.memory.load(address), as_bits(sum))
                << "n " << n << " row " << row << " column " << column;
            ASSERT_EQ(native.load(address), as_bits(sum));
          }
        }
        EXPECT_EQ(machine.memory.load(c + 4 * n * n), 0u);
      }
    }
  }
}

TEST(RayKernels, AreRefusedByAMachineThatLacksWhatTheyHave) {
  const Program& program = ray_kernel_program();
  Configuration machine;
  machine.name = "mine";
  machine.alus[AluType::Int].without = optional_operations(AluType::Int) & ~(1u << operation_of(Opcode::Or));
  machine.alus[AluType::Slw].without = 1u << operation_of(Opcode::Frsqrt);
  EXPECT_NO_THROW(check_instructions(program, "cast_eye", machine));
  EXPECT_NO_THROW(check_instructions(program, "shade", machine));
  try {
    check_instructions(program, "cast_secondary", machine);
    FAIL() << "not refused";
  } catch (const InputError& error) {
    EXPECT_EQ(
        std::string(error.what()),
        "kernel cast_secondary has frsqrt (instruction 62), which mine is without: take it off alus.slw.without of "
        "that configuration");
  }
  machine = Configuration();
  machine.name = "mine";
  const auto refusal = [&](uint32_t Configuration::*field, uint32_t value) -> std::string {
    Configuration less = machine;
    less.*field = value;
    try {
      check_instructions(program, "cast_secondary", less);
      return "";
    } catch (const InputError& error) {
      return error.what();
    }
  };
  Numbers needs;
  for (const uint64_t encoding : extract_kernel(program, "cast_secondary").code) {
    const Numbers one = numbers_of(unpack(encoding));
    needs.registers = std::max(needs.registers, one.registers);
    needs.predicates = std::max(needs.predicates, one.predicates);
    needs.arguments = std::max(needs.arguments, one.arguments);
  }
  EXPECT_EQ(refusal(&Configuration::registers, needs.registers), "");
  EXPECT_EQ(refusal(&Configuration::predicates, needs.predicates), "");
  EXPECT_EQ(refusal(&Configuration::arguments, needs.arguments), "");
  EXPECT_NE(refusal(&Configuration::registers, needs.registers - 1)
                .find(fmt::format("and mine has {} registers: give that configuration {}", needs.registers - 1,
                                  needs.registers)),
            std::string::npos)
      << refusal(&Configuration::registers, needs.registers - 1);
  EXPECT_NE(refusal(&Configuration::predicates, 1).find("with p1 (instruction"), std::string::npos);
  EXPECT_NE(refusal(&Configuration::arguments, needs.arguments - 1)
                .find(fmt::format("with argument {} (instruction", needs.arguments - 1)),
            std::string::npos);
}

}  // namespace
}  // namespace raypool
