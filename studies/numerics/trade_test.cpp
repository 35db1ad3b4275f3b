#include "numerics/trade.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>

#include "bits.hpp"
#include "machine/compute/functional_unit.hpp"
#include "numerics/cost.hpp"
#include "numerics/extreme_parts.hpp"
#include "numerics/extremes.hpp"
#include "numerics/trade_report.hpp"

namespace raypool::numerics {
namespace {

TradeScene& cornell() {
  static TradeScene scene("cornell", make_cornell(0.2), 64, 48, 3);
  if (scene.reference.color.empty()) scene.draw_reference();
  return scene;
}

TEST(ArithmeticModes, AreAsDeepAsTheyNeed) {
  Configuration deeper;
  deeper.alus[AluType::Slw].depth += 2;
  for (const ArithmeticMode& mode : arithmetic_modes()) {
    const Configuration plain = mode.applied_to(Configuration{});
    for (const AluType type : {AluType::Flt, AluType::Slw})
      EXPECT_EQ(plain.alu(type).depth, least_depth(plain, type)) << mode.name;
    EXPECT_EQ(mode.applied_to(deeper).alu(AluType::Slw).depth, least_depth(plain, AluType::Slw) + 2) << mode.name;
    // What one mode has made can be taken to another.
    EXPECT_EQ(arithmetic_modes()[3].applied_to(plain).alu(AluType::Slw).depth, 6) << mode.name;
  }
}

TEST(Trade, ExactArithmeticDrawsTheReference) {
  const Quality quality = judge_frame(cornell(), record_frame(cornell(), {}));
  EXPECT_EQ(quality.pixels, 64u * 48u);
  EXPECT_EQ(quality.wrong_triangles + quality.holes + quality.nan_pixels, 0u);
  EXPECT_LE(quality.wrong_shadows, 2u);
  EXPECT_GT(quality.same_paths, quality.pixels - 5);
  EXPECT_GT(quality.psnr_same_paths, 90);
  EXPECT_LE(quality.psnr, quality.psnr_same_paths);
  // Not a black picture.
  double sum = 0;
  for (const Vec3d& color : cornell().reference.color) sum += color.x;
  EXPECT_GT(sum / static_cast<double>(quality.pixels), 0.05);
}

TEST(Trade, CoarserSlowUnitsAreNeverBetter) {
  double previous = INFINITY;
  for (const ArithmeticMode& mode : arithmetic_modes()) {
    const double psnr = judge_frame(cornell(), record_frame(cornell(), mode.mode)).psnr_same_paths;
    if (mode.mode.slow_unit != SlowUnit::Exact) {
      EXPECT_LT(psnr, previous + 0.1) << mode.name;
    }
    if (mode.mode.slow_unit == SlowUnit::Newton0) {
      EXPECT_LT(psnr, 75) << mode.name << " must show";
    }
    previous = psnr;
  }
}

TEST(Trade, EngineFunctionalDrawsTheSamePicturesInEveryMode) {
  for (const ArithmeticMode& mode : arithmetic_modes()) {
    ExtremeFrame frame;
    frame.scene = cornell().scene;
    frame.width = cornell().width;
    frame.height = cornell().height;
    frame.depth = cornell().depth;
    const ExtremeMachine functional("functional", mode, load_configuration("4w4c"), make_functional_unit);
    EXPECT_TRUE(functional.draw(frame).frame == record_frame(cornell(), mode.mode).frame) << mode.name;
  }
}

/// The quality of a machine with kernels that do something wrong.
Quality with(const std::function<void(RayKernel, NativeThread&)>& spoil) {
  return judge_frame(cornell(), record_frame(cornell(), {}, [&](RayKernel which, NativeThread& thread) {
                       run_native(which, thread);
                       spoil(which, thread);
                     }));
}

TEST(TradeFinds, WrongTriangles) {
  // Eye rays that go astray by a hundredth.
  const Quality quality = with([](RayKernel which, NativeThread& thread) {
    if (which != RayKernel::CastEye) return;
    for (Ray& ray : thread.rays) ray[word::kDirection] = as_bits(as_float(ray[word::kDirection]) + 0.01f);
  });
  EXPECT_GT(quality.wrong_triangles, 50u);
  EXPECT_GT(quality.off_by_more, 50u);
}

TEST(TradeFinds, Holes) {
  const Quality quality = with([](RayKernel which, NativeThread& thread) {
    if (which != RayKernel::CastEye || thread.thread % 32 != 0) return;
    for (Ray& ray : thread.rays) ray[word::kLimit] = as_bits(0.5f);
  });
  EXPECT_EQ(quality.holes, quality.pixels / 32);
}

TEST(TradeFinds, WrongShadows) {
  // Shadow rays that begin beneath their surface.
  const Quality quality = with([](RayKernel which, NativeThread& thread) {
    if (which != RayKernel::CastSecondary) return;
    for (Ray& ray : thread.rays) {
      if ((ray[word::kFlags] & kShadowFlag) == 0) continue;
      for (int axis = 0; axis < 3; ++axis) {
        const auto o = static_cast<size_t>(word::kOrigin + axis), n = static_cast<size_t>(word::kNormal + axis);
        const float back = as_float(ray[o]) - 0.01f * as_float(thread.input[n]);
        ray[o] = as_bits(back);
      }
    }
  });
  EXPECT_GT(quality.wrong_shadows, 500u);
}

TEST(TradeFinds, NanPixels) {
  const Quality quality = with([](RayKernel which, NativeThread& thread) {
    if (which != RayKernel::CastSecondary || (thread.input[word::kPixel] & 0xffffu) != 7) return;
    for (Ray& ray : thread.rays) ray[word::kColor + 1] = arith::kQuietNan;
  });
  EXPECT_GT(quality.nan_pixels, 20u);
  EXPECT_LE(quality.nan_pixels, 48u);
}

TEST(TradeFinds, OneStepOfEightBits) {
  // Brighter by a thousandth: a step at most.
  const Quality quality = with([](RayKernel which, NativeThread& thread) {
    if (which != RayKernel::CastSecondary) return;
    for (Ray& ray : thread.rays) {
      if ((ray[word::kFlags] & kShadowFlag) == 0) continue;
      for (size_t i = 0; i < 3; ++i) ray[word::kColor + i] = as_bits(as_float(ray[word::kColor + i]) * 1.001f);
    }
  });
  EXPECT_GT(quality.off_by_one, quality.pixels / 50);
  EXPECT_LT(quality.off_by_more, quality.pixels / 100);
  EXPECT_LT(quality.psnr_same_paths, 85);
}

TEST(Reference, AgreesWithTheTraversalButForTies) {
  // Rays of a frame, each judged exactly.
  for (double distance : {0.0, 1e4}) {
    ExtremeFrame frame;
    frame.scene = moved(make_cornell(0.2), 1, {distance, -distance, distance});
    frame.width = frame.height = 48;
    frame.depth = 3;
    EXPECT_NO_THROW(require_right_hits(
        ExtremeMachine("native", arithmetic_modes().front(), load_configuration("4w4c")).draw(frame), frame.scene));
  }
}

TEST(Reference, HitsAtTheExactPlane) {
  const Scene scene = scene_of_triangles(square(1, -3));
  const ReferenceTracer tracer(scene);
  const DoubleHit hit = tracer.nearest({0.25, 0.125, 0}, {0, 0, -2}, INFINITY);
  EXPECT_EQ(hit.triangle, 0u);
  EXPECT_EQ(hit.t, 1.5);
  EXPECT_EQ(tracer.nearest({2, 0, 0}, {0, 0, -1}, INFINITY).triangle, kNoTriangle);
  EXPECT_EQ(tracer.occluder({0, 0, 0}, {0, 0, -1}, 3), kNoTriangle) << "the limit is exclusive";
  EXPECT_NE(tracer.occluder({0, 0, 0}, {0, 0, -1}, 3.0000000001), kNoTriangle);
}

TEST(Cost, GatesComeFromReportsWithTheSameLanes) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::path(testing::TempDir()) / "raypool_gates";
  fs::remove_all(folder);
  const arith::Mode exact, coarse{Subnormals::Ieee, SlowUnit::Newton0},
      fused{Subnormals::Ieee, SlowUnit::Newton0, true};
  EXPECT_FALSE(read_gates(folder, exact)) << "no folder";
  auto now = fs::file_time_type::clock::now();
  auto write = [&](const std::string& name, const std::string& text) {
    fs::create_directories(folder / name);
    std::ofstream(folder / name / "report.json") << text;
    fs::last_write_time(folder / name / "report.json", now += std::chrono::seconds(1));
  };
  write("broken", "{\"lanes\": [");
  write("other", "{\"lanes\": 7, \"parameters\": {\"SUBNORMALS\": \"0\", \"FMA\": \"0\"}}");
  EXPECT_FALSE(read_gates(folder, exact)) << "nothing that can be read";
  auto report = [](int slow_unit, int fma, double flt, double slw) {
    return fmt::format(
        "{{\"parameters\": {{\"WARPS\": \"1\", \"SUBNORMALS\": \"0\", \"SIGNIFICAND\": \"24\", \"SLOW_UNIT\": \"{}\", "
        "\"FMA\": \"{}\"}}, "
        "\"lanes\": {{\"Flt lane\": {{\"kge\": {}}}, \"Slw lane\": {{\"kge\": {}}}}}}}",
        slow_unit, fma, flt, slw);
  };
  write("a", report(0, 0, 14.5, 47));
  write("b", report(3, 0, 14.5, 9));
  ASSERT_TRUE(read_gates(folder, exact));
  EXPECT_EQ(read_gates(folder, exact)->flt_kge, 14.5);
  EXPECT_EQ(read_gates(folder, exact)->slw_kge, 47);
  ASSERT_TRUE(read_gates(folder, coarse));
  EXPECT_EQ(read_gates(folder, coarse)->total(), 23.5);
  EXPECT_FALSE(read_gates(folder, fused)) << "no report has its Flt lane";
  write("c", report(0, 1, 20, 46));
  ASSERT_TRUE(read_gates(folder, fused)) << "its lanes are in two reports";
  EXPECT_EQ(read_gates(folder, fused)->total(), 29);
  EXPECT_EQ(read_gates(folder, exact)->slw_kge, 46) << "the newest wins";
  EXPECT_FALSE(read_gates(folder, arithmetic_modes()[1].mode));
  EXPECT_FALSE(read_gates(folder, arithmetic_modes().back().mode)) << "other significands have other lanes";
  fs::remove_all(folder);
}

TEST(Cost, AnEngineWithoutTimeHasNoTiming) {
  EXPECT_FALSE(time_mode(make_cornell(0.05), 2, load_configuration("4w4c"), make_functional_unit));
}

TEST(Report, UnknownCostsAreDashesAndNull) {
  TradeResult result;
  result.configuration = "4w4c";
  for (const ArithmeticMode& mode : arithmetic_modes()) {
    result.rows.push_back({"scene", mode, {}});
    result.rows.back().quality.pixels = 100;
    result.costs.push_back({mode, std::nullopt, std::nullopt});
  }
  EXPECT_NE(trade_table(result).find("ieee-exact                    -        -        -        -        -"),
            std::string::npos)
      << trade_table(result);
  EXPECT_NE(to_json(result, {}, {}, {}, {}, {}).find("\"cycles_per_ray\": null"), std::string::npos);
}

TEST(Offset, TheRuleInUseHasNoAcneAndMovesNextToNothing) {
  // Small pictures of what `raypool numerics` prints in full.
  const std::vector<OffsetRule> rules = offset_rules();
  const size_t in_use = rules.size() - 3, hardware = rules.size() - 2, integer = rules.size() - 1;
  ASSERT_EQ(rules[in_use].name, "in use");
  ASSERT_TRUE(rules[hardware].hardware);
  ASSERT_EQ(rules[integer].name, "integer");
  uint64_t none_acne = 0, wrong = 0, integer_wrong = 0, shadows = 0;
  for (const OffsetScene& scene : offset_scenes()) {
    if (scene.name == "room") continue;
    const auto counts = study_offsets(scene.scene, {rules.front(), rules[in_use], rules[hardware], rules[integer]}, 64);
    for (const size_t own : {1, 2}) {
      EXPECT_EQ(counts[own].acne + counts[own].self_hits, 0u) << scene.name;
      wrong += counts[own].wrong();
    }
    none_acne += counts[0].acne;
    integer_wrong += counts[3].wrong();
    shadows += counts[1].shadow_rays;
  }
  EXPECT_GT(none_acne, shadows / 20) << "without an offset surfaces shadow themselves";
  EXPECT_LE(wrong, shadows / 2000);
  EXPECT_GT(integer_wrong, 10 * wrong);
  EXPECT_LE(offset_instructions().in_use, offset_instructions().fixed + 7);
  EXPECT_LT(offset_instructions().in_use, offset_instructions().integer);
}

}  // namespace
}  // namespace raypool::numerics
