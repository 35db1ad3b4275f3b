// A queue whose places lie one behind the other and are used again: what a block holds is bounded, so that it soon
// grows no more, and nothing is allocated from then on.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace raypool::traverser {

template <typename Item>
class Ring {
 public:
  bool empty() const { return size_ == 0; }
  size_t size() const { return size_; }

  /// In the order in which they came; `place` below size().
  Item& operator[](size_t place) { return items_[(first_ + place) & mask_]; }
  const Item& operator[](size_t place) const { return items_[(first_ + place) & mask_]; }
  Item& front() { return items_[first_]; }
  const Item& front() const { return items_[first_]; }

  void push_back(const Item& item) {
    if (size_ > mask_) grow();
    items_[(first_ + size_++) & mask_] = item;
  }
  /// The oldest leave; so many must be there.
  void pop_front(size_t count = 1) {
    first_ = (first_ + count) & mask_;
    size_ -= count;
  }

 private:
  void grow() {
    std::rotate(items_.begin(), items_.begin() + static_cast<std::ptrdiff_t>(first_), items_.end());
    first_ = 0;
    items_.resize(2 * items_.size());
    mask_ = items_.size() - 1;
  }

  std::vector<Item> items_ = std::vector<Item>(8);  // a power of two
  size_t first_ = 0, size_ = 0, mask_ = 7;
};

}  // namespace raypool::traverser
