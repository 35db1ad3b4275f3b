// What shaders become, against their SPIR-V run directly (test_spirv.hpp).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <set>
#include <sstream>

#include "config/data_folder.hpp"
#include "files/input_file.hpp"
#include "isa/input_error.hpp"
#include "kernel/compiler.hpp"
#include "kernel/function_runner.hpp"
#include "kernel/test_interpreter.hpp"
#include "random.hpp"
#include "shader/glsl.hpp"
#include "shader/lowering.hpp"
#include "shader/shader_set.hpp"
#include "shader/test_random_shaders.hpp"
#include "shader/test_spirv.hpp"
#include "shader/test_world.hpp"

namespace raypool::shader {
namespace {

namespace fs = std::filesystem;

constexpr uint32_t kLanes = test::Interpreter::kLanes;

struct Outcome {
  int kernels = 0, compiled = 0, threads = 0, undefined = 0, rays = 0, contributions = 0, spilled = 0;
};

/// What left, as text, with the bits that are not defined left out.
std::string text_of(const test::SpirvThread& oracle) {
  std::string text;
  for (const test::OracleRay& ray : oracle.rays) {
    text += "ray";
    for (size_t i = 0; i < ray.words.size(); ++i) text += fmt::format(" {:08x}", ray.words[i] & ray.defined[i]);
    text += '\n';
  }
  for (const test::OracleContribution& out : oracle.frame) {
    text += fmt::format("pixel {:08x}", out.pixel);
    for (size_t i = 0; i < 3; ++i) text += fmt::format(" {:08x}", out.defined[i] ? out.rgb[i] : 0);
    text += '\n';
  }
  return text;
}
std::string text_of(const std::vector<Ray>& rays, const std::vector<FrameContribution>& frame,
                    const test::SpirvThread& oracle) {
  std::string text;
  for (size_t n = 0; n < rays.size(); ++n) {
    text += "ray";
    for (size_t i = 0; i < rays[n].size(); ++i)
      text += fmt::format(" {:08x}", rays[n][i] & (n < oracle.rays.size() ? oracle.rays[n].defined[i] : ~0u));
    text += '\n';
  }
  for (size_t n = 0; n < frame.size(); ++n) {
    text += fmt::format("pixel {:08x}", frame[n].pixel);
    for (size_t i = 0; i < 3; ++i)
      text += fmt::format(" {:08x}", n >= oracle.frame.size() || oracle.frame[n].defined[i] ? frame[n].rgb[i] : 0);
    text += '\n';
  }
  return text;
}

std::string text_of(const Intersection& input) {
  std::string text;
  for (const uint32_t word : input) text += fmt::format(" {:08x}", word);
  return text;
}

/// Address and word of where memories differ; empty: nowhere.
std::string difference(const Memory& expected, const Memory& got) {
  for (uint32_t address = 0; address < kMemoryBytes; address += 4)
    if (expected.load(address) != got.load(address))
      return fmt::format("address {}: {:08x}, expected {:08x}", address, got.load(address), expected.load(address));
  return "";
}

/// The function with room in memory for values that find no register: value n of thread t at 32 n + 4 t.
kernel::Function with_spill_memory(kernel::Function function) {
  if (function.spill_memory) return function;
  kernel::Op thread;
  thread.info = &instruction(Opcode::Tid);
  thread.rd = function.registers++;
  thread.fresh = true;
  kernel::Op offset;
  offset.info = &instruction(Opcode::Shl);
  offset.rd = function.registers++;
  offset.ra = thread.rd;
  offset.b_is_immediate = true;
  offset.immediate = 2;
  offset.fresh = true;
  function.ops.insert(function.ops.begin(), {thread, offset});
  function.spill_memory = kernel::SpillMemory{offset.rd, kMemoryBytes, 32, kSpillSlots};
  return function;
}

/// One kernel of a shader: its SPIR-V, its intermediate code and its machine code leave the same.
// NOLINTNEXTLINE(readability-function-size): three runs side by side
void compare(const Module& module, RayKernel kernel, World& world, uint32_t warps, Outcome& outcome,
             const std::function<void(Intersection&)>& change = nullptr) {
  SCOPED_TRACE(fmt::format("{} of {}", kRayKernelNames[kernel], module.name()));
  ++outcome.kernels;
  const kernel::Function function = lower(module, world.resources, kernel, {});
  const kernel::FunctionRunner runner(function);
  std::vector<std::pair<std::string, Program>> programs;
  for (const bool triples : {false, true}) {
    const KernelTarget target(false, triples);
    Program program;
    const kernel::CompileCounts counts =
        kernel::compile(with_spill_memory(lower(module, world.resources, kernel, target)), program, target);
    programs.emplace_back(triples ? "machine code with triples" : "machine code", program);
    ++outcome.compiled;
    outcome.spilled += counts.spilled.to_words + counts.spilled.to_memory;
  }
  for (uint32_t warp = 0; warp < warps; ++warp) {
    const uint32_t block = 8 * (warp % 3) | (warp % 9) << 16;  // some lie outside of the picture
    std::array<Intersection, kLanes> input{};
    std::array<std::string, kLanes> expected;
    std::vector<std::unique_ptr<test::SpirvThread>> oracles;
    Memory memory = world.memory, native_memory = world.memory;
    bool defined = true;
    for (uint32_t lane = 0; lane < kLanes; ++lane) {
      input.at(lane) = world.input(lane);
      if (change) change(input.at(lane));
      auto oracle = std::make_unique<test::SpirvThread>(module, world.resources, kernel, world.arguments, memory);
      oracle->thread = lane;
      oracle->block = block;
      oracle->input = input.at(lane);
      ++outcome.threads;
      try {
        oracle->run();
      } catch (const test::UndefinedBehaviour& what) {
        ++outcome.undefined;
        defined = false;
      }
      expected.at(lane) = text_of(*oracle);
      outcome.rays += static_cast<int>(oracle->rays.size());
      outcome.contributions += static_cast<int>(oracle->frame.size());
      oracles.push_back(std::move(oracle));
    }
    if (!defined) continue;
    for (uint32_t lane = 0; lane < kLanes; ++lane) {
      NativeThread thread;
      thread.thread = lane;
      thread.block = block;
      thread.threads = kLanes;
      thread.arguments = &world.arguments;
      thread.memory = &native_memory;
      thread.input = input.at(lane);
      runner.run(thread);
      ASSERT_EQ(expected.at(lane), text_of(thread.rays, thread.frame, *oracles[lane]))
          << "intermediate code, thread " << lane << ", block " << block << ", of" << text_of(input.at(lane));
    }
    ASSERT_EQ(difference(memory, native_memory), "") << "intermediate code";
    for (const auto& [name, program] : programs) {
      test::Interpreter machine;
      machine.block = block;
      machine.arguments = world.arguments;
      machine.memory = world.memory;
      machine.input = input;
      machine.run(program, program.entries.begin()->second);
      for (uint32_t lane = 0; lane < kLanes; ++lane) {
        ASSERT_EQ(expected.at(lane), text_of(machine.rays.at(lane), machine.frame.at(lane), *oracles[lane]))
            << name << ", thread " << lane << ", block " << block << ", of" << text_of(input.at(lane));
      }
      ASSERT_EQ(difference(memory, machine.memory), "") << name;
    }
  }
}

std::vector<RayKernel> kernels_of(const Module& module) {
  switch (module.stage()) {
    case spv::ExecutionModel::RayGenerationKHR:
      return {RayKernel::CastEye};
    case spv::ExecutionModel::MissKHR:
      return {RayKernel::Shade};
    default:
      return {RayKernel::CastSecondary, RayKernel::CastSecondaryDirect};
  }
}

bool is_shader(const fs::path& path) {
  const std::string ending = path.extension().string();
  return ending == ".rgen" || ending == ".rchit" || ending == ".rmiss";
}

std::vector<fs::path> sorted(const fs::path& folder) {
  std::vector<fs::path> paths;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  return paths;
}

void compare_folder(const fs::path& folder, Outcome& outcome) {
  Random random(5);
  World world(random);
  for (const fs::path& path : sorted(folder)) {
    if (!is_shader(path)) continue;
    const std::string text = read_file(path.string(), "shader");
    const Module module(spirv_of(path.string()), path.string());
    world.add(module, text.find("Word n of each buffer") != std::string::npos);
    for (const RayKernel kernel : kernels_of(module))
      ASSERT_NO_FATAL_FAILURE(compare(module, kernel, world, 5, outcome));
  }
}

class ShaderFolders : public testing::TestWithParam<std::string> {};

TEST_P(ShaderFolders, LeaveWhatTheirSpirvLeaves) {
  Outcome outcome;
  compare_folder(fs::path(data_folder()) / GetParam(), outcome);
  EXPECT_GE(outcome.kernels, 3);
  EXPECT_EQ(outcome.undefined, 0);
  std::cout << fmt::format(
      "{}: {} kernels, {} compiled, {} spilled, {} threads ({} undefined), {} rays, {} contributions\n", GetParam(),
      outcome.kernels, outcome.compiled, outcome.spilled, outcome.threads, outcome.undefined, outcome.rays,
      outcome.contributions);
}

/// But for those that wait for their rays, which waits_test.cpp and shader_engines_test.cpp compare.
std::vector<std::string> folders() {
  const std::set<std::string> waiting = {"triangle", "reflections", "shadow_inside", "bounces",
                                         "groups",   "cutouts",     "layers",        "table",
                                         "nested",   "by_material", "accumulated"};
  std::vector<std::string> names;
  for (const char* outer : {"shaders", "cpp_model/shader/cases"}) {
    const fs::path folder = fs::path(data_folder()) / outer;
    if (!fs::is_directory(folder)) continue;
    for (const fs::path& path : sorted(folder))
      if (fs::is_directory(path) && waiting.count(path.filename().string()) == 0)
        names.push_back(fmt::format("{}/{}", outer, path.filename().string()));
  }
  return names;
}

INSTANTIATE_TEST_SUITE_P(All, ShaderFolders, testing::ValuesIn(folders()), [](const auto& one) {
  std::string name = fs::path(one.param).filename().string();
  std::replace_if(
      name.begin(), name.end(), [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; }, '_');
  return (one.param.rfind("shaders", 0) == 0 ? "set_" : "case_") + name;
});

void compare_random_set(uint32_t seed, Outcome& outcome) {
  SCOPED_TRACE(fmt::format("seed {}", seed));
  const Scratch scratch;
  const RandomShaders shaders = random_shaders(seed);
  Random random(seed);
  World world(random);
  const std::pair<const char*, const std::string*> stages[] = {
      {"a.rgen", &shaders.ray_generation}, {"a.rchit", &shaders.closest_hit}, {"a.rmiss", &shaders.miss}};
  for (const auto& [name, text] : stages) {
    const std::string path = scratch.write(name, *text);
    const Module module(spirv_of(path), path);
    world.add(module);
    for (const RayKernel kernel : kernels_of(module))
      ASSERT_NO_FATAL_FAILURE(compare(module, kernel, world, 4, outcome)) << *text;
  }
}

class RandomShaderSets : public testing::TestWithParam<uint32_t> {};

TEST_P(RandomShaderSets, LeaveWhatTheirSpirvLeaves) {
  Outcome outcome;
  for (uint32_t seed = 10 * GetParam(); seed < 10 * GetParam() + 10; ++seed)
    ASSERT_NO_FATAL_FAILURE(compare_random_set(seed, outcome));
  EXPECT_EQ(outcome.undefined, 0);
  EXPECT_GT(outcome.rays, 100);
  std::cout << fmt::format(
      "{} kernels, {} compiled, {} spilled, {} threads ({} undefined), {} rays, {} contributions\n", outcome.kernels,
      outcome.compiled, outcome.spilled, outcome.threads, outcome.undefined, outcome.rays, outcome.contributions);
}

INSTANTIATE_TEST_SUITE_P(Tens, RandomShaderSets, testing::Range(0u, 3u));
INSTANTIATE_TEST_SUITE_P(FurtherTens, RandomShaderSets, testing::Range(3u, 10u));

TEST(RandomShaderSet, OfASeedThatFoundABugLeavesWhatItsSpirvLeaves) {
  // A variable that a loop only wrote, in memory that another one was given.
  Outcome outcome;
  for (const uint32_t seed : {222u}) ASSERT_NO_FATAL_FAILURE(compare_random_set(seed, outcome));
  EXPECT_EQ(outcome.undefined, 0);
  EXPECT_GT(outcome.spilled, 0);
}

// ---- mistakes

/// What a message must have: the words of each line `// expect: WORDS`.
std::vector<std::string> expected_words(const std::string& text) {
  std::vector<std::string> words;
  std::istringstream lines(text);
  const std::string mark = "// expect: ";
  for (std::string line; std::getline(lines, line);)
    if (line.rfind(mark, 0) == 0) words.push_back(line.substr(mark.size()));
  return words;
}

/// The line that ends with `// here`; 0: none.
int line_here(const std::string& text) {
  std::istringstream lines(text);
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    if (line.find("// here") != std::string::npos) return number;
  }
  return 0;
}

/// The message of the set that is in the folder; empty: it has none.
std::string message_of(const fs::path& folder) {
  try {
    const auto set = ShaderSet::load(folder.string());
    Random random(3);
    World world(random);
    for (const fs::path& path : sorted(folder))
      if (is_shader(path)) world.add(Module(spirv_of(path.string()), path.string()));
    set->record(world.resources, {});
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

fs::path mistakes_folder() { return fs::path(data_folder()) / "cpp_model/shader/mistakes"; }

std::vector<std::string> mistakes() {
  std::vector<std::string> names;
  for (const fs::path& path : sorted(mistakes_folder()))
    if (path.filename() != "right" && path.extension() != ".md") names.push_back(path.filename().string());
  return names;
}

class Mistakes : public testing::TestWithParam<std::string> {};

TEST_P(Mistakes, AreReportedWithFileAndWhatToDo) {
  const Scratch scratch;
  const fs::path mistake = mistakes_folder() / GetParam();
  std::vector<std::string> words;
  int line = 0;
  if (fs::is_directory(mistake)) {
    for (const fs::path& path : sorted(mistake)) {
      const std::string text = read_file(path.string(), "shader");
      scratch.write(path.filename().string(), text);
      for (const std::string& word : expected_words(text)) words.push_back(word);
    }
  } else {
    for (const fs::path& path : sorted(mistakes_folder() / "right"))
      if (path.extension() != mistake.extension())
        scratch.write(path.filename().string(), read_file(path.string(), "shader"));
    const std::string text = read_file(mistake.string(), "shader");
    scratch.write(GetParam(), text);
    words = expected_words(text);
    words.push_back(GetParam());
    line = line_here(text);
  }
  const std::string message = message_of(scratch.path());
  ASSERT_NE(message, "");
  ASSERT_FALSE(words.empty());
  for (const std::string& word : words) EXPECT_NE(message.find(word), std::string::npos) << word << "\nin: " << message;
  // Not every message names a line, but none names another one.
  if (message.find(fmt::format("{}: ", GetParam())) == std::string::npos && line != 0) {
    const std::string place = fmt::format("{}:{}:", GetParam(), line);
    EXPECT_NE(message.find(place), std::string::npos) << place << "\nin: " << message;
  }
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

INSTANTIATE_TEST_SUITE_P(All, Mistakes, testing::ValuesIn(mistakes()), [](const auto& one) {
  std::string name = one.param;
  std::replace(name.begin(), name.end(), '.', '_');
  return name;
});

TEST(RightShaders, HaveNoMessage) { EXPECT_EQ(message_of(mistakes_folder() / "right"), ""); }

// ---- control flow

struct Snippet {
  const char* name;
  const char* functions;  // before main()
  const char* body;       // changes int r, s and float t; has ints a, b, c in 0 .. 7 and floats x, y
};

std::ostream& operator<<(std::ostream& out, const Snippet& snippet) { return out << snippet.name; }

const Snippet kSnippets[] = {
    {"EarlyReturnsInNestedIfs", "",
     R"(r = 1;
  if (a > 2) {
    s = b;
    if (b > 3) {
      r = 2;
      if (c == 1) return;
      if (x < 0.0) {
        imageStore(picture, pixel, vec4(intBitsToFloat(77), x, y, 0.0));
        return;
      }
      s += 3;
    } else if (c > 5) {
      imageStore(picture, pixel, vec4(intBitsToFloat(78), x, y, 0.0));
      return;
    }
    r += a;
  }
  t = x + y;)"},
    {"BreakAndContinueInNestedLoops", "",
     R"(for (int i = 0; i < a + 1; ++i) {
    if ((i & 1) == (b & 1)) continue;
    for (int j = 0; j < b + 2; ++j) {
      if (j == c) break;
      if (((i + j) & 3) == 1) continue;
      r += i * j + 1;
      if (r > 40) break;
    }
    s = s * 3 + r;
    if (s > 1000) break;
  })"},
    {"DoWhile", "",
     R"(int n = a;
  do {
    r += n;
    if (r > 9) { s = 1; break; }
    n = n * 2 + 1;
    if ((n & 7) == b) continue;
    t += x;
  } while (n < 30 + c);
  s += n;)"},
    {"SwitchWithFallthrough", "",
     R"(switch (a) {
    case 0:
      r = 10;
    case 1:
      r += 5;
      break;
    case 3:
      r -= 7;
      if (b > 4) break;
    case 4:
    case 5:
      r += 100;
      s = b;
      break;
    case 6:
      t = x;
  }
  s += r;)"},
    {"SwitchWithDefaultInTheMiddle", "",
     R"(switch (a - 2) {
    case 0:
      r += 1;
      break;
    case -1:
      r += 2;
    default:
      r += 4;
      if (b < 3) break;
      s = 5;
    case 1:
      r += 8;
    case 2:
      s += r;
      break;
    case 3:
      s = 50;
  }
  t = float(s);)"},
    {"LoopWithTwoExitsAndValuesAfterIt", "",
     R"(int i = 0;
  int last = -1;
  for (;; ++i) {
    const int square = i * i + b;
    last = square ^ c;
    if (square > 20) { s = i; break; }
    const float scaled = x * float(i);
    t = scaled;
    if (scaled > 3.0) { s = 100 + square; break; }
  }
  r = i * 1000 + last;)"},
    {"PhiSwaps", "",
     R"(int f = 0, g = 1;
  for (int i = 0; i < a + b; ++i) {
    const int next = f + g;
    f = g;
    g = next;
  }
  int u = 1, v = 2, w = 3;
  for (int i = 0; i < c; ++i) {
    const int first = u;
    u = v;
    v = w;
    w = first;
  }
  r = f * 8 + g;
  s = u + 10 * v + 100 * w;)"},
    {"FunctionsWithEarlyReturns",
     R"(int inner(int v, int w) {
  if (v < 2) return w;
  for (int i = 0; i < v; ++i) {
    if (i * w > 6) return i + 100;
    if (i == w) return -i;
  }
  return v - w;
}
int outer(int v, int w) {
  int sum = 0;
  for (int i = 0; i < 3; ++i) {
    const int got = inner(v + i, w);
    if (got > 100) return sum + got;
    if (got < 0) continue;
    sum += got * 2;
  }
  return inner(sum & 7, w) + sum;
}
)",
     R"(r = outer(a, b);
  s = outer(c, r & 3) + inner(b, c);)"},
    {"ShortCircuitsWithSideEffects",
     R"(int calls = 0;
bool is_large(int v) {
  calls = calls * 3 + 1;
  return v > 3;
}
bool is_odd(int v) {
  calls = calls * 5 + 2;
  return (v & 1) == 1;
}
)",
     R"(if (is_large(a) && is_odd(b) || is_large(c) && is_odd(a)) r = 1;
  if ((is_large(b) || is_odd(c)) ^^ (is_large(c) && is_odd(b))) r += 2;
  while (is_large(s) == false && !is_odd(a + s)) s += 1;
  t = float(calls);)"},
    {"Ternaries", "",
     R"(r = a > 3 ? (b > 3 ? c : a + b) : c > 3 ? a - b : -7;
  t = x < y ? x > 0.0 ? x * y : -x : (y > 1.0 ? y : 0.5);
  s = (a > b ? b > c ? 1 : 2 : a > c ? 3 : 4) * 10 + (x > y ? 1 : 0);)"},
    {"LoopsWithoutTurns", "",
     R"(for (int i = a; i < b; ++i) r += i;
  int n = c;
  while (n > 4) { n -= 2; s += n; }
  for (int i = 0; i < 0; ++i) t += 1.0;
  for (int i = 7; i < a; ++i) for (int j = 0; j < 3; ++j) s += 1000;
  r = r * 10 + n;)"},
    {"ConditionsCarriedByLoops", "",
     R"(bool found = false, even = true, before = false;
  for (int i = 0; i < a + 2 && !found; ++i) {
    const bool hit = ((i * b + c) & 7) == 5;
    found = hit || (before && even);
    before = even;
    even = !even;
    r += found ? 100 : 1;
    if (before != hit) s += 1;
  }
  if (found) s += 50;
  if (even && before) s += 1000;)"},
    {"StructsWithConditions",
     R"(struct State {
  bool alive;
  int count;
  bvec2 sides;
  float weight;
};
State next(State state, int v) {
  state.count += v;
  state.alive = state.count < 12;
  state.sides = bvec2(state.sides.y, v > 3);
  if (state.sides.x) state.weight *= 0.5;
  return state;
}
)",
     R"(State state = State(true, a, bvec2(b > 3, false), 1.0);
  for (int i = 0; i < 6 && state.alive; ++i) {
    state = next(state, (b + i * c) & 7);
    if (all(state.sides)) r += 1;
  }
  State other = state;
  if (other != next(state, 0)) s = 7;
  t = state.weight;
  r = r * 100 + state.count + (state.alive ? 1000 : 0);)"},
    {"ArraysAtDynamicIndicesInLoops", "",
     R"(int many[5] = int[](1, 2, 3, 4, 5);
  float some[3] = float[](0.5, 0.25, 0.125);
  for (int i = 0; i < a + 1; ++i) {
    const int at = (i * b + c) % 5;
    many[at] += many[(at + 1) % 5];
    if (many[at] > 20) many[at] -= 15;
    some[i % 3] = some[(i + b) % 3] + x;
    if (some[i % 3] > 2.0) break;
  }
  for (int i = 0; i < 5; ++i) r = r * 7 + many[i];
  s = many[c % 5];
  t = some[b % 3];)"},
    {"VectorsAtDynamicIndices", "",
     R"(ivec4 v = ivec4(a, b, c, 9);
  mat2 m = mat2(x, y, 1.0, -2.0);
  for (int i = 0; i < c; ++i) {
    v[(i + a) & 3] = v[i & 3] + i;
    m[i & 1][b & 1] += 0.5;
  }
  r = v.x + 10 * v.y;
  s = v[b & 3];
  t = m[a & 1][c & 1];)"},
    {"SwitchInLoopWithContinue", "",
     R"(for (int i = 0; i < 8; ++i) {
    switch ((a + i) & 3) {
      case 0:
        continue;
      case 1:
        r += 1;
        break;
      case 2:
        r += 10;
        if (i > b) return;
      default:
        r += 100;
        if (r > 400) continue;
    }
    s += r;
    if (s > 1500) break;
  })"},
    {"LoopInSwitchInLoop", "",
     R"(for (int i = 0; i < a; ++i) {
    switch (i & 1) {
      case 0:
        for (int j = 0; j < b; ++j) {
          if (j == c) break;
          if (j == 6) return;
          r += j;
        }
        if (r > 12) break;
        s += 1;
        break;
      default: {
        int n = c;
        while (true) {
          if (--n < 0) break;
          s += n;
        }
      }
    }
  }
  t = x;)"},
    {"ReturnOutOfNestedLoops", "",
     R"(for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      for (int k = 0; k < 3; ++k) {
        r = i * 100 + j * 10 + k;
        if (i * a + j * b + k * c == 11) return;
        t += x;
      }
      if (j == b) break;
    }
    s += 1;
  })"},
    {"ValuesOfLoopsUsedInLaterLoops", "",
     R"(int best = -1, at = 0;
  for (int i = 0; i < 6; ++i) {
    const int v = (i * a + b) % 7;
    if (v > best) { best = v; at = i; }
    if (best == 6) break;
  }
  int left = best;
  while (left > 0) {
    left -= at + 1;
    if (left == c) { s = 1; break; }
    r += left;
  }
  t = float(at) + 0.5 * float(best);)"},
    {"EndlessLoopsWithExitsInSwitches", "",
     R"(int state = a & 3, steps = 0;
  while (true) {
    bool done = false;
    switch (state) {
      case 0:
        state = b > 3 ? 1 : 2;
        break;
      case 1:
        state = (steps & 1) == 0 ? 3 : 2;
        break;
      case 2:
        if (steps > c) { done = true; break; }
        state = 0;
        break;
      case 3:
        s += 7;
        state = steps > 4 ? 2 : 0;
    }
    steps += 1;
    if (done || steps > 12) break;
  }
  r = steps * 10 + state;)"},
    {"FloatsCarriedByLoops", "",
     R"(float u = x, v = y;
  int n = 0;
  while (u * u + v * v < 16.0 && n < 9) {
    const float w = u * u - v * v + x;
    v = 2.0 * u * v + y;
    u = w;
    ++n;
  }
  r = n;
  t = u > v ? u : v;)"},
    {"OutParametersOfFunctionsThatReturnEarly",
     R"(bool divide(int v, int by, out int whole, inout float sum) {
  whole = -1;
  sum += 0.5;
  if (by == 0) return false;
  whole = v / by;
  if (whole * by != v) {
    sum *= 2.0;
    return false;
  }
  sum = -sum;
  return true;
}
)",
     R"(int q = 0;
  t = x;
  if (divide(a * 6, b, q, t)) r = q;
  else s = q;
  for (int i = 0; i < 3; ++i) {
    int p;
    if (!divide(c + i, i, p, t)) continue;
    s += p * 10;
    if (divide(p, b, q, t)) break;
  }
  r += 100 * q;)"},
    {"SidesOfIfsThatEndAtDifferentPlaces", "",
     R"(for (int i = 0; i < 5; ++i) {
    if (a > i) {
      if (b == i) continue;
      r += 1;
    } else {
      if (c == i) break;
      if (x > 1.0) {
        s += 4;
        continue;
      }
      r += 10;
    }
    if ((i & 1) == 0) s += r; else if (b > 5) break; else t += y;
  }
  r *= 2;)"},
    {"MemoryWrittenInLoops", "",
     R"(for (int i = 0; i < a; ++i) {
    const int at = (i + b) & 3;
    if (at == c) continue;
    // Each pixel has a place of its own.
    scratch.words[4 * place + at] += i + 1;
    r += scratch.words[4 * place + (c & 3)];
  }
  s = scratch.words[4 * place];)"},
    {"RaysLeaveFromNestedPlaces", "",
     R"(if (a > 1) {
    light = vec3(x, y, float(b));
    if (b < 3) {
      light.x = 9.0;
      traceRayEXT(tree, kShadow, 0xff, 0, 0, 0, vec3(x), 0.0, vec3(y), 1.0, 1);
      if (c > 5) return;
    } else {
      for (int i = 0; i < b; ++i) {
        light *= 0.5;
        if (light.z < 1.0) break;
      }
      traceRayEXT(tree, kShadow, 0xff, 0, 0, 0, vec3(y), 0.25, vec3(x, 1.0, 2.0), 4.0, 1);
      r = 4;
    }
  } else if (c == 2) return;
  payload = uvec3(a, b, c);
  if (c > 3) traceRayEXT(tree, gl_RayFlagsOpaqueEXT, 0xff, 0, 0, 0, vec3(1.0), 0.0, vec3(x, y, 1.0), 1e30, 0);
  s = r + a;)"},
    {"ValuesOfLoopsReadBehindThem", "",
     R"(bool big, odd = false;
  int i = 0, both;
  vec2 scaled;
  while (true) {
    big = i * a > 6;
    odd = ((i ^ b) & 1) == 1;
    both = i * 5 + b;
    scaled = vec2(x, y) * float(i);
    if (i * 3 > c) break;
    for (int j = 0;; ++j) {
      both += j;
      odd = odd != (j > a);
      if (j * 2 > b) break;
    }
    if (both > 40 && odd) break;
    ++i;
  }
  if (big) r = both + i;
  s = (odd ? 100 : 200) + i;
  t = scaled.x - scaled.y;)"},
    {"CaseThatFallsIntoALoop", "",
     R"(vec2 bound = vec2(float(b));
  switch (a & 3) {
    case 1:
      bound.y = float(c);
    default: {
      int i = 0;
      while (i++ < 3 && 2.5 < bound.y) {
        r += i;
        bound.y -= 1.0;
      }
    }
  }
  s = r * 2;
  t = bound.y;)"},
    {"ConditionsOfWholeVectors", "",
     R"(ivec3 v = ivec3(a, b, c);
  bvec3 above = greaterThan(v, v.yzx);
  bool any_equal = false;
  for (int i = 0; i < 3; ++i) {
    if (above[i]) v[i] -= 1;
    any_equal = any_equal || v[i] == v[(i + 1) % 3];
    above = not(above.zxy);
  }
  if (any(above) && !all(above)) r = v.x * 64 + v.y * 8 + v.z;
  s = int(any_equal);
  t = dot(mix(vec3(x), vec3(y), above), vec3(1.0, 2.0, 4.0));)"},
};

std::string whole_shader(const Snippet& snippet) {
  return fmt::format(R"(#version 460
#extension GL_EXT_ray_tracing : require
layout(set = 0, binding = 0) uniform accelerationStructureEXT tree;
layout(set = 0, binding = 1, rgba32f) uniform image2D picture;
layout(set = 0, binding = 2, std430) buffer Scratch {{ int words[2048]; }} scratch;
layout(location = 0) rayPayloadInEXT uvec3 payload;
layout(location = 1) rayPayloadEXT vec3 light;
hitAttributeEXT vec2 attributes;
const uint kShadow = gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT;
{}
void run(int a, int b, int c, float x, float y, inout int r, inout int s, inout float t) {{
  const ivec2 pixel = ivec2(gl_LaunchIDEXT.xy);
  const int place = gl_PrimitiveID;
  {}
}}
void main() {{
  int r = 0, s = 0;
  float t = 0.0;
  run(int(payload.x & 7u), int(payload.y & 7u), int(payload.z & 7u), gl_WorldRayOriginEXT.x, gl_WorldRayOriginEXT.y,
      r, s, t);
  imageStore(picture, ivec2(gl_LaunchIDEXT.xy), vec4(intBitsToFloat(r), intBitsToFloat(s), t, 0.0));
}}
)",
                     snippet.functions, snippet.body);
}

class ControlFlow : public testing::TestWithParam<Snippet> {};

TEST_P(ControlFlow, LeavesWhatItsSpirvLeaves) {
  const Scratch scratch;
  const std::string text = whole_shader(GetParam());
  const std::string path = scratch.write(fmt::format("{}.rchit", GetParam().name), text);
  const Module module(spirv_of(path), path);
  Random random(9);
  World world(random);
  world.add(module);
  Outcome outcome;
  uint32_t next = 0;
  // Places in memory are each thread's own.
  const auto change = [&](Intersection& input) {
    input[word::kTriangle] = next++ % 512;
    for (size_t i = word::kColor; i < word::kColor + 3; ++i) input.at(i) = random();
  };
  for (const RayKernel kernel : kernels_of(module))
    ASSERT_NO_FATAL_FAILURE(compare(module, kernel, world, 60, outcome, change)) << text;
  EXPECT_EQ(outcome.undefined, 0) << text;
  EXPECT_GT(outcome.contributions, 400) << text;
  EXPECT_EQ(outcome.compiled, 4) << text;
}

INSTANTIATE_TEST_SUITE_P(Snippets, ControlFlow, testing::ValuesIn(kSnippets),
                         [](const auto& one) { return std::string(one.param.name); });

}  // namespace
}  // namespace raypool::shader
