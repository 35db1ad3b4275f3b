// The kernel language: what code it makes, and what it refuses.
#include "kernel/kernel.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "bits.hpp"
#include "isa/assembler.hpp"
#include "kernel/kernel_report.hpp"
#include "kernel/test_interpreter.hpp"

namespace raypool::kernel {
namespace {

/// The example of docs/use/kernels.md.
template <typename K>
void scale(K& k) {
  using Int = typename K::Int;
  const Int index = k.thread();
  k.if_(index < k.int_argument(0), [&] {
    const Int address = k.int_argument(1) + (index << 2);
    k.store(address, 0, k.load_float(address) * 0.5f);
  });
}

using Bool = RecordedKernel::Bool;
using Int = RecordedKernel::Int;
using Float = RecordedKernel::Float;

template <typename Body>
Program compiled(const Body& body, const KernelTarget& target = {}) {
  Program program;
  add_kernel(program, "k", body, target);
  return program;
}

/// Assembly text of a kernel, one instruction a line.
template <typename Body>
std::string code_of(const Body& body, const KernelTarget& target = {}) {
  std::string text;
  for (const uint64_t encoding : compiled(body, target).code) text += disassemble(encoding) + "\n";
  return text;
}

template <typename Body>
std::string error_of(const Body& body) {
  try {
    compiled(body);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

std::string here(int line) { return "kernel_test.cpp:" + std::to_string(line); }

TEST(KernelLanguage, ConstantsBecomeImmediates) {
  EXPECT_EQ(code_of([](RecordedKernel& k) { k.set_word(0, 2.0f * k.float_word(1)); }),
            "rld r0, 1\nfmul r0, r0, 2.0\nrst 0, r0\nexit\n");
  EXPECT_EQ(code_of([](RecordedKernel& k) { k.set_word(0, k.int_word(1) - 3); }),
            "rld r0, 1\nisub r0, r0, 3\nrst 0, r0\nexit\n");
  EXPECT_EQ(code_of([](RecordedKernel& k) { k.set_word(0, 3 - k.int_word(1)); }),
            "mov r0, 3\nrld r1, 1\nisub r0, r0, r1\nrst 0, r0\nexit\n");
  EXPECT_EQ(code_of([](RecordedKernel& k) { k.set_word(0, Float(1.5f)); }), "rst 0, 1.5\nexit\n");
  EXPECT_EQ(code_of([](RecordedKernel& k) { k.if_(1.0f < k.float_word(3), [&] { k.ray_out(); }); }),
            "rld r0, 3\nfgt p1, r0, 1.0\n@p1 rout\nexit\n");
}

TEST(KernelLanguage, AddressesTakeConstantSums) {
  EXPECT_EQ(code_of([](RecordedKernel& k) {
              const Int base = k.int_argument(0);
              k.store(base + 8, 4, k.load_int(base + 16, -4));
            }),
            "arg r1, 0\nld r0, [r1+12]\nst [r1+12], r0\nexit\n");
}

TEST(KernelLanguage, CopiesThatNeverChangeCostNothing) {
  // NOLINTBEGIN(performance-unnecessary-value-param, performance-unnecessary-copy-initialization): tested
  const auto twice = [](Float x, Vector<RecordedKernel> v) {
    return Vector<RecordedKernel>{x * v.x, x * v.y, x * v.z};
  };
  const std::string code = code_of([&](RecordedKernel& k) {
    const Float x = k.float_word(0);
    const Float same = x;
    const Vector<RecordedKernel> v = vector_word(k, 3);
    set_vector_word(k, 0, twice(same, v) + v);
  });
  // NOLINTEND(performance-unnecessary-value-param, performance-unnecessary-copy-initialization)
  EXPECT_EQ(code.find("mov"), std::string::npos) << code;
}

TEST(KernelLanguage, CopyOfAVariableThatChangesLaterKeepsTheOldValue) {
  const Program program = compiled([](RecordedKernel& k) {
    Int x = k.thread();
    const Int old = x;
    x += 10;
    k.store(k.thread() << 3, 0, old);
    k.store(k.thread() << 3, 4, x);
  });
  test::Interpreter machine;
  machine.memory = Memory(64);
  machine.run(program, 0);
  for (uint32_t i = 0; i < 8; ++i) {
    EXPECT_EQ(machine.memory.load(8 * i), i);
    EXPECT_EQ(machine.memory.load(8 * i + 4), i + 10);
  }
}

TEST(KernelLanguage, ExampleOfTheDocumentRunsBothWays) {
  const Program program = compiled([](RecordedKernel& k) { scale(k); });
  test::Interpreter machine;
  machine.memory = Memory(64);
  machine.arguments[0] = 5;
  machine.arguments[1] = 16;
  for (uint32_t i = 0; i < 8; ++i) machine.memory.store(16 + 4 * i, as_bits(static_cast<float>(i)));
  Memory native = machine.memory;
  machine.run(program, 0);
  for (uint32_t i = 0; i < 8; ++i) {
    NativeThread thread;
    thread.thread = i;
    thread.arguments = &machine.arguments;
    thread.memory = &native;
    NativeKernel<Subnormals::Ieee, SlowUnit::Exact> k(thread);
    scale(k);
  }
  for (uint32_t i = 0; i < 8; ++i) {
    const uint32_t expected = as_bits(static_cast<float>(i) * (i < 5 ? 0.5f : 1.0f));
    EXPECT_EQ(machine.memory.load(16 + 4 * i), expected) << i;
    EXPECT_EQ(native.load(16 + 4 * i), expected) << i;
  }
}

TEST(KernelLanguage, UnusedCodeIsLeftOut) {
  EXPECT_EQ(code_of([](RecordedKernel& k) {
              const Float unused = k.float_word(1) * k.float_argument(2);
              const Bool condition = unused < 1.0f;
              (void)condition;
            }),
            "exit\n");
}

TEST(KernelLanguage, NestedConditionsCostOneCompareEach) {
  EXPECT_EQ(code_of([](RecordedKernel& k) {
              const Int x = k.int_word(0);
              k.if_(x > 1 && x < 5 && x != 3, [&] { k.ray_out(); });
            }),
            "rld r0, 0\nigt p1, r0, 1\n@p1 ilt p1, r0, 5\n@p1 ine p1, r0, 3\n@p1 rout\nexit\n");
  EXPECT_EQ(code_of([](RecordedKernel& k) {
              const Int x = k.int_word(0);
              k.if_(x > 1, [&] { k.if_(x < 5, [&] { k.ray_out(); }); });
            }),
            "rld r0, 0\nigt p1, r0, 1\n@p1 ilt p1, r0, 5\n@p1 rout\nexit\n");
}

TEST(KernelLanguage, ConditionUsedTwiceIsNotNarrowedByAnAnd) {
  const Program program = compiled([](RecordedKernel& k) {
    const Int x = k.thread();
    const Bool a = x > 3;
    const Bool b = x < 6;
    const Bool both = a && b;
    k.store(x << 3, 0, select(both, Int(1), Int(0)));
    k.store(x << 3, 4, select(b, Int(1), Int(0)));
  });
  test::Interpreter machine;
  machine.memory = Memory(64);
  machine.run(program, 0);
  for (uint32_t i = 0; i < 8; ++i) {
    EXPECT_EQ(machine.memory.load(8 * i), i > 3 && i < 6 ? 1u : 0u) << i;
    EXPECT_EQ(machine.memory.load(8 * i + 4), i < 6 ? 1u : 0u) << i;
  }
}

TEST(KernelLanguage, LongBodyThatNoThreadNeedsIsJumpedOver) {
  const Program program = compiled([](RecordedKernel& k) {
    Int x = k.thread();
    k.if_(k.int_argument(0) == 1, [&] {
      for (int i = 0; i < 20; ++i) x = x * 3 + i;
    });
    k.store(k.thread() << 2, 0, x);
  });
  uint64_t executed[2];
  for (uint32_t taken = 0; taken < 2; ++taken) {
    test::Interpreter machine;
    machine.memory = Memory(64);
    machine.arguments[0] = taken;
    machine.run(program, 0);
    executed[taken] = machine.executed;
    EXPECT_EQ(machine.memory.load(4) == 1, taken == 0);
  }
  EXPECT_GT(executed[1], executed[0] + 35);
}

TEST(KernelLanguage, WarpWideRayInstructionsAreNeverJumpedOver) {
  const std::string code = code_of([](RecordedKernel& k) {
    k.if_(k.int_argument(0) == 1, [&] {
      for (int i = 0; i < 12; ++i) k.set_word(i, Int(i));
      k.ray_out();
    });
  });
  EXPECT_EQ(code.find("jnone"), std::string::npos) << code;
}

TEST(KernelLanguage, SixteenValuesAtOnceFit) {
  const auto body = [](RecordedKernel& k, int count) {
    std::vector<Float> values;
    values.reserve(32);
    for (int i = 0; i < count; ++i) values.push_back(k.float_word(i % 12) * static_cast<float>(i));
    k.ray_out();
    for (int i = 0; i < count; ++i) k.set_word(i % 12, values[i]);
  };
  EXPECT_EQ(error_of([&](RecordedKernel& k) { body(k, 16); }), "no error");
  EXPECT_NE(error_of([&](RecordedKernel& k) { body(k, 17); }), "no error");
}

TEST(KernelLanguage, TooManyValuesAreReportedWithKernelAndLine) {
  int line = 0;
  const std::string error = error_of([&](RecordedKernel& k) {
    std::vector<Float> values;
    values.reserve(32);
    for (int i = 0; i < 12; ++i) values.push_back(k.float_word(i) * 2.0f);
    for (int i = 0; i < 5; ++i) values.push_back(k.float_argument(i) + values[0]);
    line = __LINE__ - 1;
    k.ray_out();
    for (int i = 0; i < 17; ++i) k.set_word(i % 12, values[i]);
  });
  EXPECT_EQ(error, here(line) +
                       ": kernel 'k' holds 17 values at once here, but a thread has 16 registers, and no ray words are "
                       "free for the others; compute some of them later, or again");
}

TEST(KernelLanguage, TooManyConditionsAreReportedWithKernelAndLine) {
  int line = 0;
  const auto body = [&](RecordedKernel& k, int count) {
    std::vector<Bool> conditions;
    conditions.reserve(40);
    const Int x = k.int_word(0);
    for (int i = 0; i < count; ++i) {
      conditions.push_back(x == i);
      line = __LINE__ - 1;
    }
    k.ray_out();
    for (int i = 0; i < count; ++i) k.set_word(1, select(conditions[i], Int(i), k.int_word(1)));
  };
  EXPECT_EQ(error_of([&](RecordedKernel& k) { body(k, 25); }), "no error") << "some become values";
  EXPECT_EQ(error_of([&](RecordedKernel& k) { body(k, 40); }),
            here(line) +
                ": kernel 'k' holds 40 conditions at once here, but a warp has 15 predicates for them, and no ray "
                "words are free for the others; compute some of them later, or again");
}

TEST(KernelLanguage, ConditionOfAnIfMayNotBeAssignedInside) {
  int line = 0;
  const std::string error = error_of([&](RecordedKernel& k) {
    Bool running = k.thread() < 4;
    line = __LINE__ + 1;
    k.if_(running, [&] { running = k.thread() < 2; });
  });
  EXPECT_EQ(error, here(line) + ": kernel 'k' assigns a condition inside the if_ of " + here(line) +
                       " that it decides; assign a copy");
}

TEST(KernelLanguage, NumbersOutOfRangeAreReportedWithTheirLine) {
  int line = __LINE__ + 1;
  const std::string argument = error_of([](RecordedKernel& k) { k.float_argument(32); });
  EXPECT_EQ(argument, here(line) + ": there is no kernel argument 32; they are 0 to 31");
  line = __LINE__ + 1;
  const std::string written = error_of([](RecordedKernel& k) { k.set_word(21, Int(0)); });
  EXPECT_EQ(written, here(line) + ": there is no ray word 21; they are 0 to 20");
  line = __LINE__ + 1;
  const std::string read = error_of([](RecordedKernel& k) { k.int_word(-1); });
  EXPECT_EQ(read, here(line) + ": there is no ray word -1; they are 0 to 20");
}

TEST(KernelLanguage, ValuesOutsideAKernelAreRefused) { EXPECT_THROW(Int(3), std::logic_error); }

TEST(KernelLanguage, FailedKernelLeavesNothingBehind) {
  EXPECT_NE(error_of([](RecordedKernel& k) { k.int_word(99); }), "no error");
  EXPECT_EQ(code_of([](RecordedKernel&) {}), "exit\n");
}

TEST(KernelLanguage, KernelsOfAProgramHaveDifferentNames) {
  Program program;
  add_kernel(program, "same", [](RecordedKernel&) {});
  EXPECT_THROW(add_kernel(program, "same", [](RecordedKernel&) {}), InputError);
}

constexpr int kTripleWords = 96;
const KernelTarget kTriples(false, true), kFusedTriples(true, true);

/// What a kernel leaves in memory, of which it gets random words, arguments and packages.
template <typename Body>
std::vector<uint32_t> left_by(const Body& body, const KernelTarget& target) {
  test::Interpreter machine;
  machine.memory = Memory(4 * kTripleWords);
  machine.mode.fused = target.fma;
  for (uint32_t i = 0; i < kTripleWords; ++i)
    machine.memory.store(4 * i, as_bits(1.5f + static_cast<float>(i * i % 37)));
  for (auto& package : machine.input)
    for (uint32_t i = 0; i < package.size(); ++i) package[i] = as_bits(0.25f + static_cast<float>(i * 7 % 11));
  machine.arguments.fill(0);
  machine.run(compiled(body, target), 0);
  std::vector<uint32_t> left;
  for (uint32_t i = 0; i < kTripleWords; ++i) left.push_back(machine.memory.load(4 * i));
  for (const auto& rays : machine.rays)
    for (const Ray& ray : rays) left.insert(left.end(), ray.begin(), ray.end());
  return left;
}

int count_of(const std::string& code, const std::string& what) {
  int count = 0;
  for (size_t at = code.find(what); at != std::string::npos; at = code.find(what, at + 1)) ++count;
  return count;
}

TEST(KernelTriples, WhatIsDoneToThreeComponentsIsOneInstruction) {
  const auto body = [](RecordedKernel& k) {
    const Vector<RecordedKernel> v = vector_word(k, 3), w = vector_argument(k, 4);
    set_vector_word(k, 0, k.float_word(6) * (v + w));
  };
  const std::string code = code_of(body, kTriples);
  for (const char* triple : {"rld3 ", "arg3 ", "fadd3 ", "fmul3s ", "rst3 "})
    EXPECT_EQ(count_of(code, triple), 1) << code;
  EXPECT_EQ(count_of(code, "\n"), 7) << code;  // and rld, exit
  EXPECT_EQ(count_of(code_of(body), "3 r"), 0);
  const auto fused = [](RecordedKernel& k) {
    const Vector<RecordedKernel> v = vector_word(k, 3), w = vector_word(k, 0);
    const Float f = k.float_word(6);
    set_vector_word(k, 0, {multiply_add(f, v.x, w.x), multiply_add(f, v.y, w.y), multiply_add(f, v.z, w.z)});
  };
  EXPECT_EQ(count_of(code_of(fused, kFusedTriples), "ffma3s "), 1) << code_of(fused, kFusedTriples);
}

TEST(KernelTriples, OnlyWordsInAQuadwordAreLoadedByOne) {
  const auto load = [](RecordedKernel& k, int offset) {
    const Vector<RecordedKernel> v = vector_load(k, k.int_argument(0), offset);
    set_vector_word(k, 0, v);
  };
  EXPECT_EQ(count_of(code_of([&](RecordedKernel& k) { load(k, 16); }, kTriples), "ld3 "), 1);
  EXPECT_EQ(count_of(code_of([&](RecordedKernel& k) { load(k, 20); }, kTriples), "ld3 "), 0);
}

TEST(KernelTriples, MultiplyByOneImmediateAlone) {
  const auto scale = [](RecordedKernel& k, float z) {
    k.ray_in();
    const Vector<RecordedKernel> v = vector_word(k, word::kDirection);
    set_vector_word(k, word::kOrigin, {v.x * 0.5f, v.y * 0.5f, v.z * z});
    k.ray_out();
  };
  const auto same = [&](RecordedKernel& k) { scale(k, 0.5f); };
  const auto other = [&](RecordedKernel& k) { scale(k, 0.25f); };
  EXPECT_EQ(count_of(code_of(same, kTriples), "fmul3 "), 1) << code_of(same, kTriples);
  EXPECT_EQ(count_of(code_of(other, kTriples), "fmul3 "), 0) << code_of(other, kTriples);
  EXPECT_EQ(left_by(other, kTriples), left_by(other, {}));
}

TEST(KernelTriples, WhatOrderForbidsStaysThreeInstructions) {
  // The second word is read from memory that the first has written.
  const auto body = [](RecordedKernel& k) {
    const Int base = k.int_argument(0);
    const Float x = k.load_float(base, 16);
    k.store(base, 20, x);
    const Float y = k.load_float(base, 20);
    k.store(base, 24, y);
    const Float z = k.load_float(base, 24);
    k.store(base, 28, z);
  };
  EXPECT_EQ(count_of(code_of(body, kTriples), "ld3 "), 0) << code_of(body, kTriples);
  EXPECT_EQ(left_by(body, kTriples), left_by(body, {}));
}

// Five triples and the address are all registers. Of each one then becomes free, which are six, but no three in a row.
TEST(KernelTriples, WithoutRegistersInARowThereAreFewer) {
  const auto body = [](RecordedKernel& k) {
    const Int base = k.int_argument(0);
    std::vector<Vector<RecordedKernel>> vectors;
    vectors.reserve(6);
    for (int i = 0; i < 5; ++i) vectors.push_back(vector_load(k, base, 16 * i));
    for (int i = 0; i < 5; ++i) k.store(base, 256 + 4 * i, vectors[i].x);
    vectors.push_back(vector_load(k, base, 80));
    k.store(base, 300, vectors[5].x);
    for (int i = 0; i < 6; ++i) {
      k.store(base, 304 + 8 * i, vectors[i].y);
      k.store(base, 308 + 8 * i, vectors[i].z);
    }
  };
  const std::string code = code_of(body, kTriples);
  EXPECT_EQ(count_of(code, "ld3 "), 5) << code;
  EXPECT_EQ(count_of(code, "ld r"), 3) << code;
  EXPECT_EQ(left_by(body, kTriples), left_by(body, {}));
}

TEST(KernelTriples, CopiesInALoopKeepTheValueOfTheRoundBefore) {
  const auto body = [](RecordedKernel& k) {
    k.ray_in();
    Vector<RecordedKernel> v = vector_word(k, 0);
    Vector<RecordedKernel> before = vector_word(k, 3), sum = vector_word(k, 6);
    Int left = k.thread() & 3;
    k.while_([&] { return left > 0; },
             [&] {
               const Vector<RecordedKernel> current = v;
               v = v + before;
               before = current;
               const Vector<RecordedKernel> loaded = vector_load(k, left << 4, 32);
               sum = sum + 0.5f * loaded + current;
               left -= 1;
             });
    set_vector_word(k, 0, v);
    set_vector_word(k, 3, before);
    set_vector_word(k, 6, sum);
    for (int word = 9; word < 12; ++word) k.set_word(word, left);
    k.ray_out();
  };
  EXPECT_GT(count_of(code_of(body, kTriples), "3 "), 0);
  EXPECT_EQ(left_by(body, kTriples), left_by(body, {}));
}

TEST(KernelReport, ExtractedKernelIsTheOneCompiledAlone) {
  const auto second = [](RecordedKernel& k) {
    Int i = k.thread();
    k.while_([&] { return i < 20; }, [&] { i += 7; });
    k.store(k.thread() << 2, 0, i);
  };
  Program program, alone;
  add_kernel(program, "first", [](RecordedKernel& k) { k.ray_in(); });
  add_kernel(program, "second", second);
  add_kernel(alone, "second", second);
  EXPECT_EQ(program.entries["second"], 2u);
  EXPECT_EQ(extract_kernel(program, "second").code, alone.code);
  EXPECT_EQ(extract_kernel(program, "second").entries, alone.entries);
  test::Interpreter machine;
  machine.memory = Memory(64);
  machine.run(program, program.entries["second"]);
  for (uint32_t i = 0; i < 8; ++i) EXPECT_EQ(machine.memory.load(4 * i), 20 + (i + 1) % 7) << i;
  EXPECT_EQ(extract_kernel(program, "first").code.size(), 2u);
  try {
    extract_kernel(program, "third");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "there is no kernel 'third'; there are first, second");
  }
}

}  // namespace
}  // namespace raypool::kernel
