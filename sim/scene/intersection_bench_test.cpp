#include "scene/intersection_bench.hpp"

#include <gtest/gtest.h>

#include <array>

#include "scene/native_renderer.hpp"

namespace raypool {
namespace {

TEST(IntersectionBench, MeasuresEveryRayOfTheFrameOnBothSides) {
  const Scene scene = make_room(0.02);
  const MemoryImage image = build_memory(ray_kernel_program(), scene);
  const Tracer tracer(scene, image.material_base);
  const std::vector<BenchRays> rays = rays_of_frame(scene, tracer, 40, 30, 3);
  NativeOptions native;
  native.width = 40, native.height = 30, native.depth = 3;
  NativeStatistics frame;
  render_native(scene, image, tracer, native, &frame);

  IntersectionBenchOptions options;
  options.threads = 3;
  options.repetitions = 2;
  double done = 0;
  options.progress = [&](double share) {
    EXPECT_GT(share, done);
    done = share;
  };
  const std::vector<BenchRow> rows = bench_intersection(scene, tracer.traversal(), rays, options);
  EXPECT_EQ(done, 1);
  ASSERT_EQ(rows.size(), 8u);
  const RayCounts& counts = frame.ray_counts;
  const RayCounts::Kind* kinds[] = {&counts.eye, &counts.reflection, &counts.shadow};
  for (size_t i = 0; i < rows.size(); ++i) {
    SCOPED_TRACE(i);
    const BenchRow& row = rows[i];
    EXPECT_EQ(row.threads, i < 4 ? 1u : 3u);
    EXPECT_EQ(row.kind, (std::array<const char*, 4>{"eye", "reflection", "shadow", "all"}[i % 4]));
    if (i % 4 < 3) {
      const RayCounts::Kind& kind = *kinds[i % 4];
      EXPECT_EQ(row.rays, kind.traced);
      EXPECT_EQ(row.our_hits, i % 4 == 2 ? kind.ended : kind.traced - kind.ended);
    } else {
      EXPECT_EQ(row.rays, counts.traced());
      EXPECT_EQ(row.our_hits, rows[i - 1].our_hits + rows[i - 2].our_hits + rows[i - 3].our_hits);
    }
    EXPECT_NEAR(static_cast<double>(row.embree_hits), static_cast<double>(row.our_hits), 3) << "but for rays at edges";
    for (const Rate& rate : {row.ours, row.embree, row.ratio}) {
      EXPECT_GT(rate.median, 0);
      EXPECT_LE(rate.lower, rate.median);
      EXPECT_GE(rate.upper, rate.median);
    }
  }
}

TEST(IntersectionBench, WithoutReflectionsThereIsNoRowOfThem) {
  const Scene scene = make_cornell(0.1);
  const Tracer tracer(scene, build_memory(ray_kernel_program(), scene).material_base);
  IntersectionBenchOptions options;
  options.repetitions = 1;
  options.processor_time = true;
  const std::vector<BenchRow> rows =
      bench_intersection(scene, tracer.traversal(), rays_of_frame(scene, tracer, 8, 8, 1), options);
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[1].kind, "shadow");
}

TEST(IntersectionBench, QuartilesLieBetweenMeasurements) {
  const Rate rate = rate_of({5, 1, 3, 2, 4});
  EXPECT_EQ(rate.median, 3);
  EXPECT_EQ(rate.lower, 2);
  EXPECT_EQ(rate.upper, 4);
  EXPECT_EQ(rate_of({7}).upper, 7);
  EXPECT_EQ(rate_of({1, 2}).median, 1.5);
}

}  // namespace
}  // namespace raypool
