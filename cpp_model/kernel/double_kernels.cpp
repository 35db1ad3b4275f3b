#include "kernel/double_kernels.hpp"

#include <algorithm>
#include <cmath>

#include "bits.hpp"
#include "kernel/ray_kernels.hpp"

namespace raypool {
namespace {

/// What the kernels ask of a kernel language (kernel/kernel.hpp), and no more.
class DoubleKernel {
 public:
  struct Bool {
    bool value;
    Bool(bool literal) : value(literal) {}
    friend Bool operator&&(Bool a, Bool b) { return a.value & b.value; }
  };
  struct Float;
  /// A word that is copied may be a number.
  struct Int {
    DoubleWord word;
    Int(int literal) : word{static_cast<uint32_t>(literal), 0} {}
    Int(uint32_t literal) : word{literal, 0} {}
    explicit Int(const DoubleWord& copied) : word(copied) {}
    int32_t value() const { return static_cast<int32_t>(word.bits); }
    friend Int operator+(const Int& a, const Int& b) { return a.word.bits + b.word.bits; }
    friend Int operator&(const Int& a, const Int& b) { return a.word.bits & b.word.bits; }
    friend Int operator|(const Int& a, const Int& b) { return a.word.bits | b.word.bits; }
    friend Int operator<<(const Int& a, const Int& b) { return a.word.bits << (b.word.bits & 31); }
    friend Int shift_right_logical(const Int& a, const Int& b) { return a.word.bits >> (b.word.bits & 31); }
    friend Bool operator<(const Int& a, const Int& b) { return a.value() < b.value(); }
    friend Float to_float(const Int& a) { return static_cast<double>(a.value()); }
  };
  struct Float {
    double value;
    Float(double literal) : value(literal) {}
    friend Float operator+(Float a, Float b) { return a.value + b.value; }
    friend Float operator-(Float a, Float b) { return a.value - b.value; }
    friend Float operator*(Float a, Float b) { return a.value * b.value; }
    friend Float operator-(Float a) { return -a.value; }
    friend Float multiply_add(Float a, Float b, Float c) { return a.value * b.value + c.value; }
    friend Float rsqrt(Float a) { return 1 / std::sqrt(a.value); }
    // Of NaN and a number the number, as the machine's.
    friend Float min(Float a, Float b) { return std::fmin(a.value, b.value); }
    friend Float abs(Float a) { return std::fabs(a.value); }
    friend Float max(Float a, Float b) { return std::fmax(a.value, b.value); }
    friend Bool operator>(Float a, Float b) { return a.value > b.value; }
  };

  explicit DoubleKernel(DoubleThread& thread) : thread_(thread) {}

  static bool culling() { return false; }
  Int thread() const { return thread_.thread; }
  Int block() const { return thread_.block; }
  Int int_argument(int number) const { return Int((*thread_.arguments)[number]); }
  Float float_argument(int number) const { return (*thread_.arguments)[number].number; }
  Float load_float(const Int& address, int offset) const {
    return as_float(thread_.memory->load(address.word.bits + static_cast<uint32_t>(offset)));
  }

  void ray_in() { words_ = thread_.input; }
  Int int_word(int number) const { return Int(words_[number]); }
  Float float_word(int number) const { return words_[number].number; }
  void set_word(int number, const Int& value) { words_[number] = value.word; }
  void set_word(int number, Float value) { words_[number].number = value.value; }
  void ray_out() {
    DoubleRay ray;
    std::copy_n(words_.begin(), ray.size(), ray.begin());
    thread_.rays.push_back(ray);
  }
  void frame_out() {
    thread_.frame.push_back(
        {words_[word::kPixel].bits,
         {words_[word::kColor].number, words_[word::kColor + 1].number, words_[word::kColor + 2].number}});
  }
  template <typename Then>
  void if_(Bool condition, const Then& then) {
    if (condition.value) then();
  }

 private:
  DoubleThread& thread_;
  DoubleIntersection words_;
};

}  // namespace

void run_in_double(RayKernel which, DoubleThread& thread) {
  DoubleKernel k(thread);
  kernel::run_kernel(which, k);
}

}  // namespace raypool
