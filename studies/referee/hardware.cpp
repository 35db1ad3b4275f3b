#include "referee/hardware.hpp"

#include <fmt/format.h>

#include "machine/traverser/box_ray.hpp"
#include "scene/hard_rays.hpp"
#include "scene/traversal.hpp"

namespace raypool::referee {
namespace {

HitAnswer answer_of(const Traversal& traversal, const RayQuery& ray) {
  Hit hit;
  const bool found = traversal.nearest(ray, hit);
  return {found, hit.triangle, hit.t};
}

/// The hits of a chip that has the traverser inside.
void take_hardware_hits(Traversal& traversal) {
  ChipConfiguration chip;
  chip.traverser = TraverserName::Hardware;
  traversal.take_hits_of(chip);
}

class OurAnswers : public Contender {
 public:
  std::vector<std::string> names() const override {
    std::vector<std::string> names = {kEngines};
    for (const uint32_t bits : kTimeWidths) names.push_back(fmt::format("pipe of {} bits", bits));
    names.push_back(kHardware);
    for (uint32_t bits = kMostBoxBits; bits >= kLeastBoxBits; --bits) names.push_back(fmt::format("boxes of {}", bits));
    return names;
  }
  void answer(const HitCase& hit_case, Said* answers) override {
    Traversal traversal(scene_of(hit_case));
    *answers++ = answer_of(traversal, hit_case.ray);
    for (const uint32_t bits : kTimeWidths) {
      traversal.set_triangle_test(TriangleTest(TriangleTime::Plane, bits));
      *answers++ = answer_of(traversal, hit_case.ray);
    }
    take_hardware_hits(traversal);
    *answers++ = answer_of(traversal, hit_case.ray);
    for (uint32_t bits = kMostBoxBits; bits >= kLeastBoxBits; --bits) {
      traversal.compress_nodes(bits);
      *answers++ = answer_of(traversal, hit_case.ray);
    }
  }
};

}  // namespace

Scene scene_of(const HitCase& hit_case) { return raypool::scene_of(hit_case.triangles); }

HitAnswer hardware_answer(const HitCase& hit_case) {
  Traversal traversal(scene_of(hit_case));
  take_hardware_hits(traversal);
  return answer_of(traversal, hit_case.ray);
}

std::unique_ptr<Contender> our_answers() { return std::make_unique<OurAnswers>(); }

}  // namespace raypool::referee
