// What each tile costs of a run in which many are under way at a time: the counts of an interval, its cycles too, are
// shared out equally among the pixels that are held in it, and a tile has what its pixels have. So the tiles' costs sum
// up to the counts of the run, exactly.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "isa/isa.hpp"

namespace raypool::chip {

/// What is counted, as numbers of an array; of ALU types that of the first, the others follow.
namespace count {
inline constexpr size_t kCycles = 0, kEyeRays = 1, kReflectionRays = 2, kShadowRays = 3, kBusyCycles = 4,
                        kInstructions = 5, kThreadInstructions = 6, kRayPort = 7, kIntersectionPort = 8,
                        kMemoryPort = 9,
                        kUnused = 10,  ///< busy cycles x instances without a task, of each ALU type
    kIssued = kUnused + kAluTypes,     ///< tasks, of each ALU type
    kCount = kIssued + kAluTypes;
}  // namespace count
using Counts = std::array<double, count::kCount>;

class TileCosts {
 public:
  /// A tile is cast of so many pixels, `now` being all that has been counted. Returns its number: they count from 0.
  uint32_t cast(uint32_t pixels, const Counts& now);
  /// A pixel of the tile is finished.
  void finished(uint32_t tile, const Counts& now);
  /// The run has ended.
  void end(const Counts& now);

  /// [tile], in the order in which they were cast. After end().
  const std::vector<Counts>& costs() const { return costs_; }

 private:
  void share(const Counts& now);

  Counts last_{};     // all that has been shared out
  Counts a_pixel_{};  // what a pixel would have that was held from the beginning on
  uint32_t held_ = 0;
  std::vector<Counts> costs_;
};

}  // namespace raypool::chip
