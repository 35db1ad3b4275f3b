// rtl/line_offers.v: two lines at most that are offered to be looked up, of which one can be taken in a cycle.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

namespace raypool {

template <typename T>
class LineOffers {
 public:
  bool ready() const { return !there_[0] || !there_[1]; }
  /// The older one (0), and the younger (1), or null.
  const T* offer(uint32_t i) const {
    const std::optional<T>& offer = there_[older_ ^ i];
    return offer ? &*offer : nullptr;
  }
  /// What was taken in the cycle before.
  const std::optional<T>& asked() const { return asked_; }

  /// The end of a cycle. `comes`: only while ready(). `taken`: 0 or 1, of those that are offered.
  void clock(const std::optional<T>& comes, std::optional<uint32_t> taken) {
    const uint32_t free = there_[0] ? 1 : 0;
    if (!there_[0] && !there_[1]) older_ = 0;
    asked_.reset();
    if (taken) {
      const uint32_t gone = older_ ^ *taken;
      asked_.swap(there_[gone]);
      older_ = gone ^ 1;
    }
    if (comes) there_[free] = comes;
  }

 private:
  std::array<std::optional<T>, 2> there_;
  uint32_t older_ = 0;  // which is older; if one is free, the other
  std::optional<T> asked_;
};

}  // namespace raypool
