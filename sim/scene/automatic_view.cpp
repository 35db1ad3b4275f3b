// A view of triangles of which nothing is known: cameras around their subject and, in an interior, among them are tried
// with a few rays each, and the one that shows most is taken; then lights. docs/use/views.md describes the rule.
// Scores are rounded before they are compared, so that every machine chooses the same.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>

#include "scene/automatic_light.hpp"
#include "scene/enclosure.hpp"
#include "scene/scene_probe.hpp"
#include "scene/subject.hpp"

namespace raypool {
namespace {

constexpr double kInsideFov = 60, kOutsideFov = 40;
constexpr double kNear = 1.0;      // of the box's middle side: what is nearer counts less, down to nothing at the eye
constexpr double kBackSide = 0.5;  // what a surface's back counts, its front being 1
constexpr double kAmong = 0.85;    // what a view from among the triangles counts: less of the whole is in it
constexpr double kWide = 0.9;      // what a wider angle counts, each step of kWiderFovs
constexpr double kDeep = 0.25;     // of the distance of the subject's far side: as far away its near side should be
constexpr double kMargin = 1.04;   // of the picture, around what must be in it
constexpr double kWideMargin = 1.15;                         // the same where there is more around it
constexpr std::array<double, 3> kWiderFovs = {60, 85, 110};  // where the eye has no room for kOutsideFov

/// Where the places of the camera are counted from.
struct Axes {
  Vec3d right, up, back;
};

/// Models face +z as a rule, or -y where z is up.
Axes axes_of(const Vec3& up_word) {
  const Vec3d up = normalized(up_word.as<double>());
  Vec3d back = std::fabs(up.z) > 0.9 ? Vec3d{0, -1, 0} : Vec3d{0, 0, 1};
  back = normalized(back - up * dot(back, up));
  return {cross(up, back), up, back};
}

/// Horizontal direction, `step` sixteenths of a turn from back towards right, tilted up by `slope`.
Vec3d direction(const Axes& axes, int step, double slope) {
  constexpr std::array<double, 5> kSine = {0, 0.38268343236508977, 0.70710678118654752, 0.92387953251128674, 1};
  const auto sine = [&](int s) {
    const int k = (s % 16 + 16) % 16, half = k % 8;
    const double value = kSine[half <= 4 ? half : 8 - half];
    return k < 8 ? value : -value;
  };
  return normalized(axes.right * sine(step) + axes.back * sine(step + 4) + axes.up * slope);
}

bool within_reach(const Vec3d& eye) {
  return std::max({std::fabs(eye.x), std::fabs(eye.y), std::fabs(eye.z)}) <= kLargestCoordinate;
}

class Viewfinder {
 public:
  Viewfinder(const Scene& scene, const ViewChanges& changes)
      : changes_(changes),
        probe_(scene),
        axes_(axes_of(changes.up.value_or(Vec3{0, 1, 0}))),
        room_(probe_.bounds(), axes_.up),
        shells_(shells_of(scene)),
        subject_(find_subject(scene, shells_)) {
    if (subject_.vertices.empty()) subject_.box = room_.box();
    near_ = std::max(kNear * subject_.box.nth_extent(1), 1e-3 * length(subject_.box.extent()));
  }

  View find() {
    View view;
    view.camera = best_camera();
    if (changes_.light) return view;
    const Vec3d eye = view.camera.eye.as<double>();
    const bool inside = room_.contains(eye) && !subject_.has_surroundings;
    const double distance = inside ? 0.5 * room_.box().nth_extent(2) : length(subject_.box.centre() - eye);
    view.light.position = automatic_light(probe_, view.camera, distance, inside ? &room_ : nullptr);
    return view;
  }

 private:
  struct Candidate {
    Camera camera;
    double prior = 1;
    double score = 0;
  };

  Camera camera(const Vec3d& eye, const Vec3d& forward, double fov) const {
    return {eye.as<float>(), forward.as<float>(), axes_.up.as<float>(), changes_.fov.value_or(static_cast<float>(fov))};
  }

  /// How much there is to see: the share of the picture that shows the subject, and into how many kinds of surface (by
  /// direction, distance and material) that falls, as an entropy. What is around the subject is one kind.
  double score(const Camera& camera, int n) const {
    std::map<std::tuple<long, long, long, int, uint32_t>, int> kinds;
    double covered = 0;
    int seen = 0;
    for (const auto& sample : probe_.picture(camera, n, n)) {
      if (!sample) continue;
      const Sample& s = *sample;
      ++seen;
      if (!subject_.triangles[s.triangle]) {
        ++kinds[{0, 0, 0, 0, UINT32_MAX}];
        continue;
      }
      covered += (s.front ? 1 : kBackSide) * std::min(1.0, s.distance / near_);
      int octave = 0;
      const double mantissa = std::frexp(s.distance / length(subject_.box.extent()), &octave);
      const auto sector = [](double c) { return std::lround(2.4 * c); };
      ++kinds[{sector(s.normal.x), sector(s.normal.y), sector(s.normal.z), 2 * octave + (mantissa > 0.7),
               probe_.scene().triangle_materials[s.triangle]}];
    }
    double entropy = 0;
    for (const auto& [kind, count] : kinds) {
      const double share = static_cast<double>(count) / seen;
      entropy -= share * std::log(share);
    }
    return std::sqrt(covered / (n * n)) * (1 + entropy);
  }

  struct Fit {
    Vec3d eye;
    double depth;  // distance of the subject's near side along the view, of that of its far side
  };

  /// The nearest eye in direction `from` of the subject that has all of it in a square picture; seen from there, the
  /// subject touches the picture's borders on both sides, or above and below. `target`: what must be in the middle.
  Fit fit(const Vec3d& from, double half, const std::optional<Vec3d>& target) const {
    const Vec3d right = normalized(cross(axes_.up, from)), up = cross(from, right);
    const Vec3d origin = target.value_or(subject_.box.centre());
    const double slope = half / (subject_.has_surroundings ? kWideMargin : kMargin);
    // An eye at (x, y, z) of right, up and from sees v when |v.x - x| and |v.y - y| are at most slope (z - v.z).
    std::array<double, 4> most = {-INFINITY, -INFINITY, -INFINITY, -INFINITY};
    double nearest = -INFINITY, furthest = INFINITY;
    for (const Vec3d& vertex : subject_.vertices) {
      const Vec3d p = vertex - origin;
      const double x = dot(p, right), y = dot(p, up), z = dot(p, from), reach = slope * z;
      most = {std::max(most[0], reach + x), std::max(most[1], reach - x), std::max(most[2], reach + y),
              std::max(most[3], reach - y)};
      nearest = std::max(nearest, z), furthest = std::min(furthest, z);
    }
    const double least = 1e-3 * length(subject_.box.extent());
    if (target) {
      const double distance = std::max(*std::max_element(most.begin(), most.end()) / slope, least);
      return {origin + from * distance, (distance - nearest) / (distance - furthest)};
    }
    const double across = most[0] + most[1], upwards = most[2] + most[3];
    const double distance = std::max(std::max(across, upwards) / 2 / slope, least);
    return {origin + right * ((most[0] - most[1]) / 2) + up * ((most[2] - most[3]) / 2) + from * distance,
            (distance - nearest) / (distance - furthest)};
  }

  void add_around(double fov, double liking, std::vector<Candidate>& candidates) const {
    const double half = half_height(changes_.fov.value_or(static_cast<float>(fov)));
    std::optional<Vec3d> target;
    if (changes_.look_at) target = changes_.look_at->as<double>();
    for (const auto& [slope, height] : {std::pair(0.36, 1.0), std::pair(0.1, 0.93), std::pair(0.9, 0.9)}) {
      for (const int step : {1, 0, -1, 2, -2, 3, -3, 4, -4, 5, -5, 6, -6, 7, -7, 8}) {
        const Vec3d from = direction(axes_, step, slope);
        const Fit found = fit(from, half, target);
        const double facing = std::abs(step) <= 3 ? 1 : std::abs(step) <= 5 ? 0.93 : 0.86;
        const double deep = found.depth < kDeep ? std::sqrt(std::max(found.depth, 0.0) / kDeep) : 1;
        if (!within_reach(found.eye)) continue;
        const Vec3d forward = target ? *target - found.eye : from * -1.0;
        candidates.push_back({camera(found.eye, forward, fov), liking * height * facing * deep});
      }
    }
  }

  void add_outside(std::vector<Candidate>& candidates) const {
    add_around(kOutsideFov, 1, candidates);
    // What is around the subject may leave no room for the eye, and so may the largest coordinate.
    if (changes_.fov || (!subject_.has_surroundings && !candidates.empty())) return;
    double liking = 1;
    for (const double fov : kWiderFovs) add_around(fov, liking *= kWide, candidates);
  }

  void add_from(const Vec3d& eye, double fov, std::initializer_list<double> slopes,
                std::vector<Candidate>& candidates) const {
    if (changes_.look_at) {
      candidates.push_back({camera(eye, changes_.look_at->as<double>() - eye, fov), kAmong});
      return;
    }
    for (const double slope : slopes) {
      for (int step = 0; step < 16; ++step)
        candidates.push_back({camera(eye, direction(axes_, step, slope), fov), kAmong});
    }
  }

  /// Of what is seen from around the subject, the share of fronts.
  double outer_fronts(const std::vector<Candidate>& outside) const {
    int seen = 0, fronts = 0;
    for (const Candidate& candidate : outside) {
      for (const auto& sample : probe_.picture(candidate.camera, 6, 6)) {
        seen += sample.has_value();
        fronts += sample && sample->front;
      }
    }
    return seen == 0 ? 0 : static_cast<double>(fronts) / seen;
  }

  std::vector<Candidate> candidates() const {
    std::vector<Candidate> result;
    if (changes_.eye) {
      const Vec3d eye = changes_.eye->as<double>();
      const double fov = room_.contains(eye) ? kInsideFov : kOutsideFov;
      if (!changes_.look_at) result.push_back({camera(eye, subject_.box.centre() - eye, fov)});
      add_from(eye, fov, {-0.1, -0.4, 0.25, -1.0}, result);
      return result;
    }
    add_outside(result);
    if (!subject_.has_surroundings) {
      for (const Vec3d& eye : places_inside(probe_, shells_, room_, outer_fronts(result)))
        add_from(eye, kInsideFov, {-0.1, -0.3}, result);
    }
    // So large that no eye within the largest coordinate sees all of it.
    if (result.empty()) {
      for (const double along : {0.0, 1.0}) {
        for (const double across : {0.0, 1.0}) {
          const Vec3d eye = room_.place(along, 1, across);
          result.push_back({camera(eye, room_.box().centre() - eye, kWiderFovs.back())});
        }
      }
    }
    return result;
  }

  Camera best_camera() const {
    if (subject_.vertices.empty() && !changes_.eye && !changes_.look_at) {
      // No triangle has an area, and no view shows anything.
      const double distance = std::max(probe_.diagonal(), 1.0);
      return camera(room_.box().centre() + axes_.back * distance, Vec3d{} - axes_.back, kOutsideFov);
    }
    std::vector<Candidate> all = candidates();
    const auto unusable = [](const Candidate& c) {
      const Vec3d forward = c.camera.direction.as<double>(), up = c.camera.up.as<double>();
      return !(length(cross(forward, up)) > 1e-3 * length(forward) * length(up));
    };
    const Camera first = all.front().camera;
    all.erase(std::remove_if(all.begin(), all.end(), unusable), all.end());
    if (all.size() < 2) return all.empty() ? first : all.front().camera;
    // All with few rays, the best of them with many.
    for (const auto& [rays, keep] : {std::pair<int, size_t>(10, 16), std::pair<int, size_t>(32, 1)}) {
      for (Candidate& c : all) c.score = std::round(1e6 * c.prior * score(c.camera, rays));
      std::stable_sort(all.begin(), all.end(),
                       [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
      all.resize(std::min(all.size(), keep));
    }
    return all.front().camera;
  }

  const ViewChanges& changes_;
  SceneProbe probe_;
  Axes axes_;
  RoomBox room_;
  Shells shells_;
  Subject subject_;
  double near_;
};

}  // namespace

View automatic_view(const Scene& scene, const ViewChanges& changes) {
  View view;
  view.centre = scene.centre;
  // Without a direction upwards, and for an eye that looks at itself, there is nothing to find: the checks report it.
  if (length(changes.up.value_or(view.camera.up).as<double>()) > 0 &&
      !(changes.eye && changes.look_at && *changes.eye == *changes.look_at)) {
    view = Viewfinder(scene, changes).find();
    view.centre = scene.centre;
  }
  change_view(view, changes);
  return view;
}

}  // namespace raypool
