// A pipeline of constant latency: what goes in comes out so many cycles later, in order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>

namespace raypool::traverser {

inline constexpr uint64_t kNever = UINT64_MAX;  ///< the cycle of what does not happen

template <typename Item>
class DelayLine {
 public:
  explicit DelayLine(uint64_t latency) : latency_(latency) {}

  void push(uint64_t cycle, const Item& item) { items_.push_back({cycle + latency_, item}); }
  /// Something comes out in this cycle, and must be taken in it.
  bool valid(uint64_t cycle) const { return !items_.empty() && items_.front().due <= cycle; }
  Item take() {
    const Item item = items_.front().item;
    items_.pop_front();
    return item;
  }
  uint64_t next() const { return items_.empty() ? kNever : items_.front().due; }
  size_t size() const { return items_.size(); }
  uint64_t latency() const { return latency_; }

 private:
  struct Entry {
    uint64_t due;
    Item item;
  };
  uint64_t latency_;
  std::deque<Entry> items_;
};

}  // namespace raypool::traverser
