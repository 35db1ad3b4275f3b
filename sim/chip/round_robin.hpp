// Who is served next: the first of the askers after the one served last.
#pragma once

namespace raypool::chip {

class RoundRobin {
 public:
  explicit RoundRobin(int count) : count_(count), last_(count - 1) {}

  /// The next number for which asks(number) holds, or -1; it counts as served.
  template <typename Asks>
  int next(Asks asks) {
    for (int i = 1; i <= count_; ++i) {
      const int candidate = (last_ + i) % count_;
      if (asks(candidate)) return last_ = candidate;
    }
    return -1;
  }

 private:
  int count_, last_;
};

}  // namespace raypool::chip
