// A pipeline of constant latency: what goes in comes out so many cycles later, in order.
#pragma once

#include <cstddef>
#include <cstdint>

#include "traverser/ring.hpp"

namespace raypool::traverser {

inline constexpr uint64_t kNever = UINT64_MAX;  ///< the cycle of what does not happen

template <typename Item>
class DelayLine {
 public:
  explicit DelayLine(uint64_t latency) : latency_(latency) {}

  void push(uint64_t cycle, const Item& item) {
    if (items_.empty()) next_ = cycle + latency_;
    items_.push_back({cycle + latency_, item});
  }
  /// Something comes out in this cycle, and must be taken in it.
  bool valid(uint64_t cycle) const { return next_ <= cycle; }
  Item take() {
    const Item item = items_.front().item;
    items_.pop_front();
    next_ = items_.empty() ? kNever : items_.front().due;
    return item;
  }
  uint64_t next() const { return next_; }
  size_t size() const { return items_.size(); }
  uint64_t latency() const { return latency_; }

 private:
  struct Entry {
    uint64_t due;
    Item item;
  };
  uint64_t latency_;
  uint64_t next_ = kNever;  // cycle in which the oldest comes out
  Ring<Entry> items_;
};

}  // namespace raypool::traverser
