// rtl/chip/rp_chip.v with the traverser inside, in lockstep with its model while it draws whole frames with nothing
// around it but memories, frame buffer and host: all ports of all blocks in every cycle. The pictures are the native
// engine's.
#include <gtest/gtest.h>

#include <deque>
#include <functional>
#include <iostream>
#include <memory>
#include <string>
#include <utility>

#include "chip/board_modules.hpp"
#include "chip/frame_setup.hpp"
#include "chip/simulation.hpp"
#include "chip/test_banked_dram.hpp"
#include "lockstep/lockstep_chip.hpp"
#include "lockstep/rtl_loader.hpp"
#include "machine/chip/chip_model.hpp"
#include "machine/compute/model.hpp"
#include "rtl/chip_frames.hpp"
#include "rtl/next_frames.hpp"
#include "rtl/traverser_frames.hpp"

namespace raypool {
namespace {

using namespace test;

std::unique_ptr<ChipDevice> model_of(const Machine& machine, const Memory& memory) {
  return make_chip(ChipKind::Model, machine.configuration, memory, machine.units);
}

class ChipTraverser : public testing::TestWithParam<Machine (*)()> {};

TEST_P(ChipTraverser, DrawsThePictureOfTheNativeEngineWithoutADifference) {
  const Machine machine = GetParam()();
  const Configuration& c = machine.configuration;
  const std::string library = chip_library(machine);
  std::unique_ptr<LockstepChip> chip;
  uint64_t frames = 0;
  for (const Picture& picture : {Picture{9, 11, 3, true}, Picture{1, 9, 2, false}, Picture{8, 4, 1, true}}) {
    SCOPED_TRACE(testing::Message() << picture.width << " x " << picture.height << ", depth " << picture.depth);
    Drawing drawing(machine, picture, make_cornell());
    if (!chip) chip = make_lockstep_chip(c, load_rtl_chip(library, c, machine.units), drawing.memory(), c.name);
    try {
      drawing.expect_native(drawing.draw_on(*chip));
    } catch (const LockstepDifference& difference) {
      FAIL() << difference.what();
    }
    ++frames;
  }
  const ChipLockstepCounts& counts = chip->lockstep_counts();
  std::cout << c.name << ", " << machine.units << " units: " << to_string(counts) << "\n";
  EXPECT_EQ(counts.differences, 0u);
  EXPECT_GE(counts.counters, frames);
  EXPECT_GT(counts.memory_writes, 0u) << "no stack has been longer than what the traverser keeps of it";
}

/// Pictures of scenes that differ from one of the cornell box: in triangles, trees, materials, cameras and lights. The
/// last one is that again.
std::deque<Drawing> other_drawings(const Machine& machine) {
  std::deque<Drawing> drawings;
  for (const auto& [seed, triangles] : {std::pair{3u, 40u}, {4u, 3u}, {5u, 90u}})
    drawings.emplace_back(machine, Picture{2 + seed, 9 - seed, 1 + seed % 3, true}, random_scene(seed, triangles),
                          seed == 5 ? 7 : 0);
  drawings.emplace_back(machine, Picture{7, 5, 3, true}, make_cornell());
  return drawings;
}

/// Draws all of them without a reset on the chip that make(memory) makes. `told(result)` of each but the first.
template <typename Make, typename Told>
void draw_one_after_another(const Machine& machine, const Make& make, const Told& told) {
  Drawing first(machine, {7, 5, 3, true}, make_cornell());
  first.memory().grow(first.memory().size() + kRoomForNext);
  std::deque<Drawing> others = other_drawings(machine);
  WaitingChip hasty(make(first.memory()), {}, 1);
  first.expect_native(first.draw_on(hasty, FrameBegin::Reset, true));
  draw_next(others, first.memory(), hasty, told);
}

TEST_P(ChipTraverser, DrawsOneTreeAfterAnotherWithoutAReset) {
  const Machine machine = GetParam()();
  const Configuration& c = machine.configuration;
  const std::string library = chip_library(machine);
  std::unique_ptr<LockstepChip> chip;
  const auto make = [&](const Memory& memory) -> ChipDevice& {
    chip = make_lockstep_chip(c, load_rtl_chip(library, c, machine.units), memory, c.name);
    return *chip;
  };
  try {
    draw_one_after_another(machine, make, [](const ChipResult&) {});
  } catch (const LockstepDifference& difference) {
    FAIL() << difference.what();
  }
  EXPECT_EQ(chip->lockstep_counts().differences, 0u);
  EXPECT_GT(chip->lockstep_counts().counters, 0u);
}

// The Verilated chip as a module of SystemC, with memories that answer in a time of their own.
TEST_P(ChipTraverser, DrawsTheSameInSystemCWithDramOfBanks) {
  Machine machine = GetParam()();
  Configuration& c = machine.configuration;
  // Of the memory of this test, which looks for its rows: how long an answer may take goes by it.
  constexpr uint32_t kSlowest = 40;
  c.chip.memory_latency = std::max(c.chip.memory_latency, kSlowest);
  Drawing drawing(machine, {9, 11, 3, true}, make_cornell());
  const std::unique_ptr<LockstepChip> device =
      make_lockstep_chip(c, load_rtl_chip(chip_library(machine), c, machine.units), drawing.memory(), c.name);
  chip::Simulation simulation;
  chip::ChipModule chip("chip", drawing.options(), *device);
  BankedDram memory("memory", drawing.memory()), tree("tree", drawing.tree().memory);
  chip::FrameBufferModule frame("frame", *drawing.options().frame);
  chip::HostModule host("host", chip::frame_setup(drawing.options()));
  sc_core::sc_signal<bool> done("done");
  chip.memory.bind(memory.socket);
  chip.tree.bind(tree.socket);
  chip.frame.bind(frame.socket);
  host.socket.bind(chip.host);
  chip.done.bind(done);
  host.done.bind(done);
  try {
    simulation.run();
    drawing.expect_native(chip.result());
  } catch (const LockstepDifference& difference) {
    FAIL() << difference.what();
  }
  EXPECT_EQ(device->lockstep_counts().differences, 0u);
  EXPECT_GT(memory.row_hits, memory.row_misses);
  EXPECT_GT(tree.row_hits, 0u);
}

INSTANTIATE_TEST_SUITE_P(Machines, ChipTraverser, testing::Values(smallest_inside, full_inside, returning_inside),
                         [](const auto& machine) { return machine.param().configuration.name; });

/// Malformed trees, and the faults that come of them.
struct Garbage {
  const char* name;
  TreeFaultCode code;
  void (*make)(TreeImage&);
};
constexpr uint32_t kNodeBytes = 64, kCountWord = 12, kFirstChild = 40;
const Garbage kGarbage[] = {
    {"node beyond", TreeFaultCode::NodeBeyond, [](TreeImage& tree) { tree.setup.root = tree.setup.triangles_line; }},
    {"triangle beyond", TreeFaultCode::TriangleBeyond,
     [](TreeImage& tree) { tree.setup.root = kLeafBit | (tree.setup.triangle_lines * kNodeBytes / 44 + 2); }},
    {"end of triangles", TreeFaultCode::TriangleBeyond,
     [](TreeImage& tree) {
       tree.setup.triangle_lines = 1;
       tree.setup.root = kLeafBit | 1;
     }},
    {"children", TreeFaultCode::Children,
     [](TreeImage& tree) { tree.memory.store(kCountWord, tree.memory.load(kCountWord) | 7u << 24); }},
    {"way back", TreeFaultCode::Order, [](TreeImage& tree) { tree.memory.store(kFirstChild, 0); }},
    {"fewer nodes", TreeFaultCode::NodeBeyond, [](TreeImage& tree) { tree.setup.triangles_line = 1; }},
};

TEST_P(ChipTraverser, StopsWithTheSameFaultOnMalformedTrees) {
  const Machine machine = GetParam()();
  const Configuration& c = machine.configuration;
  const std::string library = chip_library(machine);
  for (const Garbage& garbage : kGarbage) {
    SCOPED_TRACE(garbage.name);
    Drawing drawing(machine, {9, 7, 2, true}, make_cornell());
    garbage.make(drawing.tree());
    const std::unique_ptr<LockstepChip> chip =
        make_lockstep_chip(c, load_rtl_chip(library, c, machine.units), drawing.memory(), c.name);
    try {
      drawing.draw_on(*chip);
      ADD_FAILURE() << "a picture of a malformed tree";
    } catch (const TraverserFault& fault) {
      EXPECT_EQ(fault.fault.code, garbage.code) << fault.what();
      // The host might go on: it stays, and the frame does not end.
      const TreeFault first = chip->outputs().tree_fault;
      for (int cycle = 0; cycle < 5000; ++cycle) {
        ChipInputs inputs;
        inputs.frame_ready = true;
        ASSERT_NO_THROW(chip->clock(inputs));
        ASSERT_TRUE(chip->outputs().busy);
        const TreeFault& now = chip->outputs().tree_fault;
        ASSERT_TRUE(now.valid && now.code == first.code && now.line == first.line);
      }
    }
  }
}

/// Shows in one cycle at one port of the traverser something else than the chip does that it wraps.
class BrokenTraverser : public ChipDevice {
 public:
  /// True: it has been changed.
  using Change = std::function<bool(ChipOutputs&)>;

  BrokenTraverser(std::unique_ptr<ChipDevice> chip, Change change)
      : chip_(std::move(chip)), change_(std::move(change)) {}

  uint32_t units() const override { return chip_->units(); }
  void start(const FrameSetup& setup) override {
    chip_->start(setup);
    out_ = chip_->outputs();
  }
  void start_next(const FrameSetup& setup) override {
    chip_->start_next(setup);
    out_ = chip_->outputs();
  }
  const ChipOutputs& outputs() const override { return out_; }
  void clock(const ChipInputs& inputs) override {
    chip_->clock(inputs);
    out_ = chip_->outputs();
    if (!done_) done_ = change_(out_);
  }
  ChipCounts counts() override { return chip_->counts(); }
  uint64_t counter(int number) override { return chip_->counter(number); }

 private:
  std::unique_ptr<ChipDevice> chip_;
  Change change_;
  bool done_ = false;
  ChipOutputs out_;
};

/// A port of the traverser, and what breaks it.
struct BrokenPort {
  const char* port;
  BrokenTraverser::Change change;
};

BrokenPort broken(const char* port, bool (*change)(TraverserPorts&)) {
  return {port, [change](ChipOutputs& out) { return change(out.traverser); }};
}

BrokenPort broken(const char* port, bool (*change)(TreeFault&)) {
  return {port, [change](ChipOutputs& out) { return change(out.tree_fault); }};
}

bool flip(bool& bit) {
  bit = !bit;
  return true;
}

/// Draws with the broken port until the lockstep differs; its report must name port and block.
/// `prepare`: what becomes of the tree before.
void expect_named(const BrokenPort& broken, void (*prepare)(TreeImage&)) {
  SCOPED_TRACE(broken.port);
  const Machine machine = full_inside();
  Drawing drawing(machine, {7, 5, 3, true}, make_cornell());
  prepare(drawing.tree());
  const std::unique_ptr<LockstepChip> chip = make_lockstep_chip(
      machine.configuration, std::make_unique<BrokenTraverser>(model_of(machine, drawing.memory()), broken.change),
      drawing.memory());
  try {
    drawing.draw_on(*chip);
    ADD_FAILURE() << "no difference was reported";
  } catch (const LockstepDifference& difference) {
    const std::string report = difference.what();
    EXPECT_EQ(report.find("lockstep difference in chip: " + std::string(broken.port) + " of traverser is "), 0u)
        << report;
    EXPECT_NE(report.find("look at: rtl/traverser/rp_traverser.v, rtl/chip/rp_chip.v"), std::string::npos) << report;
  }
}

TEST(ChipTraverser, ThatIsBrokenIsNamed) {
  using Ports = TraverserPorts;
  const BrokenPort ports[] = {
      broken("ray_ready", [](Ports& p) { return flip(p.ray_ready); }),
      broken("free_valid", [](Ports& p) { return flip(p.free_valid); }),
      broken("free_place", [](Ports& p) { return p.free_valid && (p.free_place ^= 1, true); }),
      broken("free_shadow", [](Ports& p) { return p.free_valid && flip(p.free_shadow); }),
      broken("put_valid", [](Ports& p) { return flip(p.put_valid); }),
      broken("put_kind", [](Ports& p) { return p.put_valid && (p.put_kind = ImportKind::Shadow, true); }),
      broken("put_data", [](Ports& p) { return p.put_valid && (p.put_data[3] ^= 1, true); }),
      broken("contribution_valid", [](Ports& p) { return flip(p.contribution_valid); }),
      broken("contribution_pixel",
             [](Ports& p) { return p.contribution_valid && (p.contribution.pixel ^= 1 << 16, true); }),
      broken("contribution_color", [](Ports& p) { return p.contribution_valid && (p.contribution.rgb[1] ^= 1, true); }),
      broken("request_valid", [](Ports& p) { return flip(p.tree_request_valid); }),
      broken("request_write", [](Ports& p) { return p.tree_request_valid && flip(p.tree_request.write); }),
      broken("request_second", [](Ports& p) { return p.tree_request_valid && flip(p.tree_request.second); }),
      broken("request_address", [](Ports& p) { return p.tree_request_valid && (p.tree_request.address ^= 64, true); }),
      broken("request_data",
             [](Ports& p) {
               return p.tree_request_valid && p.tree_request.write && (p.tree_request.data[1][0] ^= 1, true);
             }),
  };
  for (const BrokenPort& each : ports) expect_named(each, [](TreeImage&) {});
}

TEST(ChipTraverser, ABrokenFaultPortIsNamed) {
  const BrokenPort ports[] = {
      broken("fault_valid", [](TreeFault& fault) { return flip(fault.valid); }),
      broken("fault_code",
             [](TreeFault& fault) { return fault.valid && (fault.code = TreeFaultCode::StackFull, true); }),
      broken("fault_line", [](TreeFault& fault) { return fault.valid && (fault.line ^= 1, true); }),
  };
  for (const BrokenPort& each : ports) expect_named(each, [](TreeImage& tree) { tree.memory.store(kFirstChild, 0); });
}

// A frame that is asked for while one is drawn is refused; what cannot change without a reset is, too.
TEST(ChipTraverser, OnTheModelDrawsOneTreeAfterAnotherWithoutAReset) {
  for (const auto machine_of : {smallest_inside, full_inside, crowded_inside}) {
    const Machine machine = machine_of();
    SCOPED_TRACE(machine.configuration.name);
    std::unique_ptr<ChipDevice> chip;
    const auto make = [&](const Memory& memory) -> ChipDevice& {
      chip = model_of(machine, memory);
      return *chip;
    };
    uint32_t frames = 0;
    draw_one_after_another(machine, make, [&](const ChipResult& result) {
      ++frames;
      EXPECT_GT(result.cycles, 100u);
    });
    EXPECT_EQ(frames, 4u);
    ASSERT_TRUE(chip->outputs().ready);
    FrameSetup setup;
    setup.program_length = 1;
    EXPECT_THROW(chip->start_next(setup), std::logic_error);
  }
}

TEST(ChipTraverser, OnTheModelIsReadyForAFrameOnlyWhenNothingOfAnotherIsLeft) {
  const Machine machine = full_inside();
  Drawing drawing(machine, {9, 7, 3, true}, make_cornell());
  const std::unique_ptr<ChipDevice> chip = model_of(machine, drawing.memory());
  chip::FixedLatencyStore store(drawing.memory(), &drawing.tree().memory, machine.configuration.chip);
  chip::Board board(drawing.options(), *chip, store);
  EXPECT_TRUE(chip->outputs().ready);
  uint64_t frames = 0, waited = 0;
  for (bool busy = false; !board.ended(); busy = chip->outputs().busy) {
    board.clock();
    const ChipOutputs& out = chip->outputs();
    frames += !busy && out.busy;
    waited += !out.busy && !out.ready;
    if (!out.ready) continue;
    ASSERT_FALSE(out.busy || out.frame_valid || out.memory_request_valid || out.tree_response_valid);
    ASSERT_TRUE(out.device.idle && out.rays == 0);
  }
  EXPECT_EQ(frames, 1u);
  EXPECT_GT(waited, 0u) << "nothing was left when the frame was done";
  EXPECT_TRUE(chip->outputs().ready);
  ChipInputs inputs;
  inputs.start = true;  // the same frame again
  chip->clock(inputs);
  EXPECT_TRUE(chip->outputs().busy);
  EXPECT_FALSE(chip->outputs().ready);
  EXPECT_THROW(chip->start_next({}), std::logic_error);
}

TEST(ChipTraverser, OnTheModelDrawsThePictureOfTheNativeEngine) {
  for (const auto machine_of : {smallest_inside, full_inside}) {
    const Machine machine = machine_of();
    SCOPED_TRACE(machine.configuration.name);
    Drawing drawing(machine, {23, 17, 4, true}, make_cornell());
    const std::unique_ptr<ChipDevice> chip = model_of(machine, drawing.memory());
    drawing.expect_native(drawing.draw_on(*chip));
  }
}

}  // namespace
}  // namespace raypool
