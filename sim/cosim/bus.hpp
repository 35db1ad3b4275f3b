// A bus as a hexadecimal number, for vectors that another simulator reads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace raypool {

/// Put together from its highest field down.
class Bus {
 public:
  /// The low bits of `value`.
  void put(uint64_t value, int bits) {
    for (int i = bits - 1; i >= 0; --i) bits_.push_back((value >> i & 1) != 0);
  }
  /// A word a place, the first one lowest.
  template <typename Words>
  void put_words(const Words& words) {
    for (size_t i = words.size(); i-- > 0;) put(words[i], 32);
  }
  void clear() { bits_.clear(); }
  std::string hex() const {
    std::string text;
    const size_t lead = (4 - bits_.size() % 4) % 4;
    unsigned digit = 0;
    for (size_t i = 0; i < bits_.size(); ++i) {
      digit = digit << 1 | (bits_[i] ? 1u : 0u);
      if ((i + 1 + lead) % 4 == 0) {
        text += "0123456789abcdef"[digit];
        digit = 0;
      }
    }
    return text;
  }

 private:
  std::vector<bool> bits_;
};

/// Outputs that are expected, and which of their bits count.
class ExpectedBus {
 public:
  void put(uint64_t value, int bits, bool counts) {
    expected_.put(value, bits);
    care_.put(counts ? ~uint64_t{0} : 0, bits);
  }
  /// Words of which those in the mask count; the first one is the lowest, as its bit is.
  template <typename Words>
  void put_words(const Words& words, uint32_t mask) {
    for (size_t i = words.size(); i-- > 0;) put(words[i], 32, (mask >> i & 1) != 0);
  }
  void clear() {
    expected_.clear();
    care_.clear();
  }
  /// Two numbers.
  std::string hex() const { return expected_.hex() + ' ' + care_.hex(); }

 private:
  Bus expected_, care_;
};

}  // namespace raypool
