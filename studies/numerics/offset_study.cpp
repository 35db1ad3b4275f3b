#include "numerics/offset_study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "bits.hpp"
#include "kernel/kernel.hpp"
#include "kernel/kernel_report.hpp"
#include "kernel/ray_kernels.hpp"
#include "numerics/extreme_parts.hpp"
#include "numerics/reference.hpp"
#include "scene/hits_check.hpp"
#include "scene/mesh_builder.hpp"
#include "scene/native_renderer.hpp"
#include "scene/traversal.hpp"

namespace raypool::numerics {
namespace {

// Constants of the source.
constexpr float kNearOrigin = 1.0f / 32;
constexpr float kFloatScale = 1.0f / 65536;
constexpr float kIntegerScale = 256;

Vec3 along(const OffsetInput& in, float offset) { return in.origin + in.direction * in.t + in.normal * offset; }

Vec3 integer_offset(const OffsetInput& in) {
  const Vec3 point = in.origin + in.direction * in.t;
  Vec3 result;
  for (int axis = 0; axis < 3; ++axis) {
    const float p = point[axis], n = in.normal[axis];
    const auto steps = static_cast<int32_t>(kIntegerScale * n);
    const auto bits = static_cast<int32_t>(as_bits(p)) + (p < 0 ? -steps : steps);
    result[axis] = std::fabs(p) < kNearOrigin ? p + kFloatScale * n : as_float(static_cast<uint32_t>(bits));
  }
  return result;
}

/// The rules in the kernel language, nothing around them but words in and words out. `offset(k, distance, point)`.
template <typename K, typename Offset>
void kernel_along(K& k, const Offset& offset) {
  using Float = typename K::Float;
  k.ray_in();
  const Float distance = k.float_word(word::kDistance);
  const kernel::Vector<K> point =
      kernel::vector_word(k, word::kOrigin) + distance * kernel::vector_word(k, word::kDirection);
  kernel::set_vector_word(k, word::kOrigin, point + offset(k, distance, point) * kernel::vector_word(k, word::kNormal));
  k.ray_out();
}
template <typename K>
void kernel_fixed(K& k) {
  kernel_along(k, [](K& of, const auto&, const auto&) { return of.float_argument(argument::kOffset); });
}
template <typename K>
void kernel_in_use(K& k) {
  kernel_along(
      k, [](K& of, const auto& distance, const auto& point) { return kernel::surface_offset(of, distance, point); });
}
template <typename K>
void kernel_integer(K& k) {
  using Int = typename K::Int;
  using Float = typename K::Float;
  k.ray_in();
  for (int axis = 0; axis < 3; ++axis) {
    const Float p =
        k.float_word(word::kOrigin + axis) + k.float_word(word::kDistance) * k.float_word(word::kDirection + axis);
    const Float n = k.float_word(word::kNormal + axis);
    Int steps = to_int(n * kIntegerScale);
    k.if_(p < 0.0f, [&] { steps = -steps; });
    Float moved = as_float(as_int(p) + steps);
    k.if_(abs(p) < kNearOrigin, [&] { moved = p + n * kFloatScale; });
    k.set_word(word::kOrigin + axis, moved);
  }
  k.ray_out();
}

/// A primary hit and what is true of its shadow.
struct Hitpoint {
  RayQuery eye;
  Hit hit;
  Vec3 normal;  // on the eye's side
  ReferenceShadowRay shadow;
  uint32_t blocker;
};

std::vector<Hitpoint> hitpoints(const Scene& scene, const Traversal& traversal, const ReferenceTracer& reference,
                                int size) {
  const auto arguments = camera_arguments(scene, size, size, 1);
  const ReferenceCamera camera(arguments);
  std::vector<Hitpoint> points;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      // The float ray is the truth here: only what happens at the hit is on trial.
      const RayQuery eye{camera.eye.as<float>(), camera.direction(x, y).as<float>(), INFINITY};
      Hitpoint point{eye, {}, {}, {}, kNoTriangle};
      const DoubleHit truth = reference.nearest(eye.origin.as<double>(), eye.direction.as<double>(), INFINITY);
      if (!traversal.nearest(eye, point.hit) || truth.triangle != point.hit.triangle) continue;
      point.normal = dot(point.hit.normal, eye.direction) > 0 ? point.hit.normal * -1.0f : point.hit.normal;
      point.shadow = shadow_ray(reference, eye.origin.as<double>(), eye.direction.as<double>(), truth, camera.light);
      if (point.shadow.cosine > 0) point.blocker = reference.occluder(point.shadow.origin, point.shadow.direction, 1);
      points.push_back(point);
    }
  }
  return points;
}

void judge_shadow(const ReferenceTracer& reference, const Traversal& traversal, const Hitpoint& point,
                  const Vec3& origin, OffsetCounts& counts) {
  ++counts.shadow_rays;
  const Scene& scene = reference.scene();
  Hit blocker;
  const RayQuery ray{origin, scene.light.position - origin, 1};
  const bool blocked = traversal.nearest(ray, blocker);
  if (blocked == (point.blocker != kNoTriangle)) return;
  if (blocked && same_surface(reference, blocker.triangle, point.hit.triangle)) {
    ++counts.acne;
    return;
  }
  std::string reason;
  const HitAnswer ours{blocked, blocker.triangle, 0}, theirs{!blocked, point.blocker, 0};
  if (judge_hits(scene, {point.shadow.origin, point.shadow.direction, 1}, ours, theirs, reason) == HitVerdict::Tie)
    return;
  ++(blocked ? counts.moved : counts.leaks);
}

/// A cube and a ball of 1 m on a square ground, seen from 6 m.
Scene on_ground(double size, bool tilted) {
  Scene scene;
  MeshBuilder mesh(scene, 1);
  const Transform place = tilted ? Transform::turn_z(31) * Transform::turn_x(17) : Transform{};
  mesh.place(place);
  mesh.add_material("all", {0.8f, 0.8f, 0.8f}, {0.2f, 0.2f, 0.2f});
  mesh.quad({-size, 0, size}, {size, 0, size}, {size, 0, -size}, {-size, 0, -size});
  mesh.box({0, 0, 0}, {1, 1, 1});
  mesh.sphere({-1, 0.5, 1}, 0.5, 48);
  scene.camera = {place({4, 3, 5}).as<float>(), place({-4, -2.5, -5}).as<float>(), place({0, 1, 0}).as<float>(), 40};
  scene.light = {place({-2, 4, 3}).as<float>(), {1, 1, 1}};
  return scene;
}

}  // namespace

std::vector<OffsetRule> offset_rules() {
  std::vector<OffsetRule> rules;
  rules.push_back({"none", [](const OffsetInput& in) { return along(in, 0); }});
  rules.push_back({"fixed 1e-04 m", [](const OffsetInput& in) { return along(in, 1e-4f); }});
  for (float share : {1e-6f, 1e-5f}) {
    rules.push_back({fmt::format("{:.0e} of diagonal", share),
                     [share](const OffsetInput& in) { return along(in, share * in.diagonal); }});
  }
  rules.push_back({"in use", [](const OffsetInput& in) {
                     const Vec3 point = in.origin + in.direction * in.t;
                     return along(in, (largest_of(point) + in.t) * in.share);
                   }});
  rules.push_back(rules.back());
  rules.back().name = "in use, hardware";
  rules.back().hardware = true;
  rules.push_back({"integer", integer_offset});
  return rules;
}

std::vector<OffsetScene> offset_scenes() {
  const Scene cornell = make_cornell(0.5);
  std::vector<OffsetScene> scenes;
  scenes.push_back({"cornell", cornell});
  scenes.push_back({"room", make_room(0.1)});
  scenes.push_back({"cornell x 1e-6", moved(cornell, 1e-6, {})});
  scenes.push_back({"cornell x 1e6", moved(cornell, 1e6, {})});
  scenes.push_back({"cornell + 100 m", moved(cornell, 1, {100, 70, -90})});
  scenes.push_back({"cornell + 10 km", moved(cornell, 1, {1e4, 7e3, -9e3})});
  for (const double size : {1e1, 1e3, 1e6}) {
    const std::string name = fmt::format("ground of {:.0e} m", size);
    scenes.push_back({name, on_ground(size, false)});
    scenes.push_back({name + ", tilted", on_ground(size, true)});
  }
  return scenes;
}

std::vector<OffsetCounts> study_offsets(const Scene& scene, const std::vector<OffsetRule>& rules, int size) {
  const Traversal engines(scene);
  Traversal hardware(scene);
  ChipConfiguration chip;
  chip.traverser = TraverserName::Hardware;
  hardware.take_hits_of(chip);
  const ReferenceTracer reference(scene);
  const std::vector<Hitpoint> of_engines = hitpoints(scene, engines, reference, size);
  const std::vector<Hitpoint> of_hardware = hitpoints(scene, hardware, reference, size);
  OffsetInput input{};
  input.diagonal = scene.bounds().diagonal();
  const auto arguments = camera_arguments(scene, size, size, 1);
  input.share = as_float(arguments[argument::kOffset]);
  std::vector<OffsetCounts> results;
  for (const OffsetRule& rule : rules) {
    OffsetCounts counts;
    const Traversal& traversal = rule.hardware ? hardware : engines;
    for (const Hitpoint& point : rule.hardware ? of_hardware : of_engines) {
      input.origin = point.eye.origin;
      input.direction = point.eye.direction;
      input.t = point.hit.t;
      input.normal = point.normal;
      const Vec3 origin = rule.origin(input);
      if (point.shadow.cosine > 0) judge_shadow(reference, traversal, point, origin, counts);
      const Vec3 reflected = point.eye.direction - point.normal * (2 * dot(point.normal, point.eye.direction));
      Hit hit;
      ++counts.reflections;
      counts.self_hits += traversal.nearest({origin, reflected, INFINITY}, hit) &&
                          same_surface(reference, hit.triangle, point.hit.triangle);
    }
    results.push_back(counts);
  }
  return results;
}

OffsetInstructions offset_instructions() {
  Program program;
  kernel::add_kernel(program, "fixed", [](auto& k) { kernel_fixed(k); });
  kernel::add_kernel(program, "in_use", [](auto& k) { kernel_in_use(k); });
  kernel::add_kernel(program, "integer", [](auto& k) { kernel_integer(k); });
  auto computed = [&](const char* name) {
    const InstructionCounts counts = count_instructions(program, name);
    return counts[AluType::Int] + counts[AluType::Flt] + counts[AluType::Brh] - 1;
  };
  return {computed("fixed"), computed("in_use"), computed("integer")};
}

}  // namespace raypool::numerics
