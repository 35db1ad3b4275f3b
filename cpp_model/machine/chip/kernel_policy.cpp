#include "machine/chip/kernel_policy.hpp"

#include <algorithm>
#include <stdexcept>

#include "machine/chip/fill_policy.hpp"

namespace raypool {

namespace {

constexpr uint32_t kThesisContents = 64;  // for which thresholds are given

}  // namespace

ThesisPolicy::ThesisPolicy(const PolicySetup& setup) : contents_(setup.contents) {
  const uint32_t scale = std::max(1u, setup.contents / kThesisContents);
  ray_threshold_ = std::min(setup.ray_threshold * scale * setup.units, setup.ray_capacity * 3 / 4);
  intersection_threshold_ =
      std::min({setup.intersection_threshold * scale, setup.contents - 1, setup.intersection_capacity - 1});
}

Choice ThesisPolicy::choose(const PolicyView& view) const {
  const Choice shade{Choice::Kind::Shade, std::min(contents_, view.shadow)};
  const Choice secondary{Choice::Kind::Secondary, std::min({contents_, view.normal, view.secondary_room})};
  // Shade instead where a full secondary kernel would not be safe, so that room comes back.
  const bool secondary_fits = view.secondary_room >= std::min(contents_, view.normal);

  Choice choice;
  if (view.rays > ray_threshold_) {
    if (view.shadow > 0) choice = shade;
  } else if (view.normal + view.shadow > intersection_threshold_) {
    if (view.shadow < view.normal && secondary_fits) {
      choice = secondary;
    } else if (view.shadow > 0) {
      choice = shade;
    }
  } else if (view.eye_possible) {
    choice.kind = Choice::Kind::Eye;
  } else if (!view.more_to_come) {
    // The tail: nothing will come by itself, so run what is left.
    if (view.shadow < view.normal && secondary.threads > 0) {
      choice = secondary;
    } else if (view.shadow > 0) {
      choice = shade;
    }
  }
  // A kernel that can wait is launched ahead only to import a full load; any other decision
  // is better made when the unit is free.
  if (view.ahead && choice.threads < contents_) choice = {};
  return choice;
}

std::unique_ptr<KernelPolicy> make_policy(PolicyName name, const PolicySetup& setup) {
  switch (name) {
    case PolicyName::Thesis:
      return std::make_unique<ThesisPolicy>(setup);
    case PolicyName::Fill:
      return std::make_unique<FillPolicy>(setup);
  }
  throw std::logic_error("a policy without a class");
}

}  // namespace raypool
