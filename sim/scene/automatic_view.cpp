// A view of triangles of which nothing is known: cameras around them and, where they enclose something, among them are
// tried with a few rays each, and the one that shows most is taken; then lights. docs/scenes.md describes the rule.
// Nothing here depends on the machine: no thread, no clock, and scores are rounded before they are compared.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>

#include "scene/scene.hpp"
#include "scene/traversal.hpp"

namespace raypool {
namespace {

constexpr double kInsideFov = 60, kOutsideFov = 40;
constexpr double kNear = 1.0;      // of the box's middle side: what is nearer counts less, down to nothing at the eye
constexpr double kBackSide = 0.5;  // what a surface's back counts, its front being 1
constexpr double kAmong = 0.85;    // what a view from among the triangles counts: less of the whole is in it
constexpr double kLeastEnclosed = 0.7;  // of the directions from a place among the triangles
constexpr double kLeastContent = 0.08;  // of what places see: surfaces that are hidden from outside on either side
constexpr double kLeastFront = 0.9;     // of what places see, in a box with nothing in it
constexpr double kLitEnough = 0.6;      // of what the eye sees

/// Where the places of camera and light are counted from.
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

/// The 26 directions to a cube's corners, edges and sides.
std::vector<Vec3d> all_around() {
  std::vector<Vec3d> directions;
  for (int i = 0; i < 27; ++i) {
    if (i != 13) directions.push_back(normalized(Vec3d{i % 3 - 1.0, i / 3 % 3 - 1.0, i / 9 - 1.0}));
  }
  return directions;
}

struct Sample {
  Vec3d point, normal;  // the normal turned towards the eye
  double distance;
  bool front;
  uint32_t material;
};

class Viewfinder {
 public:
  Viewfinder(const Scene& scene, const ViewChanges& changes)
      : scene_(scene),
        changes_(changes),
        bounds_(scene.bounds()),
        lower_(bounds_.lower.as<double>()),
        extent_(bounds_.upper.as<double>() - lower_),
        diagonal_(std::max(length(extent_), 1e-6)),
        axes_(axes_of(changes.up.value_or(Vec3{0, 1, 0}))),
        traversal_(scene) {
    for (const int axis : {0, 1, 2}) {
      if (std::fabs(axes_.up[axis]) > std::fabs(axes_.up[vertical_])) vertical_ = axis;
    }
    const double largest = std::max({extent_.x, extent_.y, extent_.z}),
                 least = std::min({extent_.x, extent_.y, extent_.z});
    near_ = std::max(kNear * (extent_.x + extent_.y + extent_.z - largest - least), 1e-3 * diagonal_);
    const int a = (vertical_ + 1) % 3, b = (vertical_ + 2) % 3;
    along_ = extent_[a] >= extent_[b] ? a : b;
  }

  View find() {
    View view;
    view.camera = best_camera();
    if (!changes_.light) view.light.position = light(view.camera);
    return view;
  }

 private:
  struct Candidate {
    Camera camera;
    double prior = 1;
    double score = 0;
  };

  /// From 0 to 1 on each axis of the box.
  Vec3d place(double along, double height, double across) const {
    Vec3d share;
    share[vertical_] = axes_.up[vertical_] > 0 ? height : 1 - height;
    share[along_] = along;
    share[3 - vertical_ - along_] = across;
    return {lower_.x + share.x * extent_.x, lower_.y + share.y * extent_.y, lower_.z + share.z * extent_.z};
  }

  bool inside(const Vec3d& p) const {
    const Vec3d d = p - lower_;
    return d.x >= 0 && d.y >= 0 && d.z >= 0 && d.x <= extent_.x && d.y <= extent_.y && d.z <= extent_.z;
  }

  Camera camera(const Vec3d& eye, const Vec3d& forward, double fov) const {
    return {eye.as<float>(), forward.as<float>(), axes_.up.as<float>(), changes_.fov.value_or(static_cast<float>(fov))};
  }

  bool hit(const Vec3d& from, const Vec3d& towards, Sample& sample) const {
    Hit found;
    if (!traversal_.nearest({from.as<float>(), towards.as<float>(), INFINITY}, found)) return false;
    const Vec3d normal = found.normal.as<double>();
    const double distance = found.t;
    const bool front = dot(normal, towards) < 0;
    sample = {from + towards * distance, front ? normal : normal * -1.0, distance, front,
              scene_.triangle_materials[found.triangle]};
    return true;
  }

  /// What an n x n grid of rays of a square picture hits.
  std::vector<Sample> look(const Camera& camera, int n) const {
    const Vec3d eye = camera.eye.as<double>(), forward = normalized(camera.direction.as<double>());
    const Vec3d right = normalized(cross(forward, camera.up.as<double>())), up = cross(right, forward);
    const double half = half_height(camera.fov);
    std::vector<Sample> samples;
    for (int i = 0; i < n * n; ++i) {
      const double x = (2 * (i % n) + 1.0) / n - 1, y = (2 * (i / n) + 1.0) / n - 1;
      Sample sample;
      if (hit(eye, normalized(forward + right * (x * half) + up * (y * half)), sample)) samples.push_back(sample);
    }
    return samples;
  }

  /// In float, which hides that the libraries' tangents differ in the last place.
  static double half_height(float fov) {
    return static_cast<double>(static_cast<float>(std::tan(fov * 0.5 * 3.14159265358979323846 / 180)));
  }

  /// How much there is to see: the share of the picture that shows something, and into how many kinds of surface (by
  /// direction, distance and material) it falls, as an entropy.
  double score(const Camera& camera, int n) const {
    std::map<std::tuple<long, long, long, int, uint32_t>, int> kinds;
    double covered = 0;
    int seen = 0;
    for (const Sample& s : look(camera, n)) {
      covered += (s.front ? 1 : kBackSide) * std::min(1.0, s.distance / near_);
      ++seen;
      int octave = 0;
      const double mantissa = std::frexp(s.distance / diagonal_, &octave);
      const auto sector = [](double c) { return std::lround(2.4 * c); };
      ++kinds[{sector(s.normal.x), sector(s.normal.y), sector(s.normal.z), 2 * octave + (mantissa > 0.7), s.material}];
    }
    double entropy = 0;
    for (const auto& [kind, count] : kinds) {
      const double share = static_cast<double>(count) / seen;
      entropy -= share * std::log(share);
    }
    return std::sqrt(covered / (n * n)) * (1 + entropy);
  }

  /// How far from `target` the eye must be to have all vertices in a square picture.
  double distance_to_fit(const Vec3d& target, const Vec3d& from, double half) const {
    const Vec3d right = normalized(cross(axes_.up, from)), up = cross(from, right);
    double distance = 0;
    for (const auto& triangle : scene_.triangles) {
      const Vec3d p = scene_.vertices[triangle[0]].as<double>() - target,
                  q = scene_.vertices[triangle[1]].as<double>() - target,
                  r = scene_.vertices[triangle[2]].as<double>() - target;
      for (const Vec3d& v : {p, q, r}) {
        distance = std::max(distance, std::max(std::fabs(dot(v, right)), std::fabs(dot(v, up))) / half + dot(v, from));
      }
    }
    return std::max(1.04 * distance, 1e-3 * diagonal_);
  }

  void add_outside(std::vector<Candidate>& candidates) const {
    const Vec3d centre = lower_ + extent_ * 0.5, target = changes_.look_at ? changes_.look_at->as<double>() : centre;
    const float fov = changes_.fov.value_or(static_cast<float>(kOutsideFov));
    for (const auto& [slope, liking] : {std::pair(0.36, 1.0), std::pair(0.1, 0.97), std::pair(0.9, 0.9)}) {
      for (const int step : {1, 0, -1, 2, -2, 3, -3, 4, -4, 5, -5, 6, -6, 7, -7, 8}) {
        const Vec3d from = direction(axes_, step, slope);
        const Vec3d eye = target + from * distance_to_fit(target, from, half_height(fov));
        const double facing = std::abs(step) <= 3 ? 1 : std::abs(step) <= 5 ? 0.93 : 0.86;
        candidates.push_back({camera(eye, target - eye, fov), liking * facing});
      }
    }
  }

  /// Places among the triangles with triangles around them; empty when that is but the inside of something solid, where
  /// the surfaces' other sides are all that is seen from outside.
  std::vector<Vec3d> places_inside() const {
    const std::vector<Vec3d> around = all_around();
    std::vector<Vec3d> places;
    int seen = 0, hidden = 0, fronts = 0;
    for (const double height : {0.55, 0.4}) {
      for (const double along : {0.08, 0.92, 0.28, 0.72, 0.5}) {
        for (const double across : {0.3, 0.7, 0.5, 0.12, 0.88}) {
          const Vec3d eye = place(along, height, across);
          std::vector<Sample> samples;
          bool free = true;
          for (const Vec3d& towards : around) {
            Sample sample;
            if (!hit(eye, towards, sample)) continue;
            free &= sample.distance > 0.005 * diagonal_;
            samples.push_back(sample);
          }
          if (!free || static_cast<double>(samples.size()) < kLeastEnclosed * static_cast<double>(around.size()))
            continue;
          places.push_back(eye);
          for (const Sample& sample : samples) {
            ++seen;
            hidden += !exposed(sample, around);
            fronts += sample.front;
          }
        }
      }
    }
    const bool furnished = hidden > kLeastContent * seen, room = fronts > kLeastFront * seen && is_box();
    return furnished || room ? places : std::vector<Vec3d>();
  }

  /// The side that the eye does not see has the open before it.
  bool exposed(const Sample& sample, const std::vector<Vec3d>& around) const {
    const Vec3d origin = sample.point - sample.normal * (1e-4 * diagonal_);
    int tried = 0, open = 0;
    for (const Vec3d& towards : around) {
      if (dot(towards, sample.normal) > -0.2) continue;
      ++tried;
      open += !traversal_.occluded({origin.as<float>(), towards.as<float>(), INFINITY});
    }
    return 4 * open > tried;
  }

  /// Triangles cover at least five sides of the bounding box by more than half.
  bool is_box() const {
    std::array<double, 6> covered{};
    for (size_t i = 0; i < scene_.triangles.size(); ++i) {
      const Vec3d p = scene_.corner(i, 0).as<double>() - lower_, q = scene_.corner(i, 1).as<double>() - lower_,
                  r = scene_.corner(i, 2).as<double>() - lower_;
      const Vec3d area = cross(q - p, r - p) * 0.5;
      for (int axis = 0; axis < 3; ++axis) {
        const double low = std::min({p[axis], q[axis], r[axis]}), high = std::max({p[axis], q[axis], r[axis]});
        const size_t side = 2 * axis;
        if (high <= 0.03 * extent_[axis]) covered[side] += std::fabs(area[axis]);
        if (low >= 0.97 * extent_[axis]) covered[side + 1] += std::fabs(area[axis]);
      }
    }
    int walls = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double side = extent_[(axis + 1) % 3] * extent_[(axis + 2) % 3];
      for (const size_t end : {0u, 1u}) walls += covered[static_cast<size_t>(2 * axis) + end] > 0.5 * side;
    }
    return walls >= 5;
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

  Camera best_camera() const {
    std::vector<Candidate> candidates;
    if (changes_.eye) {
      const Vec3d eye = changes_.eye->as<double>(), centre = lower_ + extent_ * 0.5;
      if (!changes_.look_at) candidates.push_back({camera(eye, centre - eye, inside(eye) ? kInsideFov : kOutsideFov)});
      add_from(eye, inside(eye) ? kInsideFov : kOutsideFov, {-0.1, -0.4, 0.25, -1.0}, candidates);
    } else {
      add_outside(candidates);
      for (const Vec3d& eye : places_inside()) add_from(eye, kInsideFov, {-0.1, -0.3}, candidates);
    }
    const auto unusable = [](const Candidate& c) {
      const Vec3d forward = c.camera.direction.as<double>(), up = c.camera.up.as<double>();
      return !(length(cross(forward, up)) > 1e-3 * length(forward) * length(up));
    };
    const Camera first = candidates.front().camera;
    candidates.erase(std::remove_if(candidates.begin(), candidates.end(), unusable), candidates.end());
    if (candidates.size() < 2) return candidates.empty() ? first : candidates.front().camera;
    // All with few rays, the best of them with many.
    for (const auto& [rays, keep] : {std::pair<int, size_t>(10, 16), std::pair<int, size_t>(32, 1)}) {
      for (Candidate& c : candidates) c.score = std::round(1e6 * c.prior * score(c.camera, rays));
      std::stable_sort(candidates.begin(), candidates.end(),
                       [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
      candidates.resize(std::min(candidates.size(), keep));
    }
    return candidates.front().camera;
  }

  /// What the eye sees of a light: the sum of the cosines, and the share of samples that are not dark.
  struct Lit {
    double light = 0, share = 0;
  };
  Lit lit(const std::vector<Sample>& samples, const Vec3d& light) const {
    Lit result;
    for (const Sample& sample : samples) {
      const Vec3d origin = sample.point + sample.normal * (1e-5 * diagonal_), way = light - origin;
      const double cosine = dot(sample.normal, way) / std::max(length(way), 1e-30);
      if (!(cosine > 0.02) || traversal_.occluded({origin.as<float>(), way.as<float>(), 1})) continue;
      result.light += cosine;
      result.share += 1 / static_cast<double>(samples.size());
    }
    return result;
  }

  /// Over the viewer's shoulders, as long as that lights most of what is seen; else the
  /// best of these and of places in the box.
  Vec3 light(const Camera& camera) const {
    const std::vector<Sample> samples = look(camera, 24);
    const Vec3d forward = camera.direction.as<double>(), centre = lower_ + extent_ * 0.5;
    const Vec3d right = normalized(cross(forward, axes_.up)), back = cross(right, axes_.up);
    Vec3d best = centre + normalized(right * 0.6 + axes_.up * 0.9 + back * 0.8) * (2 * diagonal_);
    double most = -1;
    const auto consider = [&](const Vec3d& place) {
      const Lit found = lit(samples, place);
      const double rounded = std::round(1e6 * found.light);
      if (rounded > most) most = rounded, best = place;
      return found.share >= kLitEnough;
    };
    if (!inside(camera.eye.as<double>())) {
      for (const Vec3d& from :
           {Vec3d{0.6, 0.9, 0.8}, Vec3d{-0.6, 0.9, 0.8}, Vec3d{0.2, 1.2, 0.4}, Vec3d{0.3, 0.3, 1.2}}) {
        const Vec3d place = centre + normalized(right * from.x + axes_.up * from.y + back * from.z) * (2 * diagonal_);
        if (consider(place)) return place.as<float>();
      }
    }
    for (const double height : {0.75, 0.85}) {
      for (const double along : {0.5, 0.4, 0.6, 0.3, 0.7, 0.2, 0.8, 0.12, 0.88}) {
        for (const double across : {0.5, 0.4, 0.6, 0.3, 0.7, 0.2, 0.8}) consider(place(along, height, across));
      }
    }
    return best.as<float>();
  }

  const Scene& scene_;
  const ViewChanges& changes_;
  Bounds bounds_;
  Vec3d lower_, extent_;
  double diagonal_;
  Axes axes_;
  Traversal traversal_;
  int vertical_ = 0, along_ = 0;  // axes of the box
  double near_;
};

}  // namespace

View automatic_view(const Scene& scene, const ViewChanges& changes) {
  View view;
  // Without a direction upwards, and for an eye that looks at itself, there is nothing to find: the checks will tell.
  if (length(changes.up.value_or(view.camera.up).as<double>()) > 0 &&
      !(changes.eye && changes.look_at && *changes.eye == *changes.look_at)) {
    view = Viewfinder(scene, changes).find();
  }
  change_view(view, changes);
  return view;
}

}  // namespace raypool
