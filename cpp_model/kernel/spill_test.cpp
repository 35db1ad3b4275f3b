// Kernels with more values than registers, and more conditions than predicates: what they leave, and what it costs.
#include "kernel/spill.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "bits.hpp"
#include "isa/assembler.hpp"
#include "kernel/kernel.hpp"
#include "kernel/liveness.hpp"
#include "kernel/needed_places.hpp"
#include "kernel/ray_kernels.hpp"
#include "kernel/test_interpreter.hpp"

namespace raypool::kernel {
namespace {

constexpr uint32_t kBytes = 8192;
constexpr uint32_t kSpilledFrom = 4096;  // value n of thread t lies at kSpilledFrom + 32 n + 4 t

struct Compiled {
  Program program;
  CompileCounts counts;
};

enum class Room { Words, WordsAndMemory };

template <typename Body>
Compiled compiled(const Body& body, Room room, bool reuses_values = true) {
  int offset = kNothing;
  Function function = record_kernel("k", [&](RecordedKernel& k) {
    const RecordedKernel::Int bytes = k.thread() << 2;
    offset = bytes.number();
    body(k);
  });
  if (room == Room::WordsAndMemory)
    function.spill_memory = SpillMemory{offset, kSpilledFrom, 32, (kBytes - kSpilledFrom) / 32};
  function.reuses_values = reuses_values;
  Compiled result;
  result.counts = compile(function, result.program);
  return result;
}

/// Compares the machine code with the source run as C++, on eight threads.
template <typename Body>
Compiled check(const Body& body, Room room, bool reuses_values = true) {
  Compiled code = compiled(body, room, reuses_values);
  test::Interpreter machine;
  machine.memory = Memory(kBytes);
  machine.mode.subnormals = Subnormals::Flush;
  for (uint32_t address = 0; address < kBytes; address += 4) machine.memory.store(address, address * 2654435761u);
  for (uint32_t lane = 0; lane < test::Interpreter::kLanes; ++lane)
    for (size_t i = 0; i < machine.input[lane].size(); ++i)
      machine.input[lane][i] = as_bits(static_cast<float>(i + 1) * 0.75f - static_cast<float>(lane));
  for (size_t i = 0; i < machine.arguments.size(); ++i) machine.arguments[i] = as_bits(static_cast<float>(3 * i + 1));
  Memory memory = machine.memory;
  machine.run(code.program, code.program.entries.at("k"));
  for (uint32_t lane = 0; lane < machine.threads; ++lane) {
    NativeThread thread;
    thread.thread = lane;
    thread.threads = machine.threads;
    thread.arguments = &machine.arguments;
    thread.memory = &memory;
    thread.mode = machine.mode;
    thread.input = machine.input[lane];
    NativeKernel<Subnormals::Flush, SlowUnit::Exact> k(thread);
    body(k);
    EXPECT_EQ(thread.rays, machine.rays[lane]) << "thread " << lane << "\n" << listing(code.program);
    EXPECT_FALSE(thread.rays.empty()) << "thread " << lane;
  }
  for (uint32_t address = 0; address < kSpilledFrom; address += 4)
    EXPECT_EQ(memory.load(address), machine.memory.load(address)) << address << "\n" << listing(code.program);
  return code;
}

template <typename K>
using Ints = std::vector<typename K::Int>;

/// Values of which none can be computed again without another one.
template <typename K>
Ints<K> many_values(K& k, int count) {
  Ints<K> values;
  values.reserve(static_cast<size_t>(count));
  for (int i = 0; i < count; ++i) values.push_back(k.int_word(i % 21) * (2 * i + 1));
  return values;
}

/// Exports a ray that depends on all of them.
template <typename K>
void export_all(K& k, const Ints<K>& values) {
  using KInt = typename K::Int;
  KInt sum = 7;
  for (const KInt& value : values) sum = (sum << 1) ^ (sum + value);
  for (int word = 0; word < kRayWords; ++word) k.set_word(word, sum + word);
  k.ray_out();
}

int count_of(const Program& program, Opcode opcode) {
  return static_cast<int>(std::count_if(program.code.begin(), program.code.end(),
                                        [&](uint64_t encoded) { return unpack(encoded).info->opcode == opcode; }));
}

TEST(Spill, ValuesInStraightCodeKeepTheirBits) {
  for (const int values : {17, 20, 36}) {
    const auto body = [&](auto& k) {
      k.ray_in();
      export_all(k, many_values(k, values));
    };
    for (const bool reuses_values : {false, true}) check(body, Room::WordsAndMemory, reuses_values);
  }
}

TEST(Spill, TwentyValuesNeedNoMemory) {
  const auto body = [](auto& k) {
    k.ray_in();
    export_all(k, many_values(k, 20));
  };
  const Compiled code = check(body, Room::Words, false);
  EXPECT_GT(code.counts.spilled.to_words, 0);
  EXPECT_EQ(code.counts.spilled.to_memory, 0);
  EXPECT_EQ(count_of(code.program, Opcode::St), 0);
  EXPECT_EQ(code.counts.instructions, static_cast<int>(code.program.code.size()));
  EXPECT_LE(code.counts.stores, 6) << "20 values are 4 more than there are registers, and the sum needs two";
  EXPECT_LE(code.counts.loads, 6);
}

TEST(Spill, AHundredValuesGoToMemoryWhenWordsAreFull) {
  const auto body = [](auto& k) {
    k.ray_in();
    export_all(k, many_values(k, 100));
  };
  const Compiled code = check(body, Room::WordsAndMemory, false);
  EXPECT_GT(code.counts.spilled.to_words, 10);
  EXPECT_GT(code.counts.spilled.to_memory, 40);
  EXPECT_THROW(compiled(body, Room::Words, false), InputError);
  check(body, Room::Words);  // put in another order they are few
}

TEST(Spill, ValuesThatOutliveAnExportGoToMemory) {
  const auto body = [](auto& k) {
    k.ray_in();
    const auto values = many_values(k, 40);
    for (int word = 0; word < kRayWords; ++word) k.set_word(word, values[static_cast<size_t>(word)]);
    k.ray_out();
    export_all(k, values);
  };
  for (const bool reuses_values : {false, true}) {
    const Compiled code = check(body, Room::WordsAndMemory, reuses_values);
    EXPECT_GE(code.counts.spilled.to_memory, 20);
  }
  try {
    compiled(body, Room::Words);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("no ray words are free for the others"), std::string::npos)
        << error.what();
  }
}

template <typename K>
void branches(K& k, int count) {
  using KInt = typename K::Int;
  k.ray_in();
  Ints<K> values = many_values(k, count);
  const KInt thread = k.thread();
  k.if_((thread & 1) == 0,
        [&] {
          for (size_t i = 0; i < values.size(); i += 2) values[i] += values[(i + 5) % values.size()];
          k.if_(thread > 3, [&] { values[1] = thread; });
        },
        [&] {
          for (size_t i = 0; i < values.size(); i += 3) values[i] = values[(i + 1) % values.size()] ^ 3;
          values[2] = KInt(11);
        });
  export_all(k, values);
}

TEST(Spill, PartialWritesInBranchesKeepTheOtherLanes) {
  for (const int values : {20, 40, 100})
    for (const bool reuses_values : {false, true})
      check([&](auto& k) { branches(k, values); }, Room::WordsAndMemory, reuses_values);
}

template <typename K>
void loops(K& k, int count) {
  using KInt = typename K::Int;
  k.ray_in();
  Ints<K> values = many_values(k, count);
  KInt left = (k.thread() & 3) + 1;
  k.while_([&] { return left > 0; },
           [&] {
             for (size_t i = 0; i < values.size(); i += 4) values[i] += values[(i + 7) % values.size()] + left;
             KInt inner = left & 1;
             k.while_([&] { return inner < 3; },
                      [&] {
                        values[3] = values[3] * 5 + inner;
                        values[6] = values[6] ^ inner;
                        inner += 1;
                      });
             k.if_(left == 2, [&] { values[5] = left; });
             left -= 1;
           });
  export_all(k, values);
}

TEST(Spill, PartialWritesInLoopsKeepTheLanesThatHaveLeft) {
  for (const int values : {20, 40, 100})
    for (const bool reuses_values : {false, true})
      check([&](auto& k) { loops(k, values); }, Room::WordsAndMemory, reuses_values);
}

/// Loops that write values which nothing reads.
template <typename K>
void idle_loops(K& k, int count) {
  using KInt = typename K::Int;
  k.ray_in();
  Ints<K> idle = many_values(k, 12), values = many_values(k, count);
  KInt left = (k.thread() & 3) + 1;
  k.while_([&] { return left > 0; },
           [&] {
             for (size_t i = 0; i < values.size(); i += 3) values[i] += values[(i + 7) % values.size()] + left;
             KInt inner = left & 1;
             k.while_([&] { return inner < 3; },
                      [&] {
                        for (size_t i = 0; i < idle.size(); ++i) idle[i] = values[i] + inner;
                        values[3] = values[3] * 5 + inner;
                        inner += 1;
                      });
             left -= 1;
           });
  export_all(k, values);
}

TEST(Spill, WhatLoopsOnlyWriteTakesNoSlotOfOthers) {
  for (const int values : {40, 60, 100})
    for (const bool reuses_values : {false, true})
      check([&](auto& k) { idle_loops(k, values); }, Room::WordsAndMemory, reuses_values);
}

TEST(Spill, NothingIsNeededOfWhatALoopOnlyWrites) {
  int idle = kNothing;
  Function function = record_kernel("k", [&](RecordedKernel& k) {
    RecordedKernel::Int left = k.thread() & 3, written = left;
    idle = written.number();
    k.while_([&] { return left > 0; },
             [&] {
               written = left * 3;
               left -= 1;
             });
  });
  const auto writes = [&] {
    return std::count_if(function.ops.begin(), function.ops.end(),
                         [&](const Op& op) { return effects(op).register_defined == idle; });
  };
  EXPECT_EQ(writes(), 2);
  for (const NumberSet& needed : find_liveness(function).registers_after) EXPECT_FALSE(needed.has(idle));
  remove_dead(function);
  EXPECT_EQ(writes(), 0);
}

TEST(Spill, WhatALoopUsesStaysInRegisters) {
  const auto body = [](auto& k) {
    using KInt = typename std::decay_t<decltype(k)>::Int;
    k.ray_in();
    const auto values = many_values(k, 20);
    KInt sum = 0, left = k.thread() & 7;
    k.while_([&] { return left > 0; },
             [&] {
               sum += (sum ^ left) + values[0];
               left -= 1;
             });
    k.store(k.thread() << 5, 0, sum);
    export_all(k, values);
  };
  const Compiled code = check(body, Room::Words);
  int first = 0, last = 0;
  for (int pc = 0; pc < static_cast<int>(code.program.code.size()); ++pc) {
    const Instruction op = unpack(code.program.code[static_cast<size_t>(pc)]);
    if (op.info->opcode == Opcode::Loop) first = pc, last = static_cast<int>(op.immediate & 0xffff);
  }
  ASSERT_GT(last, first);
  for (int pc = first; pc < last; ++pc)
    EXPECT_NE(unpack(code.program.code[static_cast<size_t>(pc)]).info->alu(), AluType::Ray) << listing(code.program);
}

TEST(Spill, ConditionsBeyondFifteenKeepTheirBits) {
  const auto body = [](auto& k) {
    using K = std::decay_t<decltype(k)>;
    using KInt = typename K::Int;
    using KBool = typename K::Bool;
    k.ray_in();
    std::vector<KBool> conditions;
    conditions.reserve(40);
    for (int i = 0; i < 40; ++i) conditions.push_back((k.int_word(i % 12) & (1 << i % 31)) != 0);
    k.if_(conditions[4], [&] { conditions[7] = conditions[20] || conditions[39]; });
    KInt sum = 0;
    for (const KBool& condition : conditions) sum = (sum << 1) + select(condition, KInt(3), sum);
    k.if_(conditions[7], [&] { sum += 1000; });
    for (int word = 0; word < kRayWords; ++word) k.set_word(word, sum + word);
    k.ray_out();
  };
  for (const bool reuses_values : {false, true}) {
    const Compiled code = check(body, Room::WordsAndMemory, reuses_values);
    if (!reuses_values) {
      EXPECT_GE(code.counts.spilled.predicates, 25);
    }
  }
}

/// As where what defines it is in code that no lane comes to.
TEST(Spill, AConditionThatNothingDefinesIsFalse) {
  constexpr int kConditions = 20;
  int never = kNothing;
  Recorder recorder("k");
  RecordedKernel k(recorder);
  k.ray_in();
  never = recorder.declare_predicate();
  std::vector<RecordedKernel::Bool> conditions;
  for (int i = 0; i < kConditions; ++i) conditions.push_back(k.int_word(i) == -1);
  for (int i = 0; i < kConditions; ++i)
    k.if_(conditions[static_cast<size_t>(i)], [&] { k.store(k.thread() << 2, 0, k.thread()); });
  recorder.begin_if({never, false, {}});
  k.store(k.thread() << 2, 64, k.thread() + 1);
  recorder.end_if();
  Function function = recorder.finish();
  const auto defines = [&](const Op& op) {
    return op.kind == Op::Kind::Instruction && writes_predicate(*op.info) && op.rd == never;
  };
  function.ops.erase(std::find_if(function.ops.begin(), function.ops.end(), defines));
  Program program;
  EXPECT_GT(compile(function, program).spilled.predicates, 0);
  test::Interpreter machine;
  machine.memory = Memory(kBytes);
  machine.run(program, program.entries.at("k"));
  for (uint32_t lane = 0; lane < test::Interpreter::kLanes; ++lane)
    EXPECT_EQ(machine.memory.load(4 * lane + 64), 0u) << lane << "\n" << listing(program);
}

TEST(Spill, ConstantsAndArgumentsAreComputedAgain) {
  const auto body = [](auto& k) {
    using KFloat = typename std::decay_t<decltype(k)>::Float;
    k.ray_in();
    std::vector<KFloat> values;
    values.reserve(30);
    for (int i = 0; i < 30; ++i) values.push_back(k.float_argument(i));
    KFloat sum = 0.0f;
    k.if_(k.thread() < 9, [&] {
      for (int round = 0; round < 2; ++round)
        for (const KFloat& value : values) sum = sum * 0.5f + value;
    });
    for (int word = 0; word < kRayWords; ++word) k.set_word(word, sum);
    k.ray_out();
  };
  const Compiled code = check(body, Room::Words);
  EXPECT_GT(code.counts.spilled.recomputed, 10);
  EXPECT_EQ(code.counts.spilled.to_words + code.counts.spilled.to_memory, 0);
  EXPECT_EQ(code.counts.stores, 0);
}

TEST(Spill, CompactRecordsHaveNoWordsBehindTheirLast) {
  const auto body = [](auto& k) {
    k.ray_in();
    auto values = many_values(k, 12);
    for (int i = 0; i < 8; ++i) values.push_back(values[static_cast<size_t>(i)] * 3 + 1);
    export_all(k, values);
  };
  const KernelTarget compact(false, false, false, true);
  RecordLayout layout = RecordLayout::in_order(16);
  for (const bool with_layout : {false, true}) {
    Program program;
    const CompileCounts counts = add_kernel(program, "k", body, compact, with_layout ? layout : RecordLayout());
    EXPECT_GT(counts.spilled.to_words, 0);
    for (const uint64_t encoded : program.code) {
      const Instruction op = unpack(encoded);
      if (op.info->opcode == Opcode::Rst) {
        EXPECT_LT(op.x, with_layout ? 16 : 12) << listing(program);
      }
    }
  }
}

TEST(Spill, WordsThatAnExportNeedsStayAsTheyAre) {
  // Words 0 .. 11 go out as they came, in the threads of a condition: only 12 .. 20 are free.
  const auto body = [](auto& k) {
    using KInt = typename std::decay_t<decltype(k)>::Int;
    k.ray_in();
    const auto values = many_values(k, 22);
    KInt sum = 0;
    for (const KInt& value : values) sum = (sum << 1) ^ (sum + value);
    for (const KInt& value : values) sum = (sum << 1) + value;
    k.store(k.thread() << 5, 0, sum);
    k.if_(k.thread() < 8, [&] { k.ray_out(); });
  };
  const Compiled code = check(body, Room::Words);
  EXPECT_GT(code.counts.spilled.to_words, 0);
  for (const uint64_t encoded : code.program.code) {
    const Instruction op = unpack(encoded);
    if (op.info->opcode == Opcode::Rst) {
      EXPECT_GE(op.x, kRayWords) << listing(code.program);
    }
  }
}

TEST(Spill, AWordWrittenWhereItIsExportedIsFreeBefore) {
  const Function function = record_kernel("k", [](RecordedKernel& k) {
    k.ray_in();
    const RecordedKernel::Int thread = k.thread();
    k.if_(thread < 3, [&] {
      for (int word = 0; word < kRayWords; ++word) k.set_word(word, thread);
      k.ray_out();
    });
  });
  const std::vector<NumberSet> needed = find_needed_places(function);
  EXPECT_EQ(needed[0].count(), 0) << "behind rin";
  for (size_t i = 1; i < function.ops.size(); ++i) {
    if (is(function.ops[i], Opcode::Rout)) {
      EXPECT_EQ(needed[i - 1].count(), 12);
    }
  }
}

TEST(ReuseValues, EqualExpressionsLoadsAndConditionsAreComputedOnce) {
  const auto body = [](auto& k) {
    using KInt = typename std::decay_t<decltype(k)>::Int;
    k.ray_in();
    const KInt a = k.int_word(1), b = k.int_word(2), address = k.thread() << 4;
    const KInt first = (a + b) * 3 + k.load_int(address, 4);
    const KInt again = (b + k.int_word(1)) * 3 + k.load_int(k.thread() << 4, 4);
    KInt sum = first ^ (again << 1);
    k.if_(a < b, [&] { sum += a * b; });
    k.if_(b > a, [&] { sum += b * a; });
    for (int word = 0; word < kRayWords; ++word) k.set_word(word, sum);
    k.ray_out();
  };
  const Compiled code = check(body, Room::Words);
  EXPECT_EQ(count_of(code.program, Opcode::Ld), 1) << listing(code.program);
  EXPECT_EQ(count_of(code.program, Opcode::Imul), 2);
  EXPECT_EQ(count_of(code.program, Opcode::Rld), 2);
  EXPECT_EQ(count_of(code.program, Opcode::Ilt) + count_of(code.program, Opcode::Igt), 1);
  const Compiled plain = check(body, Room::Words, false);
  EXPECT_EQ(count_of(plain.program, Opcode::Ld), 2);
}

TEST(ReuseValues, LoadsAreNotKeptAcrossStoresAndWordsNotAcrossWrites) {
  const auto body = [](auto& k) {
    using KInt = typename std::decay_t<decltype(k)>::Int;
    k.ray_in();
    const KInt address = k.thread() << 4;
    const KInt before = k.load_int(address, 4), word_before = k.int_word(3);
    KInt left = k.thread() & 1;
    k.while_([&] { return left < 2; },
             [&] {
               k.store(address, 4, before + left);
               k.set_word(3, word_before * 7);
               left += 1;
             });
    const KInt behind = k.load_int(address, 4), word_behind = k.int_word(3);
    const KInt sum = (before ^ (behind * 3)) + (word_before ^ (word_behind * 5));
    for (int word = 0; word < kRayWords; ++word) k.set_word(word, sum);
    k.ray_out();
  };
  const Compiled code = check(body, Room::Words);
  EXPECT_EQ(count_of(code.program, Opcode::Ld), 2) << listing(code.program);
  EXPECT_EQ(count_of(code.program, Opcode::Rld), 2) << listing(code.program);
}

TEST(ReuseValues, WordsAreNotWrittenWithWhatTheyHold) {
  const auto body = [](auto& k) {
    using KInt = typename std::decay_t<decltype(k)>::Int;
    k.ray_in();
    const KInt pixel = k.int_word(7), other = k.int_word(8);
    k.set_word(7, pixel);                                 // idle
    k.set_word(8, pixel);                                 // not idle
    k.if_(pixel > other, [&] { k.set_word(6, other); });  // not idle
    k.set_word(15, other);                                // nothing reads it
    k.ray_out();
  };
  EXPECT_EQ(count_of(check(body, Room::Words).program, Opcode::Rst), 2);
  EXPECT_EQ(count_of(check(body, Room::Words, false).program, Opcode::Rst), 4);
}

TEST(Spill, RayKernelsFitAsTheyAre) {
  for (int n = 0; n < 8; ++n) {
    const KernelTarget target((n & 1) != 0, (n & 2) != 0, (n & 4) != 0);
    for (const RayKernel which :
         {RayKernel::CastEye, RayKernel::CastSecondary, RayKernel::CastSecondaryDirect, RayKernel::Shade}) {
      Program program;
      const CompileCounts counts = add_kernel(
          program, "k", [&](RecordedKernel& k) { run_kernel(which, k); }, target);
      EXPECT_EQ(counts.stores + counts.loads, 0);
      EXPECT_EQ(counts.instructions, static_cast<int>(program.code.size()));
    }
  }
}

}  // namespace
}  // namespace raypool::kernel
