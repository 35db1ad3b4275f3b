// A function for each kind of hard case (corpus.hpp).
#pragma once

#include "referee/draw.hpp"

namespace raypool::referee {

// Through, or next to, what triangles share.
DrawnCase through_corner(Draw& draw);
DrawnCase through_edge(Draw& draw);
DrawnCase next_to_edge(Draw& draw);
DrawnCase at_seam(Draw& draw);
DrawnCase at_fan(Draw& draw);

// Triangles of hardly any area, or several in one place.
DrawnCase at_slivers(Draw& draw);
DrawnCase at_needles(Draw& draw);
DrawnCase at_coincident(Draw& draw);
DrawnCase at_coplanar(Draw& draw);
DrawnCase at_crossing(Draw& draw);
DrawnCase grazing(Draw& draw);

// Numbers at the ends of their range, and of the ray's.
DrawnCase from_far(Draw& draw);
DrawnCase huge(Draw& draw);
DrawnCase subnormal(Draw& draw);
DrawnCase limited(Draw& draw);
DrawnCase from_surface(Draw& draw);
DrawnCase strange_direction(Draw& draw);
DrawnCase in_soup(Draw& draw);

// Of which these are made.

/// A closed mesh on a grid, and a ray exactly through this point of it: a corner, or a point of an edge.
DrawnCase exactly_through(Draw& draw, bool corner, int64_t reach, int exponent);
/// A ray in floats from here towards there, its direction of any length.
RayQuery ray_towards(Draw& draw, const Vec3d& from, const Vec3d& to);
/// A point of the triangle: inside, on an edge or at a corner.
Vec3d point_of(Draw& draw, const Corners& corners);

}  // namespace raypool::referee
