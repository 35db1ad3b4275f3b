// Pipes of one kind, for nodes or for triangles: a queue of tests whose data is there, of which each pipe begins one in
// a cycle, and the pipes.
#pragma once

#include <cstddef>
#include <cstdint>

#include "traverser/delay_line.hpp"
#include "traverser/ring.hpp"
#include "traverser/work.hpp"

namespace raypool::traverser {

class TestPipes {
 public:
  TestPipes(uint32_t pipes, uint32_t latency) : pipes_(pipes), line_(latency) {}

  /// There is room for what so many lookups bring. What the memory brings comes in any case, out of the registers.
  bool ready(size_t on_the_way) const { return queue_.size() + on_the_way < kQueue * pipes_; }
  /// A test of the ray in `slot`. One that need not wait is begun at once.
  void push(uint64_t cycle, uint32_t slot) {
    if (queue_.empty() && begun_ < pipes_) {
      begin(cycle, slot);
    } else {
      queue_.push_back(slot);
    }
  }

  /// The end of a cycle in which tests were pushed, or some wait.
  void clock(uint64_t cycle) {
    for (; begun_ < pipes_ && !queue_.empty(); queue_.pop_front()) begin(cycle, queue_.front());
    begun_ = 0;
    work_.waiting += queue_.size();
  }

  /// A test's result is there, that of the ray in take().
  bool valid(uint64_t cycle) const { return line_.valid(cycle); }
  uint32_t take() { return line_.take(); }

  /// Begins a test in the next cycle.
  bool busy() const { return !queue_.empty(); }
  /// The next cycle in which a result is there.
  uint64_t next() const { return line_.next(); }
  const PipeWork& work() const { return work_; }

 private:
  void begin(uint64_t cycle, uint32_t slot) {
    line_.push(cycle, slot);
    ++begun_;
    ++work_.tests;
  }

  static constexpr size_t kQueue = 4;  // places, for each pipe
  uint32_t pipes_;
  uint32_t begun_ = 0;  // tests, in this cycle
  Ring<uint32_t> queue_;
  DelayLine<uint32_t> line_;
  PipeWork work_;
};

}  // namespace raypool::traverser
