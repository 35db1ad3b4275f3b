// Numbers at the ends of their range, and of the ray's.
#include <algorithm>

#include "referee/certificate.hpp"
#include "referee/hard_kinds.hpp"
#include "scene/hard_rays.hpp"

namespace raypool::referee {
namespace {

/// Times a power of two, rounded where it becomes subnormal.
Vec3 scaled(const Vec3& v, int exponent) {
  return {std::ldexp(v.x, exponent), std::ldexp(v.y, exponent), std::ldexp(v.z, exponent)};
}

/// Corners and origin times a power of two: t stays.
void scale(DrawnCase& drawn, int exponent) {
  for (Corners& corners : drawn.triangles) {
    for (Vec3& corner : corners) corner = scaled(corner, exponent);
  }
  drawn.ray.origin = scaled(drawn.ray.origin, exponent);
  drawn.ray.direction = scaled(drawn.ray.direction, exponent);
}

/// A few triangles of all sizes, and one of the rays that are hard for them, or from where it begins at one of them.
DrawnCase soup_case(Draw& draw, float scale_by, const Vec3& at) {
  const auto seed = static_cast<uint32_t>(draw.word());
  const Scene scene = soup(seed, draw.small(2, 8), scale_by, at);
  DrawnCase drawn;
  drawn.ray = draw.any(hard_rays(scene, 6, seed));
  for (size_t i = 0; i < scene.triangles.size(); ++i) {
    drawn.triangles.push_back({scene.corner(i, 0), scene.corner(i, 1), scene.corner(i, 2)});
  }
  if (draw.one_of(2)) {
    const Vec3d from = drawn.ray.origin.as<double>(), to = point_of(draw, draw.any(drawn.triangles));
    drawn.ray.direction = ray_towards(draw, from, to).direction;
  }
  return drawn;
}

/// t of the first meeting of the ray without its limit, 1 if there is none.
Meeting first_meeting(const DrawnCase& drawn) {
  const Certificate certificate = certify({0, "", {drawn.ray.origin, drawn.ray.direction, INFINITY}, drawn.triangles});
  if (!certificate.meetings.empty()) return certificate.meetings.front();
  Meeting none;
  none.nearest = 1;
  return none;
}

}  // namespace

DrawnCase from_far(Draw& draw) {
  DrawnCase drawn = soup_case(draw, 1, {0, 0, 0});
  const Vec3d to = point_of(draw, draw.any(drawn.triangles));
  const double distance = std::ldexp(draw.uniform(1, 2), draw.small(4, 58));
  drawn.ray = ray_towards(draw, normalized(draw.place(1)) * distance, to);
  return drawn;
}

DrawnCase huge(Draw& draw) {
  const int exponent = draw.small(20, 52);  // rays of a soup begin up to 2^7 of its scale away
  if (draw.one_of(2)) return soup_case(draw, std::ldexp(1.0f, exponent), {});
  DrawnCase drawn = exactly_through(draw, draw.one_of(2), 100, 0);
  scale(drawn, exponent - 9);
  return drawn;
}

DrawnCase subnormal(Draw& draw) {
  // Of the grid of 2^-149 itself, or of a few of its bits; the direction may be as small.
  if (draw.one_of(2)) return soup_case(draw, std::ldexp(1.0f, draw.small(-148, -120)), {});
  DrawnCase drawn = exactly_through(draw, draw.one_of(2), draw.one_of(2) ? 3 : 100, draw.small(-149, -130));
  if (draw.one_of(2)) drawn.ray.direction = scaled(drawn.ray.direction, draw.small(-140, 0));
  return drawn;
}

DrawnCase limited(Draw& draw) {
  DrawnCase drawn = draw.one_of(2) ? through_edge(draw) : soup_case(draw, 1, {0, 0, 0});
  const float t = first_meeting(drawn).nearest;
  drawn.ray.limit = draw.one_of(2) ? t : draw.nudged(t);
  if (draw.one_of(16)) drawn.ray.limit = draw.one_of(2) ? 0 : draw.one_of(2) ? -1 : std::nanf("");
  if (draw.one_of(16)) drawn.ray.limit = 0x1p-149f;
  return drawn;
}

DrawnCase from_surface(Draw& draw) {
  // Exactly on it: at a corner, or a point of an edge of a mesh, or in a triangle; or a float beside it.
  DrawnCase drawn = exactly_through(draw, draw.one_of(2), 100, draw.small(-20, 8));
  if (draw.one_of(3)) {
    const Vec3d to = drawn.ray.direction.as<double>();
    drawn.ray = ray_towards(draw, point_of(draw, draw.any(drawn.triangles)), to);
    return drawn;
  }
  // Of t that is a float the point is one too, mostly.
  const double t = static_cast<double>(first_meeting(drawn).nearest);
  drawn.ray.origin = (drawn.ray.origin.as<double>() + drawn.ray.direction.as<double>() * t).as<float>();
  if (draw.one_of(2)) drawn.ray.direction = on_grid(draw.direction(9), 0);
  if (draw.one_of(3)) drawn.ray.origin = draw.nudged(drawn.ray.origin);
  return drawn;
}

DrawnCase strange_direction(Draw& draw) {
  DrawnCase drawn = exactly_through(draw, false, 10, 0);
  Vec3& direction = drawn.ray.direction;
  const uint64_t kind = draw.below(8);
  const int axis = draw.small(0, 2);
  if (kind < 2) {  // along an axis
    direction = kind == 0 ? Vec3{0, 0, 0} : Vec3{-0.0f, -0.0f, -0.0f};
    direction[axis] = draw.one_of(2) ? 1.0f : -3.0f;
  } else if (kind == 2) {  // none
    direction = {draw.one_of(2) ? 0.0f : -0.0f, 0, -0.0f};
  } else if (kind == 3) {  // infinite, or not a number
    direction[axis] = draw.one_of(3) ? std::nanf("") : draw.one_of(2) ? INFINITY : -INFINITY;
  } else if (kind == 4) {  // one component far below the others
    direction[axis] = std::ldexp(direction[axis], draw.small(-140, -20));
  } else if (kind == 5) {  // far below, or above, what is usual
    direction = scaled(direction, draw.one_of(2) ? draw.small(-149, -100) : draw.small(60, 110));
  } else if (kind == 6) {  // two components that are as large, or nearly
    direction[(axis + 1) % 3] = draw.one_of(2) ? direction[axis] : draw.nudged(-direction[axis]);
  } else {
    direction[axis] = draw.one_of(2) ? 0x1p-149f : -0x1p-149f;
  }
  return drawn;
}

DrawnCase in_soup(Draw& draw) {
  return soup_case(draw, std::ldexp(1.0f, draw.small(-30, 30)), draw.place(draw.one_of(2) ? 1 : 3000).as<float>());
}

}  // namespace raypool::referee
