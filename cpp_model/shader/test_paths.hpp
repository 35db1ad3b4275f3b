// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// For tests: paths of sets whose shaders wait for their rays, in a scripted scene where a hash of a ray decides what it
// meets. A recursive renderer runs the SPIR-V (test_spirv.hpp); beside it the kernels run natively and as machine code.
#pragma once

#include <algorithm>
#include <deque>
#include <functional>
#include <memory>

#include "isa/input_error.hpp"
#include "kernel/compiler.hpp"
#include "kernel/function_runner.hpp"
#include "kernel/test_interpreter.hpp"
#include "shader/glsl.hpp"
#include "shader/lowering.hpp"
#include "shader/test_spirv.hpp"
#include "shader/test_world.hpp"

namespace raypool::shader {

/// What a thread of a path does until its ray leaves, or the path ends: the ray's words that the scene reads, and
/// contributions.
struct Step {
  std::optional<Ray> ray;
  std::vector<test::OracleContribution> frame;
};
using Steps = std::vector<Step>;

inline std::string text_of(const Step& step) {
  std::string text;
  for (const test::OracleContribution& out : step.frame) {
    text += fmt::format("  pixel {:08x}", out.pixel);
    for (size_t i = 0; i < 3; ++i) text += out.defined[i] ? fmt::format(" {:08x}", out.rgb[i]) : " undefined";
    text += '\n';
  }
  if (step.ray) {
    text += "  ray";
    for (size_t i = 0; i <= word::kPixel; ++i) text += fmt::format(" {:08x}", (*step.ray)[i]);
    text += '\n';
  }
  return text;
}

/// Modules of a set, in the order of traceRayEXT's indices, and where they wait.
class PathSet {
 public:
  /// Files of one folder, in order.
  explicit PathSet(const std::vector<std::string>& files) {
    for (const std::string& file : files) {
      const std::vector<uint32_t> words = spirv_of(file);
      std::vector<std::unique_ptr<Module>>& to = of_stage(Module(words, file).stage());
      to.push_back(
          std::make_unique<Module>(words, file, std::map<uint32_t, uint32_t>{}, static_cast<uint32_t>(to.size())));
    }
    uint32_t first = 1;
    for (const auto* modules : {&begin_, &hits_, &misses_}) {
      for (const auto& module : *modules) {
        waits_.push_back(find_waits(*module, first));
        first += static_cast<uint32_t>(waits_.back().sites.size());
      }
    }
  }

  WaitingShaders shaders() const {
    size_t next = 0;
    const auto one = [&](const std::unique_ptr<Module>& module) { return WaitingShader{*module, waits_.at(next++)}; };
    WaitingShaders all = {one(begin_.at(0)), {}, {}, {}, callables(), static_cast<uint32_t>(hits_.size())};
    for (uint32_t i = 0; i < hits_.size(); ++i) all.closest_hits.push_back({one(hits_[i]), {i}});
    for (const auto& module : misses_) all.misses.push_back(one(module));
    return all;
  }
  Callables callables() const {
    Callables all;
    for (const auto& module : callables_) all.push_back(module.get());
    return all;
  }
  const Module& begin() const { return *begin_.at(0); }
  const Module* miss(uint32_t index) const { return index < misses_.size() ? misses_[index].get() : nullptr; }
  const Module* hit(uint32_t index) const { return index < hits_.size() ? hits_[index].get() : nullptr; }
  template <typename Visit>
  void each(const Visit& visit) const {
    for (const auto* modules : {&begin_, &hits_, &misses_, &callables_})
      for (const auto& module : *modules) visit(*module);
  }

 private:
  std::vector<std::unique_ptr<Module>>& of_stage(spv::ExecutionModel stage) {
    switch (stage) {
      case spv::ExecutionModel::RayGenerationKHR:
        return begin_;
      case spv::ExecutionModel::MissKHR:
        return misses_;
      case spv::ExecutionModel::CallableKHR:
        return callables_;
      default:
        return hits_;
    }
  }

  std::vector<std::unique_ptr<Module>> begin_, hits_, misses_, callables_;
  std::deque<Waits> waits_;
};

/// Eye to end of one path, on three ways. Every ray is answered by its first seven words alone.
class Paths {
 public:
  Paths(const PathSet& set, World& world) : set_(set), world_(world), shaders_(set.shaders()) {
    Resources& resources = world.resources;
    resources.levels = 3;
    resources.path_words = path_words(shaders_, resources.levels);
    resources.threads = test::Interpreter::kLanes;
    resources.units = 2;
    bytes_ = resources.saved + resources.paths_bytes() + resources.saved_stride() * kSpillSlots;
  }

  /// The package that comes back of a ray.
  Intersection answer(const Ray& ray, bool first) const {
    uint32_t hash = 0x811c9dc5u;
    for (size_t i = 0; i < word::kPixel; ++i) hash = (hash ^ ray[i] ^ (ray[i] >> 13)) * 0x01000193u;
    hash ^= hash >> 16;
    Random random(hash);
    Intersection package;
    package.fill(kernel::kUndefinedWord);
    std::copy(ray.begin(), ray.end(), package.begin());
    const bool met = random() % 3 != 0;
    if (met && !first) world_.put_hit(package, random);
    set_met(package, met);
    return package;
  }

  /// What the recursive renderer does in the pixel; nothing where it is undefined.
  std::optional<Steps> expected(uint32_t pixel, Memory& memory) const {
    Steps steps(1);
    test::SpirvThread thread(set_.begin(), world_.resources, RayKernel::CastEye, world_.arguments, memory);
    thread.block = pixel;
    try {
      run(thread, steps);
    } catch (const test::UndefinedBehaviour&) {
      return std::nullopt;
    }
    return steps;
  }

  kernel::Function lowered(RayKernel kernel, const KernelTarget& target = {}) const {
    return lower_waiting(shaders_, world_.resources, kernel, target);
  }

  Memory memory() const {
    Memory memory(static_cast<uint32_t>(bytes_));
    for (uint32_t address = 0; address < kMemoryBytes; address += 4) memory.store(address, world_.memory.load(address));
    return memory;
  }

  static Steps& add(Steps& steps, const std::vector<Ray>& rays, const std::vector<FrameContribution>& frame) {
    for (const FrameContribution& out : frame) steps.back().frame.push_back({out.pixel, out.rgb, {true, true, true}});
    EXPECT_LE(rays.size(), 1u);
    if (!rays.empty()) {
      steps.back().ray = rays[0];
      steps.emplace_back();
    }
    return steps;
  }

 private:
  void run(test::SpirvThread& thread, Steps& steps) const {
    const auto collect = [&steps](test::SpirvThread& its) {
      steps.back().frame.insert(steps.back().frame.end(), its.frame.begin(), its.frame.end());
      its.frame.clear();
    };
    thread.call = [&](test::SpirvThread& caller, const test::SpirvThread::Call& call,
                      test::SpirvThread::Words& payload) {
      collect(caller);
      const bool is_hit = caller.kernel() == RayKernel::CastSecondary;
      if (is_hit && caller.level >= world_.resources.levels) return;  // too deep
      const bool first = (call.flags & kShadowRay) == kShadowRay;
      Ray ray = call.ray;
      ray[word::kFlags] = steps.size() == 1 ? 1 : 2;  // depth
      steps.back().ray = ray;
      steps.emplace_back();
      const Intersection package = answer(ray, first);
      const bool met = (package[word::kFlags] & kMetFlag) != 0;
      if (met && (call.flags & 8) != 0) return;
      const Module* module = met ? set_.hit(call.closest_hit) : set_.miss(call.miss);
      if (module == nullptr) {
        // Like a shader that does nothing.
        if (!met && call.miss == 0) return;
        throw test::UndefinedBehaviour("a ray calls a shader that the set does not have");
      }
      test::SpirvThread called(*module, world_.resources, met ? RayKernel::CastSecondary : RayKernel::Shade,
                               world_.arguments, caller.memory());
      called.input = package;
      called.payload = payload;
      called.ray_flags = call.flags;
      called.begin = call.begin;
      called.level = is_hit ? caller.level + 1 : 0;
      run(called, steps);
      payload = *called.payload;
    };
    thread.callables = set_.callables();
    thread.run();
    collect(thread);
  }

  const PathSet& set_;
  World& world_;
  WaitingShaders shaders_;
  uint64_t bytes_ = 0;
};

struct PathOutcome {
  int paths = 0, undefined = 0, rays = 0, contributions = 0, spilled = 0, compiled = 0;
  size_t longest = 0;
};

/// The picture takes contributions in any order.
inline void sort_as(const std::vector<test::OracleContribution>& expected, std::vector<test::OracleContribution>& got) {
  for (size_t n = 0; n < std::min(expected.size(), got.size()); ++n) {
    const test::OracleContribution& wanted = expected[n];
    const auto same = std::find_if(got.begin() + static_cast<std::ptrdiff_t>(n), got.end(), [&](const auto& one) {
      bool equal = one.pixel == wanted.pixel;
      for (size_t i = 0; i < 3; ++i) equal &= !wanted.defined[i] || one.rgb[i] == wanted.rgb[i];
      return equal;
    });
    if (same != got.end()) std::iter_swap(got.begin() + static_cast<std::ptrdiff_t>(n), same);
    got[n].defined = wanted.defined;
  }
}

/// Expected steps as text, and what was done, with what is undefined left out.
inline std::string difference(const Steps& expected, Steps got) {
  std::string all;
  for (size_t i = 0; i < std::max(expected.size(), got.size()); ++i) {
    const bool both = i < expected.size() && i < got.size();
    if (both) {
      sort_as(expected[i].frame, got[i].frame);
    }
    const std::string wanted = i < expected.size() ? text_of(expected[i]) : "",
                      its = i < got.size() ? text_of(got[i]) : "";
    all += fmt::format("step {}:\n{}", i, its);
    if (wanted != its) return fmt::format("{} expected:\n{}", all, wanted);
  }
  return "";
}

/// Machine code of all paths, eight rays a warp, in a random order, on any of Resources::units.
class PathMachine {
 public:
  PathMachine(const Paths& paths, const World& world, const KernelTarget& target) : paths_(paths), world_(world) {
    for (const RayKernel kernel : {RayKernel::CastEye, RayKernel::CastSecondary}) {
      const kernel::CompileCounts counts = kernel::compile(paths.lowered(kernel, target), programs_[kernel], target);
      spilled += counts.spilled.to_words + counts.spilled.to_memory;
    }
    machine_.memory = paths.memory();
    machine_.arguments = world.arguments;
    if (world.resources.units > 1) machine_.caches = &caches_;
  }

  int spilled = 0;
  const Memory& memory() const { return machine_.memory; }

  /// [pixel y][x]
  std::map<uint32_t, Steps> run(Random& random) {
    for (uint32_t y = 0; y < kHeight; ++y) {
      for (uint32_t x = 0; x < kWidth; x += test::Interpreter::kLanes) {
        machine_.block = x | y << 16;
        machine_.threads = test::Interpreter::kLanes;
        std::vector<uint32_t> pixels;
        for (uint32_t lane = 0; lane < machine_.threads; ++lane) {
          pixels.push_back((x + lane) | y << 16);
          steps_[pixels.back()].resize(1);
        }
        warp(RayKernel::CastEye, pixels);
      }
    }
    while (!packages_.empty()) {
      std::vector<uint32_t> pixels;
      machine_.threads = 0;
      while (!packages_.empty() && machine_.threads < test::Interpreter::kLanes) {
        std::swap(packages_[random() % packages_.size()], packages_.back());
        pixels.push_back(packages_.back()[word::kPixel]);
        machine_.input.at(machine_.threads++) = packages_.back();
        packages_.pop_back();
      }
      warp(RayKernel::CastSecondary, pixels);
    }
    return steps_;
  }

 private:
  void warp(RayKernel kernel, const std::vector<uint32_t>& pixels) {
    for (auto& rays : machine_.rays) rays.clear();
    for (auto& frame : machine_.frame) frame.clear();
    machine_.unit = ++warps_ * 0x9e3779b9u >> 31;
    machine_.run(programs_[kernel], programs_[kernel].entries.begin()->second);
    for (uint32_t lane = 0; lane < pixels.size(); ++lane) {
      Paths::add(steps_.at(pixels[lane]), machine_.rays.at(lane), machine_.frame.at(lane));
      for (const Ray& ray : machine_.rays.at(lane)) packages_.push_back(paths_.answer(ray, returns_first(ray)));
    }
  }

  const Paths& paths_;
  const World& world_;
  EnumArray<RayKernel, Program, kRayKernels> programs_;
  test::Interpreter machine_;
  test::UnitCaches caches_{2};
  uint32_t warps_ = 0;
  std::vector<Intersection> packages_;
  std::map<uint32_t, Steps> steps_;
};

using ExpectedSteps = std::map<uint32_t, std::optional<Steps>>;

/// Machine code does the same. Kernels that find no room for their values are not compiled.
inline void compare_machine(const Paths& paths, const World& world, const ExpectedSteps& expected,
                            const KernelTarget& target, PathOutcome& outcome) {
  std::unique_ptr<PathMachine> machine;
  try {
    machine = std::make_unique<PathMachine>(paths, world, target);
  } catch (const InputError&) {
    return;
  }
  ++outcome.compiled;
  outcome.spilled += machine->spilled;
  Random random(7);
  const auto all = machine->run(random);
  for (const auto& [pixel, wanted] : expected) {
    ASSERT_EQ(difference(*wanted, all.at(pixel)), "")
        << fmt::format("machine code{}, {}, pixel {:08x}", target.triples ? " with triples" : "",
                       world.resources.units > 1 ? "two units" : "one unit", pixel);
  }
}

/// All pixels' paths: the recursive renderer, intermediate code and machine code do the same.
inline void compare_paths(const PathSet& set, World& world, const std::vector<KernelTarget>& targets,
                          PathOutcome& outcome) {
  set.each([&](const Module& module) { world.add(module); });
  world.arguments[argument::kTileWidthLog2] = 0;
  world.arguments[argument::kTileMask] = 0;
  const Paths paths(set, world);
  ExpectedSteps expected;
  Memory memory = paths.memory(), native_memory = paths.memory();
  for (uint32_t y = 0; y < kHeight; ++y) {
    for (uint32_t x = 0; x < kWidth; ++x) {
      std::optional<Steps>& steps = expected[x | y << 16] = paths.expected(x | y << 16, memory);
      ++outcome.paths;
      if (!steps) {
        ++outcome.undefined;
        continue;
      }
      outcome.rays += static_cast<int>(steps->size()) - 1;
      outcome.longest = std::max(outcome.longest, steps->size() - 1);
      for (const Step& step : *steps) outcome.contributions += static_cast<int>(step.frame.size());
    }
  }
  const bool defined = std::all_of(expected.begin(), expected.end(), [](const auto& one) { return one.second; });
  const kernel::FunctionRunner eye(paths.lowered(RayKernel::CastEye)),
      secondary(paths.lowered(RayKernel::CastSecondary));
  for (const auto& [pixel, wanted] : expected) {
    Steps steps(1);
    NativeThread thread;
    thread.block = pixel;
    thread.threads = 1;
    thread.arguments = &world.arguments;
    thread.memory = &native_memory;
    eye.run(thread);
    for (size_t count = 0; count < 10000; ++count) {
      Paths::add(steps, thread.rays, thread.frame);
      if (thread.rays.empty()) break;
      thread.input = paths.answer(thread.rays[0], returns_first(thread.rays[0]));
      thread.rays.clear();
      thread.frame.clear();
      secondary.run(thread);
    }
    if (!wanted) continue;
    ASSERT_EQ(difference(*wanted, steps), "") << fmt::format("intermediate code, pixel {:08x}", pixel);
  }
  world.arguments[argument::kTileWidthLog2] = 3;
  world.arguments[argument::kTileMask] = 7;
  if (!defined) return;  // a warp of theirs may do anything
  for (const KernelTarget& target : targets) {
    for (const uint32_t units : {1, 2}) {
      world.resources.units = units;
      ASSERT_NO_FATAL_FAILURE(compare_machine(paths, world, expected, target, outcome));
    }
  }
}

}  // namespace raypool::shader
