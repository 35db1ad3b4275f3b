// Random kernels, run natively thread by thread and as machine code: every word they leave must agree.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "bits.hpp"
#include "isa/assembler.hpp"
#include "kernel/function_runner.hpp"
#include "kernel/kernel.hpp"
#include "kernel/test_interpreter.hpp"
#include "random.hpp"

namespace raypool::kernel {
namespace {

constexpr uint32_t kMemoryBytes = 4096;
constexpr int kSlotBytes = 64;  // of memory a thread

/// Few values; more values and conditions than there are registers and predicates; of them some that nothing reads.
enum class Values { Few, Many, ManyAndIdle };

/// Writes a kernel with a shape that follows from the seed alone, so that it comes out the same for every K and however
/// often a body is run.
template <typename K>
class RandomKernel {
  using Bool = typename K::Bool;
  using Int = typename K::Int;
  using Float = typename K::Float;

 public:
  RandomKernel(K& k, uint32_t seed, Values values = Values::Few)
      : k_(k), seed_(seed), values_(values), slot_((k.thread() << 6) + 1024) {}

  void run() {
    Random random(seed_);
    k_.ray_in();
    std::vector<Int> ints;
    std::vector<Float> floats;
    std::vector<Bool> bools;
    // Room is reserved, so that no value is copied but by the kernel's own statements.
    const bool wide = values_ != Values::Few;
    const uint32_t more_ints = wide ? below(random, 16) : 0, more_floats = wide ? below(random, 20) : 0;
    const uint32_t more_bools = wide ? below(random, 20) : 0;
    ints.reserve(3 + more_ints), floats.reserve(4 + more_floats), bools.reserve(2 + more_bools);
    ints.push_back(k_.thread());
    ints.push_back(k_.int_argument(1));
    ints.push_back(k_.int_word(7) & 255);
    for (int i = 0; i < 4; ++i) floats.push_back(k_.float_word(i));
    bools.push_back(ints[0] < 4);
    bools.push_back(floats[0] > floats[1]);
    for (uint32_t i = 0; i < more_ints; ++i) ints.push_back(int_expression(random, ints, floats, bools));
    for (uint32_t i = 0; i < more_floats; ++i) floats.push_back(float_expression(random, ints, floats, bools));
    for (uint32_t i = 0; i < more_bools; ++i) bools.push_back(bool_expression(random, ints, floats, bools));
    idle_.reserve(kIdle);
    while (values_ == Values::ManyAndIdle && idle_.size() < kIdle) idle_.push_back(pick(random, floats));
    if (seed_ % 4 >= 2) vectors(random, floats);
    statements(random, ints, floats, bools, 3);
    if (wide && below(random, 2) != 0) {
      ray_between(random, ints, floats, bools);
      statements(random, ints, floats, bools, 2);
    }
    for (size_t i = 3; i < ints.size(); ++i) ints[i % 3] += ints[i];
    for (size_t i = 4; i < floats.size(); ++i) floats[i % 4] += floats[i];
    for (size_t i = 2; i < bools.size(); ++i) bools[i % 2] = bools[i % 2] ^ bools[i];
    for (size_t i = 0; i < 3; ++i) k_.set_word(static_cast<int>(i), ints[i]);
    for (size_t i = 0; i < 4; ++i) k_.set_word(static_cast<int>(4 + i), floats[i]);
    for (size_t i = 0; i < 2; ++i) k_.set_word(static_cast<int>(9 + i), select(bools[i], Int(1), Int(0)));
    k_.set_word(8, Float(0.0f));
    k_.set_word(11, Int(5));
    k_.set_word(3, Int(6));
    k_.if_(bools[0] || !bools[1], [&] { k_.ray_out(); });
  }

 private:
  /// Some threads export a ray; the words are then undefined in all of them.
  void ray_between(Random& random, const std::vector<Int>& ints, const std::vector<Float>& floats,
                   const std::vector<Bool>& bools) {
    const Bool exports = bool_expression(random, ints, floats, bools);
    if (below(random, 2) != 0) k_.set_word(2, pick(random, floats));
    const uint32_t seed = random();
    k_.if_(exports, [&] {
      Random inner(seed);
      for (int word = 0; word < kRayWords; ++word) {
        if (below(inner, 2) != 0)
          k_.set_word(word, pick(inner, floats));
        else
          k_.set_word(word, pick(inner, ints));
      }
      k_.ray_out();
    });
    has_words_ = false;
  }

  static uint32_t below(Random& random, uint32_t limit) { return static_cast<uint32_t>(random() % limit); }

  const Int& pick(Random& random, const std::vector<Int>& from) { return from[below(random, size32(from))]; }
  const Float& pick(Random& random, const std::vector<Float>& from) { return from[below(random, size32(from))]; }

  // What triples are made of; their components end among the floats.
  void vectors(Random& random, std::vector<Float>& floats) {
    Vector<K> v = vector_word(k_, 0), w = vector_word(k_, static_cast<int>(below(random, 19)));
    const Vector<K> loaded = vector_load(k_, slot_, 16 * below(random, 3));
    const uint32_t count = 1 + below(random, 4);
    for (uint32_t n = 0; n < count; ++n) {
      const Float& scale = pick(random, floats);
      switch (below(random, 7)) {
        case 0:
          v = v + w;
          break;
        case 1:
          v = w - v;
          break;
        case 2:
          v = scale * w;
          break;
        case 3:
          w = v * loaded;
          break;
        case 4:
          w = Vector<K>{multiply_add(scale, v.x, w.x), multiply_add(scale, v.y, w.y), multiply_add(scale, v.z, w.z)};
          break;
        case 5:
          v = Vector<K>{v.y, v.z, v.x};
          break;
        default:
          w = Vector<K>{w.x * 0.5f, w.y * 0.5f, w.z * 0.5f};
          break;
      }
    }
    set_vector_word(k_, 12, v);
    floats[0] = v.x, floats[1] = v.y, floats[2] = v.z;
    floats[3] = dot(v, w);
  }

  // Operands of an operator are computed in statements of their own: C++ leaves the order within an expression open.
  Int int_expression(Random& random, const std::vector<Int>& ints, const std::vector<Float>& floats,
                     const std::vector<Bool>& bools) {
    const Int& a = pick(random, ints);
    const Int& b = pick(random, ints);
    const Float& f = pick(random, floats);
    const Bool& c = bools[below(random, size32(bools))];
    const int literal = static_cast<int>(below(random, 40)) - 20;
    const int kind = below(random, 24);
    switch (kind) {
      case 0:
        return a + b;
      case 1:
        return a - literal;
      case 2:
        return literal - a;
      case 3:
        return a * b + literal;
      case 4:
        return (a & b) | (a ^ literal);
      case 5:
        return a << (b & 7);
      case 6:
        return shift_right_logical(a, Int(literal));
      case 7:
        return a >> 3;
      case 8:
        return min(a, b);
      case 9:
        return max(literal, a);
      case 10:
        return min_unsigned(a, b);
      case 11:
        return max_unsigned(a, b);
      case 12:
        return select(c, a, b);
      case 13:
        return select(!c, a, Int(literal));
      case 14:
        return select(c, Int(literal), a);
      case 15:
        return -a;
      case 16:
        return ~a;
      case 17:
        return to_int(f);
      case 18:
        return as_int(f);
      case 19:
        return k_.load_int(slot_, 4 * below(random, 8));
      case 20:
        return k_.load_int(slot_ + 4 * below(random, 4), 16);
      case 21:
        return a;
      case 22: {
        const uint32_t word = below(random, 21);
        if (!has_words_) return literal;
        return k_.int_word(word);
      }
      default:
        return literal;
    }
  }

  Float float_expression(Random& random, const std::vector<Int>& ints, const std::vector<Float>& floats,
                         const std::vector<Bool>& bools) {
    const Float& a = pick(random, floats);
    const Float& b = pick(random, floats);
    const Int& i = pick(random, ints);
    const Bool& c = bools[below(random, size32(bools))];
    const float literal = below(random, 64) * 0.25f - 8.0f;
    const int kind = below(random, 20);
    switch (kind) {
      case 0:
        return a + b;
      case 1:
        return a - literal;
      case 2:
        return literal - a;
      case 3:
        return a * b;
      case 4:
        return multiply_add(b, a, literal * a);
      case 5:
        return a / b;
      case 6:
        return a / literal;
      case 7:
        return min(a, b);
      case 8:
        return max(literal, a);
      case 9:
        return -a;
      case 10:
        return abs(a);
      case 11:
        return sqrt(abs(a));
      case 12:
        return rsqrt(b);
      case 13:
        return rcp(a);
      case 14:
        return select(c, a, b);
      case 15:
        return select(!c, Float(literal), b);
      case 16:
        return to_float(i);
      case 17:
        return as_float(i);
      case 18:
        return a;
      default:
        return literal;
    }
  }

  Bool bool_expression(Random& random, const std::vector<Int>& ints, const std::vector<Float>& floats,
                       const std::vector<Bool>& bools) {
    const Int& i = pick(random, ints);
    const Int& j = pick(random, ints);
    const Float& f = pick(random, floats);
    const Float& g = pick(random, floats);
    const Bool& c = bools[below(random, size32(bools))];
    const Bool& d = bools[below(random, size32(bools))];
    switch (below(random, 18)) {
      case 0:
        return i == j;
      case 1:
        return i != 3;
      case 2:
        return 5 < i;
      case 3:
        return i <= j;
      case 4:
        return less_unsigned(i, j);
      case 5:
        return less_equal_unsigned(Int(7), i);
      case 6:
        return f < g;
      case 7:
        return f <= 1.0f;
      case 8:
        return 0.5f >= f;
      case 9:
        return f == g;
      case 10:
        return f != g;
      case 11:
        return i < 6 && f < 2.0f;
      case 12:
        return c && i > j;
      case 13:
        return c || !d;
      case 14:
        return !c && !d;
      case 15:
        return !c ^ d;
      case 16:
        return !c;
      default:
        return c;
    }
  }

  void statements(Random& random, std::vector<Int>& ints, std::vector<Float>& floats, std::vector<Bool>& bools,
                  int depth) {
    const uint32_t count = 2 + below(random, 5);
    for (uint32_t s = 0; s < count; ++s) {
      statement(random, ints, floats, bools, depth);
      if (!idle_.empty() && below(random, 2) != 0) idle_[below(random, kIdle)] = pick(random, floats);
    }
  }

  void statement(Random& random, std::vector<Int>& ints, std::vector<Float>& floats, std::vector<Bool>& bools,
                 int depth) {
    const uint32_t kind = below(random, depth > 0 ? 14 : 9);
    const uint32_t seed = random();
    const size_t target = below(random, 60);
    if (kind < 3) {
      ints[target % ints.size()] = int_expression(random, ints, floats, bools);
    } else if (kind < 6) {
      floats[target % floats.size()] = float_expression(random, ints, floats, bools);
    } else if (kind == 6) {
      const size_t index = target % bools.size();
      if (index != locked_) bools[index] = bool_expression(random, ints, floats, bools);
    } else if (kind == 7) {
      const Float value = float_expression(random, ints, floats, bools);
      k_.store(slot_, 4 * below(random, 8), value);
    } else if (kind == 8) {
      floats[target % floats.size()] += pick(random, floats);
    } else if (kind < 12) {
      condition_on(kind, target, random, seed, ints, floats, bools, depth);
    } else {
      some_trips(random, seed, ints, floats, bools, depth);
    }
  }

  void condition_on(uint32_t kind, size_t target, Random& random, uint32_t seed, std::vector<Int>& ints,
                    std::vector<Float>& floats, std::vector<Bool>& bools, int depth) {
    // Either a new condition, or a variable of the kernel, which the body then leaves alone.
    const bool variable = below(random, 3) == 0 && locked_ == kNone;
    const size_t index = target % bools.size();
    const auto then = [&] {
      Random inner(seed);
      statements(inner, ints, floats, bools, depth - 1);
    };
    const auto otherwise = [&] {
      Random inner(seed + 1);
      statements(inner, ints, floats, bools, depth - 1);
    };
    const size_t outer_locked = locked_;
    if (variable) {
      locked_ = index;
      if (kind == 9)
        k_.if_(bools[index], then);
      else if (kind == 10)
        k_.if_(!bools[index], then);
      else
        k_.if_(bools[index], then, otherwise);
    } else {
      const Bool condition = bool_expression(random, ints, floats, bools);
      if (kind == 9)
        k_.if_(condition, then);
      else if (kind == 10)
        k_.if_(!condition, then);
      else
        k_.if_(condition, then, otherwise);
    }
    locked_ = outer_locked;
  }

  void some_trips(Random& random, uint32_t seed, std::vector<Int>& ints, std::vector<Float>& floats,
                  std::vector<Bool>& bools, int depth) {
    // Some trips, of a number that differs between threads.
    Int left = (pick(random, ints) & 3) + below(random, 2);
    const uint32_t form = below(random, 3);
    Bool again = left > 1;
    k_.while_(
        [&]() -> Bool {
          if (form == 0) return left > 0;
          if (form == 1) return left > 0 && left < 4;
          return again;
        },
        [&] {
          Random inner(seed);
          statements(inner, ints, floats, bools, depth - 1);
          left -= 1;
          again = left > 0;
        });
  }

  static constexpr size_t kNone = 99;
  static constexpr uint32_t kIdle = 8;
  K& k_;
  uint32_t seed_;
  Values values_;
  std::vector<Float> idle_;  // written, not read
  bool has_words_ = true;
  Int slot_;
  size_t locked_ = kNone;
};

struct Outcome {
  int compiled = 0, refused = 0, triples = 0;
};

Function recorded(uint32_t seed, const KernelTarget& target) {
  return record_kernel(
      "random", [&](RecordedKernel& k) { RandomKernel<RecordedKernel>(k, seed).run(); }, target);
}

Program compiled(uint32_t seed, const KernelTarget& target) {
  Program program;
  program.code.assign(seed % 5, 0);  // entries are not always 0
  compile(recorded(seed, target), program, target);
  return program;
}

int triples_of(const Program& program) {
  return static_cast<int>(std::count_if(program.code.begin(), program.code.end(), [](uint64_t encoding) {
    const InstructionInfo* info = unpack(encoding).info;
    return info != nullptr && is_triple(*info);
  }));
}

template <Subnormals kSubnormals, bool kFused, bool kNarrow>
void run_random(NativeThread& thread, uint32_t seed, Values values) {
  NativeKernel<kSubnormals, SlowUnit::Exact, kFused, kNarrow> k(thread);
  RandomKernel<decltype(k)>(k, seed, values).run();
}

template <Subnormals kSubnormals, bool kFused>
void run_random(NativeThread& thread, uint32_t seed, Values values) {
  thread.mode.narrow() ? run_random<kSubnormals, kFused, true>(thread, seed, values)
                       : run_random<kSubnormals, kFused, false>(thread, seed, values);
}

/// Words of a memory, and packages, that threads of a random kernel begin with.
struct Beginning {
  Memory memory{kMemoryBytes};
  std::array<uint32_t, kArguments> arguments{};
  std::array<Intersection, test::Interpreter::kLanes> input{};
  arith::Mode mode;
  uint32_t threads = 0;

  explicit Beginning(uint32_t seed) {
    Random random(seed);
    for (uint32_t address = 0; address < kMemoryBytes; address += 4) memory.store(address, random());
    for (uint32_t& word : arguments) word = static_cast<uint32_t>(random() % 100);
    for (auto& package : input) {
      for (uint32_t& word : package) {
        const float value = (static_cast<int>(random() % 4001) - 2000) / 256.0f;
        word = random() % 16 == 0 ? random() : as_bits(value);
      }
    }
    mode.subnormals = seed % 2 != 0 ? Subnormals::Flush : Subnormals::Ieee;
    mode.fused = seed % 3 == 0;
    if (seed % 5 == 0) mode.significand = arith::kLeastSignificand + seed % 13;
    threads = 1 + seed % test::Interpreter::kLanes;
  }

  NativeThread thread(uint32_t lane, Memory& of) const {
    NativeThread thread;
    thread.thread = lane;
    thread.threads = threads;
    thread.arguments = &arguments;
    thread.memory = &of;
    thread.mode = mode;
    thread.input = input[lane];
    return thread;
  }
};

void run_as_source(NativeThread& thread, uint32_t seed, Values values = Values::Few) {
  if (thread.mode.subnormals == Subnormals::Flush) {
    thread.mode.fused ? run_random<Subnormals::Flush, true>(thread, seed, values)
                      : run_random<Subnormals::Flush, false>(thread, seed, values);
  } else {
    thread.mode.fused ? run_random<Subnormals::Ieee, true>(thread, seed, values)
                      : run_random<Subnormals::Ieee, false>(thread, seed, values);
  }
}

/// Runs the program and the source on the same random input; the memory from `end` on is the machine's own.
void compare_runs(uint32_t seed, const Program& program, bool fused, Values values, uint32_t end) {
  Beginning begin(seed);
  begin.mode.fused = fused;
  test::Interpreter machine;
  machine.memory = begin.memory;
  machine.arguments = begin.arguments;
  machine.input = begin.input;
  machine.mode = begin.mode;
  machine.threads = begin.threads;
  Memory native_memory = machine.memory;
  machine.run(program, program.entries.at("random"));

  for (uint32_t lane = 0; lane < machine.threads; ++lane) {
    NativeThread thread = begin.thread(lane, native_memory);
    run_as_source(thread, seed, values);
    ASSERT_EQ(thread.rays, machine.rays[lane]) << "seed " << seed << ", thread " << lane << "\n" << listing(program);
  }
  for (uint32_t address = 0; address < end; address += 4) {
    const int thread = (static_cast<int>(address) - 1024) / kSlotBytes;
    ASSERT_EQ(native_memory.load(address), machine.memory.load(address))
        << "seed " << seed << ", address " << address << ", thread " << thread << "\n"
        << listing(program);
  }
}

void compare(uint32_t seed, Outcome& outcome) {
  const bool fused = seed % 3 == 0, triples = seed % 4 >= 2;
  Program program;
  try {
    program = compiled(seed, KernelTarget(fused, triples));
  } catch (const InputError& error) {
    ++outcome.refused;
    // Registers that suffice without triples suffice with them.
    ASSERT_THROW(compiled(seed, KernelTarget(fused, false)), InputError) << "seed " << seed << ": " << error.what();
    return;
  }
  ++outcome.compiled;
  outcome.triples += triples_of(program);
  ASSERT_TRUE(triples || triples_of(program) == 0) << "seed " << seed;
  ASSERT_EQ(assemble(listing(program), "listing").code, program.code) << "seed " << seed;
  compare_runs(seed, program, fused, Values::Few, kMemoryBytes);
}

// What threads spill: value n of thread t at kSpilled + 32 n + 4 t.
constexpr uint32_t kSpilled = 2048;

struct Spilled {
  int refused = 0;
  CompileCounts counts;  // of all kernels
};

void compare_wide(uint32_t seed, Values values, Spilled& all) {
  Random random(seed ^ 0x5b111edu);
  const KernelTarget target(random() % 2 != 0, random() % 2 != 0);
  const bool has_memory = random() % 4 != 0;
  int offset = kNothing;
  const auto body = [&](RecordedKernel& k) {
    const RecordedKernel::Int bytes = k.thread() << 2;
    offset = bytes.number();
    RandomKernel<RecordedKernel>(k, seed, values).run();
  };
  Function function = record_kernel("random", body, target);
  if (has_memory) function.spill_memory = SpillMemory{offset, kSpilled, 32, (kMemoryBytes - kSpilled) / 32};
  function.reuses_values = random() % 3 != 0;
  if (random() % 4 == 0) function.slice_words = kRayWords + static_cast<int>(random() % 8);
  Program program;
  program.code.assign(seed % 5, 0);
  CompileCounts counts;
  try {
    counts = compile(function, program, target);
  } catch (const InputError& error) {
    ASSERT_FALSE(has_memory) << "seed " << seed << ": " << error.what();
    ++all.refused;
    return;
  }
  all.counts.spilled.to_words += counts.spilled.to_words;
  all.counts.spilled.to_memory += counts.spilled.to_memory;
  all.counts.spilled.recomputed += counts.spilled.recomputed;
  all.counts.spilled.predicates += counts.spilled.predicates;
  ASSERT_EQ(assemble(listing(program), "listing").code, program.code) << "seed " << seed;
  compare_runs(seed, program, target.fma, values, kSpilled);
}

TEST(RandomKernel, MachineCodeLeavesWhatTheSourceRunAsCppLeaves) {
  Outcome outcome;
  for (uint32_t seed = 1; seed <= 1500; ++seed) ASSERT_NO_FATAL_FAILURE(compare(seed, outcome));
  // Large ones may need more registers than there are; but a compiler that gives up easily would show here.
  EXPECT_GT(outcome.compiled, 1350) << outcome.refused << " refused";
  EXPECT_GT(outcome.triples, 400);
}

TEST(RandomKernel, IntermediateCodeLeavesWhatTheSourceRunAsCppLeaves) {
  for (uint32_t seed = 1; seed <= 3000; ++seed) {
    const Beginning begin(seed);
    const FunctionRunner runner(recorded(seed, KernelTarget(begin.mode.fused, false)));
    Memory source_memory = begin.memory, runner_memory = begin.memory;
    std::vector<NativeThread> threads;
    for (uint32_t lane = 0; lane < begin.threads; ++lane) threads.push_back(begin.thread(lane, runner_memory));
    // A packet of all, or of some.
    const size_t at_once = seed % 3 == 0 ? 1 : seed % 3 == 1 ? 3 : threads.size();
    for (size_t first = 0; first < threads.size(); first += at_once)
      runner.run(&threads[first], std::min(at_once, threads.size() - first));
    for (uint32_t lane = 0; lane < begin.threads; ++lane) {
      NativeThread source = begin.thread(lane, source_memory);
      run_as_source(source, seed);
      ASSERT_EQ(threads[lane].rays, source.rays) << "seed " << seed << ", thread " << lane;
    }
    for (uint32_t address = 0; address < kMemoryBytes; address += 4)
      ASSERT_EQ(runner_memory.load(address), source_memory.load(address)) << "seed " << seed << ", address " << address;
  }
}

TEST(RandomKernel, MoreValuesThanRegistersChangeNothing) {
  Spilled all;
  for (uint32_t seed = 1; seed <= 150; ++seed)
    ASSERT_NO_FATAL_FAILURE(compare_wide(seed, seed % 2 != 0 ? Values::Many : Values::ManyAndIdle, all));
  // These found: the address of spill memory in a word that an import took; values computed again that had been
  // written in part.
  for (const uint32_t seed : {161u, 262u, 307u, 330u, 347u, 380u, 415u, 418u, 459u, 491u, 516u, 587u, 595u, 610u, 645u})
    ASSERT_NO_FATAL_FAILURE(compare_wide(seed, Values::Many, all));
  EXPECT_LT(all.refused, 40);
  EXPECT_GT(all.counts.spilled.to_words, 1000);
  EXPECT_GT(all.counts.spilled.to_memory, 500);
  EXPECT_GT(all.counts.spilled.recomputed, 100);
  EXPECT_GT(all.counts.spilled.predicates, 100);
}

}  // namespace
}  // namespace raypool::kernel
