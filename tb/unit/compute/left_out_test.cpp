// ALUs that lack instructions: each instruction that a unit may be without, in an ALU that has none of the others,
// gives what it gives in the ALU that has all. What has all is compared with the model elsewhere.
#include <gtest/gtest.h>

#include <random>

#include "Vleft_out_units.h"
#include "Vleft_out_units_short.h"
#include "arith/test_operands.hpp"
#include "isa/isa.hpp"

namespace raypool {
namespace {

constexpr AluType kTypes[] = {AluType::Brh, AluType::Int, AluType::Flt, AluType::Slw};  // as the top has them
constexpr int kDeepest = 16;

template <typename Top>
class Bench {
 public:
  Bench() {
    top_.rst_ni = 0;
    step();
    top_.rst_ni = 1;
  }

  /// Tasks of the operation: how many ended in that type's ALUs, and in how many the ALU that has `alone` differed.
  struct Seen {
    int ended = 0, differed = 0;
  };
  Seen run(size_t type, int operation, int alone, int tasks, arith::OperandSource& operands) {
    Seen seen;
    for (int n = 0; n < tasks + kDeepest; ++n) {
      const auto [a, b] = operands.next();
      top_.task_valid_i = n < tasks ? 1 : 0;
      top_.task_operation_i = operation;
      top_.task_operand_a_i = a;
      top_.task_operand_b_i = random_() % 4 == 0 ? a : b;
      top_.task_predicate_x_i = random_() & 1;
      step();
      if ((top_.done_valid_o >> type & 1) == 0) continue;
      ++seen.ended;
      seen.differed += top_.differs_o[type] >> alone & 1;
    }
    return seen;
  }

 private:
  void step() {
    top_.clk_i = 0;
    top_.eval();
    top_.clk_i = 1;
    top_.eval();
  }

  Top top_;
  std::mt19937 random_{1};
};

template <typename VerilatedTop, uint32_t kBits>
struct Case {
  using Top = VerilatedTop;
  static constexpr uint32_t kSignificand = kBits;
};
template <typename Type>
class LeftOut : public testing::Test {};
using Cases = testing::Types<Case<Vleft_out_units, 24>, Case<Vleft_out_units_short, 16>>;
struct CaseName {
  template <typename Type>
  static std::string GetName(int) {
    return std::to_string(Type::kSignificand);
  }
};
TYPED_TEST_SUITE(LeftOut, Cases, CaseName);

TYPED_TEST(LeftOut, AnInstructionAloneGivesWhatItGivesAmongAll) {
  Bench<typename TypeParam::Top> bench;
  arith::OperandSource operands(1, TypeParam::kSignificand);
  constexpr int kTasks = 20000;
  for (size_t type = 0; type < std::size(kTypes); ++type) {
    for (const InstructionInfo& info : kInstructions) {
      if (info.alu() != kTypes[type] || info.needs != Feature::Optional) continue;
      const auto seen = bench.run(type, info.operation(), info.operation(), kTasks, operands);
      EXPECT_EQ(seen.ended, kTasks) << info.mnemonic;
      EXPECT_EQ(seen.differed, 0) << info.mnemonic;
    }
  }
}

TYPED_TEST(LeftOut, WhatEveryUnitHasStays) {
  Bench<typename TypeParam::Top> bench;
  arith::OperandSource operands(2, TypeParam::kSignificand);
  for (size_t type = 0; type < std::size(kTypes); ++type) {
    for (const InstructionInfo& each : kInstructions) {
      if (each.alu() != kTypes[type] || each.needs != Feature::Base) continue;
      for (const InstructionInfo& alone : kInstructions) {
        if (alone.alu() != kTypes[type] || alone.needs != Feature::Optional) continue;
        EXPECT_EQ(bench.run(type, each.operation(), alone.operation(), 300, operands).differed, 0)
            << each.mnemonic << " beside " << alone.mnemonic;
      }
    }
  }
}

// The comparison sees something: what an ALU lacks it does not do.
TYPED_TEST(LeftOut, WhatIsLackingIsNotThere) {
  Bench<typename TypeParam::Top> bench;
  arith::OperandSource operands(3, TypeParam::kSignificand);
  const auto differed = [&](size_t type, Opcode asked, Opcode alone) {
    return bench.run(type, operation_of(asked), operation_of(alone), 300, operands).differed;
  };
  EXPECT_GT(differed(0, Opcode::Flt, Opcode::Ilt), 0);
  EXPECT_GT(differed(1, Opcode::Imul, Opcode::Sar), 0);
  EXPECT_GT(differed(2, Opcode::F2i, Opcode::Fmin), 0);
  EXPECT_GT(differed(3, Opcode::Fdiv, Opcode::Frsqrt), 0);
  EXPECT_GT(differed(3, Opcode::Frsqrt, Opcode::Fsqrt), 0);
}

}  // namespace
}  // namespace raypool
