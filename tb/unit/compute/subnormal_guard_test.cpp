// The ALUs of machines without subnormal numbers flag each task that has met one, as the model does.
#include "machine/compute/subnormal_guard.hpp"

#include <gtest/gtest.h>

#include <deque>
#include <random>
#include <vector>

#include "Vguard_units.h"
#include "Vguard_units_13.h"
#include "arith/test_operands.hpp"
#include "isa/isa.hpp"
#include "machine/compute/brh_alu.hpp"
#include "machine/compute/flt_alu.hpp"
#include "machine/compute/slw_alu.hpp"

namespace raypool {
namespace {

constexpr int kLanes = 4, kUnits = 5;
constexpr AluType kTypes[kUnits] = {AluType::Brh, AluType::Flt, AluType::Flt, AluType::Slw, AluType::Slw};
constexpr SlowUnit kSlowUnits[kUnits] = {SlowUnit::Exact, SlowUnit::Exact, SlowUnit::Exact, SlowUnit::Exact,
                                         SlowUnit::Newton0};
constexpr bool kFused[kUnits] = {false, false, true, false, false};
constexpr int kGroups = 4;  // of the last unit: its task ports stay for so many cycles

struct Task {
  Opcode opcode;
  uint32_t mask;
  uint32_t a[kLanes], b[kLanes], c[kLanes];
};

bool met_by_model(const Task& task, arith::Mode mode) {
  uint32_t rd[kLanes] = {};
  const Lanes<kLanes> lanes = {task.mask, rd, task.a, task.b, task.c};
  const SubnormalGuard<kLanes> guard(task.opcode, lanes, mode);
  if (alu_of(task.opcode) == AluType::Brh) return guard.met(nullptr);
  if (alu_of(task.opcode) == AluType::Flt)
    FltAlu::execute(task.opcode, lanes, mode);
  else
    SlwAlu::execute(task.opcode, lanes, mode);
  return guard.met(rd);
}

template <typename Top>
class Bench {
 public:
  explicit Bench(uint32_t significand) : significand_(significand), operands_(1, significand) {
    top_.rst_ni = 0;
    for (int n = 0; n < 20; ++n) step();  // what stages hold of before is gone
    top_.rst_ni = 1;
    for (int u = 0; u < kUnits; ++u)
      for (const InstructionInfo& info : kInstructions)
        if (info.alu() == kTypes[u] && info.kind == Kind::Plain && info.needs != Feature::Triples &&
            info.needs != Feature::FusedTriples && (kFused[u] || info.needs != Feature::FusedMultiplyAdd))
          opcodes_[u].push_back(info.opcode);
  }

  /// One task of a unit; in most of them few lanes, or none, have subnormal numbers.
  void send(int unit) {
    Task task{};
    task.opcode = opcodes_[unit][random_() % opcodes_[unit].size()];
    task.mask = random_() % 16;
    const bool calm = random_() % 2 == 0;
    const uint32_t wild = random_() % kLanes;
    for (uint32_t lane = 0; lane < kLanes; ++lane) {
      const auto [a, b] = operands_.next();
      task.a[lane] = word(a, calm && lane != wild);
      task.b[lane] = word(b, calm && lane != wild);
      task.c[lane] = word(operands_.third(a, b), calm && lane != wild);
      top_.task_operand_a_i[lane] = task.a[lane];
      top_.task_operand_b_i[lane] = task.b[lane];
      top_.task_operand_c_i[lane] = task.c[lane];
    }
    top_.task_valid_i = 1u << unit;
    top_.task_operation_i = operation_of(task.opcode);
    top_.task_mask_i = task.mask;
    expected_[unit].push_back(task);
    step();
    top_.task_valid_i = 0;
    if (unit == kUnits - 1)
      for (int n = 1; n < kGroups; ++n) step();
    top_.task_operand_a_i[0] = 1;  // must not be looked at
  }

  void finish() {
    top_.task_valid_i = 0;
    for (int n = 0; n < 40; ++n) step();
    for (int u = 0; u < kUnits; ++u) EXPECT_TRUE(expected_[u].empty()) << "unit " << u << " lost tasks";
  }

  int met = 0, clean = 0;

 private:
  /// Of the size of one, if it is to be: nothing tiny comes of it.
  static uint32_t word(uint32_t word, bool calm) { return calm ? (word & 0x9fffffffu) + 0x20000000u : word; }

  void step() {
    top_.clk_i = 0;
    top_.eval();
    top_.clk_i = 1;
    top_.eval();
    for (int u = 0; u < kUnits; ++u) {
      if ((top_.done_valid_o >> u & 1) == 0) continue;
      ASSERT_FALSE(expected_[u].empty());
      const Task task = expected_[u].front();
      expected_[u].pop_front();
      const bool expected = met_by_model(task, {Subnormals::None, kSlowUnits[u], kFused[u], significand_});
      const bool rtl = (top_.done_subnormal_o >> u & 1) != 0;
      ++(expected ? met : clean);
      if (rtl == expected) continue;
      if (++failures_ > 10) continue;
      ADD_FAILURE() << "unit " << u << ' ' << instruction_name(task.opcode) << ": RTL " << rtl << ", model " << expected
                    << std::hex << ", mask " << task.mask << ", a " << task.a[0] << ' ' << task.a[1] << ' ' << task.a[2]
                    << ' ' << task.a[3] << ", b " << task.b[0] << ' ' << task.b[1] << ' ' << task.b[2] << ' '
                    << task.b[3];
    }
  }

  static std::string_view instruction_name(Opcode opcode) {
    for (const InstructionInfo& info : kInstructions)
      if (info.opcode == opcode) return info.mnemonic;
    return "";
  }

  Top top_;
  uint32_t significand_;
  arith::OperandSource operands_;
  std::mt19937 random_{1};
  std::vector<Opcode> opcodes_[kUnits];
  std::deque<Task> expected_[kUnits];
  int failures_ = 0;
};

template <typename Top>
void compare(uint32_t significand) {
  Bench<Top> bench(significand);
  std::mt19937 random(2);
  for (int n = 0; n < 200'000; ++n) bench.send(static_cast<int>(random() % kUnits));
  bench.finish();
  EXPECT_GT(bench.met, 20'000);
  EXPECT_GT(bench.clean, 20'000);
}

TEST(SubnormalGuard, FlagsTheTasksThatTheModelFlags) { compare<Vguard_units>(24); }
TEST(SubnormalGuard, FlagsTheTasksThatTheModelFlagsOf13Bits) { compare<Vguard_units_13>(13); }

bool met(Opcode opcode, uint32_t a, uint32_t b, uint32_t c = 0, uint32_t mask = 1) {
  Task task{opcode, mask, {a}, {b}, {c}};
  return met_by_model(task, {Subnormals::None});
}

// The model's rule itself.
TEST(SubnormalGuard, OperandsThatAreReadAndResultsThatAreFlushed) {
  constexpr uint32_t kOne = 0x3f800000u, kLeast = 1, kLeastNormal = 0x00800000u, kInfinite = 0x7f800000u;
  EXPECT_TRUE(met(Opcode::Fadd, kLeast, kOne));
  EXPECT_TRUE(met(Opcode::Fadd, kOne, kLeast));
  EXPECT_FALSE(met(Opcode::Fadd, kOne, kLeast, 0, 0)) << "no lane";
  EXPECT_FALSE(met(Opcode::F2i, kOne, kLeast)) << "b is not read";
  EXPECT_TRUE(met(Opcode::F2i, kLeast, 0));
  EXPECT_FALSE(met(Opcode::I2f, kLeast, 0)) << "an integer";
  EXPECT_FALSE(met(Opcode::Ieq, kLeast, kLeast)) << "integers";
  EXPECT_TRUE(met(Opcode::Feq, kLeast, kOne));
  EXPECT_FALSE(met(Opcode::Fmul, 0, kOne)) << "zero is exact";
  EXPECT_FALSE(met(Opcode::Fsub, kOne, kOne)) << "zero is exact";
  EXPECT_TRUE(met(Opcode::Fmul, kLeastNormal, kOne - kLeastNormal));
  EXPECT_TRUE(met(Opcode::Fmul, kLeastNormal, kLeastNormal)) << "far below the smallest subnormal number";
  EXPECT_FALSE(met(Opcode::Fmul, kLeastNormal, kOne)) << "the smallest normal number";
  EXPECT_TRUE(met(Opcode::Fsub, kLeastNormal + 1, kLeastNormal));
  EXPECT_TRUE(met(Opcode::Fdiv, kLeastNormal, 2 * kOne - kLeastNormal));
  EXPECT_FALSE(met(Opcode::Fdiv, kOne, kInfinite)) << "zero is exact";
  EXPECT_TRUE(met(Opcode::Frcp, kInfinite - 1, 0));
  EXPECT_FALSE(met(Opcode::Frcp, kInfinite, 0));
  EXPECT_TRUE(met(Opcode::Ffma, kOne, kOne, kLeast));
  EXPECT_TRUE(met(Opcode::Ffma, kLeastNormal, kLeastNormal, 0));
  EXPECT_FALSE(met(Opcode::Ffma, kOne, kOne, kOne ^ 0x80000000u)) << "zero is exact";
}

}  // namespace
}  // namespace raypool
