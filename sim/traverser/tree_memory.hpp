// The traverser's side of the memory: who may ask in a cycle, banks with a row open, and lines on their way.
//
// Requests take their turns at the chip's memory port (MemoryTurns), in the order in which they are made, and keep it
// as the device's do. A line of the row that its bank has open comes after the memory's latency, one of another row
// later, and the bank begins nothing else before.
#pragma once

#include <cstdint>
#include <vector>

#include "config/configuration.hpp"
#include "traverser/fetch_unit.hpp"
#include "traverser/ray_stacks.hpp"
#include "traverser/ring.hpp"
#include "traverser/work.hpp"

namespace raypool::traverser {

/// The memory port, shared with others.
class MemoryTurns {
 public:
  virtual ~MemoryTurns() = default;
  /// Keeps the port for so many beats as soon as it is free, not before `cycle`. Returns the first cycle.
  virtual uint64_t turn(uint64_t cycle, uint32_t beats) = 0;
  /// Of a line that begins then and could end then: the cycle of its last beat, behind those of the lines before.
  virtual uint64_t line(uint64_t start, uint64_t end) = 0;
};

class TreeMemory {
 public:
  enum class Source : uint8_t { Nodes, Triangles, Stacks };
  struct Returned {
    Source source;
    uint32_t which;  ///< line, or slot of the stack
  };

  /// `turns` must outlive it.
  TreeMemory(const ChipConfiguration& chip, MemoryTurns& turns);

  /// Makes one request of those that wait, in rotation.
  void clock(uint64_t cycle, FetchUnit& nodes, FetchUnit& triangles, RayStacks& stacks, LookupListener& listener) {
    if (nodes.request_valid() || triangles.request_valid() || stacks.request_valid())
      serve(cycle, nodes, triangles, stacks, listener);
  }

  /// The same for who has chosen already: asks for a node or a line of triangles, which comes as `which`. Returns when.
  uint64_t read(uint64_t cycle, Source source, uint32_t line, uint32_t which);
  void serve_stack(uint64_t cycle, const RayStacks::Request& request);

  bool valid(uint64_t cycle) const { return !lines_.empty() && lines_.front().due <= cycle; }
  const Returned& front() const { return lines_.front().returned; }  ///< means something while valid()
  Returned take();
  uint64_t next() const { return lines_.empty() ? kNever : lines_.front().due; }

  /// The figures of the memory.
  void add_to(TraverserWork& work) const;

 private:
  struct Line {
    uint64_t due;
    Returned returned;
  };
  struct Bank {
    uint64_t row = kNever, free_from = 0;
  };
  void serve(uint64_t cycle, FetchUnit& nodes, FetchUnit& triangles, RayStacks& stacks, LookupListener& listener);
  uint64_t access(uint64_t line, uint64_t start);
  /// Lines one behind the other, which come together.
  uint64_t read_lines(uint64_t cycle, uint64_t line, uint64_t lines, Returned returned);

  MemoryTurns& turns_;
  uint64_t latency_, row_miss_, lines_a_row_, lines_a_node_;
  std::vector<Bank> banks_;
  Ring<Line> lines_;
  uint32_t next_source_ = 0;
  uint64_t reads_ = 0, quadwords_ = 0, row_hits_ = 0, row_misses_ = 0;
};

}  // namespace raypool::traverser
