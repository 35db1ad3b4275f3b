#include "rivals/rivals.hpp"

#include <cmath>

#include "scene/embree_scene.hpp"

namespace raypool::referee {
namespace {

/// The nearest triangle by a test, at the same time the first.
template <typename Test>
std::unique_ptr<Contender> of_all_triangles(std::string name, Test test) {
  return contender(std::move(name), [test](const HitCase& hit_case) {
    HitAnswer best;
    best.t = hit_case.ray.limit;
    for (uint32_t i = 0; i < hit_case.triangles.size(); ++i) {
      const FloatMeeting found = test(hit_case.ray, hit_case.triangles[i]);
      if (found.meets && found.t > 0 && found.t < best.t) best = {true, i, found.t};
    }
    return best;
  });
}

/// Of other rays it promises nothing, and ends the program where it has been built with assertions.
bool embree_takes(const RayQuery& ray) {
  constexpr float kLarge = 1.844e18f;
  bool takes = ray.limit >= 0;
  for (int axis = 0; axis < 3; ++axis) {
    takes &= std::fabs(ray.origin[axis]) <= kLarge && std::fabs(ray.direction[axis]) <= kLarge;
  }
  return takes;
}

std::unique_ptr<Contender> embree(std::string name, EmbreeMode mode) {
  return contender(std::move(name), [mode](const HitCase& hit_case) -> Said {
    if (!embree_takes(hit_case.ray)) return std::nullopt;
    Hit hit;
    const bool found = EmbreeScene(scene_of(hit_case), mode).nearest(hit_case.ray, hit);
    return HitAnswer{found, hit.triangle, hit.t};
  });
}

}  // namespace

Contenders rivals() {
  Contenders all;
  all.push_back(embree("Embree, robust", EmbreeMode::Robust));
  all.push_back(embree("Embree, fast", EmbreeMode::Fast));
  all.push_back(of_all_triangles("Woop, Benthin and Wald", woop));
  all.push_back(of_all_triangles("Moeller and Trumbore", moeller_trumbore));
  all.push_back(of_all_triangles("Baldwin and Weber", baldwin_weber));
  all.push_back(of_all_triangles("Pluecker", pluecker));
  return all;
}

}  // namespace raypool::referee
