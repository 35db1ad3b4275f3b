// Kernels run from intermediate code, beside the same kernels run as C++. random_kernel_test.cpp has random ones.
#include "kernel/function_runner.hpp"

#include <gtest/gtest.h>

#include "isa/input_error.hpp"
#include "kernel/kernel.hpp"
#include "kernel/ray_kernels.hpp"
#include "random.hpp"

namespace raypool::kernel {
namespace {

constexpr uint32_t kRayMemoryBytes = 1024;

/// A thread with words that look like rays and hits, and some that look like nothing.
struct RayThread {
  std::array<uint32_t, kArguments> arguments{};
  Memory memory{kRayMemoryBytes};
  NativeThread thread;

  explicit RayThread(uint32_t seed) {
    Random random(seed);
    const auto number = [&] {
      if (random() % 32 == 0) return static_cast<uint32_t>(random());
      return as_bits((static_cast<int>(random() % 4001) - 2000) / 256.0f);
    };
    for (uint32_t& word : arguments) word = number();
    for (uint32_t address = 0; address < kRayMemoryBytes; address += 4) memory.store(address, number());
    for (uint32_t& word : thread.input) word = number();
    thread.input[word::kMaterial] = 32 * (random() % 31);
    arguments[argument::kTileWidthLog2] = 3;
    arguments[argument::kTileMask] = 7;
    arguments[argument::kWidth] = arguments[argument::kHeight] = 100;
    thread.thread = random() % 64;
    thread.block = random() % 99 | random() % 99 << 16;
    thread.threads = 64;
    thread.arguments = &arguments;
    thread.memory = &memory;
  }
};

std::vector<arith::Mode> every_mode() {
  std::vector<arith::Mode> modes;
  for (const Subnormals subnormals : {Subnormals::Ieee, Subnormals::Flush, Subnormals::None})
    for (const SlowUnit unit : {SlowUnit::Exact, SlowUnit::Newton2, SlowUnit::Newton1, SlowUnit::Newton0})
      for (const bool fused : {false, true})
        for (const uint32_t significand : {24u, 17u, 11u}) modes.push_back({subnormals, unit, fused, significand});
  return modes;
}

std::vector<uint32_t> words_of_frame(const NativeThread& thread) {
  std::vector<uint32_t> words;
  for (const FrameContribution& one : thread.frame)
    words.insert(words.end(), {one.pixel, one.rgb[0], one.rgb[1], one.rgb[2]});
  return words;
}

TEST(FunctionRunner, RayKernelsLeaveInEveryModeWhatTheyLeaveAsCpp) {
  size_t rays = 0, contributions = 0;
  for (const arith::Mode& mode : every_mode()) {
    for (const bool culling : {false, true}) {
      for (size_t number = 0; number < kRayKernels; ++number) {
        const auto which = static_cast<RayKernel>(number);
        const FunctionRunner runner(record_kernel(
            "k", [&](RecordedKernel& k) { run_kernel(which, k); }, KernelTarget(mode.fused, false, culling)));
        RayThread shared(1);  // what the threads of a packet have in common
        for (uint32_t seed = 1; seed <= 20;) {
          std::vector<NativeThread> packet;
          for (const size_t size = 1 + seed % FunctionRunner::kMostThreads; packet.size() < size; ++seed) {
            packet.push_back(RayThread(seed).thread);
            packet.back().arguments = &shared.arguments;
            packet.back().memory = &shared.memory;
            packet.back().mode = mode;
            packet.back().culling = culling;
          }
          std::vector<NativeThread> sources = packet;
          runner.run(packet.data(), packet.size());
          for (size_t i = 0; i < packet.size(); ++i) {
            run_native(which, sources[i]);
            ASSERT_EQ(packet[i].rays, sources[i].rays) << kRayKernelNames[which] << ", before seed " << seed;
            ASSERT_EQ(words_of_frame(packet[i]), words_of_frame(sources[i]))
                << kRayKernelNames[which] << ", before seed " << seed;
            rays += sources[i].rays.size();
            contributions += sources[i].frame.size();
          }
        }
      }
    }
  }
  EXPECT_GT(rays, 1000u);
  EXPECT_GT(contributions, 1000u);
}

/// Records a kernel and runs it in this thread.
template <typename Body>
void run_recorded(const Body& body, RayThread& from, uint64_t most = FunctionRunner::kMostOperations) {
  FunctionRunner(record_kernel("k", body), most).run(from.thread);
}

/// Intermediate code that no recorder gives, op by op.
class Written {
 public:
  Written(int registers, int predicates) {
    function.name = "written";
    function.registers = registers;
    function.predicates = predicates;
  }
  Op& add(Opcode opcode, Guard guard = {}) {
    Op op;
    op.info = &instruction(opcode);
    op.guard = guard;
    function.ops.push_back(op);
    return function.ops.back();
  }
  void set_word(uint8_t number, uint32_t value, Guard guard = {}) {
    Op& op = add(Opcode::Rst, guard);
    op.b_is_immediate = true;
    op.immediate = value;
    op.word = number;
  }
  /// predicate = px and pb
  void both(int predicate, int px, int pb, Guard guard = {}) {
    Op& op = add(Opcode::Pand, guard);
    op.rd = predicate;
    op.px = px;
    op.rb = pb;
  }
  /// Begins a body that is jumped over unless the guard is on; end() ends it.
  void begin(int label, Guard guard) {
    add(Opcode::Jnone, guard).label = label;
    function.labels = std::max(function.labels, label + 1);
  }
  void end(int label) {
    Op op;
    op.kind = Op::Kind::Label;
    op.label = label;
    function.ops.push_back(op);
  }
  Function function;
};

TEST(FunctionRunner, ThreadsOfAPacketGoTheirOwnWays) {
  using Int = RecordedKernel::Int;
  const FunctionRunner runner(record_kernel("k", [](RecordedKernel& k) {
    Int sum = 0, i = 0;
    k.while_([&] { return i < k.thread(); },
             [&] {
               k.if_((i & 1) == 0, [&] { sum += i; }, [&] { sum += 100; });
               i += 1;
             });
    k.if_(k.thread() != 5, [&] {
      k.set_word(0, sum);
      k.ray_out();
    });
  }));
  RayThread shared(1);
  std::vector<NativeThread> packet(FunctionRunner::kMostThreads, shared.thread);
  for (uint32_t i = 0; i < packet.size(); ++i) packet[i].thread = i;
  runner.run(packet.data(), packet.size());
  for (uint32_t i = 0; i < packet.size(); ++i) {
    ASSERT_EQ(packet[i].rays.size(), i == 5 ? 0u : 1u) << i;
    if (i == 5) continue;
    const uint32_t even = (i + 1) / 2, odd = i / 2;
    EXPECT_EQ(packet[i].rays[0][0], even * (even - 1) + 100 * odd) << i;
  }
}

TEST(FunctionRunner, ARegisterThatWasNeverWrittenIsUndefinedInEveryRun) {
  Written written(1, 1);
  Op declaration;
  declaration.kind = Op::Kind::Undefined;
  declaration.rd = 0;
  written.function.ops.push_back(declaration);
  written.add(Opcode::Rin);
  Op& store = written.add(Opcode::Rst);
  store.rb = 0;
  store.word = 0;
  written.add(Opcode::Rout);
  Op& load = written.add(Opcode::Ld);  // so that no later run begins with what an earlier one has left
  load.rd = load.ra = 0;
  written.add(Opcode::Exit);
  const FunctionRunner runner(written.function);
  for (int i = 0; i < 2; ++i) {
    RayThread thread(1);
    runner.run(thread.thread);
    EXPECT_EQ(thread.thread.rays.at(0)[0], kUndefinedWord);
  }
}

TEST(FunctionRunner, AMaskThatChangesInsideItsBodyCountsFromThereOn) {
  Written written(0, 3);
  const Guard guard = {1, false};
  written.add(Opcode::Rin);
  written.both(1, 0, 0);  // on
  written.begin(0, guard);
  written.set_word(0, 10, guard);
  written.both(1, 2, 2);  // off
  written.set_word(1, 11, guard);
  written.set_word(2, 12, {1, true});
  written.end(0);
  written.add(Opcode::Rout);
  written.add(Opcode::Exit);
  RayThread thread(1);
  const Intersection before = thread.thread.input;
  FunctionRunner(written.function).run(thread.thread);
  const Ray& ray = thread.thread.rays.at(0);
  EXPECT_EQ(ray[0], 10u);
  EXPECT_EQ(ray[1], before[1]);
  EXPECT_EQ(ray[2], 12u);
}

TEST(FunctionRunner, BehindABodyItsMaskCountsAgain) {
  Written written(0, 2);
  const Guard guard = {1, false};
  written.add(Opcode::Rin);
  written.begin(0, guard);  // predicates are off at first
  written.set_word(0, 10, guard);
  written.end(0);
  written.set_word(1, 11, guard);
  written.set_word(2, 12);
  written.both(0, 1, 1);  // p0 is never written
  written.set_word(3, 13);
  written.both(1, 0, 0, guard);  // under a mask that is off
  written.set_word(4, 14, guard);
  written.add(Opcode::Rout);
  written.add(Opcode::Exit);
  RayThread thread(1);
  const Intersection before = thread.thread.input;
  FunctionRunner(written.function).run(thread.thread);
  const Ray& ray = thread.thread.rays.at(0);
  EXPECT_EQ(ray[0], before[0]);
  EXPECT_EQ(ray[1], before[1]);
  EXPECT_EQ(ray[2], 12u);
  EXPECT_EQ(ray[3], 13u);
  EXPECT_EQ(ray[4], before[4]);
}

TEST(FunctionRunner, WordsAreUndefinedBehindAnExportInThreadsThatDoNotTakePartToo) {
  RayThread thread(1);
  thread.thread.thread = 5;
  run_recorded(
      [](auto& k) {
        k.ray_in();
        k.if_(k.thread() < 3, [&] { k.ray_out(); });
        k.ray_out();
      },
      thread);
  ASSERT_EQ(thread.thread.rays.size(), 1u);
  EXPECT_EQ(thread.thread.rays[0][0], kUndefinedWord);
}

TEST(FunctionRunner, ALoopWithoutEndIsRefusedWithKernelAndLine) {
  RayThread thread(1);
  int line = 0;
  const auto endless = [&](auto& k) {
    line = __LINE__ + 1;
    k.while_([&] { return k.thread() >= 0; }, [&] { k.store(0, 0, k.thread()); });
  };
  try {
    run_recorded(endless, thread, 1000);
    FAIL() << "nothing is thrown";
  } catch (const InputError& error) {
    EXPECT_EQ(error.what(), "kernel 'k': the loop of function_runner_test.cpp:" + std::to_string(line) +
                                " has not ended after 1000 operations of one thread; give it a bound that every thread "
                                "reaches");
  }
}

TEST(FunctionRunner, ALongLoopEnds) {
  using Int = RecordedKernel::Int;
  RayThread thread(1);
  run_recorded(
      [](RecordedKernel& k) {
        Int sum = 0, i = 0;
        k.while_([&] { return i < 100000; },
                 [&] {
                   k.if_((i & 1) == 0, [&] { sum += i; });
                   i += 1;
                 });
        k.store(k.int_argument(0) & 0, 4, sum);
      },
      thread);
  EXPECT_EQ(thread.memory.load(4), 2499950000u);
}

TEST(FunctionRunner, WhatNoRecorderEmitsIsRefused) {
  Written written(3, 1);
  Op& triple = written.add(Opcode::Fadd3);
  triple.rd = triple.ra = triple.rb = 0;
  EXPECT_THROW(FunctionRunner{written.function}, std::logic_error);
}

}  // namespace
}  // namespace raypool::kernel
