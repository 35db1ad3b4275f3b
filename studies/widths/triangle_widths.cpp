#include "widths/triangle_widths.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "bits.hpp"
#include "numerics/extremes.hpp"
#include "numerics/watertight.hpp"
#include "scene/hard_rays.hpp"
#include "scene/hits_check.hpp"
#include "scene/native_renderer.hpp"

namespace raypool::numerics {
namespace {

/// Scenes of triangles of all sizes, at scales from 2^-126 to 2^58 and up to 3000 of their sizes away from the origin.
constexpr int kSoupScales[] = {-126, -40, 0, 30, 58};
constexpr float kSoupPlaces[] = {0, 1, 3000};
constexpr int kSoupTriangles = 60, kSoupRays = 4000;

/// A unit in the last place of a float of this size.
double unit_of(double t) { return std::ldexp(1.0, std::max(std::ilogb(t), -126) - 23); }

/// Rays with the results of the engines' test and of exact arithmetic.
class JudgedRays {
 public:
  JudgedRays(const Scene& scene, const std::vector<BenchRays>& rays) : scene_(scene), rays_(rays), engines_(scene) {
    for (const BenchRays& kind : rays_) {
      for (const RayQuery& ray : kind.rays) {
        Expected expected;
        expected.hit = kind.any ? engines_.occluded(ray) : engines_.nearest(ray, expected.found);
        if (expected.hit && !kind.any) {
          const ExactHit exact = exact_hit(scene_, expected.found.triangle, ray);
          // Where a ray meets a triangle that it sees edge-on is not defined.
          if (exact.passage != Passage::Parallel && exact.t > 0) expected.t = exact.t;
        }
        expected_.push_back(expected);
      }
    }
  }

  TriangleAnswers judge(const Traversal& traversal) const {
    TriangleAnswers answers;
    const Expected* expected = expected_.data();
    for (const BenchRays& kind : rays_) {
      for (const RayQuery& ray : kind.rays) {
        ++answers.rays;
        kind.any ? judge_shadow(traversal, ray, *expected, answers) : judge_nearest(traversal, ray, *expected, answers);
        ++expected;
      }
    }
    return answers;
  }
  const Traversal& engines() const { return engines_; }

 private:
  struct Expected {
    bool hit = false;
    Hit found;
    double t = 0;  ///< exactly; 0: unknown
  };

  void differ(const RayQuery& ray, const HitAnswer& ours, const HitAnswer& engines, TriangleAnswers& answers) const {
    ++answers.other;
    std::string reason;
    const HitVerdict verdict = judge_hits(scene_, ray, ours, engines, reason);
    answers.wrong += verdict == HitVerdict::OursWrong;
    answers.right += verdict == HitVerdict::EmbreeWrong;
  }

  void judge_shadow(const Traversal& traversal, const RayQuery& ray, const Expected& expected,
                    TriangleAnswers& answers) const {
    if (traversal.occluded(ray) == expected.hit) return;
    Hit blocker;
    (expected.hit ? engines_ : traversal).nearest(ray, blocker);
    const HitAnswer blocked{true, blocker.triangle, blocker.t}, free;
    differ(ray, expected.hit ? free : blocked, expected.hit ? blocked : free, answers);
  }

  void judge_nearest(const Traversal& traversal, const RayQuery& ray, const Expected& expected,
                     TriangleAnswers& answers) const {
    Hit found;
    const bool hit = traversal.nearest(ray, found);
    if (hit != expected.hit || (hit && found.triangle != expected.found.triangle)) {
      differ(ray, {hit, found.triangle, found.t}, {expected.hit, expected.found.triangle, expected.found.t}, answers);
      return;
    }
    if (!hit) return;
    const double t = found.t, engines_t = expected.found.t;
    answers.other_t += as_bits(found.t) != as_bits(expected.found.t);
    answers.largest = std::max(answers.largest, std::fabs(t - engines_t) / unit_of(engines_t));
    if (!(expected.t > 0)) return;
    ++answers.hits;
    answers.exact += found.t == static_cast<float>(expected.t);
    const double error = std::fabs(t - expected.t) / unit_of(expected.t);
    answers.error += std::min(error, kMostError);
    answers.far_off += error >= kMostError;
  }

  const Scene& scene_;
  const std::vector<BenchRays> rays_;
  Traversal engines_;
  std::vector<Expected> expected_;
};

void add(TriangleAnswers& sum, const TriangleAnswers& part) {
  sum.rays += part.rays;
  sum.other += part.other;
  sum.wrong += part.wrong;
  sum.right += part.right;
  sum.other_t += part.other_t;
  sum.largest = std::max(sum.largest, part.largest);
  sum.hits += part.hits;
  sum.exact += part.exact;
  sum.error += part.error;
  sum.far_off += part.far_off;
}

class Soups {
 public:
  Soups() {
    uint32_t seed = 0;
    for (const int scale : kSoupScales) {
      for (const float away : kSoupPlaces) {
        const float size = std::ldexp(1.0f, scale), at = away * size;
        scenes_.push_back(soup(++seed, kSoupTriangles, size, {at, -at, at / 3}));
      }
    }
    for (const Scene& scene : scenes_) rays_.emplace_back(scene, rays_of(scene, seed));
  }
  /// `test`: null, that of the engines.
  TriangleAnswers judge(const TriangleTest* test) const {
    TriangleAnswers sum;
    for (const JudgedRays& rays : rays_) {
      Traversal traversal = rays.engines();
      if (test != nullptr) traversal.set_triangle_test(*test);
      add(sum, rays.judge(traversal));
    }
    return sum;
  }

 private:
  static std::vector<BenchRays> rays_of(const Scene& scene, uint32_t seed) {
    return {{"hard", false, hard_rays(scene, kSoupRays, seed)}};
  }
  std::vector<Scene> scenes_;
  std::vector<JudgedRays> rays_;
};

constexpr uint64_t kLarge = 400;

/// Points next to slanted triangles of 1e9, and rays from them along the triangle's normal: on which side of it is a
/// point, and how far away?
uint64_t wrong_sides(const TriangleTest* test) {
  std::mt19937 random(8);
  const auto uniform = [&] { return std::uniform_real_distribution<float>(-1e9f, 1e9f)(random); };
  uint64_t count = 0;
  for (uint64_t i = 0; i < kLarge; ++i) {
    std::array<Vec3, 3> corners;
    for (Vec3& corner : corners) corner = {uniform(), uniform(), uniform()};
    const Vec3d a = corners[0].as<double>(), side = corners[1].as<double>() - a, other = corners[2].as<double>() - a;
    const Vec3d normal = normalized(cross(side, other));
    const Vec3 origin = (a + side * 0.4 + other * 0.3).as<float>();
    const double distance = dot(normal, a - origin.as<double>());  // above zero: in front
    if (std::fabs(distance) < kLargeError) continue;
    Traversal traversal(scene_of({corners}));
    if (test != nullptr) traversal.set_triangle_test(*test);
    Hit hit;
    const bool found = traversal.nearest({origin, normal.as<float>(), INFINITY}, hit);
    count += found != (distance > 0) || (found && std::fabs(static_cast<double>(hit.t) - distance) > kLargeError);
  }
  return count;
}

uint64_t broken_cases(const TriangleTest* test) {
  ExtremeMachine machine("native", arithmetic_modes().front(), load_configuration("4w4c"));
  if (test != nullptr) machine.set_triangle_test(*test);
  const std::vector<ExtremeCase>& cases = extreme_cases();
  return static_cast<uint64_t>(std::count_if(cases.begin(), cases.end(), [&](const ExtremeCase& extreme) {
    return !run_extreme(extreme, machine).failure.empty();
  }));
}

/// A ball seen from just inside its shell, along triangles that are seen nearly edge-on.
WatertightMesh shell() {
  WatertightMesh mesh = watertight_meshes().front();
  mesh.name = "ball along its shell";
  mesh.origins.clear();
  for (size_t i = 0; i < mesh.scene.triangles.size(); i += 7) {
    const Vec3 middle = (mesh.scene.corner(i, 0) + mesh.scene.corner(i, 1) + mesh.scene.corner(i, 2)) * (1 / 3.0f);
    mesh.origins.push_back(middle * (1 - 1e-6f * std::pow(10.0f, static_cast<float>(i % 4))));
  }
  return mesh;
}

const char* name_of(TriangleTime time) {
  switch (time) {
    case TriangleTime::Floats:
      return "floats";
    case TriangleTime::Products:
      return "products";
    case TriangleTime::Plane:
      break;
  }
  return "plane";
}

}  // namespace

TriangleWidths try_triangle_widths(const Scene& scene, const TriangleWidthOptions& options) {
  const auto progress = [&](const std::string& what) {
    if (options.progress) options.progress(what);
  };
  progress("rays of the frame");
  const MemoryImage image = build_memory(ray_kernel_program(), scene);
  Tracer tracer(scene, image.material_base);
  const JudgedRays rays(scene, rays_of_frame(scene, tracer, options.width, options.height, options.depth));
  const Soups soups;
  std::vector<WatertightMesh> meshes = watertight_meshes();
  meshes.push_back(shell());
  NativeOptions native;
  native.width = options.width;
  native.height = options.height;
  native.depth = options.depth;
  const FrameBuffer picture = render_native(scene, image, tracer, native);

  TriangleWidths result;
  result.large = kLarge;
  result.cases = extreme_cases().size();
  const auto add_row = [&](TriangleTime time, uint32_t bits, const TriangleTest* test) {
    progress(bits == 0 ? "the engines' test" : fmt::format("{}, {} bits", name_of(time), bits));
    TriangleWidthRow row;
    row.time = time;
    row.bits = bits;
    Traversal traversal = rays.engines();
    if (test != nullptr) traversal.set_triangle_test(*test), tracer.set_triangle_test(*test);
    row.frame = rays.judge(traversal);
    row.soups = soups.judge(test);
    row.picture = compare(render_native(scene, image, tracer, native), picture);
    result.seam_rays = 0;
    for (const WatertightMesh& mesh : meshes) {
      const uint64_t count = options.seam_rays / meshes.size();
      row.leaks += (test != nullptr ? aim_at_seams(mesh, *test, count) : aim_at_seams(mesh, count)).leaks;
      result.seam_rays += count;
    }
    row.sides = wrong_sides(test);
    row.broken = broken_cases(test);
    result.rows.push_back(row);
  };
  add_row(TriangleTime::Floats, 0, nullptr);
  for (const TriangleTime time : options.times) {
    for (const uint32_t bits : options.bits) {
      const TriangleTest test(time, bits);
      add_row(time, bits, &test);
    }
  }
  return result;
}

std::string triangle_width_table(const TriangleWidths& tried) {
  const auto share = [](uint64_t part, uint64_t all) {
    return all == 0 ? 0 : 100 * static_cast<double>(part) / static_cast<double>(all);
  };
  const TriangleWidthRow& first = tried.rows.front();
  std::string text = fmt::format(
      "hits that are not the engines', and which of the two exact arithmetic calls wrong; t in units in its last "
      "place\n"
      "soups: {} hard rays; cracks: of {} rays at seams; sides: wrong ones, of {} points near triangles of 1e9;\n"
      "cases: broken ones, of {} of the catalogue\n"
      "              frame                                          picture         soups\n"
      "t from   bits other wrong right  other t largest  exact  mean pixels of 255 other wrong right  mean cracks "
      "sides "
      "cases\n",
      first.soups.rays, tried.seam_rays, tried.large, tried.cases);
  for (const TriangleWidthRow& row : tried.rows) {
    const TriangleAnswers &f = row.frame, &s = row.soups;
    const auto mean = [](const TriangleAnswers& a) { return a.hits == 0 ? 0 : a.error / static_cast<double>(a.hits); };
    text += fmt::format(
        "{:<8} {:>4} {:>5} {:>5} {:>5} {:>8} {:>7.0f} {:>5.1f}% {:>5.2f} {:>6} {:>6} {:>5} {:>5} {:>5} {:>5.2f} {:>6} "
        "{:>5} {:>5}\n",
        row.bits == 0 ? "engines" : name_of(row.time), row.bits == 0 ? "" : fmt::to_string(row.bits), f.other, f.wrong,
        f.right, f.other_t, f.largest, share(f.exact, f.hits), mean(f), row.picture.visible, row.picture.largest,
        s.other, s.wrong, s.right, mean(s), row.leaks, row.sides, row.broken);
  }
  return text;
}

}  // namespace raypool::numerics
