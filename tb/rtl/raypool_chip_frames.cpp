// Draws random frames on tiny chips, rtl/chip/rp_chip.v in lockstep with its model: on machines that have every pair
// of values of what a chip has (sim/cosim/covering.hpp), with pictures, traffic at every port and answers of the
// traverser drawn at random; and on as many with the traverser inside, with scenes, trees and waits at the memories
// drawn at random; their pictures must be the native engine's. Some trees are malformed: of these the fault is
// compared, and what the chip does behind it. A frame that fails is minimised, and the command that repeats it is
// printed. With --record one frame is drawn on the model alone and written down, for another simulator of the Verilog
// (scripts/icarus_chip.sh).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <deque>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <memory>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "chip/chip.hpp"
#include "cosim/chip_recorder.hpp"
#include "lockstep/lockstep_chip.hpp"
#include "lockstep/lockstep_unit.hpp"
#include "lockstep/rtl_loader.hpp"
#include "machine/chip/chip_model.hpp"
#include "machine/compute/model.hpp"
#include "random.hpp"
#include "rtl/chip_frames.hpp"
#include "rtl/hard_scenes.hpp"
#include "rtl/next_frames.hpp"
#include "rtl/traverser_frames.hpp"

namespace raypool {
namespace {

using namespace test;

/// What one frame is drawn from.
struct Case {
  Picture picture{};
  Traffic traffic;
  uint32_t seed = 0;
  // With the traverser inside, in place of the traffic. `tree`: of a bad one; 0: the scene's own. `spoilt`: of what
  // makes it none; 0: nothing. `strange`: of numbers in place of some of the scene's; 0: none. `mirrors`: all that is
  // there.
  uint32_t triangles = 0, tree = 0, spoilt = 0, strange = 0;
  bool mirrors = false;
  // `grid`: its corners are on one. `alike`: triangles are nearly in one place. `deep`: so many of them that a stack is
  // full, or nearly.
  bool grid = false, alike = false, deep = false;
  WaitingChip::Waits waits;
  std::vector<Case> after;  ///< frames that follow it without a reset, amid what is around this one
};

/// The tree may be none, or deeper than a stack.
bool may_fault(const Case& c) { return c.spoilt != 0 || c.deep; }

bool is_inside(const Machine& machine) { return has_traverser(machine.configuration.chip); }

std::string to_string(const Case& c, const Machine& machine) {
  if (is_inside(machine)) {
    return fmt::format(
        "{} x {} pixels, depth {}, {}; {} triangles{}, {}{}{}; request {}, beat {}, frame {}, shut {}", c.picture.width,
        c.picture.height, c.picture.depth, c.picture.reflections ? "reflections" : "no reflections", c.triangles,
        c.mirrors ? " of mirrors"
        : c.grid  ? " on a grid"
        : c.alike ? " in one place"
                  : "",
        c.tree == 0 ? "their own tree" : "a bad tree", c.spoilt == 0 ? "" : " that is spoilt",
        c.strange == 0 ? "" : ", strange numbers", c.waits.request, c.waits.beat, c.waits.frame, c.waits.shut);
  }
  const Traffic& t = c.traffic;
  return fmt::format(
      "{} x {} pixels, depth {}, {}; stall {}, gap {}, tree {}, inside {}, cycles {}, latency {}, burst "
      "{}, frame {}, shut {}, age {}",
      c.picture.width, c.picture.height, c.picture.depth, c.picture.reflections ? "reflections" : "no reflections",
      t.stall, t.gap, t.tree, t.inside, t.cycles, t.latency, t.burst, t.frame, t.shut, t.age);
}

constexpr uint32_t kMostShort = 4;  ///< depth of most pictures
/// Leaves, less a stack's entries in the RAMs, with which its last blocks in the memory are written, or nearly.
constexpr uint32_t kFullStack = 499;

/// Of the depths one in four is above 127, and of these some differ from a small one in bit 7 alone.
uint32_t any_depth(Random& random, uint32_t small) {
  if (random() % 4 != 0) return small;
  return random() % 3 != 0 ? 127 + small : 127 + random() % (kLargestDepth - 126);
}

/// With what follows.
std::string described(const Case& c, const Machine& machine) {
  return to_string(c, machine) + (c.after.empty() ? "" : fmt::format("; {} more without a reset", c.after.size()));
}

Case case_of(uint32_t seed, uint32_t machine, uint32_t frame) {
  std::seed_seq all{seed, machine, frame};
  Random random(all);
  const auto one = [&](std::initializer_list<uint32_t> values) { return *(values.begin() + random() % values.size()); };
  Case c;
  c.picture = {1 + random() % 9, 1 + random() % 7, 1 + random() % 4, random() % 4 != 0};
  c.traffic.stall = one({0, 0, 2, 3, 9});
  c.traffic.gap = one({0, 0, 2, 5});
  c.traffic.tree = one({0, 2, 9, 40});
  c.traffic.inside = one({1, 3, 1000});
  c.traffic.cycles = one({1, 20, 200, 900});
  c.traffic.latency = one({1, 5, 60});
  c.traffic.burst = one({1, 1, 500, 2000});
  c.traffic.frame = one({0, 0, 3, 100});
  c.seed = random();
  c.traffic.shut = one({0, 0, 20, 150, 700});
  c.traffic.age = one({0, 0, 2, 7});
  c.picture.depth = any_depth(random, c.picture.depth);
  return c;
}

Case inside_case_of(uint32_t seed, uint32_t machine, uint32_t frame) {
  std::seed_seq all{seed, machine, frame};
  Random random(all);
  const auto one = [&](std::initializer_list<uint32_t> values) { return *(values.begin() + random() % values.size()); };
  Case c;
  c.picture = {1 + random() % 8, 1 + random() % 6, 1 + random() % 4, random() % 4 != 0};
  c.triangles = 1 + random() % one({1, 4, 12, 12, 40, 40, 100, 300});
  c.tree = random() % 2 == 0 ? 0 : 1 + random() % 1000;
  c.waits = {one({0, 0, 2, 5, 20}), one({0, 0, 2, 5, 20}), one({0, 0, 2, 30}), one({0, 0, 12, 40})};
  c.seed = random();
  // A ray that has been reflected more than 127 times takes a picture of its own.
  c.mirrors = frame % 25 == 0;
  c.picture.depth = any_depth(random, c.picture.depth);
  if (random() % 8 == 0) c.spoilt = 1 + random() % 1000;
  if (c.mirrors) {
    c.picture = {1, 1, one({127, 129, 129, 130}), true};
    c.triangles = 1 + random() % 4;
    c.spoilt = 0;
    c.waits = {};
  } else if (random() % 3 == 0) {
    c.strange = 1 + random() % 1000000;
    // Where rays meet the surface that they leave they would be reflected as often as they may be.
    c.picture.depth = 1 + c.picture.depth % kMostShort;
  }
  if (c.picture.depth > kMostShort) {  // each pixel may take many rays
    c.picture.width = std::min(c.picture.width, 3u);
    c.picture.height = std::min(c.picture.height, 2u);
  }
  return c;
}

/// Some of the frames with the traverser inside are made harder.
Case harder(Case c, uint32_t seed, uint32_t number, uint32_t frame, const Machine& machine) {
  if (!is_inside(machine) || c.mirrors) return c;
  std::seed_seq all{seed, number, frame, 2u};
  Random random(all);
  if (frame % 25 == 13) {
    const auto entries = static_cast<uint32_t>(machine.configuration.chip.hardware_traverser_stack_entries);
    c.picture = {1, 1, 1, false};
    c.alike = c.deep = true;
    c.triangles = kFullStack + entries + random() % 12;
    c.tree = 3 + random() % 1000 * 4;
    c.spoilt = c.strange = 0;
    c.waits = {};
    return c;
  }
  if (random() % 8 == 0) c.spoilt = 1 + random() % 1000;
  if (c.strange == 0 && random() % 4 == 0) {
    c.strange = 1 + random() % 1000000;
    c.picture.depth = 1 + c.picture.depth % kMostShort;
  }
  c.grid = random() % (c.strange != 0 ? 2 : 4) == 0;
  c.alike = random() % 5 == 0;
  if (c.alike && random() % 2 == 0) {  // a chain, so that all stacks spill
    c.triangles = 20 + random() % 60;
    c.tree = 2 + random() % 1000 * 4 + random() % 2;
  }
  if (random() % 6 == 0 && machine.configuration.chip.ray_pool_size > 4) {  // many rays at the same time
    c.picture = {6 + random() % 6, 5 + random() % 4, 1 + random() % 2, c.picture.reflections};
    c.triangles = std::min(c.triangles, 40u);
    if (random() % 2 == 0) c.waits = {};
  }
  return c;
}

/// With the frames that follow it: none, one or two.
Case with_followers(Case c, uint32_t seed, uint32_t machine, uint32_t frame,
                    Case (*any)(uint32_t, uint32_t, uint32_t)) {
  if (may_fault(c)) return c;  // it may stop the traverser, and then the chip is never ready
  std::seed_seq all{seed, machine, frame, 1u};
  Random random(all);
  for (uint32_t more = random() % 4 / 2 + random() % 4 / 3; more > 0; --more) {
    c.after.push_back(any(random(), machine, frame));
    Case& next = c.after.back();
    next.picture.width = std::min(next.picture.width, 4u);
    next.picture.height = std::min(next.picture.height, 3u);
    if (random() % 4 == 0) next.picture = c.picture;
    next.spoilt = next.strange = 0;
  }
  return c;
}

/// Of frames that held.
struct Drawn {
  Reached reached;
  uint64_t cycles = 0, rays = 0, faults = 0;
};

Scene scene_of(const Case& c) {
  Scene scene = random_scene(c.seed, c.triangles, c.mirrors);
  // In a closed box rays would be reflected as often as they may be.
  if (c.picture.depth > kMostShort && !c.mirrors) make_dull(scene, c.seed);
  if (c.deep) {
    scene.triangles.resize(c.triangles);
    scene.triangle_materials.resize(c.triangles);
  }
  if (c.alike) gather(scene, c.seed, c.triangles, c.deep);
  if (c.grid) put_on_grid(scene, c.seed, c.strange != 0);
  return scene;
}

/// Draws the frames that follow one in its memories, each as soon as the chip is ready for it, and their scenes are
/// others. Returns how many.
uint32_t draw_followers(const Case& c, const Machine& machine, Drawing& first, ChipDevice& chip) {
  std::deque<Drawing> drawings;
  for (const Case& next : c.after) drawings.emplace_back(machine, next.picture, scene_of(next), next.tree);
  draw_next(drawings, first.memory(), chip, [](const ChipResult&) {});
  return size32(drawings);
}

/// Draws it, and compares with the native engine what can be. Without a result the tree was malformed, and the
/// traverser has reported it: then the chip goes on for some time, and nothing comes back.
std::optional<ChipResult> draw_inside(const Case& c, const Machine& machine, Drawing& drawing, WaitingChip& chip,
                                      Reached& reached) {
  if (!c.after.empty()) drawing.memory().grow(drawing.memory().size() + kRoomForNext);
  try {
    const ChipResult result = drawing.draw_on(chip, FrameBegin::Reset, !c.after.empty());
    if (c.spoilt == 0 && c.strange == 0) drawing.expect_native(result);
    reached.frames += draw_followers(c, machine, drawing, chip);
    return result;
  } catch (const TraverserFault&) {
    if (!may_fault(c)) throw;
  }
  ChipInputs inputs;
  inputs.memory_request_ready = inputs.frame_ready = true;
  for (int cycle = 0; cycle < 1000; ++cycle) chip.clock(inputs);
  return {};
}

/// The machine's Verilog beside its model, which looks inside up to this cycle.
std::unique_ptr<LockstepChip> lockstep_of(const Machine& machine, const std::string& library, const Memory& memory,
                                          uint64_t inspect_until) {
  return make_lockstep_chip(machine.configuration, load_rtl_chip(library, machine.configuration, machine.units), memory,
                            machine.configuration.name, inspect_until);
}

void expect_counters(const LockstepChip& chip) {
  if (chip.lockstep_counts().counters == 0) throw std::runtime_error("the counters were not compared");
}

/// As draw_case(), with the traverser inside.
void draw_case_inside(const Case& c, const Machine& machine, const std::string& library, uint64_t inspect_until,
                      Drawn& drawn) {
  Drawing drawing(machine, c.picture, scene_of(c), c.tree, c.spoilt, c.strange);
  const std::unique_ptr<LockstepChip> chip = lockstep_of(machine, library, drawing.memory(), inspect_until);
  WaitingChip waiting(*chip, c.waits, c.seed);
  const std::optional<ChipResult> result = draw_inside(c, machine, drawing, waiting, drawn.reached);
  if (result) expect_counters(*chip);
  drawn.cycles += chip->lockstep_counts().cycles;
  drawn.rays += chip->lockstep_counts().rays;
  ++drawn.reached.frames;
  drawn.reached.deep += waiting.deep;
  drawn.reached.black += waiting.black;
  drawn.faults += result ? 0 : 1;
  for (size_t kernel = 0; result && kernel < kRayKernels; ++kernel)
    drawn.reached.launches[kernel] += result->kernels[static_cast<RayKernel>(kernel)].launches;
}

/// Without a traverser inside: draws it, and the frames that follow it.
void draw_frames(const Case& c, ChipDevice& chip, const Machine& machine, Frame& frame, Reached& reached) {
  draw(chip, machine, frame, c.traffic, c.seed, reached, FrameBegin::Reset, !c.after.empty());
  for (const Case& next : c.after) {
    frame.show(Frame(machine, next.picture, next.seed | 1));
    draw(chip, machine, frame, next.traffic, next.seed, reached, FrameBegin::Next, &next != &c.after.back());
  }
}

/// Draws it on a device of its own. Throws what went wrong.
void draw_case(const Case& c, const Machine& machine, const std::string& library, uint64_t inspect_until,
               Drawn& drawn) {
  if (is_inside(machine)) return draw_case_inside(c, machine, library, inspect_until, drawn);
  Frame frame(machine, c.picture, c.seed | 1);
  const std::unique_ptr<LockstepChip> chip = lockstep_of(machine, library, frame.image.memory, inspect_until);
  draw_frames(c, *chip, machine, frame, drawn.reached);
  drawn.cycles += chip->lockstep_counts().cycles;
  drawn.rays += chip->lockstep_counts().rays;
  expect_counters(*chip);
}

/// What goes wrong when it is drawn; empty: nothing. `inspected`: a difference is met again with a look inside.
std::string failure_of(const Case& c, const Machine& machine, const std::string& library, Drawn& drawn,
                       bool inspected = false) {
  try {
    const auto run = [&](uint64_t inspect_until) { draw_case(c, machine, library, inspect_until, drawn); };
    if (inspected)
      inspect_differences(run);
    else
      run(0);
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

/// Draws it on the model, and writes into `folder` what the chip gets and shows (vectors.txt) and its parameters
/// (parameters.txt).
void record(const Case& c, const Machine& machine, const std::string& folder) {
  const Configuration& configuration = machine.configuration;
  std::filesystem::create_directories(folder);
  std::ofstream vectors(folder + "/vectors.txt"), parameters(folder + "/parameters.txt");
  parameters << words_of(chip_verilog_parameters(configuration, machine.units)) << '\n';
  const auto draw_on = [&](Memory& memory, const auto& drawn) {
    const std::unique_ptr<ChipDevice> model = make_chip(ChipKind::Model, configuration, memory, machine.units);
    ChipRecorder recorder(configuration, *model, vectors);
    drawn(recorder);
  };
  if (is_inside(machine)) {
    Drawing drawing(machine, c.picture, scene_of(c), c.tree, c.spoilt, c.strange);
    draw_on(drawing.memory(), [&](ChipDevice& chip) {
      WaitingChip waiting(chip, c.waits, c.seed);
      Reached reached;
      draw_inside(c, machine, drawing, waiting, reached);
    });
  } else {
    Frame frame(machine, c.picture, c.seed | 1);
    Reached reached;
    draw_on(frame.image.memory, [&](ChipDevice& chip) { draw_frames(c, chip, machine, frame, reached); });
  }
  for (std::ofstream* file : {&vectors, &parameters})
    if (!file->flush()) throw InputError(fmt::format("{}: the recording cannot be written there", folder));
  fmt::print("{}, {} units: {}\n", configuration.name, machine.units, described(c, machine));
}

/// The smallest picture, of fewest triangles, of those tried that still fails.
Case minimised(Case c, const Machine& machine, const std::string& library) {
  const auto smaller = [](const Case& from) {
    std::vector<Case> cases;
    for (uint32_t Picture::*size : {&Picture::width, &Picture::height, &Picture::depth}) {
      for (const uint32_t value : {from.picture.*size / 2, from.picture.*size - 1}) {
        if (value == 0) continue;
        cases.push_back(from);
        cases.back().picture.*size = value;
      }
    }
    for (size_t without = 0; without < from.after.size(); ++without) {
      cases.push_back(from);
      cases.back().after.erase(cases.back().after.begin() + static_cast<std::ptrdiff_t>(without));
    }
    for (const uint32_t triangles : {from.triangles / 2, from.triangles - 1}) {
      if (from.triangles <= 1) break;
      cases.push_back(from);
      cases.back().triangles = triangles;
    }
    return cases;
  };
  for (bool found = true; found;) {
    found = false;
    for (const Case& tried : smaller(c)) {
      Drawn drawn;
      found = !failure_of(tried, machine, library, drawn).empty();
      if (!found) continue;
      c = tried;
      break;
    }
  }
  return c;
}

struct Options {
  std::string program;  ///< as it was called
  std::string record;   ///< folder for one frame; empty: none
  std::string tree;     ///< with another Verilog; empty: that of the project
  uint32_t frames = 50, seed = 1, frame = 0;
  std::vector<uint32_t> only;  ///< machines
  uint32_t machines = 0;
  bool inside = false, stop = false;
};

class Clock {
 public:
  double seconds() {
    const auto now = std::chrono::steady_clock::now();
    const double passed = std::chrono::duration<double>(now - begin_).count();
    begin_ = now;
    return passed;
  }

 private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

/// What the sets of machines have.
void print_sets() {
  const auto print = [](const std::vector<Machine>& set, const std::vector<Factor>& factors, const char* what) {
    const Covered covered = count_covered(factors, set, kSmallThreads);
    fmt::print("{} machines of at most {} threads{}: {} of {} values, {} of {} pairs of values\n", set.size(),
               kSmallThreads, what, covered.values, covered.all_values, covered.pairs, covered.all_pairs);
  };
  print(covering_chips(), chip_factors(), "");
  print(covering_inside(), inside_factors(), " with the traverser inside, and four more");
}

/// Of all machines that have drawn.
void print_totals(const Drawn& drawn, uint32_t machines, uint32_t failed) {
  const Reached& all = drawn.reached;
  const auto launches = [&all](RayKernel kernel) { return all.launches[to_underlying(kernel)]; };
  fmt::print(
      "{} machines, {} frames, {} cycles, {} rays, of which {} too deep and {} black; {} trees were none; {} kernels "
      "cast, {} reflected, {} lit, {} shaded; {} machines failed\n",
      machines, all.frames, drawn.cycles, drawn.rays, all.deep, all.black, drawn.faults, launches(RayKernel::CastEye),
      launches(RayKernel::CastSecondary), launches(RayKernel::CastSecondaryDirect), launches(RayKernel::Shade), failed);
}

/// `first`: the first machine that may be.
bool is_chosen(const Options& options, uint32_t first, uint32_t number) {
  const auto& only = options.only;
  if (number < first || (!only.empty() && std::count(only.begin(), only.end(), number) == 0)) return false;
  return !only.empty() || (options.machines == 0 || number < first + options.machines);
}

int run(const Options& options) {
  std::vector<Machine> machines = covering_chips();
  const auto outside = static_cast<uint32_t>(machines.size());
  for (Machine& machine : inside_machines()) machines.push_back(std::move(machine));
  const auto last = static_cast<uint32_t>(machines.size());
  for (const uint32_t machine : options.only) {
    if (machine > last) throw InputError(fmt::format("--machine is {}; there are machines 1 to {}", machine, last));
  }
  const auto case_on = [&](uint32_t number, uint32_t frame) {
    const auto any = number > outside ? inside_case_of : case_of;
    const Case c = harder(any(options.seed, number, frame), options.seed, number, frame, machines[number - 1]);
    return with_followers(c, options.seed, number, frame, any);
  };
  if (!options.record.empty()) {
    const uint32_t number = options.only.front();
    record(case_on(number, options.frame), machines[number - 1], options.record);
    return 0;
  }
  print_sets();
  const uint32_t first = options.inside ? outside + 1 : 1;
  Drawn drawn;
  uint32_t drawn_on = 0, failed = 0;
  for (uint32_t number = 1; number <= last; ++number) {
    if (!is_chosen(options, first, number)) continue;
    const Machine& machine = machines[number - 1];
    Clock clock;
    const std::string library =
        options.tree.empty() ? chip_library(machine) : chip_library(machine, options.tree, options.tree + "/chips");
    const double built = clock.seconds();
    const Drawn before = drawn;
    ++drawn_on;
    bool held = true;
    for (uint32_t frame = 1; frame <= options.frames && held; ++frame) {
      if (options.frame != 0 && frame != options.frame) continue;
      const Case c = case_on(number, frame);
      const std::string failure = failure_of(c, machine, library, drawn, true);
      held = failure.empty();
      if (held) continue;
      ++failed;
      if (options.stop) {
        fmt::print("FAILED on {}, frame {}: {}\n{}\n", machine.configuration.name, frame, to_string(c, machine),
                   failure);
        return 1;
      }
      fmt::print(
          "{}, {} units, frame {}: {}\n{}\nthe smallest that fails: {}\n"
          "again with: {} --seed {} --frames {} --machine {} --frame {}\n",
          machine.configuration.name, machine.units, frame, described(c, machine), failure,
          described(minimised(c, machine, library), machine), options.program, options.seed, options.frames, number,
          frame);
    }
    fmt::print("{}, {} units: {} frames, {} cycles, {} rays, {}; built in {:.0f} s, ran {:.0f} s\n",
               machine.configuration.name, machine.units, drawn.reached.frames - before.reached.frames,
               drawn.cycles - before.cycles, drawn.rays - before.rays, held ? "0 differences" : "FAILED", built,
               clock.seconds());
    std::fflush(stdout);
  }
  print_totals(drawn, drawn_on, failed);
  if (drawn.reached.frames == 0 && failed == 0) throw InputError("no frame was drawn: --frame is above --frames");
  return failed == 0 ? 0 : 1;
}

}  // namespace
}  // namespace raypool

int main(int argc, char** argv) {
  // What the surroundings assert is an exception here.
  testing::FLAGS_gtest_throw_on_failure = true;
  testing::InitGoogleTest(&argc, argv);
  raypool::Options options;
  options.program = argv[0];
  CLI::App app("Random frames on tiny chips, rtl/chip/rp_chip.v in lockstep with its model.", "raypool_chip_frames");
  app.add_option("--frames", options.frames, "of each machine")->capture_default_str()->check(CLI::PositiveNumber);
  app.add_option("--seed", options.seed, "of pictures, scenes and traffic")->capture_default_str();
  app.add_option("--machines", options.machines, "only the first so many machines; 0: all")->capture_default_str();
  app.add_flag("--inside", options.inside, "only those with the traverser inside");
  auto* machine = app.add_option("--machine", options.only, "only this machine, from 1; or several, with , between")
                      ->check(CLI::PositiveNumber)
                      ->delimiter(',');
  auto* frame = app.add_option("--frame", options.frame, "only this frame of it, from 1")->check(CLI::PositiveNumber);
  app.add_option("--record", options.record, "folder that gets this frame as the model draws it; no Verilog is needed")
      ->needs(machine)
      ->needs(frame);
  app.add_option("--tree", options.tree, "source tree: the chips, kept there in chips/, are built from its rtl/");
  app.add_flag("--stop", options.stop, "end at the first frame that fails, and do not minimise it");
  CLI11_PARSE(app, argc, argv);
  try {
    return raypool::run(options);
  } catch (const std::exception& error) {
    fmt::print(stderr, "raypool_chip_frames: {}\n", error.what());
    return 1;
  }
}
