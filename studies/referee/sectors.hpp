// Which directions around a point of a plane are covered by the triangles that meet there.
#pragma once

#include <vector>

#include "scene/exact_rational.hpp"

namespace raypool::referee {

struct Point {
  Exact x, y;
};
inline Exact cross(const Point& a, const Point& b) { return a.x * b.y - a.y * b.x; }

/// Sectors around the origin, borders included.
class Sectors {
 public:
  /// The whole plane.
  void add_all() { all_ = true; }
  /// From one direction counterclockwise to another, by half a turn at most; neither is zero.
  void add(const Point& from, const Point& to) { sectors_.push_back({from, to}); }

  /// Every direction lies in one of them.
  bool cover_all() const {
    if (all_) return true;
    // The end of each is passed by another one: from there on, that one's is, until the turn is complete.
    for (const Sector& sector : sectors_) {
      if (!is_passed(sector.to)) return false;
    }
    return !sectors_.empty();
  }

 private:
  struct Sector {
    Point from, to;

    /// The direction lies in it, but not at its end.
    bool holds(const Point& p) const {
      const int turn = cross(from, p).sign();
      if (turn < 0) return false;
      if (turn == 0) return (from.x * p.x + from.y * p.y).sign() > 0;
      return cross(from, to).sign() == 0 || cross(p, to).sign() > 0;
    }
  };
  bool is_passed(const Point& end) const {
    for (const Sector& sector : sectors_) {
      if (sector.holds(end)) return true;
    }
    return false;
  }

  std::vector<Sector> sectors_;
  bool all_ = false;
};

}  // namespace raypool::referee
