// rtl/line_offers.v: two lines at most that are offered to be looked up, of which one can be taken in a cycle.
#pragma once

#include <array>
#include <cstdint>

namespace raypool {

template <typename T>
class LineOffers {
 public:
  bool ready() const { return there_ != 3; }
  /// The older one (0), and the younger (1), or null.
  const T* offer(uint32_t i) const {
    const uint32_t place = older_ ^ i;
    return (there_ >> place & 1) != 0 ? &lines_[place] : nullptr;
  }
  /// What was taken in the cycle before, or null.
  const T* asked() const { return has_asked_ ? &asked_ : nullptr; }

  /// The end of a cycle. `comes`: only while ready(), or null. `taken`: bit i: offer i; one at most.
  void clock(const T* comes, uint32_t taken) {
    const uint32_t free = there_ & 1;
    if (there_ == 0) older_ = 0;
    has_asked_ = taken != 0;
    if (has_asked_) {
      const uint32_t gone = older_ ^ taken >> 1;
      asked_ = lines_[gone];
      there_ &= ~(1u << gone);
      older_ = gone ^ 1;
    }
    if (comes == nullptr) return;
    lines_[free] = *comes;
    there_ |= 1u << free;
  }

 private:
  std::array<T, 2> lines_{};
  uint32_t there_ = 0;  // a bit each
  uint32_t older_ = 0;  // which is older; if one is free, the other
  T asked_{};
  bool has_asked_ = false;
};

}  // namespace raypool
