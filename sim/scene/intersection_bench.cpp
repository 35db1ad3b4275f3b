#include "scene/intersection_bench.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <ctime>
#include <thread>

#include "scene/embree_scene.hpp"
#include "scene/native_renderer.hpp"

namespace raypool {
namespace {

constexpr size_t kRaysATime = 1024;  ///< that a thread takes

struct Measured {
  double seconds = 0;
  uint64_t hits = 0;
};

double thread_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// trace(ray) -> whether it hits; every ray once, on so many threads.
template <typename Trace>
Measured measure(const std::vector<RayQuery>& rays, uint32_t threads, bool processor_time, const Trace& trace) {
  std::atomic<size_t> next{0};
  std::vector<Measured> parts(threads);
  const auto work = [&](uint32_t index) {
    const double begin = thread_seconds();
    Measured part;
    for (size_t first = next.fetch_add(kRaysATime); first < rays.size(); first = next.fetch_add(kRaysATime)) {
      const size_t end = std::min(first + kRaysATime, rays.size());
      for (size_t i = first; i < end; ++i) part.hits += trace(rays[i]) ? 1 : 0;
    }
    part.seconds = thread_seconds() - begin;
    parts[index] = part;
  };
  const auto begin = std::chrono::steady_clock::now();
  std::vector<std::thread> others;
  for (uint32_t i = 1; i < threads; ++i) others.emplace_back(work, i);
  work(0);
  for (std::thread& other : others) other.join();
  const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  Measured sum;
  for (const Measured& part : parts) {
    sum.hits += part.hits;
    sum.seconds += part.seconds / threads;
  }
  if (!processor_time) sum.seconds = wall;
  return sum;
}

/// One side's time for the rays of each kind, and at the end of all kinds, in each turn.
struct Side {
  std::vector<std::vector<double>> seconds;  ///< [kind][turn]
  std::vector<uint64_t> hits;                ///< [kind]

  explicit Side(size_t kinds) : seconds(kinds + 1), hits(kinds + 1) {}
  void add(size_t kind, const Measured& measured) {
    seconds[kind].push_back(measured.seconds);
    hits[kind] = measured.hits;
  }
  void add_all() {
    const size_t all = seconds.size() - 1;
    double sum = 0;
    hits[all] = 0;
    for (size_t kind = 0; kind < all; ++kind) {
      sum += seconds[kind].back();
      hits[all] += hits[kind];
    }
    seconds[all].push_back(sum);
  }
};

Rate rays_a_second(uint64_t rays, std::vector<double> seconds) {
  for (double& value : seconds) value = static_cast<double>(rays) / std::max(value, 1e-9);
  return rate_of(std::move(seconds));
}

Rate ratio_of(const std::vector<double>& ours, const std::vector<double>& theirs) {
  std::vector<double> ratios;
  for (size_t i = 0; i < ours.size(); ++i) ratios.push_back(theirs[i] / std::max(ours[i], 1e-9));
  return rate_of(std::move(ratios));
}

}  // namespace

Rate rate_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const auto quantile = [&](double share) {
    const double place = share * static_cast<double>(values.size() - 1);
    const auto below = static_cast<size_t>(place);
    const size_t above = std::min(below + 1, values.size() - 1);
    return values[below] + (values[above] - values[below]) * (place - std::floor(place));
  };
  return {quantile(0.5), quantile(0.25), quantile(0.75)};
}

std::vector<BenchRays> rays_of_frame(const Scene& scene, const Tracer& tracer, uint32_t width, uint32_t height,
                                     uint32_t depth) {
  std::vector<BenchRays> kinds{{"eye", false, {}}, {"reflection", false, {}}, {"shadow", true, {}}};
  NativeOptions options;
  options.width = width;
  options.height = height;
  options.depth = depth;
  options.trace = [&](const Ray& ray, Intersection& intersection) {
    const bool shadow = (ray[word::kFlags] & kShadowFlag) != 0;
    kinds[shadow ? 2 : (ray[word::kFlags] & kDepthMask) == 1 ? 0 : 1].rays.push_back(to_query(ray));
    return tracer.trace(ray, intersection);
  };
  render_native(scene, build_memory(ray_kernel_program(), scene), tracer, options);
  return kinds;
}

std::vector<BenchRow> bench_intersection(const Scene& scene, const Traversal& traversal,
                                         const std::vector<BenchRays>& rays, const IntersectionBenchOptions& options) {
  const EmbreeScene embree(scene);
  std::vector<uint32_t> thread_counts{1};
  if (options.threads > 1) thread_counts.push_back(options.threads);
  std::vector<BenchRow> rows;
  size_t turns_done = 0;
  for (const uint32_t threads : thread_counts) {
    Side ours(rays.size()), theirs(rays.size());
    uint64_t all = 0;
    for (uint32_t turn = 0; turn < options.repetitions; ++turn) {
      for (size_t kind = 0; kind < rays.size(); ++kind) {
        const bool any = rays[kind].any;
        ours.add(kind, measure(rays[kind].rays, threads, options.processor_time, [&](const RayQuery& ray) {
                   Hit hit;
                   return any ? traversal.occluded(ray) : traversal.nearest(ray, hit);
                 }));
        theirs.add(kind, measure(rays[kind].rays, threads, options.processor_time, [&](const RayQuery& ray) {
                     Hit hit;
                     return any ? embree.occluded(ray) : embree.nearest(ray, hit);
                   }));
      }
      ours.add_all();
      theirs.add_all();
      ++turns_done;
      if (options.progress)
        options.progress(static_cast<double>(turns_done) /
                         static_cast<double>(options.repetitions * thread_counts.size()));
    }
    for (size_t kind = 0; kind <= rays.size(); ++kind) {
      const bool sum = kind == rays.size();
      const uint64_t count = sum ? all : rays[kind].rays.size();
      all += sum ? 0 : count;
      if (count == 0) continue;
      rows.push_back({sum ? "all" : rays[kind].kind, count, threads, ours.hits[kind], theirs.hits[kind],
                      rays_a_second(count, ours.seconds[kind]), rays_a_second(count, theirs.seconds[kind]),
                      ratio_of(ours.seconds[kind], theirs.seconds[kind])});
    }
  }
  return rows;
}

}  // namespace raypool
