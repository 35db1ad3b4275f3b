// Comparison with Embree, and the exact judge.
#include "scene/hits_check.hpp"

#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <stdexcept>

#include "scene/embree_scene.hpp"
#include "scene/native_renderer.hpp"

namespace raypool {
namespace {

// Differences and products of three floats fit in 113 bits unless their magnitudes lie
// far apart, so signs come out exact.
using Quad = __float128;

/// Nearer to an edge than this share of the triangle is on it, however near and large the triangle is.
constexpr double kBorder = 1e-6;
/// Two t this near, relatively, are equal to single precision.
constexpr double kSameT = 2e-6;

template <typename T>
Vector3<Quad> quad(const Vector3<T>& v) {
  return v.template as<Quad>();
}

std::string describe(const HitAnswer& answer) {
  return answer.hit ? fmt::format("triangle {} at t {:.9g}", answer.triangle, answer.t) : "no hit";
}

std::string describe(const ExactHit& exact) {
  const char* names[] = {"inside", "on the border", "outside", "edge-on or without area"};
  return fmt::format("{}, t {:.12g}, margin {:.3g}", names[static_cast<int>(exact.passage)], exact.t, exact.margin);
}

void settle(HitVerdict verdict, const std::string& line, HitCounts& counts, HitsReport& report,
            size_t max_explanations) {
  if (verdict == HitVerdict::Tie) {
    ++counts.ties;
    return;
  }
  ++(verdict == HitVerdict::OursWrong ? counts.ours_wrong : counts.embree_wrong);
  if (report.explanations.size() < max_explanations) {
    report.explanations.push_back((verdict == HitVerdict::OursWrong ? "OURS WRONG " : "Embree wrong ") + line);
  }
}

}  // namespace

HitVerdict judge_hits(const Scene& scene, const ExactRay& ray, const HitAnswer& ours, const HitAnswer& embree,
                      std::string& reason) {
  ExactHit exact[2];
  const HitAnswer* answers[2] = {&ours, &embree};
  const HitVerdict wrong[2] = {HitVerdict::OursWrong, HitVerdict::EmbreeWrong};
  for (int i = 0; i < 2; ++i) {
    if (!answers[i]->hit) continue;
    exact[i] = exact_hit(scene, answers[i]->triangle, ray);
    // Where the limits 0 and ray.limit cut is decided to single precision only.
    const double t = exact[i].t, limit = ray.limit, slack = kSameT * std::max(1.0, std::isfinite(limit) ? limit : t);
    if (exact[i].passage == Passage::Inside && (t <= slack || t >= limit - slack)) exact[i].passage = Passage::Border;
    if (t < -slack || t > limit + slack) exact[i].passage = Passage::Outside;
    reason += fmt::format("; exactly, {} passes triangle {} {}", i == 0 ? "ours" : "Embree's", answers[i]->triangle,
                          describe(exact[i]));
  }
  auto hits = [&](int i) { return answers[i]->hit && exact[i].passage <= Passage::Border; };
  for (int i = 0; i < 2; ++i) {
    if (answers[i]->hit && !hits(i)) return wrong[i];
  }
  if (ours.hit && embree.hit) {
    const double gap = std::fabs(exact[0].t - exact[1].t);
    if (gap <= kSameT * std::max(std::fabs(exact[0].t), std::fabs(exact[1].t))) return HitVerdict::Tie;
    const int nearer = exact[0].t < exact[1].t ? 0 : 1;
    // The nearer hit counts when it is a hit beyond doubt; on its border the ray may as well pass by.
    return exact[nearer].passage == Passage::Inside ? wrong[1 - nearer] : HitVerdict::Tie;
  }
  const int hitting = ours.hit ? 0 : 1;
  return exact[hitting].passage == Passage::Inside ? wrong[1 - hitting] : HitVerdict::Tie;
}

ExactHit exact_hit(const Scene& scene, uint32_t triangle, const ExactRay& ray) {
  const Vector3<Quad> origin = quad(ray.origin), direction = quad(ray.direction);
  const Vector3<Quad> a = quad(scene.corner(triangle, 0)) - origin, b = quad(scene.corner(triangle, 1)) - origin,
                      c = quad(scene.corner(triangle, 2)) - origin;
  const Quad u = dot(direction, cross(c, b)), v = dot(direction, cross(a, c)), w = dot(direction, cross(b, a));
  const Quad sum = u + v + w;
  ExactHit result;
  const Vector3<Quad> normal = cross(b - a, c - a);
  const double normal_length = std::sqrt(static_cast<double>(dot(normal, normal)));
  const double direction_length = std::sqrt(static_cast<double>(dot(direction, direction)));
  // Below the resolution of single precision the direction lies in the triangle's plane.
  if (!(std::fabs(static_cast<double>(sum)) > 1e-12 * normal_length * direction_length)) {
    result.passage = Passage::Parallel;
    return result;
  }
  result.margin = static_cast<double>(std::min(u / sum, std::min(v / sum, w / sum)));
  result.t = static_cast<double>(dot(normal, a) / dot(normal, direction));
  // How far single precision can move the ray, as a share of the triangle: its coordinates' rounding against its
  // smallest height, seen along the ray.
  double reach = 0, longest = 0;
  for (const Vector3<Quad>& corner : {a, b, c})
    reach = std::max(reach, std::sqrt(static_cast<double>(dot(corner, corner))));
  for (const Vector3<Quad>& edge : {b - a, c - b, a - c})
    longest = std::max(longest, std::sqrt(static_cast<double>(dot(edge, edge))));
  const double seen_height = std::fabs(static_cast<double>(sum)) / direction_length / longest;
  const double border = std::max(kBorder, 4 * 0x1p-24 * reach / seen_height);
  result.passage = result.margin > border     ? Passage::Inside
                   : result.margin >= -border ? Passage::Border
                                              : Passage::Outside;
  return result;
}

namespace {

/// Both sides on the rays of one frame.
class HitsComparison {
 public:
  HitsComparison(const Scene& scene, const HitsOptions& options)
      : scene_(scene),
        options_(options),
        arguments_(camera_arguments(scene, options.width, options.height, 1)),
        image_(build_memory({}, scene)),
        tracer_(scene, image_.material_base),
        embree_(scene) {}

  HitsReport run() {
    const std::vector<Ray> rays = eye_rays();
    find_nearest(rays);
    std::vector<Ray> shadow_rays;
    for (size_t i = 0; i < rays.size(); ++i) {
      judge_nearest(rays[i], ours_[i], theirs_[i]);
      NativeThread thread;
      if (!tracer_.trace(rays[i], thread.input)) continue;
      run_kernel(RayKernel::CastSecondaryDirect, thread);
      shadow_rays.insert(shadow_rays.end(), thread.rays.begin(), thread.rays.end());
    }
    for (const Ray& ray : shadow_rays) compare_occlusion(ray);
    return report_;
  }

 private:
  void run_kernel(RayKernel kernel, NativeThread& thread) {
    thread.arguments = &arguments_;
    thread.memory = &image_.memory;
    options_.kernel ? options_.kernel(kernel, thread) : run_native(kernel, thread);
  }

  // One a tile.
  std::vector<Ray> eye_rays() {
    std::vector<Ray> rays;
    for (int y = 0; y < options_.height; ++y) {
      for (int x = 0; x < options_.width; ++x) {
        NativeThread thread;
        thread.block = static_cast<uint32_t>(x) | static_cast<uint32_t>(y) << 16;
        run_kernel(RayKernel::CastEye, thread);
        rays.insert(rays.end(), thread.rays.begin(), thread.rays.end());
      }
    }
    return rays;
  }

  void find_nearest(const std::vector<Ray>& rays) {
    ours_.resize(rays.size());
    theirs_.resize(rays.size());
    for (size_t i = 0; i < rays.size(); ++i) {
      const RayQuery query = to_query(rays[i]);
      Hit hit, fast;
      ours_[i].hit = tracer_.traversal().nearest(query, hit, &report_.primary_visits);
      ours_[i].triangle = hit.triangle;
      ours_[i].t = hit.t;
      const bool fast_hit = tracer_.traversal().nearest(query, fast);
      require_same(rays[i], fast_hit == ours_[i].hit && fast.triangle == hit.triangle && fast.t == hit.t &&
                                fast.u == hit.u && fast.v == hit.v);
      theirs_[i] = embree_answer(query);
    }
  }

  // The fast way and the chip's.
  static void require_same(const Ray& ray, bool same) {
    if (same) return;
    throw std::logic_error(fmt::format("for a ray of pixel ({}, {}) our two walks of the tree find different hits",
                                       ray[word::kPixel] & 0xffffu, ray[word::kPixel] >> 16));
  }

  HitAnswer embree_answer(const RayQuery& query) const {
    Hit hit;
    const bool found = embree_.nearest(query, hit);
    return {found, hit.triangle, hit.t};
  }

  void judge_nearest(const Ray& ray, const HitAnswer& ours, const HitAnswer& theirs) {
    ++report_.primary.rays;
    if (ours.hit == theirs.hit && (!ours.hit || ours.triangle == theirs.triangle)) {
      ++report_.primary.agree;
      return;
    }
    std::string line = fmt::format("eye ray of pixel ({}, {}): ours {}, Embree {}", ray[word::kPixel] & 0xffffu,
                                   ray[word::kPixel] >> 16, describe(ours), describe(theirs));
    const HitVerdict verdict = judge_hits(scene_, to_query(ray), ours, theirs, line);
    settle(verdict, line, report_.primary, report_, options_.max_explanations);
  }

  // A blocked shadow ray names no triangle: where the sides differ, each side's nearest hit within the limit is judged.
  void compare_occlusion(const Ray& ray) {
    const RayQuery query = to_query(ray);
    HitAnswer our, their;
    our.hit = tracer_.traversal().occluded(query, &report_.shadow_visits);
    require_same(ray, tracer_.traversal().occluded(query) == our.hit);
    their.hit = embree_.occluded(query);
    ++report_.shadow.rays;
    if (our.hit == their.hit) {
      ++report_.shadow.agree;
      return;
    }
    Hit hit;
    if (our.hit && tracer_.traversal().nearest(query, hit)) our.triangle = hit.triangle, our.t = hit.t;
    const bool named = !their.hit || (their = embree_answer(query)).hit;
    std::string line =
        fmt::format("shadow ray of pixel ({}, {}): ours {}, Embree {}", ray[word::kPixel] & 0xffffu,
                    ray[word::kPixel] >> 16, describe(our), named ? describe(their) : "blocked by no triangle");
    // Embree's occlusion query without a hit of its intersection query cannot be judged, nor be right.
    const HitVerdict verdict = named ? judge_hits(scene_, query, our, their, line) : HitVerdict::EmbreeWrong;
    settle(verdict, line, report_.shadow, report_, options_.max_explanations);
  }

  const Scene& scene_;
  const HitsOptions& options_;
  const std::array<uint32_t, kArguments> arguments_;
  MemoryImage image_;
  const Tracer tracer_;
  const EmbreeScene embree_;
  std::vector<HitAnswer> ours_, theirs_;
  HitsReport report_;
};

}  // namespace

HitsReport compare_with_embree(const Scene& scene, const HitsOptions& options) {
  return HitsComparison(scene, options).run();
}

}  // namespace raypool
