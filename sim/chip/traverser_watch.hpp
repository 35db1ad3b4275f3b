// What a traverser inside a chip does, as seen at its ports.
#pragma once

#include <cstdint>
#include <vector>

#include "chip/traverser_counts.hpp"
#include "machine/chip/chip_device.hpp"
#include "machine/common/packages.hpp"

namespace raypool::chip {

class TraverserWatch {
 public:
  /// `layout`: of the records that leave; `places`: of the ray pool; `depth`: the largest of a normal ray.
  TraverserWatch(const RecordLayout& layout, uint32_t places, uint32_t depth)
      : layout_(layout), rays_(places), depth_(depth) {}

  /// Once in a cycle.
  void clock(const ChipOutputs& outputs);

  /// Right when no ray is in the traverser: one that has left is taken for one that has ended until it frees its place,
  /// and traced from then on.
  const TraverserCounts& counts() const { return counts_; }

 private:
  void read(const ChipOutputs& outputs);
  void put(const TraverserPorts& traverser);
  void delivered(const Ray& ray, ImportKind kind);

  RecordLayout layout_;
  std::vector<Ray> rays_;  // [place]
  uint32_t depth_;
  Ray coming_{};
  Intersection leaving_{};
  uint32_t beats_in_ = 0, beats_out_ = 0;
  uint64_t cycles_ = 0;
  TraverserCounts counts_;
};

}  // namespace raypool::chip
