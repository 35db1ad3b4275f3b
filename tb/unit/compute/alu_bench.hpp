// Drives a bench top of several ALUs (flt_units.v, slw_units.v, brh_units.v) with the same tasks and compares every
// result, its warp and the cycle it comes in with the model. Tasks come with random masks, warps and pauses, as often
// as the slowest of the ALUs takes them.
#pragma once

#include <gtest/gtest.h>
#include <verilated.h>

#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "arith/arith.hpp"
#include "arith/test_operands.hpp"
#include "enum_array.hpp"
#include "isa/encoding.hpp"
#include "numerics/long_table.hpp"
#include "unit/compute/alu_model.hpp"

namespace raypool {

inline constexpr int kBenchLanes = 4;  ///< parameter LANES of the tops

/// One of the ALUs in the top, in the order of its output bits.
struct AluUnderTest {
  std::string name;
  arith::Mode mode;
  uint32_t depth;
  uint32_t latency = 1;
};

/// The lanes of a task that have their results looked at, of a unit of this mode.
using ComparedFunction = uint32_t (*)(Opcode opcode, uint32_t mask, arith::Mode mode);
inline uint32_t lanes_of_mask(Opcode, uint32_t mask, arith::Mode) { return mask; }

template <typename Top>
class AluBench {
 public:
  AluBench(std::vector<AluUnderTest> units, ModelFunction model, uint64_t seed,
           ComparedFunction looked_at = lanes_of_mask)
      : units_(std::move(units)),
        model_(model),
        looked_at_(looked_at),
        seed_(seed),
        random_(seed),
        expected_(units_.size()),
        top_(&context_) {
    top_.rst_ni = 0;
    top_.task_valid_i = 0;
    tick();
    tick();
    top_.rst_ni = 1;
  }
  ~AluBench() { top_.final(); }

  /// Adds one lane's operation to the next task; a task takes operations of one kind, so a
  /// change of kind sends what is gathered.
  void add(Opcode opcode, uint32_t a, uint32_t b, uint32_t c = 0) {
    if (lanes_ != 0 && opcode != opcode_) send();
    opcode_ = opcode;
    while (lanes_ < kBenchLanes - 1 && random_() % 8 == 0) ++lanes_;  // a hole in the mask; the lane has old operands
    mask_ |= 1u << lanes_;
    a_[lanes_] = a;
    b_[lanes_] = b;
    c_[lanes_] = c;
    if (++lanes_ == kBenchLanes) send();
  }

  /// Adds a task without lanes, which must give `expected` in every lane.
  void add_outside(Opcode opcode, uint32_t expected) {
    if (lanes_ != 0) send();
    opcode_ = opcode;
    send(&expected);
  }

  /// Sends the rest and waits for all results.
  void finish() {
    if (lanes_ != 0) send();
    for (int i = 0; i < 64; ++i) clock();
    for (size_t u = 0; u < units_.size(); ++u) ASSERT_TRUE(expected_[u].empty()) << units_[u].name << " lost tasks";
  }

  uint64_t compared() const { return count(Subnormals::Ieee).inputs + count(Subnormals::Flush).inputs; }
  /// Of all units of a subnormal mode.
  const LongCount& count(Subnormals mode) const { return counts_[mode]; }

 private:
  struct Expected {
    uint64_t cycle;
    Opcode opcode;
    uint32_t warp, mask;
    std::array<uint32_t, kBenchLanes> a, b, c, result;
  };

  /// `everywhere`: what is expected in every lane, in place of the model's results.
  void send(const uint32_t* everywhere = nullptr) {
    while (random_() % 4 == 0 || !all_ready()) clock();
    const uint32_t warp = random_() % 8;
    top_.task_valid_i = 1;
    top_.task_warp_i = warp;
    top_.task_operation_i = operation_of(opcode_);
    top_.task_mask_i = mask_;
    for (int l = 0; l < kBenchLanes; ++l) {
      top_.task_operand_a_i[l] = a_[l];
      top_.task_operand_b_i[l] = b_[l];
      set_third(top_, l, c_[l], 0);
    }
    for (size_t u = 0; u < units_.size(); ++u) {
      Expected e{cycle_ + units_[u].depth, opcode_, warp, looked_at_(opcode_, mask_, units_[u].mode), a_, b_, c_, {}};
      for (int l = 0; l < kBenchLanes; ++l) e.result[l] = model_(opcode_, a_[l], b_[l], c_[l], units_[u].mode);
      if (everywhere != nullptr) e.mask = (1u << kBenchLanes) - 1, e.result.fill(*everywhere);
      expected_[u].push_back(e);
    }
    sent_ = cycle_;
    clock();
    top_.task_valid_i = 0;
    while (!all_ready()) clock();
    top_.task_operand_a_i[0] = static_cast<uint32_t>(random_());  // must not be looked at
    lanes_ = 0;
    mask_ = 0;
  }

  /// The third operand, of tops that have one; where there are predicates its lowest bits are task_predicate_x_i and
  /// task_predicate_b_i.
  template <typename T>
  static auto set_third(T& top, int lane, uint32_t c, int) -> decltype(void(top.task_operand_c_i[0])) {
    top.task_operand_c_i[lane] = c;
  }
  template <typename T>
  static auto set_third(T& top, int lane, uint32_t c, long) -> decltype(void(top.task_predicate_x_i)) {
    const uint32_t others = ~(1u << lane);
    top.task_predicate_x_i = (top.task_predicate_x_i & others) | (c & 1) << lane;
    top.task_predicate_b_i = (top.task_predicate_b_i & others) | (c >> 1 & 1) << lane;
  }
  template <typename T>
  static void set_third(T&, int, uint32_t, ...) {}

  /// A result, of tops without results a predicate.
  template <typename T>
  static auto result_of(const T& top, size_t index, int) -> decltype(uint32_t{top.done_data_o[0]}) {
    return top.done_data_o[index];
  }
  template <typename T>
  static uint32_t result_of(const T& top, size_t index, long) {
    return top.done_predicate_o >> index & 1;
  }

  /// Whether a task granted in this cycle, which arrives in the next one, is taken.
  bool takes_next(const AluUnderTest& unit) const { return !sent_ || cycle_ + 1 >= *sent_ + unit.latency; }
  /// Whether a task may arrive in this cycle.
  bool all_ready() const {
    for (const AluUnderTest& unit : units_)
      if (sent_ && cycle_ < *sent_ + unit.latency) return false;
    return true;
  }

  void clock() {
    top_.eval();  // ready_o depends on the task's valid
    check();
    tick();
    ++cycle_;
  }

  void tick() {
    top_.clk_i = 0;
    top_.eval();
    top_.clk_i = 1;
    top_.eval();
  }

  void check() {
    for (size_t u = 0; u < units_.size(); ++u) {
      const bool done = top_.done_valid_o >> u & 1;
      const bool due = !expected_[u].empty() && expected_[u].front().cycle == cycle_;
      const bool ready = top_.ready_o >> u & 1;
      if (done != due || ready != takes_next(units_[u])) {
        if (++failures_ <= 10)
          ADD_FAILURE() << units_[u].name << ": done " << done << ", expected " << due << "; ready " << ready
                        << ", cycle " << cycle_;
      }
      if (!due) continue;
      const Expected e = expected_[u].front();
      expected_[u].pop_front();
      const uint32_t warp = top_.done_warp_o >> (3 * u) & 7;
      for (int l = 0; l < kBenchLanes; ++l) {
        if (!(e.mask >> l & 1)) continue;
        const uint32_t result = result_of(top_, u * kBenchLanes + static_cast<size_t>(l), 0);
        LongCount& count = counts_[units_[u].mode.subnormals];
        ++count.inputs;
        if (result == e.result[l] && warp == e.warp) continue;
        ++count.errors;
        if (++failures_ <= 10) {
          ADD_FAILURE() << units_[u].name << ' ' << instruction(e.opcode).mnemonic << " lane " << l << std::hex
                        << ": a " << e.a[l] << " b " << e.b[l] << " c " << e.c[l] << " RTL " << result << " model "
                        << e.result[l] << std::dec << ", warp " << warp << " expected " << e.warp << ", seed " << seed_;
        }
      }
    }
  }

  std::vector<AluUnderTest> units_;
  ModelFunction model_;
  ComparedFunction looked_at_;
  uint64_t seed_;
  std::mt19937_64 random_;
  std::vector<std::deque<Expected>> expected_;
  VerilatedContext context_;
  Top top_;
  Opcode opcode_{};
  int lanes_ = 0;      ///< used or left out in the task that is being gathered
  uint32_t mask_ = 0;  ///< of those used
  std::array<uint32_t, kBenchLanes> a_{}, b_{}, c_{};
  uint64_t cycle_ = 0;
  std::optional<uint64_t> sent_;  ///< when the last task arrived
  EnumArray<Subnormals, LongCount, 2> counts_;
  int failures_ = 0;
};

}  // namespace raypool
