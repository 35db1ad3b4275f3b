#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <vector>

#include "kernel/compiler.hpp"

namespace raypool::kernel {
namespace {

/// What is left of a kernel whose `body` gets a predicate that no lane has.
Function left_of(const std::function<void(Recorder&, RecordedKernel&, int)>& body) {
  Recorder recorder("left");
  RecordedKernel kernel(recorder);
  const int no_lane = recorder.declare_predicate();
  body(recorder, kernel, no_lane);
  Function function = recorder.finish();
  remove_unreached(function);
  return function;
}

int count(const Function& function, Opcode opcode) {
  return static_cast<int>(
      std::count_if(function.ops.begin(), function.ops.end(), [&](const Op& op) { return is(op, opcode); }));
}

void store_some(RecordedKernel& kernel, int stores) {
  for (int i = 0; i < stores; ++i) kernel.store(kernel.thread(), 4 * i, kernel.block());
}

TEST(Unreached, GoesWithItsJumpAndAllThatDependsOnIt) {
  for (const int stores : {1, 9}) {
    const Function function = left_of([&](Recorder& recorder, RecordedKernel& kernel, int no_lane) {
      recorder.begin_if({no_lane, false, {}});
      store_some(kernel, stores);
      const auto inner = kernel.thread() == 3;
      recorder.begin_if({inner.number(), false, {}});
      store_some(kernel, stores);
      recorder.end_if();
      recorder.end_if();
    });
    EXPECT_EQ(count(function, Opcode::St), 0) << stores;
    EXPECT_EQ(count(function, Opcode::Jnone), 0) << stores;
    EXPECT_EQ(count(function, Opcode::Exit), 1);
  }
}

TEST(Unreached, IsNotTheOtherArm) {
  const Function function = left_of([](Recorder& recorder, RecordedKernel& kernel, int no_lane) {
    recorder.begin_if({no_lane, false, {}});
    store_some(kernel, 8);
    recorder.begin_else();
    store_some(kernel, 7);
    recorder.end_if();
  });
  EXPECT_EQ(count(function, Opcode::St), 7);
}

TEST(Unreached, IsNotWhatLanesJoinLater) {
  const Function function = left_of([](Recorder& recorder, RecordedKernel& kernel, int no_lane) {
    const auto some = kernel.thread() == 3;
    const int again = recorder.materialise({some.number(), false, {}});
    recorder.begin_loop(again, {});
    recorder.begin_if({no_lane, false, {}});
    store_some(kernel, 8);
    recorder.end_if();
    recorder.join(no_lane);  // from the second round on
    recorder.end_loop(some.number(), false);
  });
  EXPECT_EQ(count(function, Opcode::St), 8);
}

TEST(Unreached, IsALoopThatNoLaneEnters) {
  const Function function = left_of([](Recorder& recorder, RecordedKernel& kernel, int no_lane) {
    recorder.begin_loop(no_lane, {});
    store_some(kernel, 3);
    recorder.end_loop(no_lane, false);
    store_some(kernel, 1);
  });
  EXPECT_EQ(count(function, Opcode::St), 1);
  EXPECT_EQ(count(function, Opcode::Loop), 0);
}

bool reads(const Op& op, int predicate) {
  const Effects effect = effects(op);
  return std::find(std::begin(effect.predicate_uses), std::end(effect.predicate_uses), predicate) !=
         std::end(effect.predicate_uses);
}

TEST(Unreached, LeavesNothingThatReadsAPredicateOfNoLane) {
  int never = kNothing;
  const Function function = left_of([&](Recorder& recorder, RecordedKernel& kernel, int no_lane) {
    never = no_lane;
    const auto some = kernel.thread() == 3;
    const int joined = recorder.emit_predicates(Opcode::Por, no_lane, some.number(), {});
    const int less = recorder.emit_predicates(Opcode::Pandn, some.number(), no_lane, {});
    const int either = recorder.emit_predicates(Opcode::Pxor, joined, no_lane, {});
    const int none = recorder.emit_predicates(Opcode::Pand, less, no_lane, {});
    for (const int lanes : {joined, less, either}) {
      recorder.begin_if({lanes, false, {}});
      store_some(kernel, 2);
      recorder.end_if();
    }
    recorder.begin_if({none, true, {}});
    store_some(kernel, 1);
    recorder.emit_select({no_lane, false, {}}, kernel.thread().number(), kernel.block().number(), {});
    recorder.end_if();
  });
  EXPECT_EQ(count(function, Opcode::St), 7);
  for (const Op& op : function.ops) EXPECT_FALSE(op.kind == Op::Kind::Instruction && reads(op, never));
  for (const Opcode gone : {Opcode::Por, Opcode::Pxor, Opcode::Sel}) EXPECT_EQ(count(function, gone), 0);
}

TEST(Unreached, KeepsThatAPredicateIsCleared) {
  int cleared = kNothing;
  const Function function = left_of([&](Recorder& recorder, RecordedKernel& kernel, int no_lane) {
    const auto some = kernel.thread() == 3;
    cleared = recorder.materialise({some.number(), false, {}});
    recorder.begin_if({cleared, false, {}});
    store_some(kernel, 1);
    recorder.end_if();
    recorder.assign_predicate(cleared, no_lane, false);
  });
  std::vector<Opcode> makes;
  for (const Op& op : function.ops)
    if (op.kind == Op::Kind::Instruction && writes_predicate(*op.info) && op.rd == cleared)
      makes.push_back(op.info->opcode);
  EXPECT_EQ(makes, (std::vector<Opcode>{Opcode::Pand, Opcode::Pxor}));
}

TEST(Unreached, KeepsWhatChangesTheSlicesOfAWarp) {
  const Function function = left_of([](Recorder& recorder, RecordedKernel& kernel, int no_lane) {
    recorder.begin_if({no_lane, false, {}});
    kernel.set_word(3, kernel.thread());
    kernel.ray_out();
    recorder.end_if();
  });
  EXPECT_EQ(count(function, Opcode::Rst), 0);
  EXPECT_EQ(count(function, Opcode::Rout), 1);
}

}  // namespace
}  // namespace raypool::kernel
