#include "machine/chip/fill_policy.hpp"

#include <algorithm>

namespace raypool {

namespace {

// While the traverser is behind, shading is worth it with so much less than a load: it makes no rays, and its end
// starts the traverser.
constexpr uint32_t kBehindShare = 4;

}  // namespace

// More than one batch of the traverser can seldom be there.
FillPolicy::FillPolicy(const PolicySetup& setup)
    : setup_(setup),
      load_(std::min({setup.contents, setup.intersection_capacity, setup.batch})),
      backlog_(setup.batch * setup.units) {}

// What the ray pool has room for, if every kernel on the units exports as much as it can: each of them takes a batch
// out when it ends.
uint32_t FillPolicy::ray_room(const PolicyView& view) const {
  const uint32_t coming = view.rays + view.rays_to_come;
  const uint32_t capacity = setup_.ray_capacity + setup_.batch * view.kernels;
  return coming < capacity ? capacity - coming : 0;
}

Choice FillPolicy::choose(const PolicyView& view) const {
  const uint32_t room = ray_room(view);
  const Choice shade{Choice::Kind::Shade, std::min(setup_.contents, view.shadow)};
  const Choice secondary{Choice::Kind::Secondary, std::min({setup_.contents, view.normal, view.secondary_room,
                                                            room / setup_.rays_per_secondary})};
  const Choice full = full_load(view, secondary, shade);
  if (full.kind != Choice::Kind::Halt) return full;
  if (view.eye_possible && room >= std::min(setup_.contents, setup_.ray_capacity)) return {Choice::Kind::Eye, 0};
  if (view.ahead) return {};
  // Its packages would wait behind those at the port: later it will be fuller, and no later in the end.
  if (view.kernels > 0 && view.promised >= load_) return {};
  return part_load(view, secondary, shade);
}

Choice FillPolicy::full_load(const PolicyView& view, const Choice& secondary, const Choice& shade) const {
  const uint32_t shade_load = behind(view) ? (load_ + kBehindShare - 1) / kBehindShare : load_;
  const bool secondary_full = secondary.threads >= load_;
  if (shade.threads >= shade_load && (!secondary_full || behind(view) || shade.threads > secondary.threads)) {
    return shade;
  }
  return secondary_full ? secondary : Choice{};
}

// Of a unit without a kernel, when no full load is there and no tile has room.
Choice FillPolicy::part_load(const PolicyView& view, const Choice& secondary, const Choice& shade) const {
  Choice choice = shade;
  if (shade.threads == 0 || (!behind(view) && secondary.threads >= shade.threads)) choice = secondary;
  if (choice.threads > 0) return choice;
  if (view.kernels > 0 || view.more_to_come) return {};
  // Nothing will come by itself, so the empty ray pool has to take what is made, however small it is.
  const uint32_t threads = std::min({setup_.contents, view.normal, view.secondary_room});
  return {threads > 0 ? Choice::Kind::Secondary : Choice::Kind::Halt, threads};
}

}  // namespace raypool
