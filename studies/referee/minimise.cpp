#include "referee/minimise.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <set>
#include <vector>

#include "bits.hpp"

namespace raypool::referee {
namespace {

/// Bits of the significand without the zeros at its end, and how far from 1 its first bit is; whole numbers of a digit
/// are the simplest.
uint64_t digits_of(float x) {
  if (x == 0) return std::signbit(x) ? 1 : 0;
  if (!std::isfinite(x)) return 1;
  int exponent = 0;
  const auto significand = static_cast<uint32_t>(std::fabs(std::ldexp(std::frexp(x, &exponent), 24)));
  const auto bits = static_cast<uint64_t>(24 - __builtin_ctz(significand));
  return 2 + 4 * bits + static_cast<uint64_t>(std::abs(exponent - 1)) + (x < 0 ? 1 : 0);
}

/// The numbers of a case that stand for themselves: a value that several corners have on an axis is one of them, so
/// that what they share stays shared.
class Numbers {
 public:
  explicit Numbers(HitCase& hit_case) : case_(hit_case) {
    for (int axis = 0; axis < 3; ++axis) {
      std::set<uint32_t> values;
      for (const auto& corners : case_.triangles) {
        for (const Vec3& corner : corners) values.insert(as_bits(corner[axis]));
      }
      for (const uint32_t value : values) numbers_.push_back({axis, as_float(value)});
    }
  }
  size_t count() const { return numbers_.size() + 7; }
  float get(size_t i) const { return i < 7 ? *of_ray(i) : numbers_[i - 7].value; }
  void set(size_t i, float value) {
    if (i < 7) {
      *of_ray(i) = value;
      return;
    }
    Number& number = numbers_[i - 7];
    for (auto& corners : case_.triangles) {
      for (Vec3& corner : corners) {
        float& x = corner[number.axis];
        if (as_bits(x) == as_bits(number.value)) x = value;
      }
    }
    number.value = value;
  }

 private:
  struct Number {
    int axis;
    float value;
  };
  float* of_ray(size_t i) const {
    RayQuery& ray = case_.ray;
    return i < 3 ? &ray.origin[static_cast<int>(i)] : i < 6 ? &ray.direction[static_cast<int>(i) - 3] : &ray.limit;
  }

  HitCase& case_;
  std::vector<Number> numbers_;
};

/// Simpler ones first.
std::vector<float> simpler_than(float x) {
  std::vector<float> candidates = {0, 1, -1, 2, -2, INFINITY};
  if (!std::isfinite(x) || x == 0) return candidates;
  for (const float rounded : {std::trunc(x), std::round(x)}) candidates.push_back(rounded);
  const uint32_t bits = as_bits(x);
  for (const int dropped : {22, 20, 18, 16, 12, 8, 4, 2, 1}) {
    const uint32_t ones = (1u << dropped) - 1;
    candidates.push_back(as_float(bits & ~ones));
    candidates.push_back(as_float((bits & ~ones) + ones + 1));
  }
  candidates.push_back(std::fabs(x));
  for (const int places : {-64, -16, -4, -1, 1, 4, 16, 64}) candidates.push_back(std::ldexp(x, places));
  return candidates;
}

class Minimiser {
 public:
  Minimiser(const HitCase& failing, const std::function<bool(const HitCase&)>& fails, uint32_t trials)
      : best_(failing), size_(size_of(failing)), fails_(fails), left_(trials) {}

  HitCase run() {
    bool smaller = true;
    while (smaller && left_ > 0) {
      smaller = fewer_triangles();
      smaller |= other_places();
      smaller |= simpler_numbers();
    }
    return best_;
  }

 private:
  bool take(const HitCase& candidate) {
    const CaseSize size = size_of(candidate);
    if (left_ == 0 || !(size < size_)) return false;
    --left_;
    if (!fails_(candidate)) return false;
    best_ = candidate;
    size_ = size;
    return true;
  }
  bool fewer_triangles() {
    bool smaller = false;
    for (size_t i = best_.triangles.size(); i > 0; --i) {
      HitCase candidate = best_;
      candidate.triangles.erase(candidate.triangles.begin() + static_cast<std::ptrdiff_t>(i - 1));
      smaller |= take(candidate);
    }
    return smaller;
  }
  /// All at once: so that the origin, or a corner, is zero; and everything times a power of two.
  bool other_places() {
    bool smaller = false;
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<float> places = {best_.ray.origin[axis]};
      for (const auto& corners : best_.triangles) places.push_back(corners[0][axis]);
      for (const float place : places) smaller |= take(moved(axis, place));
    }
    for (const int exponent : {-64, -16, -4, -1, 1, 4, 16, 64}) {
      smaller |= take(scaled(exponent, true)) | take(scaled(exponent, false));
    }
    return smaller;
  }
  HitCase moved(int axis, float place) const {
    HitCase candidate = best_;
    candidate.ray.origin[axis] -= place;
    for (auto& corners : candidate.triangles) {
      for (Vec3& corner : corners) corner[axis] -= place;
    }
    return candidate;
  }
  HitCase scaled(int exponent, bool places) const {
    HitCase candidate = best_;
    for (int axis = 0; axis < 3; ++axis) {
      const auto scale = [&](Vec3& v) { v[axis] = std::ldexp(v[axis], exponent); };
      if (!places) scale(candidate.ray.direction);
      if (!places) continue;
      scale(candidate.ray.origin);
      for (auto& corners : candidate.triangles) std::for_each(corners.begin(), corners.end(), scale);
    }
    return candidate;
  }
  bool simpler_numbers() {
    bool smaller = false;
    for (size_t i = 0; i < Numbers(best_).count(); ++i) {
      const float old = Numbers(best_).get(i);
      for (const float value : simpler_than(old)) {
        HitCase candidate = best_;
        Numbers numbers(candidate);
        const bool corner = i >= 7;
        if (i >= numbers.count() || (corner && !std::isfinite(value))) continue;
        numbers.set(i, value);
        if (!take(candidate)) continue;
        smaller = true;
        break;
      }
    }
    return smaller;
  }

  HitCase best_;
  CaseSize size_;
  const std::function<bool(const HitCase&)>& fails_;
  uint32_t left_;
};

}  // namespace

CaseSize size_of(const HitCase& hit_case) {
  CaseSize size;
  size.triangles = hit_case.triangles.size();
  const auto count = [&](const Vec3& v) { size.digits += digits_of(v.x) + digits_of(v.y) + digits_of(v.z); };
  count(hit_case.ray.origin);
  count(hit_case.ray.direction);
  // No limit is the simplest.
  size.digits += std::isinf(hit_case.ray.limit) ? 0 : 1 + digits_of(hit_case.ray.limit);
  for (const auto& corners : hit_case.triangles) std::for_each(corners.begin(), corners.end(), count);
  return size;
}

HitCase minimise(const HitCase& failing, const std::function<bool(const HitCase&)>& fails, uint32_t trials) {
  return Minimiser(failing, fails, trials).run();
}

}  // namespace raypool::referee
